//! The smooth composite's first half: a patch per tile, fitted to the samples around it.
//!
//! One dispatch per level over the level's list of tiles (`fit.wgsl`), coarsest first, because a corner within a
//! coarser tile's edge follows that edge.

use crate::gpu::{
    Gpu, MipChain, bind_group, bind_group_layout, sampled, storage_read, storage_write, uniform,
};
use crate::recorder::Recorder;
use crate::shading::{CoarseTargets, LevelNumbers};
use crate::stereo::EyeLayout;
use crate::targets::Targets;
use crate::{Settings, shader};

/// Tiles of this level and up are drawn as quads, whatever they hold. Smaller ones have more vertices than pixels.
const QUAD_LEVEL: u32 = 3;

/// Formats of a patch's three texels, which `pack_patch` in `composite/patches.wgsl` describes.
const PARTS: [wgpu::TextureFormat; 3] = [
    wgpu::TextureFormat::Rgba32Uint,
    wgpu::TextureFormat::Rgba32Uint,
    wgpu::TextureFormat::R32Uint,
];

/// A draw of no quads: vertices, instances, first of either.
const NO_QUADS: [u32; 4] = [4, 0, 0, 0];
/// Bytes of an indirect draw's arguments.
pub(super) const DRAW_BYTES: u64 = size_of_val(&NO_QUADS) as u64;

/// The patches of all tiles of one frame size, and which tiles are drawn as quads.
#[derive(Debug)]
pub(crate) struct PatchTargets {
    /// Levels 1 and up: a pixel needs no patch.
    pub(super) parts: [MipChain; 3],
    /// For each level from 1 on, the levels above it; empty for the coarsest.
    above: Vec<Vec<wgpu::TextureView>>,
    /// Marks pixels of quads, and of those the ones at edges: a single level, 0.
    pub(super) stencil: MipChain,
    /// Arguments of two draws: all quads, and those that hold an edge.
    pub(super) quads: wgpu::Buffer,
    no_quads: wgpu::Buffer,
    /// The tiles of either draw, one word each.
    pub(super) quad_tiles: wgpu::Buffer,
}

impl PatchTargets {
    /// Bytes of everything.
    pub(crate) fn bytes(&self) -> u64 {
        let chains = self.parts.iter().chain([&self.stencil]);
        chains.map(MipChain::bytes).sum::<u64>() + self.quads.size() + self.quad_tiles.size()
    }

    /// `None` where all tiles are pixels.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Option<Self> {
        let coarsest = u32::from(settings.coarsest_level);
        if coarsest == 0 {
            return None;
        }
        let size = EyeLayout::of(settings).target_size();
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING;
        let parts =
            PARTS.map(|format| MipChain::new(gpu, "patches", size, 1..=coarsest, format, usage));
        let above = (1..=coarsest)
            .map(|level| match level == coarsest {
                true => Vec::new(),
                false => parts[..2].iter().map(|p| p.above(level)).collect(),
            })
            .collect();
        let (across, down) = parts[0].blocks(1);
        let buffer = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        let draws = 2 * DRAW_BYTES;
        let no_quads = buffer("no quads", draws, wgpu::BufferUsages::empty());
        let none = [NO_QUADS; 2];
        gpu.queue
            .write_buffer(&no_quads, 0, bytemuck::cast_slice(&none));
        Some(Self {
            stencil: MipChain::new(
                gpu,
                "quad stencil",
                size,
                0..=0,
                crate::shading::STENCIL_FORMAT,
                wgpu::TextureUsages::empty(),
            ),
            quads: buffer("quads", draws, storage | wgpu::BufferUsages::INDIRECT),
            no_quads,
            quad_tiles: buffer(
                "quad tiles",
                2 * 4 * u64::from(across) * u64::from(down),
                storage,
            ),
            parts,
            above,
        })
    }
}

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
        let depth = sampled(wgpu::TextureSampleType::Depth);
        let layout = |label, types: &[_]| {
            bind_group_layout(&gpu.device, label, wgpu::ShaderStages::COMPUTE, types)
        };
        let input_layout = layout("patch input", &[uint, float, uint, uint, depth, uint, uint]);
        let [part_0, part_1, part_2] = PARTS.map(|format| wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format,
            view_dimension: wgpu::TextureViewDimension::D2,
        });
        let output_layout = layout(
            "patch output",
            &[
                uniform(),
                storage_read(),
                storage_read(),
                part_0,
                part_1,
                part_2,
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
        let levels = patches.parts[0].range().rev();
        let groups: Vec<_> = levels
            .map(|level| {
                let above = match patches.above[level as usize - 1].as_slice() {
                    [a, b] => [a, b],
                    // Nothing is coarser than the coarsest: any texture will do, none is read.
                    _ => [&from.rate.owner.whole; 2],
                };
                let views = [
                    &from.rate.owner.whole,
                    &from.samples.whole,
                    &targets.gbuffer.surface_view,
                    &targets.gbuffer.identity_view,
                    &targets.gbuffer.depth_view,
                    above[0],
                    above[1],
                ];
                let views = views.map(wgpu::BindingResource::TextureView);
                let [part_0, part_1, part_2] = patches
                    .parts
                    .each_ref()
                    .map(|p| wgpu::BindingResource::TextureView(p.level(level)));
                let output = [
                    self.level_numbers.binding(level),
                    from.dispatches.as_entire_binding(),
                    from.lists[level as usize].as_entire_binding(),
                    part_0,
                    part_1,
                    part_2,
                    patches.quads.as_entire_binding(),
                    patches.quad_tiles.as_entire_binding(),
                ];
                (
                    level,
                    bind_group(&gpu.device, "patch input", &self.input_layout, &views),
                    bind_group(&gpu.device, "patch output", &self.output_layout, &output),
                )
            })
            .collect();
        recorder
            .encoder
            .copy_buffer_to_buffer(&patches.no_quads, 0, &patches.quads, 0, None);
        let mut pass = recorder.compute_pass("patches");
        pass.set_pipeline(&self.fit);
        for (level, input, output) in &groups {
            pass.set_bind_group(1, input, &[]);
            pass.set_bind_group(2, output, &[]);
            pass.dispatch_workgroups_indirect(&from.dispatches, u64::from(*level) * 16);
        }
    }
}
