//! What a frame cost: counts and times, as the program writes them to JSON.

#[cfg(feature = "serde")]
use serde::Serialize;

/// The device that drew the frame.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize))]
pub struct AdapterStats {
    /// The adapter's own name.
    pub name: String,
    /// `vulkan`, `metal`, `dx12`, `gl` or `webgpu`.
    pub backend: String,
    /// `discrete-gpu`, `integrated-gpu`, `virtual-gpu`, `cpu` or `other`.
    pub kind: String,
    /// The driver's name and version.
    pub driver: String,
}

/// What the scene holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(Serialize))]
pub struct SceneStats {
    /// Meshes (one per glTF primitive).
    pub meshes: u64,
    /// Materials.
    pub materials: u64,
    /// Families of materials that share shader, arrays of textures and samplers: as many dispatches
    /// evaluate a visibility buffer's materials at most, where they do so by families.
    pub material_families: u64,
    /// Textures.
    pub textures: u64,
    /// Bytes of all textures on the device, mip levels included.
    pub texture_bytes: u64,
    /// Objects (nodes with a mesh, GPU instances counted singly).
    pub objects: u64,
    /// Instances (one per object and primitive).
    pub instances: u64,
    /// Triangles, instanced ones counted each time.
    pub triangles: u64,
    /// Lines, instanced ones counted each time.
    pub lines: u64,
    /// Points, instanced ones counted each time.
    pub points: u64,
    /// Punctual lights.
    pub lights: u64,
}

/// One named duration.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize))]
pub struct Timing {
    /// The stage's or the pass's name.
    pub name: String,
    /// Milliseconds.
    pub ms: f64,
}

/// What coarse shading did in a frame.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize))]
#[non_exhaustive]
pub struct CoarseStats {
    /// Samples of each level, finest first.
    pub samples_per_level: Vec<u64>,
    /// Pixels that were shaded because no tile's sample speaks for them or for pixels that take their
    /// light; with the composite of light.
    pub unlit_pixels: u64,
    /// All samples and those pixels by all pixels.
    pub shaded_fraction: f64,
    /// The backend that shaded this frame: `stencil`, `compute`, or `none` where every pixel was
    /// shaded.
    pub backend: String,
    /// Why it is this backend: `asked for`, `measuring`, what was measured, that light is kept from
    /// frame to frame, or that every pixel is shaded.
    pub backend_reason: String,
    /// Whether the frame was shaded coarsely; else every pixel was.
    pub active: bool,
    /// Shading of every pixel, in milliseconds, as of the last comparison; 0 before it.
    pub full_ms: f64,
    /// What stood in for it in the same frame: rate map, reprojection, shading of samples,
    /// composite.
    pub coarse_ms: f64,
    /// A sentence where coarse shading has turned itself off, or where the picture is too large for
    /// the light history; else empty.
    pub notice: String,
}

impl CoarseStats {
    /// Samples of all levels, and pixels that were shaded beside them.
    #[must_use]
    pub fn shaded_samples(&self) -> u64 {
        self.samples_per_level.iter().sum::<u64>() + self.unlit_pixels
    }
}

/// What variable shading did in a frame, and what it costs and saves; times in milliseconds.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize))]
#[non_exhaustive]
pub struct VariableStats {
    /// Whether the frame was shaded at a rate.
    pub active: bool,
    /// Samples of one pixel, two side by side, two one above the other, a quad, and 4 x 4 pixels.
    pub samples_per_rate: Vec<u64>,
    /// All samples by all pixels.
    pub shaded_fraction: f64,
    /// Share of the quads of which nothing was known.
    pub unknown_fraction: f64,
    /// Finding rates and samples.
    pub mask_ms: f64,
    /// Reprojection over what is known from the frame before; 0 where finding rates does it
    /// (contrast within quads).
    pub reproject_ms: f64,
    /// Sorting pixels by material; 0 without a visibility buffer.
    pub binning_ms: f64,
    /// The stages that run at the rate, in full; as of the last comparison, of
    /// which there is none where `force-rate` is set.
    pub full_ms: f64,
    /// The same at the rate, in the same frame.
    pub variable_ms: f64,
    /// The difference of the two.
    pub saved_ms: f64,
    /// What is saved less mask and reprojection.
    pub net_ms: f64,
    /// A sentence where it has turned itself off, or where ssaa leaves it nothing to do; else empty.
    pub notice: String,
}

