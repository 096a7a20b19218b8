//! Partial coverage in two layers, for pixels whose parts lie far apart in depth: a near layer, and
//! one of all parts.
//!
//! Clusters come nearest first, but polygons not quite. Where a far polygon covers what a near one
//! left open, or a near one comes late, a single depth would forget how near the near parts are,
//! and their missing samples could never complete them. The near parts are therefore kept apart, as
//! in Hasselgren, Andersson and Akenine-Möller 2016, *Masked Software Occlusion Culling*, section
//! 3.2, but exactly: nothing is dropped before it is hidden.

use crate::depth::band::BlockMut;
use crate::depth::block::{BlockState, KIND_LAYERS, KIND_PARTIAL, PartialBlock};
use crate::simd::Lanes;

/// Depth codes further apart than this, half an octave of distance, are kept in two layers.
pub(super) const APART: i16 = 1024;

/// A part of a block's samples, and its farthest depth per pixel, which counts only where the part
/// has samples.
#[derive(Clone, Copy)]
pub(super) struct Layer<L: Lanes> {
    pub(super) bits: L::P,
    pub(super) center: u64,
    pub(super) depth: L::D,
}

impl<L: Lanes> Layer<L> {
    #[inline(always)]
    fn load(l: L, from: &PartialBlock) -> Self {
        Self {
            bits: l.pload(&from.bits),
            center: from.center,
            depth: l.dload(&from.depth),
        }
    }

    #[inline(always)]
    fn store(self, l: L, to: &mut PartialBlock) {
        l.pstore(self.bits, &mut to.bits);
        to.center = self.center;
        l.dstore(self.depth, &mut to.depth);
        to.any = self.any(l);
    }

    #[inline(always)]
    fn any(&self, l: L) -> u64 {
        l.pany(self.bits) | self.center
    }

    #[inline(always)]
    fn full(&self, l: L) -> u64 {
        l.pall(self.bits) & self.center
    }

    /// Only the pixels whose bit is set.
    #[inline(always)]
    fn keep(self, l: L, bits: u64) -> Self {
        Self {
            bits: l.pkeep(self.bits, bits),
            center: self.center & bits,
            ..self
        }
    }

    /// The union of two layers, at the farther depth where both have samples.
    #[inline(always)]
    fn with(&self, l: L, other: &Self) -> Self {
        let (here, there) = (self.any(l), other.any(l));
        let depth = l.dselect(here, l.dmin(self.depth, other.depth), other.depth);
        Self {
            bits: l.por(self.bits, other.bits),
            center: self.center | other.center,
            depth: l.dselect(there, depth, self.depth),
        }
    }
}

/// Adds the part `ours`, of the pixels `joined`, to a block with a slot whose depth is otherwise
/// `new`.
#[inline(always)]
pub(super) fn join<L: Lanes>(
    l: L,
    to: BlockMut<'_, '_>,
    slot: u32,
    ours: &Layer<L>,
    joined: u64,
    new: L::D,
) {
    let front = Layer::load(l, &to.slots.partial[slot as usize]);
    let all = if to.state.kind() == KIND_LAYERS {
        Layer::load(l, &to.slots.all[slot as usize])
    } else {
        front
    };
    let theirs = front.any(l);
    let apart = l.dapart(ours.depth, front.depth, APART) & joined & theirs;
    let nearer = l.dgt(ours.depth, front.depth) & apart;
    // Much nearer: the near layer begins anew, and its old parts live on in the layer of all. Much
    // farther: it stays as it is.
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

/// Drops partial coverage that cannot bring anything nearer than the depth `d`.
#[inline(always)]
pub(super) fn forget_hidden<L: Lanes>(l: L, to: BlockMut<'_, '_>, d: L::D) {
    let slot = to.state.slot();
    let partial = &mut to.slots.partial[slot as usize];
    let kept = partial.any & l.dgt(l.dload(&partial.depth), d);
    if kept == 0 {
        to.slots.give(slot, true);
        *to.state = BlockState::DEPTH;
        return;
    }
    l.pstore(l.pkeep(l.pload(&partial.bits), kept), &mut partial.bits);
    partial.center &= kept;
    partial.any = kept;
}

/// Drops partial coverage in two layers that cannot bring anything nearer than the depth `d`.
#[inline(always)]
pub(super) fn forget_hidden_layers<L: Lanes>(l: L, to: BlockMut<'_, '_>, d: L::D) {
    let slot = to.state.slot();
    let (front, all) = (
        Layer::load(l, &to.slots.partial[slot as usize]),
        Layer::load(l, &to.slots.all[slot as usize]),
    );
    forget(l, to, slot, front, all, d);
}

/// Stores what is not hidden behind `d`, in one layer where both would be the same.
#[inline(always)]
fn forget<L: Lanes>(
    l: L,
    to: BlockMut<'_, '_>,
    slot: u32,
    front: Layer<L>,
    all: Layer<L>,
    d: L::D,
) {
    let front = front.keep(l, l.dgt(front.depth, d));
    let kept = l.dgt(all.depth, d);
    // Where the layer of all is hidden, only the near parts count.
    let all = Layer {
        bits: l.por(l.pkeep(all.bits, kept), l.pkeep(front.bits, !kept)),
        center: (all.center & kept) | (front.center & !kept),
        depth: l.dselect(kept, all.depth, front.depth),
    };
    let two = l.dgt(front.depth, all.depth) & front.any(l);
    let partial = &mut to.slots.partial[slot as usize];
    front.store(l, partial);
    let any = partial.any;
    *to.state = if two != 0 {
        all.store(l, &mut to.slots.all[slot as usize]);
        BlockState::partial(KIND_LAYERS, slot)
    } else if any != 0 {
        BlockState::partial(KIND_PARTIAL, slot)
    } else {
        to.slots.give(slot, true);
        BlockState::DEPTH
    };
}
