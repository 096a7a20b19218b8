//! Views: the G-buffer made visible.

use super::PICTURE_FORMAT;
use crate::geometry::GBuffer;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled_layers, storage_read};
use crate::recorder::{Recorder, overwritten};
use crate::{View, shader};

/// Draws one of the views other than the finished frame.
#[derive(Debug)]
pub(crate) struct ViewPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl ViewPass {
    /// `None` for the finished frame and for what other stages show.
    pub(crate) fn new(gpu: &Gpu, view: View, frame_layout: &wgpu::BindGroupLayout) -> Option<Self> {
        let number = match view {
            View::Final | View::Edges | View::Samples => return None,
            View::Rate | View::Blocks | View::Shaded | View::Unknown => return None,
            View::Depth => 1,
            View::Normals => 2,
            View::BaseColor => 3,
            View::Instances => 4,
            View::Motion => 5,
            View::Bins => 6,
        };
        let layout = bind_group_layout(
            &gpu.device,
            "view",
            wgpu::ShaderStages::FRAGMENT,
            &[
                sampled_layers(wgpu::TextureSampleType::Uint),
                sampled_layers(wgpu::TextureSampleType::Uint),
                sampled_layers(wgpu::TextureSampleType::Depth),
                storage_read(),
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
        places: &wgpu::Buffer,
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
                places.as_entire_binding(),
            ],
        );
        let mut pass = recorder.render_pass("view", &[overwritten(picture)], None);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
