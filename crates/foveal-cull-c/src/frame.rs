//! Options and stats of a frame.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border::{self, Plain};
use crate::status::{Fault, FovealCullStatus, guard};
use crate::usefulness::FovealCullUsefulness;
use core::ffi::c_void;
use core::mem::offset_of;
use foveal_cull::{CullStats, FrameOptions};

/// Thresholds and switches of one frame.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct FovealCullFrameOptions {
    /// sizeof(FovealCullFrameOptions).
    pub size: u32,
    /// 1: occluders are drawn. 0: frustum and size only.
    pub occlusion: u32,
    /// Size threshold for occluders, square roots of a metre; 0 takes all.
    pub occluder_size_threshold: f32,
    /// Least screen area of a cluster, pixels of the buffer per quad; 0 takes all.
    pub occluder_pixels_per_quad: f32,
    /// Size threshold for occludees, square roots of a metre; 0 culls none by size.
    pub occludee_size_threshold: f32,
    /// 0.
    pub reserved: u32,
    /// Reads a clock, nanoseconds; null for no time limit. Called from the threads of the jobs.
    pub clock: Option<extern "C" fn(user: *mut c_void) -> u64>,
    /// Passed to `clock`.
    pub clock_user: *mut c_void,
    /// Clock reading at or after which no further cluster is begun, nanoseconds.
    pub deadline_ns: u64,
    /// What occluders were worth in the frames before; null to draw all.
    pub usefulness: *const FovealCullUsefulness,
}

// SAFETY: numbers and pointers; C writes a function or null to `clock`.
unsafe impl Plain for FovealCullFrameOptions {}

/// Stats of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct FovealCullStats {
    /// sizeof(FovealCullStats).
    pub size: u32,
    /// 0.
    pub reserved: u32,
    /// Enabled occluders in the set.
    pub occluder_models: u64,
    /// Occluders of which at least one cluster was drawn.
    pub occluder_models_rasterized: u64,
    /// Triangles of all enabled occluders.
    pub occluder_triangles: u64,
    /// Triangles of the clusters that were drawn.
    pub occluder_triangles_rasterized: u64,
    /// Convex polygons that survived set-up.
    pub polygons_rasterized: u64,
    /// Clusters of all enabled occluders.
    pub clusters: u64,
    /// Clusters that were drawn.
    pub clusters_rasterized: u64,
    /// Clusters left out because the time was spent.
    pub clusters_over_budget: u64,
    /// Clusters left out because they hid nothing in the frames before.
    pub clusters_not_useful: u64,
}

// SAFETY: numbers.
unsafe impl Plain for FovealCullStats {}

/// Sizes of the first versions: structs may not be smaller. They end with the last field that version
/// had and stay as they are when fields are added.
const FIRST_STATS: usize = offset_of!(FovealCullStats, clusters_over_budget) + size_of::<u64>();
/// Size of the last version before there was `foveal_culler_stats_sized`.
const LAST_SAID_STATS: usize = offset_of!(FovealCullStats, clusters_not_useful) + size_of::<u64>();
const FIRST_OPTIONS: usize = offset_of!(FovealCullFrameOptions, deadline_ns) + size_of::<u64>();

impl FovealCullFrameOptions {
    fn new() -> Self {
        let default = FrameOptions::default();
        Self {
            size: size_of::<Self>() as u32,
            occlusion: default.occlusion.into(),
            occluder_size_threshold: default.occluder_size_threshold,
            occluder_pixels_per_quad: default.occluder_pixels_per_quad,
            occludee_size_threshold: default.occludee_size_threshold,
            reserved: 0,
            clock: None,
            clock_user: core::ptr::null_mut(),
            deadline_ns: 0,
            usefulness: core::ptr::null(),
        }
    }

