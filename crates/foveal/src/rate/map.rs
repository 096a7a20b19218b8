//! The rate map's passes and targets.

use super::{RateImage, RateTargets, RequestUniform};
use crate::every_pixel::{LevelNumbers, LevelPass, LevelRecipe};
use crate::geometry::GBuffer;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled, sampled_layers, uniform};
use crate::recorder::Recorder;
use crate::{Settings, shader};

/// Fills the rate map.
#[derive(Debug)]
pub(crate) struct RateMapPass {
    request: LevelPass,
    request_layout: wgpu::BindGroupLayout,
    request_uniform: wgpu::Buffer,
    image: wgpu::TextureView,
    pyramid: LevelPass,
    owner: LevelPass,
    cells_layout: wgpu::BindGroupLayout,
    numbers: LevelNumbers,
}

impl RateMapPass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let cells = sampled(wgpu::TextureSampleType::Uint);
        let words = sampled_layers(wgpu::TextureSampleType::Uint);
        let depth = sampled_layers(wgpu::TextureSampleType::Depth);
        let stage = LevelPass::stage(gpu, settings);
        let request_layout = bind_group_layout(
            gpu,
            "requested levels",
            stage,
            &[uniform(), cells, words, words, depth],
        );
        let cells_layout = bind_group_layout(gpu, "rate cells", stage, &[cells]);
        let pass = |label, drawn, dispatched, layout, constants: &[(&str, f64)]| {
            let recipe = LevelRecipe {
                label,
                drawn,
                dispatched,
                groups: [frame_layout, layout],
                constants,
            };
            LevelPass::new(gpu, settings, &recipe)
        };
        let coarsest = f64::from(settings.coarse.coarsest_level);
        let balance = f64::from(u8::from(settings.coarse.balance));
        let request_uniform = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("requested levels"),
            size: size_of::<RequestUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let (by_draw, by_dispatch): (_, &[_]) = if settings.sees_by_depth() {
            let variant = shader::RATE_REQUEST.variant(&["BY_DEPTH"]);
            (variant, &["BY_DEPTH", "DISPATCHED"])
        } else {
            (shader::RATE_REQUEST, &["DISPATCHED"])
        };
        Self {
            request: pass(
                "requested levels",
                (by_draw, "requested_level"),
                (shader::RATE_REQUEST.variant(by_dispatch), "request_all"),
                &request_layout,
                &super::request::request_constants(settings),
            ),
            pyramid: pass(
                "rate pyramid",
                (shader::RATE_PYRAMID, "reduce"),
                (shader::RATE_PYRAMID.variant(&["DISPATCHED"]), "reduce_all"),
                &cells_layout,
                &[("BALANCE", balance)],
            ),
            owner: pass(
                "rate owner",
                (shader::RATE_OWNER, "owner_level"),
                (shader::RATE_OWNER.variant(&["DISPATCHED"]), "own_all"),
                &cells_layout,
                &[("COARSEST", coarsest)],
            ),
            request_layout,
            request_uniform,
            // One texel of level 0: without a picture every pixel is requested.
            image: image_texture(gpu, (1, 1), &[0]),
            cells_layout,
            numbers: LevelNumbers::new(gpu),
        }
    }

    /// Takes over the picture of the image source.
    pub(crate) fn set_image(&mut self, gpu: &Gpu, image: &RateImage) {
        self.image = image_texture(gpu, image.size(), &image.levels());
    }

    /// Encodes the passes.
    pub(crate) fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        uniform: &RequestUniform,
        gbuffer: &GBuffer,
        target: &RateTargets,
    ) {
        let gpu = recorder.gpu;
        gpu.queue
            .write_buffer(&self.request_uniform, 0, bytemuck::bytes_of(uniform));
        let request_group = bind_group(
            &gpu.device,
            "requested levels",
            &self.request_layout,
            &[
                self.request_uniform.as_entire_binding(),
                wgpu::BindingResource::TextureView(&self.image),
                wgpu::BindingResource::TextureView(&gbuffer.surface_layers),
                wgpu::BindingResource::TextureView(&gbuffer.identity_layers),
                wgpu::BindingResource::TextureView(&gbuffer.depth_layers),
            ],
        );
        let cells = |view| {
            bind_group(
                &gpu.device,
                "rate cells",
                &self.cells_layout,
                &[wgpu::BindingResource::TextureView(view)],
            )
        };
        let mut run = |label, pass: &LevelPass, chain, levels: &[_]| {
            pass.run(recorder, label, chain, levels, &self.numbers);
        };
        let pyramid = &target.pyramid;
        let reduced: Vec<_> = (pyramid.range().skip(1))
            .map(|level| (level, cells(pyramid.level(level - 1))))
            .collect();
        let whole = (1, cells(&pyramid.whole));
        let requested = (1, request_group);
        run("requested levels", &self.request, pyramid, &[requested]);
        run("rate pyramid", &self.pyramid, pyramid, &reduced);
        run("rate owner", &self.owner, &target.owner, &[whole]);
    }
}

fn image_texture(gpu: &Gpu, (width, height): (u32, u32), levels: &[u8]) -> wgpu::TextureView {
    let size = wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("rate image"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R8Uint,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    gpu.queue.write_texture(
        texture.as_image_copy(),
        levels,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(width),
            rows_per_image: None,
        },
        size,
    );
    texture.create_view(&Default::default())
}
