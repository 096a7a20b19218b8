//! Bevy that draws into a texture, frame by frame, when it is told to.

use bevy::app::TerminalCtrlCHandlerPlugin;
use bevy::asset::{AssetPlugin, RenderAssetUsages, UnapprovedPathMode};
use bevy::camera::RenderTarget;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::{
    BufferDescriptor, BufferUsages, CommandEncoderDescriptor, Extent3d, MapMode, PipelineCache,
    PollType, TexelCopyBufferInfo, TexelCopyBufferLayout, TextureDimension, TextureFormat,
    TextureUsages,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::texture::GpuImage;
use bevy::render::{RenderApp, RenderPlugin};
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use bevy_foveal_cull::CpuOcclusionPlugin;
use std::time::{Duration, Instant};

/// An app without a window, and its camera.
pub struct Headless {
    app: App,
    target: Handle<Image>,
    size: UVec2,
    /// The camera.
    pub camera: Entity,
}

impl Headless {
    /// An app with a camera that draws a picture of this size.
    pub fn new(size: UVec2, msaa: Msaa, spawn: impl FnOnce(&mut World)) -> Self {
        Self::with_pipelines(true, size, msaa, spawn)
    }

    /// The same, with pipelines that are compiled before they are needed or beside.
    pub fn with_pipelines(
        synchronous: bool,
        size: UVec2,
        msaa: Msaa,
        spawn: impl FnOnce(&mut World),
    ) -> Self {
        let mut app = App::new();
        let window = WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        };
        let render = RenderPlugin {
            synchronous_pipeline_compilation: synchronous,
            ..default()
        };
        app.add_plugins((
            DefaultPlugins
                .set(window)
                .set(render)
                .set(AssetPlugin {
                    unapproved_path_mode: UnapprovedPathMode::Allow,
                    ..default()
                })
                .disable::<WinitPlugin>()
                .disable::<LogPlugin>()
                .disable::<TerminalCtrlCHandlerPlugin>()
                .disable::<PipelinedRenderingPlugin>(),
            CpuOcclusionPlugin,
        ));
        app.finish();
        app.cleanup();
        let world = app.world_mut();
        let mut image = Image::new_uninit(
            Extent3d {
                width: size.x,
                height: size.y,
                depth_or_array_layers: 1,
            },
            TextureDimension::D2,
            TextureFormat::Rgba8UnormSrgb,
            RenderAssetUsages::default(),
        );
        image.texture_descriptor.usage |=
            TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let target = world.resource_mut::<Assets<Image>>().add(image);
        let camera = world
            .spawn((
                Camera3d::default(),
                RenderTarget::from(target.clone()),
                Tonemapping::Reinhard,
                msaa,
            ))
            .id();
        spawn(world);
        Self {
            app,
            target,
            size,
            camera,
        }
    }

    /// The main world.
    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// Draws a frame; returns the time until the device has finished it.
    pub fn frame(&mut self) -> Duration {
        let begin = Instant::now();
        self.app.update();
        self.wait();
        begin.elapsed()
    }

    /// Whether pipelines were still being compiled in the last frame.
    pub fn pipelines_wait(&self) -> bool {
        let cache = self
            .app
            .sub_app(RenderApp)
            .world()
            .resource::<PipelineCache>();
        cache.waiting_pipelines().next().is_some()
    }

    fn wait(&self) {
        let device = self.app.world().resource::<RenderDevice>();
        device
            .poll(PollType::wait_indefinitely())
            .expect("the device is there");
    }

    /// The picture of the last frame: rows of RGBA from the top left.
    pub fn picture(&self) -> Vec<u8> {
        let world = self.app.world();
        let device = world.resource::<RenderDevice>();
        let row = self.size.x * 4;
        let padded = row.next_multiple_of(256);
        let buffer = device.create_buffer(&BufferDescriptor {
            label: None,
            size: u64::from(padded * self.size.y),
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let rendered = self.app.sub_app(RenderApp).world();
        let images = rendered.resource::<RenderAssets<GpuImage>>();
        let texture = &images.get(&self.target).expect("it was drawn").texture;
        let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            TexelCopyBufferInfo {
                buffer: &buffer,
                layout: TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        rendered
            .resource::<RenderQueue>()
            .submit([encoder.finish()]);
        buffer
            .slice(..)
            .map_async(MapMode::Read, |mapped| mapped.expect("it can be read"));
        self.wait();
        let padded_rows = buffer.slice(..).get_mapped_range();
        padded_rows
            .chunks_exact(padded as usize)
            .flat_map(|padded_row| &padded_row[..row as usize])
            .copied()
            .collect()
    }
}
