//! Tone map: radiance to display values.

use super::PICTURE_FORMAT;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled};
use crate::recorder::{Recorder, overwritten};
use crate::{Settings, ToneMap, shader};

/// Exposes, maps and encodes radiance.
#[derive(Debug)]
pub(crate) struct ToneMapPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl ToneMapPass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let layout = bind_group_layout(
            gpu,
            "tone map",
            wgpu::ShaderStages::FRAGMENT,
            &[sampled(wgpu::TextureSampleType::Float {
                filterable: false,
            })],
        );
        let module = shader::module(gpu, "tone map", shader::OUTPUT_TONE_MAP);
        let pipeline = shader::full_screen(
            gpu,
            "tone map",
            &module,
            "tone_map",
            &[frame_layout, &layout],
            PICTURE_FORMAT,
            &[(
                "CLIPPED",
                f64::from(u8::from(settings.picture.tone_map == ToneMap::Linear)),
            )],
        );
        Self { pipeline, layout }
    }

    /// Encodes the pass.
    pub(crate) fn map(
        &self,
        recorder: &mut Recorder<'_>,
        radiance: &wgpu::TextureView,
        picture: &wgpu::TextureView,
    ) {
        let group = bind_group(
            &recorder.gpu.device,
            "tone map",
            &self.layout,
            &[wgpu::BindingResource::TextureView(radiance)],
        );
        let mut pass = recorder.render_pass("tone map", &[overwritten(picture)], None);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
