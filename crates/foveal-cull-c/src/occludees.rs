//! Sets of occludees that come, move and go.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border::{self, Plain};
use crate::numbers::set_number;
use crate::status::{Fault, FovealCullStatus, guard};
use foveal_cull::{Aabb, CullError, OccludeeId, OccludeeSet};
use std::sync::RwLock;

/// A set of occludees that come, move and go.
#[derive(Debug)]
pub struct FovealCullOccludees {
    /// No other set of this process has this number.
    pub(crate) number: u64,
    pub(crate) set: RwLock<OccludeeSet>,
}

/// The id of one occludee. All zero: none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct FovealCullOccludeeId {
    /// The set that it belongs to.
    pub set: u64,
    /// The occludee in it.
    pub occludee: u64,
}

// SAFETY: two numbers.
unsafe impl Plain for FovealCullOccludeeId {}

/// Most occludees of a set.
const MOST: usize = 1 << 28;

impl FovealCullOccludees {
    fn own(&self, id: FovealCullOccludeeId) -> Result<OccludeeId, Fault> {
        let occludee = OccludeeId::from_bits(id.occludee);
        match occludee {
            Some(occludee) if id.set == self.number => Ok(occludee),
            Some(_) if id.set != 0 => Err(Fault::new(
                FovealCullStatus::OtherSet,
                "the id belongs to another set",
            )),
            _ => Err(CullError::UnknownOccludee.into()),
        }
    }

    /// Checks that all ids name occludees. The text of a failure says which one does not.
    fn check(&self, set: &OccludeeSet, ids: &[FovealCullOccludeeId]) -> Result<(), Fault> {
        for (n, id) in ids.iter().enumerate() {
            let fault = match self.own(*id) {
                Ok(id) if set.contains(id) => continue,
                Ok(_) => CullError::UnknownOccludee.into(),
                Err(fault) => fault,
            };
            let text = format!("'ids'[{n}]: {}", fault.text);
            return Err(Fault::new(fault.status, text));
        }
        Ok(())
    }
}

/// Makes an empty set for boxes relative to an origin.
///
/// # Safety
/// `origin` is null or three numbers; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_create(
    origin: *const f64,
    out: *mut *mut FovealCullOccludees,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            border::give(out, || {
                let origin = crate::place::origin(origin)?;
                Ok(FovealCullOccludees {
                    number: set_number(),
                    set: RwLock::new(OccludeeSet::new(origin)),
                })
            })
        }
    })
}

/// Drops a set. Null is nothing.
///
/// # Safety
/// `occludees` is null or comes from this library, and is used no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_destroy(occludees: *mut FovealCullOccludees) {
    // SAFETY: the caller's word.
    unsafe { border::take(occludees) };
}

/// Inserts occludees, and writes their ids. After an error none was inserted.
///
/// # Safety
/// `occludees` is null or lives; `boxes` is null or `6 * count` numbers; `out` is null, or `count`
/// ids can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_insert(
    occludees: *mut FovealCullOccludees,
    boxes: *const f32,
    count: usize,
    out: *mut FovealCullOccludeeId,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let occludees = unsafe { border::object(occludees, "occludees") }?;
        let mut set = border::write(&occludees.set)?;
        if count > MOST.saturating_sub(set.len()) {
            return Err(Fault::argument("a set has at most 2^28 occludees"));
        }
        let boxes = boxes.cast::<Aabb>();
        border::check_list(out, count, "out")?;
        border::check_list(boxes, count, "boxes")?;
        border::disjoint((boxes, count, "boxes"), (out, count, "out"))?;
        // SAFETY: the caller's word; zero is the id that names none.
        let (boxes, ids) = unsafe {
            (
                border::list(boxes, count, "boxes")?,
                border::zeroed_list(out, count, "out")?,
            )
        };
        for (id, bounds) in ids.iter_mut().zip(boxes) {
            *id = FovealCullOccludeeId {
                set: occludees.number,
                occludee: set.insert(*bounds).to_bits(),
            };
        }
        Ok(())
    })
}

/// Moves or resizes occludees. Everything is checked first: after an error none has moved.
///
/// # Safety
/// `occludees` is null or lives; `ids` is null or `count` ids; `boxes` is null or `6 * count`
/// numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_move(
    occludees: *mut FovealCullOccludees,
    ids: *const FovealCullOccludeeId,
    boxes: *const f32,
    count: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (occludees, ids, boxes) = unsafe {
            (
                border::object(occludees, "occludees")?,
                border::list(ids, count, "ids")?,
                border::list(boxes.cast::<Aabb>(), count, "boxes")?,
            )
        };
        let mut set = border::write(&occludees.set)?;
        occludees.check(&set, ids)?;
        for (id, bounds) in ids.iter().zip(boxes) {
            set.set_bounds(occludees.own(*id)?, *bounds)?;
        }
        Ok(())
    })
}

