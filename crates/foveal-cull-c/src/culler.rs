//! Cullers: rasterize, then test.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border;
use crate::frame::{Clock, FovealCullFrameOptions, FovealCullStats};
use crate::jobs::{CallerJobs, FovealCullJobs};
use crate::occludees::FovealCullOccludees;
use crate::occluders::FovealCullOccluders;
use crate::place;
use crate::status::{Fault, FovealCullStatus, guard};
use crate::tree::FovealCullTree;
use crate::view::{self, FovealCullView};
use foveal_cull::{Aabb, Budget, CullError, Culler, Visibility};
use std::sync::RwLock;

/// A culler with its occlusion buffer.
#[derive(Debug)]
pub struct FovealCuller(pub(crate) RwLock<Culler>);

/// The result for one box, one byte each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum FovealCullVisibility {
    /// May be seen: draw it.
    Visible = 0,
    /// Outside the view frustum.
    Outside = 1,
    /// Below the size threshold.
    Small = 2,
    /// Hidden behind occluders.
    Occluded = 3,
}

const _: () = {
    assert!(FovealCullVisibility::Visible as u32 == Visibility::Visible as u32);
    assert!(FovealCullVisibility::Outside as u32 == Visibility::Outside as u32);
    assert!(FovealCullVisibility::Small as u32 == Visibility::Small as u32);
    assert!(FovealCullVisibility::Occluded as u32 == Visibility::Occluded as u32);
    assert!(size_of::<Visibility>() == 1);
};

/// Makes a culler with an occlusion buffer of this size.
///
/// # Safety
/// `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_create(
    width_px: u32,
    height_px: u32,
    out: *mut *mut FovealCuller,
) -> FovealCullStatus {
    let make = || Ok(FovealCuller(RwLock::new(Culler::new(width_px, height_px)?)));
    // SAFETY: the caller's word.
    guard(|| unsafe { border::give(out, make) })
}

/// Makes a culler for a picture of this size: the buffer has a quarter of it per axis, rounded up.
///
/// # Safety
/// `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_create_for_picture(
    width_px: u32,
    height_px: u32,
    out: *mut *mut FovealCuller,
) -> FovealCullStatus {
    let make = || {
        view::check_picture(width_px, height_px)?;
        let culler = Culler::for_picture(width_px, height_px)?;
        Ok(FovealCuller(RwLock::new(culler)))
    };
    // SAFETY: the caller's word.
    guard(|| unsafe { border::give(out, make) })
}

/// Drops a culler. Null is nothing.
///
/// # Safety
/// `culler` is null or comes from this library, and is used no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_destroy(culler: *mut FovealCuller) {
    // SAFETY: the caller's word.
    unsafe { border::take(culler) };
}

/// Writes the size of the buffer, pixels.
///
/// # Safety
/// `culler` is null or lives; the others are null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_size(
    culler: *const FovealCuller,
    width_px: *mut u32,
    height_px: *mut u32,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let culler = border::object(culler, "culler")?;
            border::check_out(width_px, "width_px")?;
            border::check_out(height_px, "height_px")?;
            let (width, height) = border::read(&culler.0)?.size();
            border::put(width_px, width, "width_px")?;
            border::put(height_px, height, "height_px")
        }
    })
}

/// Begins a frame: clears the buffer and draws the occluders that the view can see. After an error
/// everything is visible until the next good frame, unless `culler` itself was busy.
///
/// # Safety
/// Handles are null or live; structs are null or as described.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_rasterize(
    culler: *mut FovealCuller,
    view: *const FovealCullView,
    occluders: *const FovealCullOccluders,
    options: *const FovealCullFrameOptions,
    jobs: *const FovealCullJobs,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let culler = unsafe { border::object(culler, "culler") }?;
        let mut culler = border::write(&culler.0)?;
        let mut frame = || -> Result<(), Fault> {
            // SAFETY: the caller's word.
            let (view, occluders, options, jobs) = unsafe {
                (
                    view::view(view)?,
                    border::object(occluders, "occluders")?,
                    FovealCullFrameOptions::read(options)?,
                    CallerJobs::read(jobs)?,
                )
            };
            let set = border::read(&occluders.set)?;
            let clock = options.clock.map(|read| Clock {
                read,
                user: options.clock_user,
            });
            let now = || clock.as_ref().map_or(0, Clock::now);
            let budget = clock
                .is_some()
                .then(|| Budget::new(&now, options.deadline_ns));
            // SAFETY: the caller's word.
            let usefulness = unsafe { options.usefulness() }?;
            let usefulness = usefulness.map(|u| border::read(&u.0)).transpose()?;
            let plain = options
                .plain()
                .with_budget(budget)
                .with_usefulness(usefulness.as_deref());
            culler.rasterize(&view, &set, &plain, CallerJobs::threads(&jobs))?;
            Ok(())
        };
        let done = frame();
        if done.is_err() {
            culler.clear();
        }
        done
    })
}

