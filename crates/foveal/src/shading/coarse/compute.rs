//! The compute backend: an indirect dispatch per level over its list of tiles.

use super::{CoarseTargets, LevelNumbers, by_size};
use crate::composite::{LIGHT_FORMAT, LightTargets};
use crate::gpu::{Gpu, bind_group, bind_group_layout, storage_read, uniform, written};
use crate::recorder::Recorder;
use crate::shading::RADIANCE_FORMAT;
use crate::{Composite, Settings, shader};

/// Shades tiles by dispatches over lists.
#[derive(Debug)]
pub(crate) struct ComputeBackend {
    /// Of larger blocks, and of single pixels.
    shade: [wgpu::ComputePipeline; 2],
    shade_layout: wgpu::BindGroupLayout,
    level_numbers: LevelNumbers,
}

impl ComputeBackend {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
        input_layout: &wgpu::BindGroupLayout,
        shader: shader::Shader,
    ) -> Self {
        let has_light = settings.coarse.composite == Composite::Light;
        let types = [
            uniform(),
            storage_read(),
            storage_read(),
            written(RADIANCE_FORMAT),
            written(LIGHT_FORMAT),
        ];
        let shade_layout = bind_group_layout(
            gpu,
            "tile shading",
            wgpu::ShaderStages::COMPUTE,
            if has_light { &types } else { &types[..4] },
        );
        let module = shader::module(gpu, "coarse shading, list", shader);
        let shade = by_size(settings, |constants| {
            shader::compute(
                gpu,
                "coarse shading, list",
                &module,
                "shade_tiles",
                &[frame_layout, input_layout, &shade_layout],
                constants,
            )
        });
        Self {
            shade,
            shade_layout,
            level_numbers: LevelNumbers::new(gpu),
        }
    }

    /// Encodes the shading of the pixels that no sample speaks for into `radiance`, and of their
    /// light.
    pub(super) fn shade_unlit(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        light: &LightTargets,
        radiance: &wgpu::TextureView,
    ) {
        let group = bind_group(
            &recorder.gpu.device,
            "unlit pixels",
            &self.shade_layout,
            &[
                self.level_numbers.binding(0),
                light.unlit_dispatches.as_entire_binding(),
                light.unlit.as_entire_binding(),
                wgpu::BindingResource::TextureView(radiance),
                wgpu::BindingResource::TextureView(light.samples.level(0)),
            ],
        );
        let mut pass = recorder.compute_pass("shading");
        pass.set_pipeline(&self.shade[1]);
        pass.set_bind_group(1, input, &[]);
        pass.set_bind_group(2, &group, &[]);
        pass.dispatch_workgroups_indirect(&light.unlit_dispatches, 0);
    }

    /// Encodes the shading of the tiles that were listed.
    pub(super) fn shade(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        target: &CoarseTargets,
    ) {
        let gpu = recorder.gpu;
        let levels = || target.samples.range().zip(&target.lists);
        let shading: Vec<_> = levels()
            .map(|(level, list)| {
                let mut resources = vec![
                    self.level_numbers.binding(level),
                    target.dispatches.as_entire_binding(),
                    list.as_entire_binding(),
                    wgpu::BindingResource::TextureView(target.samples.level(level)),
                ];
                if let Some(light) = &target.light {
                    let view = light.samples.level(level);
                    resources.push(wgpu::BindingResource::TextureView(view));
                }
                bind_group(&gpu.device, "tile shading", &self.shade_layout, &resources)
            })
            .collect();
        let mut pass = recorder.compute_pass("shading");
        pass.set_bind_group(1, input, &[]);
        for ((level, _), group) in levels().zip(&shading) {
            pass.set_pipeline(&self.shade[usize::from(level == 0)]);
            pass.set_bind_group(2, group, &[]);
            pass.dispatch_workgroups_indirect(&target.dispatches, u64::from(level) * 16);
        }
    }
}
