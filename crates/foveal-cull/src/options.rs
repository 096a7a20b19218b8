//! Options

/// A time limit for rasterizing, by the caller's own clock (this crate reads none).
#[derive(Clone, Copy)]
pub struct Budget<'a> {
    /// Reads the clock, nanoseconds from any fixed start.
    pub clock: &'a (dyn Fn() -> u64 + Sync),
    /// No occluder is begun at or after this reading. Nearer occluders come first, so the most useful ones
    /// are there; results stay safe, only more is reported visible.
    pub deadline_ns: u64,
}

impl core::fmt::Debug for Budget<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Budget")
            .field("deadline_ns", &self.deadline_ns)
            .finish_non_exhaustive()
    }
}

/// Switches and thresholds of a frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameOptions<'a> {
    /// Occluder models with `radius² < distance * threshold² * tan(fov_y / 2)` (distance above 1 m) are left
    /// out, as in Intel's sample (1.5 there). 0 takes all.
    pub occluder_size_threshold: f32,
    /// Clusters (up to 64 quads) that cannot cover more pixels than this per quad, by their rectangle on the screen and
    /// how much of it their triangles fill in the mean, are left out: fine detail costs much and hides little that what
    /// lies behind it does not. 0 takes all, but for two eyes or a validity radius: there clusters that would lose most of
    /// themselves at their borders are left out in any case.
    pub occluder_pixels_per_quad: f32,
    /// The same as the first for occludees ([`Visibility::Small`]; 0.01 in the sample). 0 culls none by size.
    pub occludee_size_threshold: f32,
    /// Whether occluders are drawn; off, only frustum and size are tested.
    pub occlusion: bool,
    /// Time limit for rasterizing.
    pub budget: Option<Budget<'a>>,
}

impl Default for FrameOptions<'_> {
    fn default() -> Self {
        Self {
            occluder_size_threshold: 0.0,
            occluder_pixels_per_quad: 6.0,
            occludee_size_threshold: 0.0,
            occlusion: true,
            budget: None,
        }
    }
}
