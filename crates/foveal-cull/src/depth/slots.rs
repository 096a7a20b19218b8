//! Slots: memory for the partial coverage of blocks.
//!
//! Most blocks are covered in part only for a short time, until the neighbours of the first polygon
//! come. A few slots therefore circulate and stay in the nearest caches; memory for every block
//! would be most of what a frame touches. There are as many slots as blocks, since all may be taken
//! at once. A taken slot is the one that was given back longest ago: its number is known early and
//! does not wait for the block before.

use super::block::PartialBlock;

/// Slots that are put into circulation at once when none is free.
const BEGUN_AT_ONCE: u32 = 64;

/// The slots of a band. At most as many as it has blocks are taken.
pub(crate) struct Slots<'a> {
    pub(crate) partial: &'a mut [PartialBlock],
    /// The far layer: all parts together, where those in `partial` are the near ones.
    pub(crate) all: &'a mut [PartialBlock],
    /// Ring buffer of free slots, from `taken` to `given`. Its length is a power of two.
    free: &'a mut [u32],
    around: u32,
    taken: u32,
    given: u32,
    begun: u32,
}

impl<'a> Slots<'a> {
    /// `free` is twice as long as the other slices.
    pub(crate) fn new(
        partial: &'a mut [PartialBlock],
        all: &'a mut [PartialBlock],
        free: &'a mut [u32],
    ) -> Self {
        let around = partial.len().next_power_of_two() as u32 - 1;
        Self {
            partial,
            all,
            free,
            around,
            taken: 0,
            given: 0,
            begun: 0,
        }
    }

    /// The slots of the first `blocks` blocks, and those of the rest.
    pub(crate) fn split(self, blocks: usize) -> (Self, Self) {
        let (p0, p1) = self.partial.split_at_mut(blocks);
        let (a0, a1) = self.all.split_at_mut(blocks);
        let (f0, f1) = self.free.split_at_mut(2 * blocks);
        (Self::new(p0, a0, f0), Self::new(p1, a1, f1))
    }

    /// The next free slot.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn next(&mut self) -> u32 {
        if self.taken == self.given {
            self.begin();
        }
        self.free[self.place(self.taken)]
    }

    /// Takes the next free slot, if `wanted`.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn take(&mut self, wanted: bool) {
        self.taken = self.taken.wrapping_add(u32::from(wanted));
    }

    /// Gives a taken slot back, if `unwanted`.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn give(&mut self, slot: u32, unwanted: bool) {
        // The slot is taken, so the ring buffer has room for it.
        let place = self.place(self.given);
        self.free[place] = slot;
        self.given = self.given.wrapping_add(u32::from(unwanted));
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    fn place(&self, n: u32) -> usize {
        (n & self.around) as usize
    }

    #[cold]
    fn begin(&mut self) {
        let end = (self.begun + BEGUN_AT_ONCE).min(self.partial.len() as u32);
        for slot in self.begun..end {
            self.give(slot, true);
        }
        self.begun = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::block::PartialBlock;

    #[test]
    fn no_slot_is_held_twice_and_few_go_round() {
        for (blocks, held_at_most) in [(1, 1), (3, 3), (100, 100), (3000, 40), (3000, 3000)] {
            let mut partial = vec![PartialBlock::NONE; blocks];
            let mut all = partial.clone();
            let mut free = vec![0; 2 * blocks];
            let mut slots = Slots::new(&mut partial, &mut all, &mut free);
            let mut held_by: Vec<Option<u32>> = vec![None; blocks];
            let (mut used, mut held) = (vec![false; blocks], 0);
            let mut seed = 1u32;
            for _ in 0..20_000 {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let block = (seed >> 8) as usize % blocks;
                let begins = held_by[block].is_none();
                if begins && held == held_at_most {
                    continue;
                }
                // A block takes a slot if it has none, and gives it back when it is done.
                let next = slots.next();
                slots.take(begins);
                let slot = held_by[block].unwrap_or(next);
                assert!(
                    !begins || !held_by.contains(&Some(slot)),
                    "{blocks}: {slot}"
                );
                used[slot as usize] = true;
                let done = seed >> 30 == 0;
                slots.give(slot, done);
                held += usize::from(begins);
                held -= usize::from(done);
                held_by[block] = (!done).then_some(slot);
            }
            let used = used.iter().filter(|u| **u).count();
            assert!(used < held_at_most + 2 * BEGUN_AT_ONCE as usize, "{used}");
        }
    }
}