/// Removes occludees. Everything is checked first: after an error none was removed.
///
/// # Safety
/// `occludees` is null or lives; `ids` is null or `count` ids.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_remove(
    occludees: *mut FovealCullOccludees,
    ids: *const FovealCullOccludeeId,
    count: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (occludees, ids) = unsafe {
            (
                border::object(occludees, "occludees")?,
                border::list(ids, count, "ids")?,
            )
        };
        let mut set = border::write(&occludees.set)?;
        occludees.check(&set, ids)?;
        let mut sorted: Vec<u64> = ids.iter().map(|id| id.occludee).collect();
        sorted.sort_unstable();
        if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(Fault::argument("'ids' has one id twice"));
        }
        for id in ids {
            set.remove(occludees.own(*id)?)?;
        }
        Ok(())
    })
}

/// Writes 1 if the id names an occludee of this set, 0 if not.
///
/// # Safety
/// `occludees` is null or lives; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_contains(
    occludees: *const FovealCullOccludees,
    id: FovealCullOccludeeId,
    out: *mut u32,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let occludees = border::object(occludees, "occludees")?;
            let set = border::read(&occludees.set)?;
            let known = occludees.own(id).is_ok_and(|id| set.contains(id));
            border::put(out, known.into(), "out")
        }
    })
}

/// Writes the box of an occludee.
///
/// # Safety
/// `occludees` is null or lives; `out` is null, or six numbers can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_bounds(
    occludees: *const FovealCullOccludees,
    id: FovealCullOccludeeId,
    out: *mut f32,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let occludees = border::object(occludees, "occludees")?;
            let id = occludees.own(id)?;
            let bounds = border::read(&occludees.set)?.bounds(id)?;
            border::put(out.cast::<Aabb>(), bounds, "out")
        }
    })
}

/// Writes the places that the results of occludees have among the results of a test.
///
/// # Safety
/// `occludees` is null or lives; `ids` is null or `count` ids; `out` is null, or `count` numbers can
/// be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_indices(
    occludees: *const FovealCullOccludees,
    ids: *const FovealCullOccludeeId,
    count: usize,
    out: *mut u32,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let occludees = unsafe { border::object(occludees, "occludees") }?;
        border::check_list(ids, count, "ids")?;
        border::check_list(out, count, "out")?;
        border::disjoint((ids, count, "ids"), (out, count, "out"))?;
        // SAFETY: the caller's word.
        let ids = unsafe { border::list(ids, count, "ids") }?;
        let set = border::read(&occludees.set)?;
        occludees.check(&set, ids)?;
        // SAFETY: the caller's word; zero is a number.
        let indices = unsafe { border::zeroed_list(out, count, "out") }?;
        for (index, id) in indices.iter_mut().zip(ids) {
            *index = occludees.own(*id)?.index() as u32;
        }
        Ok(())
    })
}

/// Writes the number of occludees.
///
/// # Safety
/// `occludees` is null or lives; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_count(
    occludees: *const FovealCullOccludees,
    out: *mut usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let occludees = border::object(occludees, "occludees")?;
            border::put(out, border::read(&occludees.set)?.len(), "out")
        }
    })
}

/// Writes the number of results of a test: more than the largest index.
///
/// # Safety
/// `occludees` is null or lives; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_result_count(
    occludees: *const FovealCullOccludees,
    out: *mut usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let occludees = border::object(occludees, "occludees")?;
            border::put(out, border::read(&occludees.set)?.result_count(), "out")
        }
    })
}

/// Fits the hierarchy to what has moved since the last time.
///
/// # Safety
/// `occludees` is null or lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_refit(
    occludees: *mut FovealCullOccludees,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let occludees = unsafe { border::object(occludees, "occludees") }?;
        border::write(&occludees.set)?.refit();
        Ok(())
    })
}

/// Writes 1 if the hierarchy is worth being built again, 0 if not.
///
/// # Safety
/// `occludees` is null or lives; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_wants_rebuild(
    occludees: *const FovealCullOccludees,
    out: *mut u32,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let occludees = border::object(occludees, "occludees")?;
            let wants = border::read(&occludees.set)?.wants_rebuild();
            border::put(out, wants.into(), "out")
        }
    })
}

/// Builds the hierarchy again, on this thread.
///
/// # Safety
/// `occludees` is null or lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_rebuild(
    occludees: *mut FovealCullOccludees,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let occludees = unsafe { border::object(occludees, "occludees") }?;
        border::write(&occludees.set)?.rebuild();
        Ok(())
    })
}
