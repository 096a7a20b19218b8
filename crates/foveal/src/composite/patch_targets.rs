//! What the smooth composite keeps of each tile.

use crate::gpu::{Gpu, MipChain};
use crate::stereo::EyeLayout;
use crate::{Error, Settings};

/// Bytes of a patch's parts in the two buffers, which `pack_patch` in `composite/patches.wgsl`
/// describes.
const PART_BYTES: [u64; 2] = [32, 4];

/// The patches of all tiles of one frame size, and which tiles are drawn as quads.
#[derive(Debug)]
pub(crate) struct PatchTargets {
    /// The parts of all patches, levels 1 and up: a pixel needs none.
    pub(super) parts: [wgpu::Buffer; 2],
    pub(super) coarsest: u32,
    /// Marks pixels of quads, and of those the ones at edges: a single level, 0.
    pub(super) stencil: MipChain,
    /// Arguments of two draws: all quads, and those that hold an edge.
    pub(super) quads: wgpu::Buffer,
    pub(super) no_quads: wgpu::Buffer,
    /// The tiles of either draw, one word each.
    pub(super) quad_tiles: wgpu::Buffer,
}

impl PatchTargets {
    /// Bytes of everything.
    pub(crate) fn bytes(&self) -> u64 {
        let buffers = self.parts.iter().chain([&self.quads, &self.quad_tiles]);
        self.stencil.bytes() + buffers.map(wgpu::Buffer::size).sum::<u64>()
    }

    /// `None` where all tiles are pixels.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Option<Self> {
        let coarsest = u32::from(settings.coarse.coarsest_level);
        if coarsest == 0 {
            return None;
        }
        let size = EyeLayout::of(settings).target_size();
        let buffer = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        let patches = patches(size, coarsest);
        let [pixels_across, pixels_down] = [size.0, size.1].map(|p| u64::from(p.div_ceil(2)));
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
            quad_tiles: buffer("quad tiles", 2 * 4 * pixels_across * pixels_down, storage),
            parts: PART_BYTES.map(|bytes| buffer("patches", bytes * patches, storage)),
            coarsest,
        })
    }
}

/// How many patches there are: one per block of each level from 1 on, of a picture padded to whole
/// blocks of the coarsest.
fn patches((width, height): (u32, u32), coarsest: u32) -> u64 {
    let padded = |pixels: u32| u64::from(pixels.next_multiple_of(1 << coarsest));
    let pixels = padded(width) * padded(height);
    (1..=coarsest).map(|level| pixels >> (2 * level)).sum()
}

/// [`Error::Limit`] where the device cannot bind as large a buffer as the patches of these settings
/// need.
pub(crate) fn check_limits(settings: &Settings, limits: &wgpu::Limits) -> Result<(), Error> {
    let size = EyeLayout::of(settings).target_size();
    let value = PART_BYTES[0] * patches(size, settings.coarse.coarsest_level.into());
    let limit = limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size);
    if value <= limit {
        return Ok(());
    }
    Err(Error::Limit {
        what: "bytes for the smooth composite's patches".to_owned(),
        value,
        limit,
        hint: ": make the picture smaller, or take the composite 'nearest' or 'paper'".to_owned(),
    })
}

/// A draw of no quads: vertices, instances, first of either.
const NO_QUADS: [u32; 4] = [4, 0, 0, 0];
/// Bytes of an indirect draw's arguments.
pub(super) const DRAW_BYTES: u64 = size_of_val(&NO_QUADS) as u64;
