//! The shading pass.

use crate::environment::environment_constants;
use crate::every_pixel::{EveryPixel, Recipe};
use crate::formats::RADIANCE_FORMAT;
use crate::geometry::GBuffer;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled, sampled_layers};
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
    input_layout: wgpu::BindGroupLayout,
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
        Self {
            every_pixel,
            input_layout,
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

    /// Encodes the pass: shades every pixel into `target`.
    pub(crate) fn shade(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        target: &wgpu::TextureView,
    ) {
        self.shade_every_pixel(recorder, input, target, "shading");
    }

    /// As [`ShadingPass::shade`], timed under `label`.
    pub(crate) fn shade_every_pixel(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        target: &wgpu::TextureView,
        label: &str,
    ) {
        self.every_pixel.run(recorder, label, &[input], &[target]);
    }
}
