//! The shading pass.

use super::{SampleList, Samples};
use crate::environment::environment_constants;
use crate::every_pixel::{EveryPixel, Recipe};
use crate::formats::RADIANCE_FORMAT;
use crate::geometry::GBuffer;
use crate::gpu::{
    Gpu, bind_group, bind_group_layout, sampled, sampled_layers, storage_read, written,
};
use crate::lights::SceneLights;
use crate::recorder::Recorder;
use crate::{LightAssignment, LightingModel, Settings, shader};

/// Settings that change the lighting shaders.
pub(crate) fn lighting_constants(settings: &Settings) -> Vec<(&'static str, f64)> {
    let mut constants = model_constants(settings).to_vec();
    constants.extend(environment_constants(settings));
    constants.push(("SHADOWS", f64::from(settings.lighting.shadows as u8)));
    constants
}

fn model_constants(settings: &Settings) -> [(&'static str, f64); 2] {
    [
        (
            "BLINN_PHONG",
            f64::from(u8::from(
                settings.lighting.model == LightingModel::BlinnPhong,
            )),
        ),
        (
            "BRUTE",
            f64::from(u8::from(
                settings.lighting.assignment == LightAssignment::Brute,
            )),
        ),
    ]
}

/// Lights samples of the G-buffer.
#[derive(Debug)]
pub(crate) struct ShadingPass {
    every_pixel: EveryPixel,
    /// Where the device has compute shaders.
    list: Option<wgpu::ComputePipeline>,
    input_layout: wgpu::BindGroupLayout,
    list_layout: wgpu::BindGroupLayout,
}

impl ShadingPass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let (read, depth_type): (fn(_) -> _, _) = if gpu.is_reduced() {
            (sampled, wgpu::TextureSampleType::Uint)
        } else {
            (sampled_layers, wgpu::TextureSampleType::Depth)
        };
        let mut types = vec![read(wgpu::TextureSampleType::Uint), read(depth_type)];
        types.extend(SceneLights::binding_types(gpu));
        let input_layout = bind_group_layout(
            gpu,
            "shading input",
            wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE,
            &types,
        );
        let listed = [storage_read(), storage_read(), written(RADIANCE_FORMAT)];
        let list_layout = bind_group_layout(
            gpu,
            "sample list",
            wgpu::ShaderStages::COMPUTE,
            if gpu.is_reduced() { &[] } else { &listed },
        );
        let constants = lighting_constants(settings);
        let drawn = if gpu.is_reduced() {
            shader::SHADING_EVERY_PIXEL.variant(&["REDUCED"])
        } else {
            shader::SHADING_EVERY_PIXEL
        };
        let every_pixel = EveryPixel::new(
            gpu,
            settings,
            &Recipe {
                label: "shading, every pixel",
                drawn: (drawn, "shade_pixel"),
                dispatched: (
                    shader::SHADING_EVERY_PIXEL.variant(&["DISPATCHED"]),
                    "shade_all",
                ),
                groups: &[frame_layout, &input_layout],
                targets: &[RADIANCE_FORMAT],
                constants: &constants,
            },
        );
        let list = (!gpu.is_reduced()).then(|| {
            shader::compute(
                gpu,
                "shading list",
                &shader::module(gpu, "shading, list", shader::SHADING_LIST),
                "shade_list",
                &[frame_layout, &input_layout, &list_layout],
                &constants,
            )
        });
        Self {
            every_pixel,
            list,
            input_layout,
            list_layout,
        }
    }

    /// The layout of [`ShadingPass::input`].
    pub(crate) fn input_layout(&self) -> &wgpu::BindGroupLayout {
        &self.input_layout
    }

    /// What the pass reads: the G-buffer and the lights with their clusters.
    pub(crate) fn input(
        &self,
        gpu: &Gpu,
        gbuffer: &GBuffer,
        lights: SceneLights<'_>,
    ) -> wgpu::BindGroup {
        // The reduced G-buffer holds depth where others hold identity, and is no array.
        let (surface, depth) = if gpu.is_reduced() {
            (&gbuffer.surface_view, &gbuffer.identity_view)
        } else {
            (&gbuffer.surface_layers, &gbuffer.depth_layers)
        };
        let mut resources = vec![
            wgpu::BindingResource::TextureView(surface),
            wgpu::BindingResource::TextureView(depth),
        ];
        resources.extend(lights.resources());
        bind_group(&gpu.device, "shading input", &self.input_layout, &resources)
    }

    /// Encodes the pass: shades `samples` into the same texels of `target`.
    pub(crate) fn shade(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        samples: Samples<'_>,
        target: &wgpu::TextureView,
    ) {
        match samples {
            Samples::EveryPixel => self.shade_every_pixel(recorder, input, target, "shading"),
            Samples::List(list) => {
                let Some(pipeline) = &self.list else { return };
                let group = self.list_group(recorder.gpu, list, target);
                let mut pass = recorder.compute_pass("shading");
                pass.set_pipeline(pipeline);
                pass.set_bind_group(1, input, &[]);
                pass.set_bind_group(2, &group, &[]);
                pass.dispatch_workgroups_indirect(&list.dispatch, 0);
            }
        }
    }

    /// As [`ShadingPass::shade`] for every pixel, timed under `label`.
    pub(crate) fn shade_every_pixel(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        target: &wgpu::TextureView,
        label: &str,
    ) {
        self.every_pixel.run(recorder, label, &[input], &[target]);
    }

    fn list_group(
        &self,
        gpu: &Gpu,
        list: &SampleList,
        target: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        bind_group(
            &gpu.device,
            "sample list",
            &self.list_layout,
            &[
                list.texels.as_entire_binding(),
                list.dispatch.as_entire_binding(),
                wgpu::BindingResource::TextureView(target),
            ],
        )
    }
}
