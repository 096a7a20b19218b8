//! Hierarchies of sets of occludees, built again on any thread.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border;
use crate::occludees::FovealCullOccludees;
use crate::status::{Fault, FovealCullStatus, guard};
use core::sync::atomic::{AtomicU8, Ordering};
use foveal_cull::{OccludeeRebuild, OccludeeSnapshot};
use std::sync::RwLock;

/// The occludees of a set at one moment, then the hierarchy over them.
#[derive(Debug)]
pub struct FovealCullRebuild {
    /// The number of the set.
    set: u64,
    step: RwLock<Step>,
    /// [`NEW`], [`BUILDING`] or [`BUILT`]. Who asks too early to adopt is told so without the lock,
    /// which would keep the builder out.
    progress: AtomicU8,
}

const NEW: u8 = 0;
const BUILDING: u8 = 1;
const BUILT: u8 = 2;

#[derive(Debug)]
enum Step {
    Snapshot(OccludeeSnapshot),
    Built(OccludeeRebuild),
    /// The set has the hierarchy now.
    Adopted,
}

/// Notes that building has ended, by a panic too.
struct Ended<'a>(&'a AtomicU8);

impl Drop for Ended<'_> {
    fn drop(&mut self) {
        self.0.store(BUILT, Ordering::Release);
    }
}

fn adopted() -> Fault {
    Fault::argument("'rebuild' has been adopted: take a new snapshot")
}

fn not_built() -> Fault {
    Fault::argument("'rebuild' is not built yet")
}

/// Takes a snapshot of a set's occludees.
///
/// # Safety
/// `occludees` is null or lives; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_snapshot(
    occludees: *const FovealCullOccludees,
    out: *mut *mut FovealCullRebuild,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            border::give(out, || {
                let occludees = border::object(occludees, "occludees")?;
                let snapshot = border::read(&occludees.set)?.snapshot();
                Ok(FovealCullRebuild {
                    set: occludees.number,
                    step: RwLock::new(Step::Snapshot(snapshot)),
                    progress: AtomicU8::new(NEW),
                })
            })
        }
    })
}

/// Builds the hierarchy, on any thread.
///
/// # Safety
/// `rebuild` is null or lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_rebuild_build(
    rebuild: *mut FovealCullRebuild,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let rebuild = unsafe { border::object(rebuild, "rebuild") }?;
        let mut step = border::write(&rebuild.step)?;
        *step = match core::mem::replace(&mut *step, Step::Adopted) {
            Step::Snapshot(snapshot) => {
                rebuild.progress.store(BUILDING, Ordering::Relaxed);
                let _ended = Ended(&rebuild.progress);
                Step::Built(snapshot.build())
            }
            built @ Step::Built(_) => built,
            Step::Adopted => return Err(adopted()),
        };
        Ok(())
    })
}

/// Gives the hierarchy to its set.
///
/// # Safety
/// Handles are null or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occludees_adopt(
    occludees: *mut FovealCullOccludees,
    rebuild: *mut FovealCullRebuild,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (occludees, rebuild) = unsafe {
            (
                border::object(occludees, "occludees")?,
                border::object(rebuild, "rebuild")?,
            )
        };
        if rebuild.set != occludees.number {
            return Err(Fault::new(
                FovealCullStatus::OtherSet,
                "the hierarchy belongs to another set of occludees",
            ));
        }
        match rebuild.progress.load(Ordering::Acquire) {
            NEW => return Err(not_built()),
            BUILDING => return Err(Fault::busy()),
            _ => {}
        }
        let mut set = border::write(&occludees.set)?;
        let mut step = border::write(&rebuild.step)?;
        match core::mem::replace(&mut *step, Step::Adopted) {
            Step::Built(hierarchy) => set.adopt(hierarchy),
            snapshot @ Step::Snapshot(_) => {
                *step = snapshot;
                return Err(not_built());
            }
            Step::Adopted => return Err(adopted()),
        }
        Ok(())
    })
}

/// Drops a snapshot or a hierarchy. Null is nothing.
///
/// # Safety
/// `rebuild` is null or comes from this library, and is used no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_rebuild_destroy(rebuild: *mut FovealCullRebuild) {
    // SAFETY: the caller's word.
    unsafe { border::take(rebuild) };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occludees::*;
    use core::ptr::{null, null_mut};

    use FovealCullStatus as Status;

    #[test]
    fn objects_that_another_call_uses_are_busy() {
        let (mut set, mut rebuild) = (null_mut(), null_mut());
        let none = FovealCullOccludeeId {
            set: 0,
            occludee: 0,
        };
        let (mut ids, mut number, mut size, mut numbers) = ([none], 9u32, 9usize, [9.0f32; 6]);
        // SAFETY: live handles; pointers to variables of the right size.
        unsafe {
            assert_eq!(foveal_cull_occludees_create(null(), &mut set), Status::Ok);
            let boxes = [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0];
            let to = (&raw mut ids).cast();
            let insert = || foveal_cull_occludees_insert(set, boxes.as_ptr(), 1, to);
            assert_eq!(insert(), Status::Ok);
            let [id] = ids;
            assert_eq!(
                foveal_cull_occludees_snapshot(set, &mut rebuild),
                Status::Ok
            );
            let (lock, step) = (&(*set).set, &(*rebuild).step);
            {
                // Without the lock: a builder could be about to take it.
                let _builder = step.write();
                let adopted = foveal_cull_occludees_adopt(set, rebuild);
                assert_eq!(adopted, Status::BadArgument);
            }
            assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Ok);
            let change = || {
                [
                    insert(),
                    foveal_cull_occludees_move(set, &id, boxes.as_ptr(), 1),
                    foveal_cull_occludees_remove(set, &id, 1),
                    foveal_cull_occludees_refit(set),
                    foveal_cull_occludees_rebuild(set),
                    foveal_cull_occludees_adopt(set, rebuild),
                ]
            };
            let mut read = || {
                let mut other = null_mut();
                let read = [
                    foveal_cull_occludees_contains(set, id, &mut number),
                    foveal_cull_occludees_indices(set, &id, 1, &mut number),
                    foveal_cull_occludees_wants_rebuild(set, &mut number),
                    foveal_cull_occludees_bounds(set, id, numbers.as_mut_ptr()),
                    foveal_cull_occludees_count(set, &mut size),
                    foveal_cull_occludees_result_count(set, &mut size),
                    foveal_cull_occludees_snapshot(set, &mut other),
                ];
                foveal_cull_rebuild_destroy(other);
                read
            };
            {
                let _writer = lock.write();
                assert_eq!(change(), [Status::Busy; 6]);
                assert_eq!(read(), [Status::Busy; 7]);
            }
            {
                let _reader = lock.read();
                assert_eq!(change(), [Status::Busy; 6]);
                assert_eq!(read(), [Status::Ok; 7]);
            }
            {
                let _builder = step.write();
                assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Busy);
                assert_eq!(foveal_cull_occludees_adopt(set, rebuild), Status::Busy);
            }
            (*rebuild).progress.store(BUILDING, Ordering::Relaxed);
            assert_eq!(foveal_cull_occludees_adopt(set, rebuild), Status::Busy);
            (*rebuild).progress.store(BUILT, Ordering::Relaxed);
            // What was busy is as it was.
            assert_eq!((ids, size), ([id], 1));
            assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Ok);
            assert_eq!(foveal_cull_occludees_adopt(set, rebuild), Status::Ok);
            foveal_cull_rebuild_destroy(rebuild);
            foveal_cull_occludees_destroy(set);
        }
    }
}
