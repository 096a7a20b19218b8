//! The tiling of coarse shading made visible over the finished frame.

use super::PICTURE_FORMAT;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled};
use crate::recorder::{Recorder, drawn_over};
use crate::shader::Screen;
use crate::shading::CoarseTargets;
use crate::{DebugView, shader};

/// Draws levels, tile borders or samples over the picture.
#[derive(Debug)]
pub(crate) struct OverlayPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl OverlayPass {
    /// `None` for views that do not show the tiling.
    pub(crate) fn new(
        gpu: &Gpu,
        view: DebugView,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Option<Self> {
        let number = match view {
            DebugView::Rate => 1,
            DebugView::Blocks => 2,
            DebugView::Shaded => 3,
            _ => return None,
        };
        let layout = bind_group_layout(
            gpu,
            "overlay",
            wgpu::ShaderStages::FRAGMENT,
            &[
                sampled(wgpu::TextureSampleType::Uint),
                sampled(wgpu::TextureSampleType::Float { filterable: false }),
            ],
        );
        let module = shader::module(gpu, "overlay", shader::OUTPUT_OVERLAY);
        let pipeline = shader::screen(
            gpu,
            &Screen {
                groups: &[frame_layout, &layout],
                targets: &[Some(wgpu::ColorTargetState {
                    format: PICTURE_FORMAT,
                    blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::COLOR,
                })],
                constants: &[("VIEW", f64::from(number))],
                ..Screen::of_level("overlay", &module, "overlay")
            },
        );
        Some(Self { pipeline, layout })
    }

    /// Encodes the pass.
    pub(crate) fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        tiles: &CoarseTargets,
        picture: &wgpu::TextureView,
    ) {
        let group = bind_group(
            &recorder.gpu.device,
            "overlay",
            &self.layout,
            &[&tiles.rate.owner.whole, &tiles.samples.whole]
                .map(wgpu::BindingResource::TextureView),
        );
        let mut pass = recorder.render_pass("overlay", &[drawn_over(picture)], None);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
