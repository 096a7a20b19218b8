//! Partly covered pixels whose parts lie far apart in depth: a layer in front, and one of all.
//!
//! Clusters come nearest first, polygons do not quite. Where a far polygon covers what a near one has left open, or a
//! near one comes late, one depth for both would forget how near the near parts are, and what they still lack would
//! never complete them. So the near parts are kept apart, as in masked occlusion culling (Hasselgren, Andersson and
//! Akenine-Moeller 2016, section 3.2), but exactly: nothing is thrown away before it is hidden.

use crate::depth::band::Here;
use crate::depth::block::{Held, PartialBlock, STATE_LAYERS, STATE_PARTIAL};
use crate::simd::Lanes;

/// Codes further apart than this (half of them are a factor of two in distance) are kept apart.
pub(super) const APART: i16 = 1024;

/// A part of the samples of a block, and its farthest depth per pixel, which counts only where there are any.
#[derive(Clone, Copy)]
pub(super) struct Layer<L: Lanes> {
    pub(super) planes: L::P,
    pub(super) center: u64,
    pub(super) depth: L::D,
}

impl<L: Lanes> Layer<L> {
    #[inline(always)]
    fn load(l: L, from: &PartialBlock) -> Self {
        Self {
            planes: l.pload(&from.planes),
            center: from.center,
            depth: l.dload(&from.depth),
        }
    }

    #[inline(always)]
    fn store(self, l: L, to: &mut PartialBlock) {
        l.pstore(self.planes, &mut to.planes);
        to.center = self.center;
        l.dstore(self.depth, &mut to.depth);
        to.any = self.any(l);
    }

    #[inline(always)]
    fn any(&self, l: L) -> u64 {
        l.pany(self.planes) | self.center
    }

    #[inline(always)]
    fn full(&self, l: L) -> u64 {
        l.pall(self.planes) & self.center
    }

    /// Only the pixels whose bit is set.
    #[inline(always)]
    fn keep(self, l: L, bits: u64) -> Self {
        Self {
            planes: l.pkeep(self.planes, bits),
            center: self.center & bits,
            ..self
        }
    }

    /// Both where both have something, as far as the farther one.
    #[inline(always)]
    fn with(&self, l: L, other: &Self) -> Self {
        let (here, there) = (self.any(l), other.any(l));
        let depth = l.dselect(here, l.dmin(self.depth, other.depth), other.depth);
        Self {
            planes: l.por(self.planes, other.planes),
            center: self.center | other.center,
            depth: l.dselect(there, depth, self.depth),
        }
    }
}

/// Adds a part `ours`, of the pixels `joined`, to a block (that has a slot) whose depth is otherwise `new`.
#[inline(always)]
pub(super) fn join<L: Lanes>(
    l: L,
    to: Here<'_, '_>,
    slot: u32,
    ours: &Layer<L>,
    joined: u64,
    new: L::D,
) {
    let front = Layer::load(l, &to.pool.partial[slot as usize]);
    let all = if to.held.state() == STATE_LAYERS {
        Layer::load(l, &to.pool.all[slot as usize])
    } else {
        front
    };
    let theirs = front.any(l);
    let apart = l.dapart(ours.depth, front.depth, APART) & joined & theirs;
    let nearer = l.dgt(ours.depth, front.depth) & apart;
    // Much nearer: the front begins anew; it is part of all. Much farther: it stays as it is.
    let front = front
        .keep(l, !nearer)
        .with(l, &ours.keep(l, nearer | !apart));
    let all = all.with(l, ours);
    let full = front.full(l);
    let new = l.dselect(full, l.dmax(new, front.depth), new);
    let full = all.full(l);
    let new = l.dselect(full, l.dmax(new, all.depth), new);
    l.dstore(new, &mut to.depth.0);
    *to.min = l.dreduce_min(new);
    forget(l, to, slot, front, all, new);
}

/// Drops partial coverage that can no longer bring anything nearer than the depth `d` that is there.
#[inline(always)]
pub(super) fn forget_hidden<L: Lanes>(l: L, to: Here<'_, '_>, d: L::D) {
    let slot = to.held.slot();
    let partial = &mut to.pool.partial[slot as usize];
    let kept = partial.any & l.dgt(l.dload(&partial.depth), d);
    if kept == 0 {
        to.pool.give(slot, true);
        *to.held = Held::DEPTH;
        return;
    }
    l.pstore(l.pkeep(l.pload(&partial.planes), kept), &mut partial.planes);
    partial.center &= kept;
    partial.any = kept;
}

/// The same where there are layers.
#[inline(always)]
pub(super) fn forget_hidden_layers<L: Lanes>(l: L, to: Here<'_, '_>, d: L::D) {
    let slot = to.held.slot();
    let (front, all) = (
        Layer::load(l, &to.pool.partial[slot as usize]),
        Layer::load(l, &to.pool.all[slot as usize]),
    );
    forget(l, to, slot, front, all, d);
}

/// Stores what is not hidden behind `d`, in one layer where two would be the same.
#[inline(always)]
fn forget<L: Lanes>(l: L, to: Here<'_, '_>, slot: u32, front: Layer<L>, all: Layer<L>, d: L::D) {
    let front = front.keep(l, l.dgt(front.depth, d));
    let kept = l.dgt(all.depth, d);
    // All that counts is in front where the rest is hidden.
    let all = Layer {
        planes: l.por(l.pkeep(all.planes, kept), l.pkeep(front.planes, !kept)),
        center: (all.center & kept) | (front.center & !kept),
        depth: l.dselect(kept, all.depth, front.depth),
    };
    let two = l.dgt(front.depth, all.depth) & front.any(l);
    let partial = &mut to.pool.partial[slot as usize];
    front.store(l, partial);
    let any = partial.any;
    *to.held = if two != 0 {
        all.store(l, &mut to.pool.all[slot as usize]);
        Held::partial(STATE_LAYERS, slot)
    } else if any != 0 {
        Held::partial(STATE_PARTIAL, slot)
    } else {
        to.pool.give(slot, true);
        Held::DEPTH
    };
}
