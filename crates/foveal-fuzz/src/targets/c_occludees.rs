//! The C interface's sets of occludees: random calls, and a model of what they must give.
#![allow(
    unsafe_code,
    reason = "calls the functions as C does, with pointers to its own variables"
)]

use core::ptr::null_mut;
use foveal_cull_c::*;

use FovealCullStatus as Status;

use super::c_arguments::{Arguments, Calls, boxes};
use crate::random::Choices;

/// Sets, and what is known about them.
#[derive(Default)]
pub(super) struct Occludees {
    sets: Vec<(*mut FovealCullOccludees, [f64; 3])>,
    objects: Vec<Object>,
    rebuilds: Vec<Rebuild>,
    pub(super) calls: Calls,
}

/// An id that was given out.
#[derive(Clone, Copy)]
struct Object {
    id: FovealCullOccludeeId,
    /// The set's place in the list.
    owner: usize,
    lives: bool,
    bounds: [f32; 6],
}

struct Rebuild {
    handle: *mut FovealCullRebuild,
    owner: usize,
    step: Step,
}

#[derive(Clone, Copy, PartialEq)]
enum Step {
    Snapshot,
    Built,
    Adopted,
}

const NONE: FovealCullOccludeeId = FovealCullOccludeeId {
    set: 0,
    occludee: 0,
};

fn bits(bounds: [f32; 6]) -> [u32; 6] {
    bounds.map(f32::to_bits)
}

impl Occludees {
    pub(super) fn create(&mut self, r: &mut Choices<'_>) {
        if self.sets.len() == 3 {
            return;
        }
        let origin: [f64; 3] = r.numbers();
        let mut set = null_mut();
        // SAFETY: three numbers and a place for the set.
        let status = unsafe { foveal_cull_occludees_create(origin.as_ptr(), &mut set) };
        let good = origin.iter().all(|v| v.is_finite());
        assert_eq!(self.calls.note(status) == Status::Ok, good);
        assert_eq!(set.is_null(), !good);
        if good {
            self.sets.push((set, origin));
        }
    }

    /// Changes a set, or looks at it.
    pub(super) fn change(&mut self, r: &mut Choices<'_>) {
        if self.sets.is_empty() {
            return;
        }
        let n = r.below(self.sets.len());
        match r.below(10) {
            0..3 => self.insert(r, n),
            3..5 => self.change_some(r, n, Self::move_all),
            5 => self.change_some(r, n, Self::remove_all),
            6 => self.rebuild(r, n),
            7 => self.refit(r, n),
            _ => self.look(r, n),
        }
        let mut count = usize::MAX;
        // SAFETY: a live set and a place for the count.
        let status = unsafe { foveal_cull_occludees_count(self.sets[n].0, &mut count) };
        let live = self.objects.iter().filter(|o| o.owner == n && o.lives);
        assert_eq!((status, count), (Status::Ok, live.count()));
    }

    fn insert(&mut self, r: &mut Choices<'_>, n: usize) {
        // Now and then as many as a tree is used for.
        let count = if r.one_in(20) { 1100 } else { r.below(30) };
        let mut numbers = boxes(r, count);
        let mut ids = vec![NONE; count];
        let said = if r.one_in(30) {
            r.bits() as usize | 1 << 40
        } else {
            count
        };
        let from = r.or_null(numbers.as_mut_ptr());
        let to = r.or_null(ids.as_mut_ptr());
        // SAFETY: a live set; lists as long as is said, or longer than any set may be.
        let status = unsafe { foveal_cull_occludees_insert(self.sets[n].0, from, said, to) };
        let expected = if said != count {
            Status::BadArgument
        } else if count > 0 && (from.is_null() || to.is_null()) {
            Status::NullPointer
        } else {
            Status::Ok
        };
        assert_eq!(self.calls.note(status), expected);
        if status != Status::Ok {
            assert!(ids.iter().all(|id| *id == NONE), "results of a failure");
            return;
        }
        for (id, bounds) in ids.iter().zip(numbers.as_chunks().0) {
            assert!(self.objects.iter().rev().take(50).all(|o| o.id != *id));
            self.objects.push(Object {
                id: *id,
                owner: n,
                lives: true,
                bounds: *bounds,
            });
        }
    }

