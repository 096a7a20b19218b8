//! Options of a frame.

use crate::occluder::OccluderUsefulness;

/// A time limit for rasterizing, by the caller's clock. This crate reads none. Finding what may be
/// rasterized is not limited: some 0.1 microseconds for each enabled occluder in view, several times
/// that from 50,000 on.
///
/// Occluders are drawn nearest first, so most useful ones are there when the time is spent; with
/// [`FrameOptions::usefulness`] those are chosen that hide most for their time.
/// Results stay safe; more boxes are visible.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct Budget<'a> {
    /// Reads the clock: nanoseconds since any fixed moment. It is called once for 16 clusters on
    /// each thread.
    pub clock: &'a (dyn Fn() -> u64 + Sync),
    /// Clock reading at or after which no further cluster is begun, nanoseconds.
    pub deadline_ns: u64,
}

impl<'a> Budget<'a> {
    /// A limit at a reading of `clock`, both in nanoseconds.
    #[must_use]
    pub fn new(clock: &'a (dyn Fn() -> u64 + Sync), deadline_ns: u64) -> Self {
        Self { clock, deadline_ns }
    }
}

impl core::fmt::Debug for Budget<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Budget")
            .field("deadline_ns", &self.deadline_ns)
            .finish_non_exhaustive()
    }
}

/// Thresholds and switches of one frame.
///
/// ```
/// use foveal_cull::FrameOptions;
///
/// let options = FrameOptions::default().with_occludee_size_threshold(0.01);
/// assert_eq!(options.occludee_size_threshold, 0.01);
/// ```
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct FrameOptions<'a> {
    /// Size threshold for occluders, in square roots of a metre, as in Intel's sample (1.5 there):
    /// what it leaves out depends on the scene's scale. Occluders with
    /// `radius² < distance * threshold² * tan(fov_y / 2)` are left out, where the radius is that of
    /// the bounding sphere and the distance, along the view direction, is above 1 m. Orthographic
    /// views leave out none. 0 (the default) and less take all.
    pub occluder_size_threshold: f32,
    /// Least screen area of a cluster (up to 64 quads), pixels of the buffer per quad; 6 by
    /// default, 0 takes all. The area is that of the cluster's screen rectangle, times the part of
    /// it that the cluster's triangles can fill. Fine detail costs much and hides little. With two
    /// eyes or a validity radius, clusters that would lose most of their area to silhouette margins
    /// are left out whatever this says.
    pub occluder_pixels_per_quad: f32,
    /// Size threshold for occludees ([`Visibility::Small`](crate::Visibility::Small)), as the one
    /// for occluders (0.01 in Intel's sample). 0 (the default) and less cull none by size.
    pub occludee_size_threshold: f32,
    /// Whether occluders are drawn; `true` by default. `false` tests frustum and size only.
    pub occlusion: bool,
    /// Time limit for rasterizing; none by default.
    pub budget: Option<Budget<'a>>,
    /// What occluders were worth in the frames before; none by default. Those that hid nothing are
    /// left out, and with a [`budget`](Self::budget) those are drawn that hide most for their time.
    pub usefulness: Option<&'a OccluderUsefulness>,
}

impl Default for FrameOptions<'_> {
    fn default() -> Self {
        Self {
            occluder_size_threshold: 0.0,
            occluder_pixels_per_quad: 6.0,
            occludee_size_threshold: 0.0,
            occlusion: true,
            budget: None,
            usefulness: None,
        }
    }
}

impl<'a> FrameOptions<'a> {
    /// Sets [`occluder_size_threshold`](Self::occluder_size_threshold).
    #[must_use]
    pub fn with_occluder_size_threshold(mut self, threshold: f32) -> Self {
        self.occluder_size_threshold = threshold;
        self
    }

    /// Sets [`occluder_pixels_per_quad`](Self::occluder_pixels_per_quad).
    #[must_use]
    pub fn with_occluder_pixels_per_quad(mut self, pixels: f32) -> Self {
        self.occluder_pixels_per_quad = pixels;
        self
    }

    /// Sets [`occludee_size_threshold`](Self::occludee_size_threshold).
    #[must_use]
    pub fn with_occludee_size_threshold(mut self, threshold: f32) -> Self {
        self.occludee_size_threshold = threshold;
        self
    }

    /// Sets [`occlusion`](Self::occlusion).
    #[must_use]
    pub fn with_occlusion(mut self, occlusion: bool) -> Self {
        self.occlusion = occlusion;
        self
    }

    /// Sets [`budget`](Self::budget).
    #[must_use]
    pub fn with_budget(mut self, budget: Option<Budget<'a>>) -> Self {
        self.budget = budget;
        self
    }

    /// Sets [`usefulness`](Self::usefulness).
    #[must_use]
    pub fn with_usefulness(mut self, usefulness: Option<&'a OccluderUsefulness>) -> Self {
        self.usefulness = usefulness;
        self
    }
}