/// Classifies boxes against the last frame.
///
/// # Safety
/// `culler` is null or lives; `boxes` is null or `6 * count` numbers; `origin` is null or three;
/// `results` is null, or `count` bytes can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_test_boxes(
    culler: *const FovealCuller,
    boxes: *const f32,
    count: usize,
    origin: *const f64,
    results: *mut u8,
) -> FovealCullStatus {
    guard(|| {
        let boxes = boxes.cast::<Aabb>();
        // SAFETY: the caller's word.
        let culler = unsafe { border::object(culler, "culler") }?;
        border::check_list(boxes, count, "boxes")?;
        // SAFETY: the caller's word.
        let origin = unsafe { place::origin(origin) }?;
        border::check_list(results, count, "results")?;
        border::disjoint((boxes, count, "boxes"), (results, count, "results"))?;
        // SAFETY: the caller's word.
        let boxes = unsafe { border::list(boxes, count, "boxes") }?;
        let culler = border::read(&culler.0)?;
        // SAFETY: the caller's word; zero is `Visibility::Visible`.
        let results =
            unsafe { border::zeroed_list(results.cast::<Visibility>(), count, "results") }?;
        Ok(culler.query(boxes, origin, results)?)
    })
}

/// Classifies a tree of boxes against the last frame.
///
/// # Safety
/// Handles are null or live; `results` is null, or `count` bytes can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_test_tree(
    culler: *const FovealCuller,
    tree: *const FovealCullTree,
    results: *mut u8,
    count: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (culler, tree) = unsafe {
            (
                border::object(culler, "culler")?,
                border::object(tree, "tree")?,
            )
        };
        border::check_list(results, count, "results")?;
        let tree = border::read(&tree.0)?;
        let culler = border::read(&culler.0)?;
        // Before anything is written.
        CullError::check_length(tree.len(), count)?;
        // SAFETY: the caller's word; zero is `Visibility::Visible`.
        let results =
            unsafe { border::zeroed_list(results.cast::<Visibility>(), count, "results") }?;
        Ok(culler.query_tree(&tree, results)?)
    })
}

/// Classifies a set of occludees against the last frame. `count` is its result count.
///
/// # Safety
/// Handles are null or live; `results` is null, or `count` bytes can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_test_occludees(
    culler: *const FovealCuller,
    occludees: *const FovealCullOccludees,
    results: *mut u8,
    count: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (culler, occludees) = unsafe {
            (
                border::object(culler, "culler")?,
                border::object(occludees, "occludees")?,
            )
        };
        border::check_list(results, count, "results")?;
        let set = border::read(&occludees.set)?;
        let culler = border::read(&culler.0)?;
        // Before anything is written.
        CullError::check_length(set.result_count(), count)?;
        // SAFETY: the caller's word; zero is `Visibility::Visible`.
        let results =
            unsafe { border::zeroed_list(results.cast::<Visibility>(), count, "results") }?;
        Ok(culler.query_set(&set, results)?)
    })
}

/// Copies the depth of the last frame, row by row from the top left.
///
/// # Safety
/// `culler` is null or lives; `pixels` is null, or `count` floats can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_read_depth(
    culler: *const FovealCuller,
    pixels: *mut f32,
    count: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let culler = border::object(culler, "culler")?;
            border::check_list(pixels, count, "pixels")?;
            let culler = border::read(&culler.0)?;
            let (width, height) = culler.size();
            // Before anything is written.
            CullError::check_length(width as usize * height as usize, count)?;
            let pixels = border::zeroed_list(pixels, count, "pixels")?;
            Ok(culler.read_depth(pixels)?)
        }
    })
}

/// Writes the stats of the last frame. `size` is the caller's sizeof(FovealCullStats).
///
/// # Safety
/// `culler` is null or lives; `out` is null, or `size` bytes can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_stats_sized(
    culler: *const FovealCuller,
    out: *mut FovealCullStats,
    size: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let culler = border::object(culler, "culler")?;
            let stats = border::read(&culler.0)?.stats();
            FovealCullStats::put(out, size, &stats)
        }
    })
}

/// The same for programs that were compiled with a header without [`foveal_culler_stats_sized`].
/// `out` says its own size. Larger sizes than that of their struct are refused.
///
/// # Safety
/// `culler` is null or lives; `out` is null, or can be written as far as its size says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_culler_stats(
    culler: *const FovealCuller,
    out: *mut FovealCullStats,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let culler = border::object(culler, "culler")?;
            let stats = border::read(&culler.0)?.stats();
            FovealCullStats::put_as_said(out, &stats)
        }
    })
}
