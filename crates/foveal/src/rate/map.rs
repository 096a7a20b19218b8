//! The rate map's passes and targets.

use super::targets::{CELL_FORMAT, RateTargets};
use super::{RateImage, RequestUniform};
use crate::geometry::GBuffer;
use crate::gpu::{Gpu, MipChain, bind_group, bind_group_layout, sampled, sampled_layers, uniform};
use crate::recorder::{Recorder, overwritten};
use crate::shader::Screen;
use crate::stereo::{Eye, LensFit};
use crate::{Settings, shader};

/// Fills the rate map.
#[derive(Debug)]
pub(crate) struct RateMapPass {
    request: wgpu::RenderPipeline,
    request_layout: wgpu::BindGroupLayout,
    request_uniform: wgpu::Buffer,
    image: wgpu::TextureView,
    pyramid: wgpu::RenderPipeline,
    owner: wgpu::RenderPipeline,
    cells_layout: wgpu::BindGroupLayout,
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
        let stage = wgpu::ShaderStages::FRAGMENT;
        let request_layout = bind_group_layout(
            gpu,
            "requested levels",
            stage,
            &[uniform(), cells, words, words, depth],
        );
        let cells_layout = bind_group_layout(gpu, "rate cells", stage, &[cells]);
        let pipeline = |label, shader, entry, layout, constant: &[(&str, f64)]| {
            shader::screen(
                gpu,
                &Screen {
                    groups: &[frame_layout, layout],
                    targets: &[Some(CELL_FORMAT.into())],
                    constants: constant,
                    ..Screen::of_level(label, &shader::module(gpu, label, shader), entry)
                },
            )
        };
        let coarsest = f64::from(settings.coarse.coarsest_level);
        let balance = f64::from(u8::from(settings.coarse.balance));
        let request_uniform = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("requested levels"),
            size: size_of::<RequestUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self {
            request: pipeline(
                "requested levels",
                if settings.sees_by_depth() {
                    shader::RATE_REQUEST.variant(&["BY_DEPTH"])
                } else {
                    shader::RATE_REQUEST
                },
                "requested_level",
                &request_layout,
                &super::request::request_constants(settings),
            ),
            pyramid: pipeline(
                "rate pyramid",
                shader::RATE_PYRAMID,
                "reduce",
                &cells_layout,
                &[("BALANCE", balance)],
            ),
            owner: pipeline(
                "rate owner",
                shader::RATE_OWNER,
                "owner_level",
                &cells_layout,
                &[("COARSEST", coarsest)],
            ),
            request_layout,
            request_uniform,
            // One texel of level 0: without a picture every pixel is requested.
            image: image_texture(gpu, (1, 1), &[0]),
            cells_layout,
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
        settings: &Settings,
        (eyes, lenses): (&[Eye; 2], Option<&[LensFit; 2]>),
        gbuffer: &GBuffer,
        target: &RateTargets,
    ) {
        let gpu = recorder.gpu;
        let uniform = RequestUniform::new(settings, eyes, lenses);
        gpu.queue
            .write_buffer(&self.request_uniform, 0, bytemuck::bytes_of(&uniform));
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
        let mut fill = |label, chain: &MipChain, level, pipeline, group: &wgpu::BindGroup| {
            let color = overwritten(chain.level(level));
            let mut pass = recorder.render_pass(label, &[color], None);
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, group, &[]);
            chain.draw(&mut pass, level);
        };
        let pyramid = &target.pyramid;
        fill(
            "requested levels",
            pyramid,
            1,
            &self.request,
            &request_group,
        );
        for level in pyramid.range().skip(1) {
            let below = cells(pyramid.level(level - 1));
            fill("rate pyramid", pyramid, level, &self.pyramid, &below);
        }
        let whole = cells(&pyramid.whole);
        fill("rate owner", &target.owner, 1, &self.owner, &whole);
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
        format: CELL_FORMAT,
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