    /// Picks some ids, good and bad ones, and the code that they must give.
    fn change_some(
        &mut self,
        r: &mut Choices<'_>,
        n: usize,
        call: fn(&mut Self, &mut Choices<'_>, usize, &[usize], &[FovealCullOccludeeId], Status),
    ) {
        let odd = r.one_in(4);
        let good = |o: &Object| o.owner == n && o.lives;
        let mut picked = Vec::new();
        for _ in 0..r.below(12) {
            let k = r.below(self.objects.len().max(1));
            let fits = self.objects.get(k).is_some_and(|o| odd || good(o));
            picked.extend((fits && !picked.contains(&k)).then_some(k));
        }
        let mut ids: Vec<FovealCullOccludeeId> =
            picked.iter().map(|&k| self.objects[k].id).collect();
        let of = |&k: &usize| match self.objects[k] {
            o if o.owner != n => Status::OtherSet,
            o if o.lives => Status::Ok,
            _ => Status::UnknownOccludee,
        };
        let mut codes: Vec<Status> = picked.iter().map(of).collect();
        if odd && !ids.is_empty() && r.one_in(3) {
            // A generation that no slot has reached.
            let at = r.below(ids.len());
            ids[at].occludee |= 1 << 62;
            if codes[at] == Status::Ok {
                codes[at] = Status::UnknownOccludee;
            }
        }
        let first = codes.into_iter().find(|c| *c != Status::Ok);
        call(self, r, n, &picked, &ids, first.unwrap_or(Status::Ok));
    }

    fn move_all(
        &mut self,
        r: &mut Choices<'_>,
        n: usize,
        picked: &[usize],
        ids: &[FovealCullOccludeeId],
        expected: Status,
    ) {
        let numbers = boxes(r, ids.len());
        let (set, from) = (self.sets[n].0, numbers.as_ptr());
        // SAFETY: a live set and lists as long as is said.
        let status = unsafe { foveal_cull_occludees_move(set, ids.as_ptr(), from, ids.len()) };
        assert_eq!(self.calls.note(status), expected);
        if status == Status::Ok {
            for (k, bounds) in picked.iter().zip(numbers.as_chunks().0) {
                self.objects[*k].bounds = *bounds;
            }
        }
    }

    fn remove_all(
        &mut self,
        r: &mut Choices<'_>,
        n: usize,
        picked: &[usize],
        ids: &[FovealCullOccludeeId],
        expected: Status,
    ) {
        let mut ids = ids.to_vec();
        let mut expected = expected;
        if !ids.is_empty() && r.one_in(6) {
            ids.push(ids[0]);
            if expected == Status::Ok {
                expected = Status::BadArgument;
            }
        }
        // SAFETY: a live set and as many ids as are said.
        let status =
            unsafe { foveal_cull_occludees_remove(self.sets[n].0, ids.as_ptr(), ids.len()) };
        assert_eq!(self.calls.note(status), expected);
        if status == Status::Ok {
            picked.iter().for_each(|k| self.objects[*k].lives = false);
        }
    }

    /// Takes a snapshot, or builds, adopts or drops one.
    fn rebuild(&mut self, r: &mut Choices<'_>, n: usize) {
        let set = self.sets[n].0;
        if self.rebuilds.is_empty() || (self.rebuilds.len() < 4 && r.one_in(3)) {
            let mut handle = null_mut();
            // SAFETY: a live set and a place for the snapshot.
            let status = unsafe { foveal_cull_occludees_snapshot(set, &mut handle) };
            assert_eq!(self.calls.note(status), Status::Ok);
            self.rebuilds.push(Rebuild {
                handle,
                owner: n,
                step: Step::Snapshot,
            });
            return;
        }
        let k = r.below(self.rebuilds.len());
        let Rebuild {
            handle,
            owner,
            step,
        } = self.rebuilds[k];
        // SAFETY: live handles; the one that is destroyed is taken out of the list.
        unsafe {
            match r.below(8) {
                0..3 => {
                    let status = self.calls.note(foveal_cull_rebuild_build(handle));
                    let (expected, after) = match step {
                        Step::Adopted => (Status::BadArgument, step),
                        _ => (Status::Ok, Step::Built),
                    };
                    assert_eq!(status, expected);
                    self.rebuilds[k].step = after;
                }
                3..7 => {
                    let status = self.calls.note(foveal_cull_occludees_adopt(set, handle));
                    let (expected, after) = match step {
                        _ if owner != n => (Status::OtherSet, step),
                        Step::Built => (Status::Ok, Step::Adopted),
                        _ => (Status::BadArgument, step),
                    };
                    assert_eq!(status, expected);
                    self.rebuilds[k].step = after;
                }
                _ => {
                    self.rebuilds.swap_remove(k);
                    foveal_cull_rebuild_destroy(handle);
                }
            }
        }
    }

    fn refit(&mut self, r: &mut Choices<'_>, n: usize) {
        let set = r.or_null(self.sets[n].0);
        let mut wants = 9;
        // SAFETY: the set lives or is null; a place for the answer.
        let [status, asked] = unsafe {
            let status = if r.one_in(4) {
                foveal_cull_occludees_rebuild(set)
            } else {
                foveal_cull_occludees_refit(set)
            };
            [status, foveal_cull_occludees_wants_rebuild(set, &mut wants)]
        };
        assert_eq!(self.calls.note(status), asked);
        assert_eq!(status == Status::Ok, !set.is_null());
        assert_eq!(wants < 2, !set.is_null());
    }

    /// Asks for one object of any set.
    fn look(&mut self, r: &mut Choices<'_>, n: usize) {
        if self.objects.is_empty() {
            return;
        }
        let object = self.objects[r.below(self.objects.len())];
        let expected = match object {
            o if o.owner != n => Status::OtherSet,
            o if o.lives => Status::Ok,
            _ => Status::UnknownOccludee,
        };
        let (mut bounds, mut index, mut count, mut contains) = ([9.0; 6], 9, 0, 9);
        let set = self.sets[n].0;
        // SAFETY: a live set, one id, and places for the answers.
        let statuses = unsafe {
            [
                foveal_cull_occludees_bounds(set, object.id, bounds.as_mut_ptr()),
                foveal_cull_occludees_indices(set, &object.id, 1, &mut index),
                foveal_cull_occludees_contains(set, object.id, &mut contains),
                foveal_cull_occludees_result_count(set, &mut count),
            ]
        };
        for status in statuses {
            self.calls.note(status);
        }
        assert_eq!(statuses, [expected, expected, Status::Ok, Status::Ok]);
        assert_eq!(contains == 1, expected == Status::Ok);
        if expected == Status::Ok {
            assert_eq!(bits(bounds), bits(object.bounds));
            assert!((index as usize) < count);
        } else {
            assert_eq!((bounds, index), ([9.0; 6], 9), "results of a failure");
        }
    }

    /// Tests all sets, and compares with lists. No result may be more than `most`.
    pub(super) fn test(&mut self, r: &mut Choices<'_>, culler: *const FovealCuller, most: u8) {
        for (n, &(set, origin)) in self.sets.iter().enumerate() {
            let live: Vec<Object> = self
                .objects
                .iter()
                .copied()
                .filter(|o| o.owner == n && o.lives)
                .collect();
            let ids: Vec<FovealCullOccludeeId> = live.iter().map(|o| o.id).collect();
            let numbers: Vec<f32> = live.iter().flat_map(|o| o.bounds).collect();
            let (mut indices, mut of_list) = (vec![0u32; ids.len()], vec![9u8; ids.len()]);
            let mut count = 0;
            // SAFETY: live handles; lists as long as is said; three numbers; places for results.
            unsafe {
                let at = indices.as_mut_ptr();
                let listed = foveal_cull_occludees_indices(set, ids.as_ptr(), ids.len(), at);
                assert_eq!(listed, Status::Ok);
                let counted = foveal_cull_occludees_result_count(set, &mut count);
                assert_eq!(counted, Status::Ok);
                let mut results = vec![9u8; count + 1];
                let wrong = usize::from(r.one_in(5));
                let to = results.as_mut_ptr();
                let status = foveal_culler_test_occludees(culler, set, to, count + wrong);
                if wrong != 0 {
                    assert_eq!(self.calls.note(status), Status::WrongLength);
                    assert!(results.iter().all(|v| *v == 9), "results of a failure");
                    continue;
                }
                assert_eq!(self.calls.note(status), Status::Ok);
                let (from, to) = (numbers.as_ptr(), of_list.as_mut_ptr());
                let status = foveal_culler_test_boxes(culler, from, ids.len(), origin.as_ptr(), to);
                assert_eq!(status, Status::Ok);
                for (index, of_list) in indices.iter().zip(of_list) {
                    let result = results[*index as usize];
                    assert!(result <= most);
                    // A group that is hidden as a whole hides more, never less.
                    assert!(result != 0 || of_list == 0);
                }
            }
        }
    }
}

impl Drop for Occludees {
    fn drop(&mut self) {
        // SAFETY: nothing uses them any more.
        unsafe {
            let (sets, rebuilds) = (&self.sets, &self.rebuilds);
            sets.iter().for_each(|s| foveal_cull_occludees_destroy(s.0));
            rebuilds
                .iter()
                .for_each(|b| foveal_cull_rebuild_destroy(b.handle));
        }
    }
}