/// How two eyes were drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(Serialize))]
#[non_exhaustive]
pub struct StereoStats {
    /// `two-pass`, `instanced-clip`, `instanced-discard`, `multiview`, or `once` where both eyes
    /// see the same.
    pub mode: String,
    /// Why it is this one.
    pub reason: String,
}

/// What shadows did in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize))]
#[non_exhaustive]
pub struct ShadowStats {
    /// Tiles of the atlas that the frame may look into.
    pub tiles: u64,
    /// Tiles that were drawn in this frame; all others were kept.
    pub tiles_drawn: u64,
    /// Kept tiles to which casters were added that had been left out: what they shade is seen now.
    pub tiles_completed: u64,
    /// Instances that were submitted to draw and to complete tiles, counted once per tile.
    pub casters: u64,
    /// Instances in the parts of space that drawn tiles see, counted once per tile: what would have
    /// been submitted without culling.
    pub casters_in_reach: u64,
    /// Those of them that others hide from the light.
    pub casters_hidden: u64,
    /// Those of them whose shadows fall on nothing that is seen.
    pub casters_unneeded: u64,
    /// Those of them that are beside what has moved: the tile keeps what it holds of them.
    pub casters_beside: u64,
    /// Triangles of these.
    pub triangles: u64,
    /// Texels of the tiles that the frame may look into.
    pub texels: u64,
    /// Tiles that the budget left for a later frame: they show older shadows, or none yet.
    pub tiles_waiting: u64,
    /// Frames for which the one of them has waited that waits longest.
    pub longest_wait: u64,
    /// Bytes of the atlas.
    pub atlas_bytes: u64,
    /// Lights that the atlas has no room for: they shine through everything, in part or wholly.
    pub lights_left_out: u64,
    /// Powers of two by which tiles are smaller than the view asks for, for lack of room.
    pub shrunk_by: f32,
}

/// One frame's stats.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize))]
#[non_exhaustive]
pub struct FrameStats {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// CPU time per stage, in the order of the frame. Empty without a clock.
    pub cpu_ms: Vec<Timing>,
    /// GPU time per pass, in the order of the frame. Empty where the device has no timestamps.
    pub gpu_ms: Vec<Timing>,
    /// Objects that were drawn.
    pub objects_visible: u64,
    /// Objects outside the frustum.
    pub objects_outside: u64,
    /// Objects hidden by others.
    pub objects_occluded: u64,
    /// Objects below the size threshold.
    pub objects_small: u64,
    /// Triangles that were rasterized on the CPU to find the hidden ones.
    pub occluder_triangles: u64,
    /// Groups of occluders that the time budget of culling left out.
    pub occluders_over_budget: u64,
    /// Whether what is seen was found in an earlier frame, and still holds.
    pub culling_reused: bool,
    /// Draw calls that show the scene once, to all eyes. Those of shadows are not among them, and
    /// anti-aliasing issues them several times where it draws the picture in parts.
    pub draws: u64,
    /// Triangles of these, counted for each eye.
    pub triangles: u64,
    /// Lighting evaluations of the deferred stage, backdrop included.
    pub shaded_samples: u64,
    /// Share of the pixels that anti-aliasing shades more than once; 0 without anti-aliasing.
    pub edge_fraction: f64,
    /// Surfaces that anti-aliasing found no room for: their pixels show their largest surface
    /// alone. The next frame has room for them, unless the device has none.
    pub surfaces_left_out: u64,
    /// Bytes of all targets that depend on the frame's size: G-buffers, radiance, picture, lists.
    pub target_bytes: u64,
    /// With coarse shading.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub coarse: Option<CoarseStats>,
    /// With variable shading.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub variable: Option<VariableStats>,
    /// With shadows.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub shadows: Option<ShadowStats>,
    /// With two eyes.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub stereo: Option<StereoStats>,
    /// From the start of the frame's CPU work until the GPU finished it, in milliseconds.
    /// [`Renderer::render_to`](crate::Renderer::render_to) does not wait for that: it ends when
    /// wgpu tells of it, outside browsers when something is submitted or polled next. Where that is
    /// the next frame, it is no less than the time between frames; `cpu_ms` and `gpu_ms` are the
    /// work.
    pub frame_ms: f64,
}
