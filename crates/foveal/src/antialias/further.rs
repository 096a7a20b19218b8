//! What is kept of further surfaces at edges.

use crate::geometry::{
    DEPTH_FORMAT, GBuffer, IDENTITY_FORMAT, SURFACE_FORMAT, TRIANGLE_FORMAT, VisibilityTargets,
};

use crate::gpu::{Gpu, target};

/// A word per texel: bits of an entry's depth, a candidate, a pixel's largest surface.
pub(super) const WORD: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// A texture that stands where one is asked for and none is looked at.
const NONE: (u32, u32) = (1, 1);

/// What the further surfaces of all pixels are evaluated in.
#[derive(Debug)]
pub(crate) struct FurtherTargets {
    /// Of entry i, row by row; without depth.
    pub(super) gbuffer: GBuffer,
    pub(super) depth_view: wgpu::TextureView,
    /// Of one band: how many pixels show several triangles, which they are, and each one's largest
    /// surface.
    pub(super) candidates: wgpu::Buffer,
    pub(super) no_candidates: wgpu::Buffer,
    pub(super) candidate_list_view: wgpu::TextureView,
    pub(super) largest_view: wgpu::TextureView,
}

/// An indirect dispatch of nothing, and the number of candidates.
const NO_CANDIDATES: [u32; 4] = [0, 1, 1, 0];
/// Bytes of an entry in [`FurtherTargets`], the list of its pixels included.
const FURTHER_BYTES: u64 = 16 + 8 + 4 + 4 + 4;

impl FurtherTargets {
    /// Room for one further surface in every fourth pixel, more for a small picture: one of a
    /// detailed scene has one in every fifth. Where the room ends, a pixel shows its largest
    /// surface alone, until there is more.
    pub(super) fn usual_room(width: u32, height: u32) -> u64 {
        u64::from(width) * u64::from(height.div_ceil(4).max((2 * height).min(128)))
    }

    /// Rows of the target that has room for so many entries, as far as the device's textures go.
    pub(super) fn rows(limits: &wgpu::Limits, width: u32, room: u64) -> u32 {
        let most = limits.max_texture_dimension_2d;
        room.div_ceil(width.into()).clamp(1, most.into()) as u32
    }

    /// For a picture of this size, with room for at least so many entries, as far as the device's
    /// textures go.
    pub(super) fn new(gpu: &Gpu, width: u32, height: u32, room: u64) -> Self {
        let rows = Self::rows(&gpu.device.limits(), width, room);
        let size = (width, rows);
        let written = wgpu::TextureUsages::STORAGE_BINDING;
        let none = wgpu::TextureUsages::empty();
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size_of_val(&NO_CANDIDATES) as u64,
                usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let no_candidates = buffer("no candidates", wgpu::BufferUsages::empty());
        gpu.queue
            .write_buffer(&no_candidates, 0, bytemuck::cast_slice(&NO_CANDIDATES));
        let triangles = target(gpu, "further triangles", size, TRIANGLE_FORMAT, written);
        let visibility = VisibilityTargets::new(gpu, size, 1).with_triangles(triangles);
        Self {
            gbuffer: GBuffer::of(
                target(gpu, "further surfaces", size, SURFACE_FORMAT, written),
                target(gpu, "further identity", size, IDENTITY_FORMAT, written),
                target(gpu, "no depth", NONE, DEPTH_FORMAT, none),
                Some(visibility),
            ),
            depth_view: target(gpu, "further depth", size, WORD, written),
            candidates: buffer(
                "candidates",
                wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT,
            ),
            no_candidates,
            candidate_list_view: target(gpu, "candidates", (width, height), WORD, written),
            largest_view: target(gpu, "largest surfaces", (width, height), WORD, written),
        }
    }

    /// Number of entries that there is room for.
    pub(super) fn entries(&self) -> u64 {
        let size = self.depth_view.texture().size();
        u64::from(size.width) * u64::from(size.height)
    }

    pub(super) fn bytes(&self) -> u64 {
        let size = self.largest_view.texture().size();
        let pixels = u64::from(size.width) * u64::from(size.height);
        self.entries() * FURTHER_BYTES + pixels * 8
    }
}

/// A band's sub-samples without surfaces.
pub(super) fn band_of_triangles(gpu: &Gpu, texels: (u32, u32)) -> GBuffer {
    let none = wgpu::TextureUsages::empty();
    let triangles = target(gpu, "triangles", texels, TRIANGLE_FORMAT, none);
    let visibility = VisibilityTargets::new(gpu, NONE, 1).with_triangles(triangles);
    GBuffer::of(
        target(gpu, "no surfaces", NONE, SURFACE_FORMAT, none),
        target(gpu, "G-buffer identity", texels, IDENTITY_FORMAT, none),
        target(gpu, "G-buffer depth", texels, DEPTH_FORMAT, none),
        Some(visibility),
    )
}
