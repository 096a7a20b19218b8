//! The smooth composite's first half: a patch per tile, fitted to the samples around it.
//!
//! One dispatch per level over the level's list of tiles (`fit.wgsl`), coarsest first, because a
//! corner within a coarser tile's edge follows that edge.

use super::patch_targets::PatchTargets;
use crate::gpu::{
    Gpu, bind_group, bind_group_layout, sampled, sampled_layers, storage_read, storage_write,
    uniform,
};

use crate::recorder::Recorder;
use crate::shader;
use crate::shading::{CoarseTargets, LevelNumbers};
use crate::targets::Targets;

/// Tiles of this level and up are drawn as quads, whatever they hold. Smaller ones have more
/// vertices than pixels.
const QUAD_LEVEL: u32 = 3;

/// Fits patches.
#[derive(Debug)]
pub(super) struct PatchPass {
    fit: wgpu::ComputePipeline,
    input_layout: wgpu::BindGroupLayout,
    output_layout: wgpu::BindGroupLayout,
    level_numbers: LevelNumbers,
}

impl PatchPass {
    pub(super) fn new(gpu: &Gpu, frame_layout: &wgpu::BindGroupLayout) -> Self {
        let uint = sampled(wgpu::TextureSampleType::Uint);
        let float = sampled(wgpu::TextureSampleType::Float { filterable: false });
        let words = sampled_layers(wgpu::TextureSampleType::Uint);
        let depth = sampled_layers(wgpu::TextureSampleType::Depth);
        let layout =
            |label, types: &[_]| bind_group_layout(gpu, label, wgpu::ShaderStages::COMPUTE, types);
        let input_layout = layout("patch input", &[uint, float, words, words, depth]);
        let output_layout = layout(
            "patch output",
            &[
                uniform(),
                storage_read(),
                storage_read(),
                storage_write(),
                storage_write(),
                storage_write(),
                storage_write(),
            ],
        );
        Self {
            fit: shader::compute(
                gpu,
                "patches",
                &shader::module(gpu, "patches", shader::COMPOSITE_FIT),
                "fit_patches",
                &[frame_layout, &input_layout, &output_layout],
                &[("QUAD_LEVEL", f64::from(QUAD_LEVEL))],
            ),
            input_layout,
            output_layout,
            level_numbers: LevelNumbers::new(gpu),
        }
    }

    /// Encodes the pass.
    pub(super) fn fit(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &Targets,
        from: &CoarseTargets,
        patches: &PatchTargets,
    ) {
        let gpu = recorder.gpu;
        let views = [
            &from.rate.owner.whole,
            &from.samples.whole,
            &targets.gbuffer.surface_layers,
            &targets.gbuffer.identity_layers,
            &targets.gbuffer.depth_layers,
        ];
        let views = views.map(wgpu::BindingResource::TextureView);
        let input = bind_group(&gpu.device, "patch input", &self.input_layout, &views);
        let [corners, raises] = patches.parts.each_ref().map(|p| p.as_entire_binding());
        let outputs = (1..=patches.coarsest).rev().map(|level| {
            let output = [
                self.level_numbers.binding(level),
                from.dispatches.as_entire_binding(),
                from.lists[level as usize].as_entire_binding(),
                corners.clone(),
                raises.clone(),
                patches.quads.as_entire_binding(),
                patches.quad_tiles.as_entire_binding(),
            ];
            let group = bind_group(&gpu.device, "patch output", &self.output_layout, &output);
            (level, group)
        });
        let outputs: Vec<_> = outputs.collect();
        recorder
            .encoder
            .copy_buffer_to_buffer(&patches.no_quads, 0, &patches.quads, 0, None);
        let mut pass = recorder.compute_pass("patches");
        pass.set_pipeline(&self.fit);
        pass.set_bind_group(1, &input, &[]);
        for (level, output) in &outputs {
            pass.set_bind_group(2, output, &[]);
            pass.dispatch_workgroups_indirect(&from.dispatches, u64::from(*level) * 16);
        }
    }
}
