//! Views: the G-buffer made visible.

use super::PICTURE_FORMAT;
use crate::geometry::GBuffer;
use crate::gpu::{Gpu, Table, bind_group, bind_group_layout, sampled_layers};
use crate::recorder::{Recorder, overwritten};
use crate::{DebugView, shader};

/// Draws one of the views other than the finished frame.
#[derive(Debug)]
pub(crate) struct ViewPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl ViewPass {
    /// `None` for the finished frame and for what other stages show.
    pub(crate) fn new(
        gpu: &Gpu,
        view: DebugView,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Option<Self> {
        let number = match view {
            DebugView::Final | DebugView::Edges | DebugView::Samples => return None,
            DebugView::Rate | DebugView::Blocks | DebugView::Shaded | DebugView::Unknown => {
                return None;
            }
            DebugView::Depth => 1,
            DebugView::Normals => 2,
            DebugView::BaseColor => 3,
            DebugView::Instances => 4,
            DebugView::Motion => 5,
            DebugView::Bins => 6,
        };
        let layout = bind_group_layout(
            gpu,
            "view",
            wgpu::ShaderStages::FRAGMENT,
            &[
                sampled_layers(wgpu::TextureSampleType::Uint),
                sampled_layers(wgpu::TextureSampleType::Uint),
                sampled_layers(wgpu::TextureSampleType::Depth),
                Table::binding_type(gpu),
            ],
        );
        let module = shader::module(gpu, "view", shader::OUTPUT_VIEW);
        let constants = [("VIEW", f64::from(number))];
        let pipeline = shader::full_screen(
            gpu,
            "view",
            &module,
            "view",
            &[frame_layout, &layout],
            PICTURE_FORMAT,
            &constants,
        );
        Some(Self { pipeline, layout })
    }

    /// Encodes the pass.
    pub(crate) fn show(
        &self,
        recorder: &mut Recorder<'_>,
        gbuffer: &GBuffer,
        places: &Table,
        picture: &wgpu::TextureView,
    ) {
        let group = bind_group(
            &recorder.gpu.device,
            "view",
            &self.layout,
            &[
                wgpu::BindingResource::TextureView(&gbuffer.surface_layers),
                wgpu::BindingResource::TextureView(&gbuffer.identity_layers),
                wgpu::BindingResource::TextureView(&gbuffer.depth_layers),
                places.resource(),
            ],
        );
        let mut pass = recorder.render_pass("view", &[overwritten(picture)], None);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
