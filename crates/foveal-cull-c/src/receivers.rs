//! Receiver masks: which shadow casters can shade anything that the camera sees.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border;
use crate::place;
use crate::status::{Fault, FovealCullStatus, guard};
use crate::view::{self, FovealCullView};
use foveal_cull::{Aabb, ReceiverMask};
use std::sync::RwLock;

/// The places of one shadow map where a shadow can be seen.
#[derive(Debug)]
pub struct FovealCullReceiverMask(RwLock<ReceiverMask>);

/// Makes an empty mask for a square shadow map of `shadow_map_px` texels per side, as a light sees
/// it.
///
/// # Safety
/// `light` is null or as described; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_receiver_mask_create(
    light: *const FovealCullView,
    shadow_map_px: u32,
    out: *mut *mut FovealCullReceiverMask,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            border::give(out, || {
                let light = view::view(light)?;
                let mask = ReceiverMask::new(&light, shadow_map_px)?;
                Ok(FovealCullReceiverMask(RwLock::new(mask)))
            })
        }
    })
}

/// Drops a mask. Null is nothing.
///
/// # Safety
/// `mask` is null or comes from this library, and is used no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_receiver_mask_destroy(mask: *mut FovealCullReceiverMask) {
    // SAFETY: the caller's word.
    unsafe { border::take(mask) };
}

/// Empties a mask and takes another shadow map for it. The reach stays. After an error the mask is
/// as it was.
///
/// # Safety
/// `mask` is null or lives; `light` is null or as described.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_receiver_mask_reset(
    mask: *mut FovealCullReceiverMask,
    light: *const FovealCullView,
    shadow_map_px: u32,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (mask, light) = unsafe { (border::object(mask, "mask")?, view::view(light)?) };
        Ok(border::write(&mask.0)?.reset(&light, shadow_map_px)?)
    })
}

/// Sets what lookups read beside a place, for receivers that are entered from now on: up to so many
/// texels, after moving the place by up to so many metres.
///
/// # Safety
/// `mask` is null or lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_receiver_mask_set_reach(
    mask: *mut FovealCullReceiverMask,
    texels: f64,
    metres: f64,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let mask = unsafe { border::object(mask, "mask") }?;
        if ![texels, metres].iter().all(|v| v.is_finite() && *v >= 0.0) {
            return Err(Fault::new(
                FovealCullStatus::NotFinite,
                "'texels' and 'metres' must be finite and not negative",
            ));
        }
        border::write(&mask.0)?.set_reach(texels, metres);
        Ok(())
    })
}

/// Empties a mask.
///
/// # Safety
/// `mask` is null or lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_receiver_mask_clear(
    mask: *mut FovealCullReceiverMask,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let mask = unsafe { border::object(mask, "mask") }?;
        border::write(&mask.0)?.clear();
        Ok(())
    })
}

/// Writes 1 if no receiver meets the shadow map, which then need not be drawn; 0 if one does.
///
/// # Safety
/// `mask` is null or lives; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_receiver_mask_is_empty(
    mask: *const FovealCullReceiverMask,
    out: *mut u32,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let mask = border::object(mask, "mask")?;
            let empty = border::read(&mask.0)?.is_empty();
            border::put(out, empty.into(), "out")
        }
    })
}

/// Enters receivers: the boxes that `results` call visible.
///
/// # Safety
/// `mask` is null or lives; `boxes` is null or `6 * count` numbers; `origin` is null or three;
/// `results` is null or `count` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_receiver_mask_receive(
    mask: *mut FovealCullReceiverMask,
    boxes: *const f32,
    count: usize,
    origin: *const f64,
    results: *const u8,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (mask, boxes, origin, results) = unsafe {
            (
                border::object(mask, "mask")?,
                border::list(boxes.cast::<Aabb>(), count, "boxes")?,
                place::origin(origin)?,
                border::results(results, count, "results")?,
            )
        };
        Ok(border::write(&mask.0)?.receive(boxes, origin, results)?)
    })
}

/// Leaves out casters whose shadows fall on no receiver: changes results that are visible.
///
/// # Safety
/// `mask` is null or lives; `boxes` is null or `6 * count` numbers; `origin` is null or three;
/// `results` is null, or `count` bytes that can be read and written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_receiver_mask_cull(
    mask: *const FovealCullReceiverMask,
    boxes: *const f32,
    count: usize,
    origin: *const f64,
    results: *mut u8,
) -> FovealCullStatus {
    guard(|| {
        let boxes = boxes.cast::<Aabb>();
        // SAFETY: the caller's word.
        let mask = unsafe { border::object(mask, "mask") }?;
        border::check_list(boxes, count, "boxes")?;
        // SAFETY: the caller's word.
        let origin = unsafe { place::origin(origin) }?;
        border::check_list(results, count, "results")?;
        border::disjoint((boxes, count, "boxes"), (results, count, "results"))?;
        // SAFETY: the caller's word; they share no byte.
        let (boxes, results) = unsafe {
            (
                border::list(boxes, count, "boxes")?,
                border::results_mut(results, count, "results")?,
            )
        };
        Ok(border::read(&mask.0)?.cull(boxes, origin, results)?)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::ptr::{null, null_mut};
    use foveal_cull::{Eye, Projection, View};

    #[test]
    fn a_mask_in_use_is_busy_and_what_only_reads_it_may_share_it() {
        let side = Projection::perspective(1.5, 1.0, 0.1, 20.0);
        let eye = Eye::look_at([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], side);
        let mask = ReceiverMask::new(&View::mono(eye), 64).unwrap();
        let mut mask = FovealCullReceiverMask(RwLock::new(mask));
        let mut empty = 9;
        // SAFETY: a live mask that only its lock lends out; lists without elements, a place for a
        // number.
        let mut calls = |mask: *mut FovealCullReceiverMask| unsafe {
            [
                foveal_cull_receiver_mask_receive(mask, null(), 0, null(), null()),
                foveal_cull_receiver_mask_set_reach(mask, 1.0, 0.0),
                foveal_cull_receiver_mask_clear(mask),
                foveal_cull_receiver_mask_cull(mask, null(), 0, null(), null_mut()),
                foveal_cull_receiver_mask_is_empty(mask, &mut empty),
            ]
        };
        let (ok, busy) = (FovealCullStatus::Ok, FovealCullStatus::Busy);
        let handle = &raw mut mask;
        // SAFETY: the mask lives, and is shared as its lock allows.
        let lock = unsafe { &(*handle).0 };
        let reader = lock.read().unwrap();
        assert_eq!(calls(handle), [busy, busy, busy, ok, ok]);
        drop(reader);
        let writer = lock.write().unwrap();
        assert_eq!(calls(handle), [busy; 5]);
        drop(writer);
        assert_eq!(calls(handle), [ok; 5]);
    }
}