    /// Reads options; null gives the defaults.
    ///
    /// # Safety
    /// The pointer is null, or names as many bytes as the struct says.
    pub(crate) unsafe fn read(pointer: *const Self) -> Result<Self, Fault> {
        if pointer.is_null() {
            return Ok(Self::new());
        }
        // SAFETY: the caller's word.
        let options = unsafe { border::sized(pointer, FIRST_OPTIONS, Self::new(), "options") }?;
        if options.occlusion > 1 {
            return Err(Fault::argument("'occlusion' is neither 0 nor 1"));
        }
        if options.reserved != 0 {
            return Err(Fault::argument("'reserved' of the options is not 0"));
        }
        for (threshold, name) in [
            (options.occluder_size_threshold, "occluder_size_threshold"),
            (options.occluder_pixels_per_quad, "occluder_pixels_per_quad"),
            (options.occludee_size_threshold, "occludee_size_threshold"),
        ] {
            if !(threshold.is_finite() && threshold >= 0.0) {
                return Err(Fault::new(
                    FovealCullStatus::NotFinite,
                    format!("'{name}' is {threshold}, but must be finite and not negative"),
                ));
            }
        }
        Ok(options)
    }

    /// What is known about the occluders.
    ///
    /// # Safety
    /// `usefulness` is null or lives.
    pub(crate) unsafe fn usefulness<'a>(&self) -> Result<Option<&'a FovealCullUsefulness>, Fault> {
        if self.usefulness.is_null() {
            return Ok(None);
        }
        // SAFETY: the caller's word.
        unsafe { border::object(self.usefulness, "usefulness") }.map(Some)
    }

    /// The options without the time limit and what is known.
    pub(crate) fn plain(&self) -> FrameOptions<'static> {
        FrameOptions::default()
            .with_occlusion(self.occlusion == 1)
            .with_occluder_size_threshold(self.occluder_size_threshold)
            .with_occluder_pixels_per_quad(self.occluder_pixels_per_quad)
            .with_occludee_size_threshold(self.occludee_size_threshold)
    }
}

/// A clock of the caller's.
pub(crate) struct Clock {
    pub(crate) read: extern "C" fn(user: *mut c_void) -> u64,
    pub(crate) user: *mut c_void,
}

// SAFETY: the header asks for a clock that may be read from any thread of the jobs.
unsafe impl Sync for Clock {}

impl Clock {
    pub(crate) fn now(&self) -> u64 {
        (self.read)(self.user)
    }
}

impl FovealCullStats {
    fn of(s: &CullStats) -> Self {
        Self {
            size: size_of::<Self>() as u32,
            reserved: 0,
            occluder_models: s.occluder_models,
            occluder_models_rasterized: s.occluder_models_rasterized,
            occluder_triangles: s.occluder_triangles,
            occluder_triangles_rasterized: s.occluder_triangles_rasterized,
            polygons_rasterized: s.polygons_rasterized,
            clusters: s.clusters,
            clusters_rasterized: s.clusters_rasterized,
            clusters_over_budget: s.clusters_over_budget,
            clusters_not_useful: s.clusters_not_useful,
        }
    }

    /// Writes stats to a struct of `size` bytes.
    ///
    /// # Safety
    /// The pointer is null, or `size` bytes can be written to it.
    pub(crate) unsafe fn put(to: *mut Self, size: usize, stats: &CullStats) -> Result<(), Fault> {
        // SAFETY: the caller's word.
        unsafe { border::init_sized(to, size, FIRST_STATS, &Self::of(stats), "out") }
    }

    /// Writes stats to a struct that says its own size, as those of headers without
    /// `foveal_culler_stats_sized` do. Larger sizes than theirs are refused.
    ///
    /// # Safety
    /// The pointer is null, or names as many bytes as the struct says, which can be written.
    pub(crate) unsafe fn put_as_said(to: *mut Self, stats: &CullStats) -> Result<(), Fault> {
        // SAFETY: the caller's word.
        unsafe { border::put_sized(to, FIRST_STATS..=LAST_SAID_STATS, &Self::of(stats), "out") }
    }
}

/// Fills options with the defaults. `size` is the caller's sizeof(FovealCullFrameOptions).
///
/// # Safety
/// `options` is null, or `size` bytes can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_frame_options_init_sized(
    options: *mut FovealCullFrameOptions,
    size: usize,
) -> FovealCullStatus {
    let default = FovealCullFrameOptions::new();
    // SAFETY: the caller's word.
    guard(|| unsafe { border::init_sized(options, size, FIRST_OPTIONS, &default, "options") })
}
