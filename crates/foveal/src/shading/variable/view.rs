//! Rates made visible over the finished frame.

use super::VariableTargets;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled};
use crate::output::PICTURE_FORMAT;
use crate::recorder::{Recorder, overwritten};
use crate::{DebugView, shader};

/// Draws one of the views of the rates.
#[derive(Debug)]
pub(crate) struct RateView {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl RateView {
    /// `None` for views that do not show rates.
    pub(crate) fn new(
        gpu: &Gpu,
        view: DebugView,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Option<Self> {
        let number = match view {
            DebugView::Rate => 1,
            DebugView::Unknown => 2,
            DebugView::Shaded => 3,
            _ => return None,
        };
        let layout = bind_group_layout(
            gpu,
            "rate view",
            wgpu::ShaderStages::FRAGMENT,
            &[
                sampled(wgpu::TextureSampleType::Float { filterable: false }),
                sampled(wgpu::TextureSampleType::Uint),
            ],
        );
        let pipeline = shader::full_screen(
            gpu,
            "rate view",
            &shader::module(gpu, "rate view", shader::SHADING_VARIABLE_VIEW),
            "show",
            &[frame_layout, &layout],
            PICTURE_FORMAT,
            &[("VIEW", f64::from(number))],
        );
        Some(Self { pipeline, layout })
    }

    /// Encodes the pass.
    pub(crate) fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        t: &VariableTargets,
        picture: &wgpu::TextureView,
    ) {
        let Some(finished) = &t.finished else { return };
        let group = bind_group(
            &recorder.gpu.device,
            "rate view",
            &self.layout,
            &[finished, &t.mask].map(wgpu::BindingResource::TextureView),
        );
        let mut pass = recorder.render_pass("overlay", &[overwritten(picture)], None);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
