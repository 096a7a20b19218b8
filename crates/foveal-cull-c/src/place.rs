//! Placements and origins.
#![allow(unsafe_code, reason = "pointers from C; see the SAFETY lines")]

use crate::border;
use crate::status::{Fault, FovealCullStatus};
use foveal_cull::Affine;

/// An origin; null is zero.
///
/// # Safety
/// The pointer is null or names three numbers.
pub(crate) unsafe fn origin(pointer: *const f64) -> Result<[f64; 3], Fault> {
    if pointer.is_null() {
        return Ok([0.0; 3]);
    }
    // SAFETY: the caller's word.
    let origin = unsafe { border::object(pointer.cast::<[f64; 3]>(), "origin") }?;
    if !origin.iter().all(|v| v.is_finite()) {
        let text = "'origin' must be finite";
        return Err(Fault::new(FovealCullStatus::NotFinite, text));
    }
    Ok(*origin)
}

/// A placement; null is the identity.
///
/// # Safety
/// The pointer is null or names twelve numbers.
pub(crate) unsafe fn affine(pointer: *const f64) -> Result<Affine, Fault> {
    if pointer.is_null() {
        return Ok(Affine::IDENTITY);
    }
    // SAFETY: the caller's word.
    let columns = unsafe { border::object(pointer.cast::<[[f64; 3]; 4]>(), "world_from_mesh") }?;
    Ok((*columns).into())
}
