//! The composite of light: each pixel's own surface in the light of the samples around it
//! (`light.wgsl`).
//!
//! Pixels that no sample speaks for are listed: some for the caller to shade, the others to take
//! those pixels' light (`leaders.wgsl`).

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
    follow: wgpu::ComputePipeline,
    follow_layout: wgpu::BindGroupLayout,
}

/// The place of the pixels that are led among the lists' counts and dispatches.
const LED: u64 = 1;

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
                storage_write(),
            ],
        );
        let size_layout = layout("unlit dispatches", &[storage_read(), storage_write()]);
        let follow_layout = layout(
            "led pixels",
            &[
                sampled_layers(words),
                sampled_layers(wgpu::TextureSampleType::Depth),
                sampled(words),
                written(RADIANCE_FORMAT),
                storage_read(),
                storage_read(),
            ],
        );
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
                "unlit dispatches",
                &shader::module(gpu, "unlit dispatches", shader::SHADING_COARSE_DISPATCH),
                "size_dispatches",
                &[&size_layout],
                &[],
            ),
            follow: shader::compute(
                gpu,
                "led pixels",
                &shader::module(gpu, "led pixels", shader::COMPOSITE_FOLLOW),
                "follow",
                &[frame_layout, &follow_layout],
                &[
                    &environment_constants(settings)[..],
                    &[("LIST", LED as f64)],
                ]
                .concat(),
            ),
            join_layout,
            size_layout,
            follow_layout,
        }
    }

    /// Encodes the passes: fills the radiance target but for the pixels that it lists in
    /// `light.unlit`.
    pub(super) fn join(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &Targets,
        from: &CoarseTargets,
        light: &LightTargets,
    ) {
        let device = &recorder.gpu.device;
        let view = wgpu::BindingResource::TextureView;
        let counts = light.unlit_counts.as_entire_binding();
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
                counts.clone(),
                light.unlit.as_entire_binding(),
                light.wanted.as_entire_binding(),
            ],
        );
        let sizing = bind_group(
            device,
            "unlit dispatches",
            &self.size_layout,
            &[counts, light.unlit_dispatches.as_entire_binding()],
        );
        for buffer in [&light.unlit_counts, &light.wanted] {
            recorder.encoder.clear_buffer(buffer, 0, None);
        }
        let size = targets.radiance_view.texture().size();
        let mut pass = recorder.compute_pass("composite");
        pass.set_pipeline(&self.join);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups(size.width.div_ceil(TILE), size.height.div_ceil(TILE), 1);
        pass.set_pipeline(&self.size);
        pass.set_bind_group(0, &sizing, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }

    /// Encodes the pass: once the other pixels of `light.unlit` are shaded, those that are led take
    /// their light.
    pub(super) fn follow(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &Targets,
        light: &LightTargets,
    ) {
        let view = wgpu::BindingResource::TextureView;
        let group = bind_group(
            &recorder.gpu.device,
            "led pixels",
            &self.follow_layout,
            &[
                view(&targets.gbuffer.surface_layers),
                view(&targets.gbuffer.depth_layers),
                view(light.samples.level(0)),
                view(&targets.radiance_view),
                light.unlit.as_entire_binding(),
                light.unlit_dispatches.as_entire_binding(),
            ],
        );
        let mut pass = recorder.compute_pass("composite");
        pass.set_pipeline(&self.follow);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups_indirect(&light.unlit_dispatches, LED * 16);
    }
}
