//! Passes over one level of a mip chain.

use super::kind::{TILE, dispatches};
use crate::Settings;
use crate::gpu::{Gpu, MipChain, bind_group, bind_group_layout, uniform, written};
use crate::recorder::{Recorder, overwritten};
use crate::shader::{self, Screen, Shader};

/// Levels that a dispatch may be told.
const LEVELS: u32 = crate::COARSEST_LEVEL as u32 + 1;

/// The numbers 0, 1, ... that tell a dispatch its level.
#[derive(Debug)]
pub(crate) struct LevelNumbers {
    buffer: wgpu::Buffer,
    /// Bytes from one to the next.
    step: u32,
}

impl LevelNumbers {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let step = gpu.device.limits().min_uniform_buffer_offset_alignment;
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("levels"),
            size: u64::from(step * LEVELS),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        for level in 0..LEVELS {
            let number = bytemuck::bytes_of(&level);
            gpu.queue
                .write_buffer(&buffer, u64::from(level * step), number);
        }
        Self { buffer, step }
    }

    fn of(&self, level: u32) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset: u64::from(level * self.step),
            size: std::num::NonZeroU64::new(size_of::<u32>() as u64),
        })
    }
}

/// A pass that writes every block of a level.
#[derive(Debug)]
pub(crate) enum LevelPass {
    Drawn(wgpu::RenderPipeline),
    /// With the layout of the group of `shared/dispatched_level.wgsl`.
    Dispatched(wgpu::ComputePipeline, wgpu::BindGroupLayout),
}

/// What such a pass is made of.
pub(crate) struct LevelRecipe<'a> {
    pub(crate) label: &'a str,
    /// With the entry point of its fragments (`shared/level.wgsl`).
    pub(crate) drawn: (Shader, &'a str),
    /// With the entry point of its invocations (`shared/dispatched_level.wgsl`).
    pub(crate) dispatched: (Shader, &'a str),
    /// Groups 0 and 1.
    pub(crate) groups: [&'a wgpu::BindGroupLayout; 2],
    pub(crate) constants: &'a [(&'a str, f64)],
}

impl LevelPass {
    /// The stage that sees the bindings of group 1.
    pub(crate) fn stage(gpu: &Gpu, settings: &Settings) -> wgpu::ShaderStages {
        if dispatches(gpu, settings) {
            wgpu::ShaderStages::COMPUTE
        } else {
            wgpu::ShaderStages::FRAGMENT
        }
    }

    /// A format of one number that the pass can write, and the usage that it needs.
    pub(crate) fn format(
        gpu: &Gpu,
        settings: &Settings,
    ) -> (wgpu::TextureFormat, wgpu::TextureUsages) {
        if dispatches(gpu, settings) {
            // No smaller integers can be written in WebGPU.
            let usage = wgpu::TextureUsages::STORAGE_BINDING;
            (wgpu::TextureFormat::R32Uint, usage)
        } else {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
            (wgpu::TextureFormat::R8Uint, usage)
        }
    }

    pub(crate) fn new(gpu: &Gpu, settings: &Settings, recipe: &LevelRecipe<'_>) -> Self {
        let label = recipe.label;
        let (format, _) = Self::format(gpu, settings);
        let [frame, group] = recipe.groups;
        if dispatches(gpu, settings) {
            let (shader, entry) = recipe.dispatched;
            let stage = wgpu::ShaderStages::COMPUTE;
            let layout = bind_group_layout(gpu, label, stage, &[written(format), uniform()]);
            let module = shader::module(gpu, label, shader);
            let groups = [frame, group, &layout];
            let pipeline = shader::compute(gpu, label, &module, entry, &groups, recipe.constants);
            return Self::Dispatched(pipeline, layout);
        }
        let (shader, entry) = recipe.drawn;
        Self::Drawn(shader::screen(
            gpu,
            &Screen {
                groups: &[frame, group],
                targets: &[Some(format.into())],
                constants: recipe.constants,
                ..Screen::of_level(label, &shader::module(gpu, label, shader), entry)
            },
        ))
    }

    /// Encodes the pass into levels of a chain, timed under `label`, each with its group 1.
    pub(crate) fn run(
        &self,
        recorder: &mut Recorder<'_>,
        label: &str,
        chain: &MipChain,
        levels: &[(u32, wgpu::BindGroup)],
        numbers: &LevelNumbers,
    ) {
        match self {
            Self::Drawn(pipeline) => {
                for (level, group) in levels {
                    let color = overwritten(chain.level(*level));
                    let mut pass = recorder.render_pass(label, &[color], None);
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(1, group, &[]);
                    chain.draw(&mut pass, *level);
                }
            }
            Self::Dispatched(pipeline, layout) => {
                let device = &recorder.gpu.device;
                let mut pass = recorder.compute_pass(label);
                pass.set_pipeline(pipeline);
                for (level, group) in levels {
                    let target = wgpu::BindingResource::TextureView(chain.level(*level));
                    let written = bind_group(device, label, layout, &[target, numbers.of(*level)]);
                    let (width, height) = chain.blocks(*level);
                    pass.set_bind_group(1, group, &[]);
                    pass.set_bind_group(2, &written, &[]);
                    pass.dispatch_workgroups(width.div_ceil(TILE), height.div_ceil(TILE), 1);
                }
            }
        }
    }
}
