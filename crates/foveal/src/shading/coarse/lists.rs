//! Lists of the tiles of each level, and the indirect dispatches that visit them.

use super::{CoarseTargets, LEVELS};
use crate::gpu::{
    Gpu, bind_group, bind_group_layout, sampled, storage_read, storage_write, uniform,
};

use crate::recorder::Recorder;
use crate::{Settings, shader};

/// Blocks a side that one workgroup of the listing looks at.
const LISTED: u32 = 16;

/// The numbers of the levels as uniforms, one binding each.
#[derive(Debug)]
pub(crate) struct LevelNumbers(wgpu::Buffer);

/// Uniform offsets are multiples of this on every device.
const OFFSET_ALIGNMENT: u32 = 256;

impl LevelNumbers {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("level numbers"),
            size: u64::from(LEVELS * OFFSET_ALIGNMENT),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        for level in 0..LEVELS {
            let offset = u64::from(level * OFFSET_ALIGNMENT);
            gpu.queue
                .write_buffer(&buffer, offset, &level.to_le_bytes());
        }
        Self(buffer)
    }

    pub(crate) fn binding(&self, level: u32) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.0,
            offset: u64::from(level * OFFSET_ALIGNMENT),
            size: std::num::NonZeroU64::new(4),
        })
    }
}

/// Lists tiles.
#[derive(Debug)]
pub(crate) struct TileListing {
    list: wgpu::ComputePipeline,
    list_layout: wgpu::BindGroupLayout,
    size: wgpu::ComputePipeline,
    size_layout: wgpu::BindGroupLayout,
    level_numbers: LevelNumbers,
}

impl TileListing {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let layout = |label, types: &[wgpu::BindingType]| {
            bind_group_layout(gpu, label, wgpu::ShaderStages::COMPUTE, types)
        };
        let list_layout = layout(
            "tile listing",
            &[
                uniform(),
                sampled(wgpu::TextureSampleType::Uint),
                storage_write(),
                storage_write(),
            ],
        );
        let size_layout = layout("tile dispatches", &[storage_read(), storage_write()]);
        Self {
            list: shader::compute(
                gpu,
                "tile listing",
                &shader::module(gpu, "tile listing", shader::SHADING_COARSE_LIST),
                "list_tiles",
                &[frame_layout, &list_layout],
                &[("COARSEST", f64::from(settings.coarse.coarsest_level))],
            ),
            size: shader::compute(
                gpu,
                "tile dispatches",
                &shader::module(gpu, "tile dispatches", shader::SHADING_COARSE_DISPATCH),
                "size_dispatches",
                &[&size_layout],
                &[],
            ),
            list_layout,
            size_layout,
            level_numbers: LevelNumbers::new(gpu),
        }
    }

    /// Encodes the pass: fills `target.lists`, `target.counts` and `target.dispatches`.
    pub(super) fn list(&self, recorder: &mut Recorder<'_>, target: &CoarseTargets) {
        let gpu = recorder.gpu;
        let levels = || target.samples.range().zip(&target.lists);
        recorder.encoder.clear_buffer(&target.counts, 0, None);
        let listing: Vec<_> = levels()
            .map(|(level, list)| {
                bind_group(
                    &gpu.device,
                    "tile listing",
                    &self.list_layout,
                    &[
                        self.level_numbers.binding(level),
                        wgpu::BindingResource::TextureView(&target.rate.pyramid.whole),
                        target.counts.as_entire_binding(),
                        list.as_entire_binding(),
                    ],
                )
            })
            .collect();
        let sizing = bind_group(
            &gpu.device,
            "tile dispatches",
            &self.size_layout,
            &[
                target.counts.as_entire_binding(),
                target.dispatches.as_entire_binding(),
            ],
        );
        {
            let mut pass = recorder.compute_pass("tile listing");
            pass.set_pipeline(&self.list);
            for ((level, _), group) in levels().zip(&listing) {
                let (width, height) = target.samples.blocks(level);
                pass.set_bind_group(1, group, &[]);
                pass.dispatch_workgroups(width.div_ceil(LISTED), height.div_ceil(LISTED), 1);
            }
            pass.set_pipeline(&self.size);
            pass.set_bind_group(0, &sizing, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        }
    }
}
