//! Passes over every pixel, or every block of a level, as the fragments of a draw or as the
//! invocations of a dispatch.

mod kind;
mod level;
#[cfg(test)]
mod tests;

pub(crate) use level::{LevelNumbers, LevelPass, LevelRecipe};

use crate::Settings;
use crate::gpu::{Gpu, bind_group, bind_group_layout, written};
use crate::recorder::{Recorder, overwritten};
use crate::shader::{self, Screen, Shader};
use kind::{TILE, dispatches};

/// What a pass is made of.
pub(crate) struct Recipe<'a> {
    pub(crate) label: &'a str,
    /// With the entry point of its fragments.
    pub(crate) drawn: (Shader, &'a str),
    /// With the entry point of its invocations, in workgroups of 8 x 8. It writes the targets as
    /// the bindings of the group after `groups`.
    pub(crate) dispatched: (Shader, &'a str),
    pub(crate) groups: &'a [&'a wgpu::BindGroupLayout],
    pub(crate) targets: &'a [wgpu::TextureFormat],
    pub(crate) constants: &'a [(&'a str, f64)],
}

/// A pass that writes every pixel of its targets.
#[derive(Debug)]
pub(crate) enum EveryPixel {
    Drawn(wgpu::RenderPipeline),
    /// With the layout of the targets' group.
    Dispatched(wgpu::ComputePipeline, wgpu::BindGroupLayout),
}

impl EveryPixel {
    pub(crate) fn new(gpu: &Gpu, settings: &Settings, recipe: &Recipe<'_>) -> Self {
        let label = recipe.label;
        if dispatches(gpu, settings) {
            let (shader, entry) = recipe.dispatched;
            let types: Vec<_> = recipe
                .targets
                .iter()
                .map(|&format| written(format))
                .collect();
            let stage = wgpu::ShaderStages::COMPUTE;
            let layout = bind_group_layout(gpu, label, stage, &types);
            let groups: Vec<_> = recipe.groups.iter().copied().chain([&layout]).collect();
            let module = shader::module(gpu, label, shader);
            let pipeline = shader::compute(gpu, label, &module, entry, &groups, recipe.constants);
            return Self::Dispatched(pipeline, layout);
        }
        let (shader, entry) = recipe.drawn;
        let targets = recipe.targets.iter().map(|&format| Some(format.into()));
        Self::Drawn(shader::screen(
            gpu,
            &Screen {
                groups: recipe.groups,
                targets: &targets.collect::<Vec<_>>(),
                constants: recipe.constants,
                ..Screen::of(label, &shader::module(gpu, label, shader), entry)
            },
        ))
    }

    /// Encodes the pass, timed under `label`, with these groups after group 0.
    pub(crate) fn run(
        &self,
        recorder: &mut Recorder<'_>,
        label: &str,
        groups: &[&wgpu::BindGroup],
        targets: &[&wgpu::TextureView],
    ) {
        match self {
            Self::Drawn(pipeline) => {
                // Every texel is written.
                let colors: Vec<_> = targets.iter().map(|target| overwritten(target)).collect();
                let mut pass = recorder.render_pass(label, &colors, None);
                pass.set_pipeline(pipeline);
                for (group, number) in groups.iter().zip(1..) {
                    pass.set_bind_group(number, *group, &[]);
                }
                pass.draw(0..3, 0..1);
            }
            Self::Dispatched(pipeline, layout) => {
                let views: Vec<_> = targets
                    .iter()
                    .map(|target| wgpu::BindingResource::TextureView(target))
                    .collect();
                let written = bind_group(&recorder.gpu.device, label, layout, &views);
                let size = targets.first().map(|target| target.texture().size());
                let size = size.unwrap_or_default();
                let mut pass = recorder.compute_pass(label);
                pass.set_pipeline(pipeline);
                for (group, number) in groups.iter().copied().chain([&written]).zip(1..) {
                    pass.set_bind_group(number, group, &[]);
                }
                pass.dispatch_workgroups(size.width.div_ceil(TILE), size.height.div_ceil(TILE), 1);
            }
        }
    }
}
