//! The composite of light: each pixel's own surface in the light of the samples around it
//! (`light.wgsl`).
//!
//! Pixels that no sample speaks for are listed; the caller shades them.

use super::LightTargets;
use crate::environment::environment_constants;
use crate::gpu::{
    Gpu, bind_group, bind_group_layout, sampled, sampled_layers, storage_read, storage_write,
    written,
};

use crate::recorder::Recorder;
use crate::shading::{CoarseTargets, RADIANCE_FORMAT};
use crate::targets::Targets;
use crate::{CoarseSample, Settings, shader};

/// Pixels a side of a workgroup.
const TILE: u32 = 8;

/// Puts surfaces into the samples' light.
#[derive(Debug)]
pub(crate) struct LightComposite {
    join: wgpu::ComputePipeline,
    join_layout: wgpu::BindGroupLayout,
    size: wgpu::ComputePipeline,
    size_layout: wgpu::BindGroupLayout,
}

impl LightComposite {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let words = wgpu::TextureSampleType::Uint;
        let layout = |label, types: &[wgpu::BindingType]| {
            bind_group_layout(gpu, label, wgpu::ShaderStages::COMPUTE, types)
        };
        let join_layout = layout(
            "light composite",
            &[
                sampled(words),
                sampled(wgpu::TextureSampleType::Float { filterable: false }),
                sampled_layers(words),
                sampled_layers(wgpu::TextureSampleType::Depth),
                sampled(words),
                written(RADIANCE_FORMAT),
                storage_write(),
                storage_write(),
            ],
        );
        let size_layout = layout("unlit dispatch", &[storage_read(), storage_write()]);
        let typical = settings.coarse.sample == CoarseSample::Typical;
        Self {
            join: shader::compute(
                gpu,
                "light composite",
                &shader::module(gpu, "light composite", shader::COMPOSITE_LIGHT),
                "join",
                &[frame_layout, &join_layout],
                &[
                    &environment_constants(settings)[..],
                    &[("TYPICAL", f64::from(u8::from(typical)))],
                ]
                .concat(),
            ),
            size: shader::compute(
                gpu,
                "unlit dispatch",
                &shader::module(gpu, "unlit dispatch", shader::SHADING_COARSE_DISPATCH),
                "size_dispatches",
                &[&size_layout],
                &[],
            ),
            join_layout,
            size_layout,
        }
    }

    /// Encodes the passes: fills the radiance target but for `light.unlit`, which it lists.
    pub(super) fn join(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &Targets,
        from: &CoarseTargets,
        light: &LightTargets,
    ) {
        let device = &recorder.gpu.device;
        let view = wgpu::BindingResource::TextureView;
        let count = light.unlit_count.as_entire_binding();
        let group = bind_group(
            device,
            "light composite",
            &self.join_layout,
            &[
                view(&from.rate.owner.whole),
                view(&from.samples.whole),
                view(&targets.gbuffer.surface_layers),
                view(&targets.gbuffer.depth_layers),
                view(&light.samples.whole),
                view(&targets.radiance_view),
                count.clone(),
                light.unlit.texels.as_entire_binding(),
            ],
        );
        let sizing = bind_group(
            device,
            "unlit dispatch",
            &self.size_layout,
            &[count, light.unlit.dispatch.as_entire_binding()],
        );
        recorder.encoder.clear_buffer(&light.unlit_count, 0, None);
        let size = targets.radiance_view.texture().size();
        let mut pass = recorder.compute_pass("composite");
        pass.set_pipeline(&self.join);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups(size.width.div_ceil(TILE), size.height.div_ceil(TILE), 1);
        pass.set_pipeline(&self.size);
        pass.set_bind_group(0, &sizing, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
}
