//! Counts the tiles of each level, for the statistics: the stencil backend itself never needs their
//! number.

use super::{CoarseTargets, LEVELS, LevelNumbers};
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled, storage_write, uniform};
use crate::recorder::Recorder;
use crate::{Settings, shader};

/// Blocks a side that one workgroup looks at.
const COUNTED: u32 = 16;

/// Counts tiles.
#[derive(Debug)]
pub(crate) struct CountPass {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    level_numbers: LevelNumbers,
}

impl CountPass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let layout = bind_group_layout(
            gpu,
            "tile counting",
            wgpu::ShaderStages::COMPUTE,
            &[
                uniform(),
                sampled(wgpu::TextureSampleType::Uint),
                storage_write(),
            ],
        );
        let pipeline = shader::compute(
            gpu,
            "tile counting",
            &shader::module(gpu, "tile counting", shader::SHADING_COARSE_LIST),
            "count_tiles",
            &[frame_layout, &layout],
            &[("COARSEST", f64::from(settings.coarse.coarsest_level))],
        );
        Self {
            pipeline,
            layout,
            level_numbers: LevelNumbers::new(gpu),
        }
    }

    /// Encodes the pass.
    pub(super) fn draw(&self, recorder: &mut Recorder<'_>, target: &CoarseTargets) {
        let gpu = recorder.gpu;
        recorder.encoder.clear_buffer(&target.counts, 0, None);
        let groups: Vec<_> = target
            .samples
            .range()
            .map(|level| {
                bind_group(
                    &gpu.device,
                    "tile counting",
                    &self.layout,
                    &[
                        self.level_numbers.binding(level),
                        wgpu::BindingResource::TextureView(&target.rate.pyramid.whole),
                        target.counts.as_entire_binding(),
                    ],
                )
            })
            .collect();
        let mut pass = recorder.compute_pass("tile counting");
        pass.set_pipeline(&self.pipeline);
        for (level, group) in target.samples.range().zip(&groups) {
            let (width, height) = target.samples.blocks(level);
            pass.set_bind_group(1, group, &[]);
            pass.dispatch_workgroups(width.div_ceil(COUNTED), height.div_ceil(COUNTED), 1);
        }
    }

    /// Tiles per level from the bytes of [`CoarseTargets::counts`].
    pub(crate) fn tiles(bytes: &[u8], coarsest: u8) -> Vec<u64> {
        bytes
            .as_chunks::<4>()
            .0
            .iter()
            .take((usize::from(coarsest) + 1).min(LEVELS as usize))
            .map(|&word| u64::from(u32::from_le_bytes(word)))
            .collect()
    }
}
