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
use crate::simd::{Depths, Lanes, Samples};

/// Depth codes further apart than this, half an octave of distance, are kept in two layers.
pub(super) const APART: i16 = 1024;

/// A part of a block's samples, and its farthest depth per pixel, which counts only where the part
/// has samples.
#[derive(Clone, Copy)]
pub(super) struct Layer<L: Lanes> {
    pub(super) bits: Samples<L>,
    pub(super) center: u64,
    pub(super) depth: Depths<L>,
}

impl<L: Lanes> Layer<L> {
    #[cfg_attr(not(unoptimized), inline(always))]
    fn load(l: L, from: &PartialBlock) -> Self {
        Self {
            bits: l.load_samples(&from.bits),
            center: from.center,
            depth: l.load_depths(&from.depth),
        }
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    fn store(self, to: &mut PartialBlock) {
        self.bits.store(&mut to.bits);
        to.center = self.center;
        self.depth.store(&mut to.depth);
        to.any = self.any();
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    fn any(&self) -> u64 {
        self.bits.any() | self.center
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    fn full(&self) -> u64 {
        self.bits.all() & self.center
    }

    /// Only the pixels whose bit is set.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn keep(self, bits: u64) -> Self {
        Self {
            bits: self.bits.keep(bits),
            center: self.center & bits,
            ..self
        }
    }

    /// The union of two layers, at the farther depth where both have samples.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn with(&self, other: &Self) -> Self {
        let (here, there) = (self.any(), other.any());
        let depth = Depths::select(here, self.depth.min(other.depth), other.depth);
        Self {
            bits: self.bits | other.bits,
            center: self.center | other.center,
            depth: Depths::select(there, depth, self.depth),
        }
    }
}

/// Adds the part `ours`, of the pixels `joined`, to a block with a slot whose depth is otherwise
/// `new`.
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn join<L: Lanes>(
    l: L,
    to: BlockMut<'_, '_>,
    slot: u32,
    ours: &Layer<L>,
    joined: u64,
    new: Depths<L>,
) {
    let front = Layer::load(l, &to.slots.partial[slot as usize]);
    let all = if to.state.kind() == KIND_LAYERS {
        Layer::load(l, &to.slots.all[slot as usize])
    } else {
        front
    };
    let theirs = front.any();
    let apart = ours.depth.apart(front.depth, APART) & joined & theirs;
    let nearer = ours.depth.gt(front.depth) & apart;
    // Much nearer: the near layer begins anew, and its old parts live on in the layer of all. Much
    // farther: it stays as it is.
    let front = front.keep(!nearer).with(&ours.keep(nearer | !apart));
    let all = all.with(ours);
    let full = front.full();
    let new = Depths::select(full, new.max(front.depth), new);
    let full = all.full();
    let new = Depths::select(full, new.max(all.depth), new);
    new.store(&mut to.depth.0);
    *to.min = new.farthest();
    forget(to, slot, front, all, new);
}

/// Drops partial coverage that cannot bring anything nearer than the depth `d`.
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn forget_hidden<L: Lanes>(l: L, to: BlockMut<'_, '_>, d: Depths<L>) {
    let slot = to.state.slot();
    let partial = &mut to.slots.partial[slot as usize];
    let kept = partial.any & l.load_depths(&partial.depth).gt(d);
    if kept == 0 {
        to.slots.give(slot, true);
        *to.state = BlockState::DEPTH;
        return;
    }
    l.load_samples(&partial.bits)
        .keep(kept)
        .store(&mut partial.bits);
    partial.center &= kept;
    partial.any = kept;
}

/// Drops partial coverage in two layers that cannot bring anything nearer than the depth `d`.
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn forget_hidden_layers<L: Lanes>(l: L, to: BlockMut<'_, '_>, d: Depths<L>) {
    let slot = to.state.slot();
    let (front, all) = (
        Layer::load(l, &to.slots.partial[slot as usize]),
        Layer::load(l, &to.slots.all[slot as usize]),
    );
    forget(to, slot, front, all, d);
}

/// Stores what is not hidden behind `d`, in one layer where both would be the same.
#[cfg_attr(not(unoptimized), inline(always))]
fn forget<L: Lanes>(to: BlockMut<'_, '_>, slot: u32, front: Layer<L>, all: Layer<L>, d: Depths<L>) {
    let front = front.keep(front.depth.gt(d));
    let kept = all.depth.gt(d);
    // Where the layer of all is hidden, only the near parts count.
    let all = Layer {
        bits: all.bits.keep(kept) | front.bits.keep(!kept),
        center: (all.center & kept) | (front.center & !kept),
        depth: Depths::select(kept, all.depth, front.depth),
    };
    let two = front.depth.gt(all.depth) & front.any();
    let partial = &mut to.slots.partial[slot as usize];
    front.store(partial);
    let any = partial.any;
    *to.state = if two != 0 {
        all.store(&mut to.slots.all[slot as usize]);
        BlockState::partial(KIND_LAYERS, slot)
    } else if any != 0 {
        BlockState::partial(KIND_PARTIAL, slot)
    } else {
        to.slots.give(slot, true);
        BlockState::DEPTH
    };
}
