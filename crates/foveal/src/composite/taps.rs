//! Composites that read nothing but the tiling and its samples.

use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled};
use crate::recorder::{Recorder, overwritten};
use crate::shader;
use crate::shader::Screen;
use crate::shading::{CoarseTargets, RADIANCE_FORMAT};

/// A pixel's radiance from a few taps.
#[derive(Debug)]
pub(crate) struct TapComposite {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl TapComposite {
    pub(super) fn new(
        gpu: &Gpu,
        frame_layout: &wgpu::BindGroupLayout,
        shader: shader::Shader,
        entry_point: &str,
    ) -> Self {
        let layout = bind_group_layout(
            gpu,
            "composite",
            wgpu::ShaderStages::FRAGMENT,
            &[
                sampled(wgpu::TextureSampleType::Uint),
                sampled(wgpu::TextureSampleType::Float { filterable: false }),
            ],
        );
        let module = shader::module(gpu, "composite", shader);
        let pipeline = shader::screen(
            gpu,
            &Screen {
                groups: &[frame_layout, &layout],
                targets: &[Some(RADIANCE_FORMAT.into())],
                ..Screen::of_level("composite", &module, entry_point)
            },
        );
        Self { pipeline, layout }
    }

    /// Encodes the pass.
    pub(super) fn join(
        &self,
        recorder: &mut Recorder<'_>,
        from: &CoarseTargets,
        radiance: &wgpu::TextureView,
    ) {
        let group = bind_group(
            &recorder.gpu.device,
            "composite",
            &self.layout,
            &[&from.rate.owner.whole, &from.samples.whole].map(wgpu::BindingResource::TextureView),
        );
        let mut pass = recorder.render_pass("composite", &[overwritten(radiance)], None);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
