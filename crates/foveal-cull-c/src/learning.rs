//! What occluders were worth in a frame.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border;
use crate::culler::FovealCuller;
use crate::occludees::FovealCullOccludees;
use crate::occluders::FovealCullOccluders;
use crate::place;
use crate::status::{FovealCullStatus, guard};
use crate::usefulness::FovealCullUsefulness;
use foveal_cull::Aabb;

/// Observes results of the culler's frame.
///
/// # Safety
/// Handles are null or live; `boxes` is null or `6 * count` numbers; `origin` is null or three;
/// `results` is null or `count` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_usefulness_observe(
    usefulness: *mut FovealCullUsefulness,
    culler: *const FovealCuller,
    boxes: *const f32,
    count: usize,
    origin: *const f64,
    results: *const u8,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (usefulness, culler, boxes, origin, results) = unsafe {
            (
                border::object(usefulness, "usefulness")?,
                border::object(culler, "culler")?,
                border::list(boxes.cast::<Aabb>(), count, "boxes")?,
                place::origin(origin)?,
                border::results(results, count, "results")?,
            )
        };
        let culler = border::read(&culler.0)?;
        Ok(border::write(&usefulness.0)?.observe(&culler, boxes, origin, results)?)
    })
}

/// Observes the results of a set of occludees.
///
/// # Safety
/// Handles are null or live; `results` is null or `count` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_usefulness_observe_occludees(
    usefulness: *mut FovealCullUsefulness,
    culler: *const FovealCuller,
    occludees: *const FovealCullOccludees,
    results: *const u8,
    count: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (usefulness, culler, occludees, results) = unsafe {
            (
                border::object(usefulness, "usefulness")?,
                border::object(culler, "culler")?,
                border::object(occludees, "occludees")?,
                border::results(results, count, "results")?,
            )
        };
        let set = border::read(&occludees.set)?;
        let culler = border::read(&culler.0)?;
        Ok(border::write(&usefulness.0)?.observe_set(&culler, &set, results)?)
    })
}

/// Learns from what was observed since the last call.
///
/// # Safety
/// Handles are null or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_usefulness_learn(
    usefulness: *mut FovealCullUsefulness,
    culler: *const FovealCuller,
    occluders: *const FovealCullOccluders,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (usefulness, culler, occluders) = unsafe {
            (
                border::object(usefulness, "usefulness")?,
                border::object(culler, "culler")?,
                border::object(occluders, "occluders")?,
            )
        };
        let set = border::read(&occluders.set)?;
        let culler = border::read(&culler.0)?;
        border::write(&usefulness.0)?.learn(&culler, &set);
        Ok(())
    })
}
