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
    /// [`NEW`], [`BUILDING`], [`BUILT`] (adopted too) or [`FAILED`]. Who asks too early is told so
    /// without the lock, which would keep the builder out.
    progress: AtomicU8,
}

const NEW: u8 = 0;
const BUILDING: u8 = 1;
const BUILT: u8 = 2;
const FAILED: u8 = 3;

#[derive(Debug)]
enum Step {
    Snapshot(OccludeeSnapshot),
    Built(OccludeeRebuild),
    /// Building panicked, which took the snapshot along.
    Failed,
    /// The set has the hierarchy now.
    Adopted,
}

/// Notes how building has ended: it failed, unless something else is said before.
struct Ended<'a> {
    progress: &'a AtomicU8,
    how: u8,
}

impl Drop for Ended<'_> {
    fn drop(&mut self) {
        self.progress.store(self.how, Ordering::Release);
    }
}

impl FovealCullRebuild {
    fn build(&self, build: impl FnOnce(OccludeeSnapshot) -> OccludeeRebuild) -> Result<(), Fault> {
        // Dropped after the lock: what is said to be built can be adopted.
        let mut ended = None;
        let mut step = border::write(&self.step)?;
        *step = match core::mem::replace(&mut *step, Step::Failed) {
            Step::Snapshot(snapshot) => {
                self.progress.store(BUILDING, Ordering::Relaxed);
                let ended = ended.insert(Ended {
                    progress: &self.progress,
                    how: FAILED,
                });
                let built = build(snapshot);
                ended.how = BUILT;
                Step::Built(built)
            }
            built @ Step::Built(_) => {
                // The builder may be about to say so.
                self.progress.store(BUILT, Ordering::Release);
                built
            }
            Step::Failed => return Err(failed()),
            Step::Adopted => {
                *step = Step::Adopted;
                return Err(adopted());
            }
        };
        Ok(())
    }

    /// Whether the hierarchy is built. That it could not be is an error.
    fn is_built(&self) -> Result<bool, Fault> {
        match self.progress.load(Ordering::Acquire) {
            BUILT => Ok(true),
            FAILED => Err(failed()),
            _ => Ok(false),
        }
    }
}

fn failed() -> Fault {
    let text = "'rebuild' could not be built: take a new snapshot";
    Fault::new(FovealCullStatus::Internal, text)
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

/// Builds the hierarchy, on any thread. What is built already stays.
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
        rebuild.build(OccludeeSnapshot::build)
    })
}

/// Writes 1 if the hierarchy is built, and may be adopted or was; 0 if not yet.
///
/// # Safety
/// `rebuild` is null or lives; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_rebuild_is_built(
    rebuild: *const FovealCullRebuild,
    out: *mut u32,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let built = border::object(rebuild, "rebuild")?.is_built()?;
            border::put(out, built.into(), "out")
        }
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
            FAILED => return Err(failed()),
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
            Step::Failed => {
                *step = Step::Failed;
                return Err(failed());
            }
            Step::Adopted => return Err(adopted()),
        }
        Ok(())
    })
}

/// Drops a snapshot or a hierarchy. Null is nothing.
///
/// # Safety
/// `rebuild` is null or comes from this library, and is used no more: a call that builds it has
/// returned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_rebuild_destroy(rebuild: *mut FovealCullRebuild) {
    // SAFETY: the caller's word.
    unsafe { border::take(rebuild) };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occludees::*;
    use crate::status::with_last;
    use core::ptr::{null, null_mut};

    use FovealCullStatus as Status;

    #[test]
    fn a_build_that_fails_is_no_hierarchy_that_was_adopted() {
        let (mut set, mut rebuild, mut built) = (null_mut(), null_mut(), 9);
        // SAFETY: live handles; places for results.
        unsafe {
            assert_eq!(foveal_cull_occludees_create(null(), &mut set), Status::Ok);
            let snapshot = foveal_cull_occludees_snapshot;
            assert_eq!(snapshot(set, &mut rebuild), Status::Ok);
            let object = &*rebuild;
            let failed = guard(|| object.build(|_| panic!("building fails in a test")));
            assert_eq!(failed, Status::Internal);
            for _ in 0..2 {
                let calls = [
                    foveal_cull_rebuild_is_built(rebuild, &mut built),
                    foveal_cull_occludees_adopt(set, rebuild),
                    foveal_cull_rebuild_build(rebuild),
                ];
                assert_eq!((calls, built), ([Status::Internal; 3], 9));
                let text = with_last(str::to_owned);
                assert_eq!(text, "'rebuild' could not be built: take a new snapshot");
            }
            foveal_cull_rebuild_destroy(rebuild);
            // The set is as it was.
            assert_eq!(snapshot(set, &mut rebuild), Status::Ok);
            assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Ok);
            assert_eq!(foveal_cull_occludees_adopt(set, rebuild), Status::Ok);
            foveal_cull_rebuild_destroy(rebuild);
            foveal_cull_occludees_destroy(set);
        }
    }

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
                assert_eq!(is_built(rebuild), 0);
                (*rebuild).progress.store(BUILDING, Ordering::Relaxed);
                assert_eq!(is_built(rebuild), 0);
                (*rebuild).progress.store(NEW, Ordering::Relaxed);
            }
            assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Ok);
            assert_eq!(is_built(rebuild), 1);
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
            // Whoever is told that it is built may adopt it, though the builder has not said so yet.
            assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Ok);
            assert_eq!(is_built(rebuild), 1);
            // What was busy is as it was.
            assert_eq!((ids, size), ([id], 1));
            assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Ok);
            assert_eq!(foveal_cull_occludees_adopt(set, rebuild), Status::Ok);
            assert_eq!(is_built(rebuild), 1, "adopted too");
            let nowhere = foveal_cull_rebuild_is_built(rebuild, null_mut());
            assert_eq!(nowhere, Status::NullPointer);
            foveal_cull_rebuild_destroy(rebuild);
            foveal_cull_occludees_destroy(set);
        }
    }

    fn is_built(rebuild: *const FovealCullRebuild) -> u32 {
        let mut built = 9;
        // SAFETY: a live handle and a place for the result.
        let status = unsafe { foveal_cull_rebuild_is_built(rebuild, &mut built) };
        assert_eq!(status, Status::Ok);
        built
    }
}
