//! What occluders were worth in the frames before.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border;
use crate::status::{FovealCullStatus, guard};
use foveal_cull::OccluderUsefulness;
use std::sync::RwLock;

/// What each cluster of the occluders was worth in the frames before.
#[derive(Debug)]
pub struct FovealCullUsefulness(pub(crate) RwLock<OccluderUsefulness>);

/// Makes an object that knows nothing: all occluders are drawn.
///
/// # Safety
/// `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_usefulness_create(
    out: *mut *mut FovealCullUsefulness,
) -> FovealCullStatus {
    let make = || Ok(FovealCullUsefulness(RwLock::new(OccluderUsefulness::new())));
    // SAFETY: the caller's word.
    guard(|| unsafe { border::give(out, make) })
}

/// Drops it. Null is nothing.
///
/// # Safety
/// `usefulness` is null or comes from this library, and is used no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_usefulness_destroy(usefulness: *mut FovealCullUsefulness) {
    // SAFETY: the caller's word.
    unsafe { border::take(usefulness) };
}

/// Forgets all that was learned.
///
/// # Safety
/// `usefulness` is null or lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_usefulness_forget(
    usefulness: *mut FovealCullUsefulness,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let usefulness = unsafe { border::object(usefulness, "usefulness") }?;
        border::write(&usefulness.0)?.forget();
        Ok(())
    })
}
