//! The update of one 8x8 block by one polygon: its coverage, its depth, and the merge into the
//! buffer.
//!
//! Coverage: for a row of blocks the polygon's edges are evaluated in `f64` in its 32 rows of
//! samples (and in 8 rows through pixel centres) and rounded to the first covered sample. In a
//! block these numbers become bits, a few integer operations for all of its 1,024 samples.
//!
//! Depth: the polygon's plane at its farthest point within each pixel, but no farther than its
//! farthest vertex.
//!
//! Merge, per pixel:
//!
//! | samples that the polygon covers | pixel so far | result |
//! |---|---|---|
//! | all, nearer than the depth so far | any | the polygon's depth; partial coverage behind it is dropped |
//! | some, nearer | no partial coverage | partial coverage begins |
//! | some, nearer | partial, together still not all samples | union of samples, farther of the two depths |
//! | some, nearer | partial, together all samples | depth: the farther of the two, if nearer than so far |
//! | some, nearer | partial, far apart in depth | two layers (see [`super::layers`]) |
//! | any, farther than the depth so far, or in a silhouette margin | any | unchanged |

use super::edges::Edges;
use super::layers::{self, APART, Layer};
use crate::depth::band::{Band, BlockMut};
use crate::depth::block::{
    BlockState, KIND_DEPTH, KIND_EMPTY, KIND_LAYERS, KIND_PARTIAL, PartialBlock,
};
use crate::format::{BLOCK, BLOCK_SAMPLES, EMPTY, encode};
use crate::simd::{Lanes, larger, smaller};

/// The depth plane of a polygon: an affine function of pixels, lowered to hold for whole pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthPlane {
    /// A point on the plane, samples.
    pub(crate) x: f32,
    pub(crate) y: f32,
    /// Depth at that point, lowered.
    pub(crate) depth: f32,
    /// Change per sample.
    pub(crate) dx: f32,
    pub(crate) dy: f32,
    /// Depth of the farthest vertex, and the codes of the farthest and the nearest.
    pub(crate) min: f32,
    pub(crate) min_code: i16,
    pub(crate) max_code: i16,
}

/// The edges of a polygon, two left and two right ones, prepared for rows of blocks.
pub(crate) struct EdgeRows<L: Lanes> {
    edges: Edges<L>,
    rows: L::B,
}

impl<L: Lanes> EdgeRows<L> {
    #[inline(always)]
    pub(crate) fn new(l: L, edges: &Edges<L>) -> Self {
        Self {
            edges: *edges,
            rows: l.edge_rows(edges.slope),
        }
    }

    /// Positions of the edges at the first sample row of a row of blocks that begins at `top`,
    /// samples.
    #[inline(always)]
    pub(crate) fn at(&self, l: L, top: f32) -> L::Q {
        let e = &self.edges;
        let down = l.qsub(l.qsplat(f64::from(top + 0.5)), e.y);
        l.qadd(l.qmul(down, e.slope), e.x)
    }

    /// Spans of covered samples in a row of blocks, from the positions there.
    #[inline(always)]
    pub(crate) fn spans(&self, l: L, at: L::Q, rows: Option<(f32, f32)>, top: f32) -> L::S {
        let first = f64::from(top + 0.5);
        let limits = rows.map(|(after, last)| [f64::from(after) - first, f64::from(last) - first]);
        // Sample n of a row lies at n + 0.5.
        l.spans(l.qadd(at, l.qsplat(0.5)), &self.rows, limits)
    }
}

/// Depths of a block's pixels as an affine function of column and row.
struct Slope {
    /// At the first pixel.
    first: f32,
    /// Change per pixel.
    across: f32,
    down: f32,
}

impl Slope {
    #[inline(always)]
    fn new(plane: &DepthPlane, bx: u32, by: u32) -> Self {
        // Centre of the first pixel.
        let x = (bx * BLOCK_SAMPLES) as f32 + 2.0 - plane.x;
        let y = (by * BLOCK_SAMPLES) as f32 + 2.0 - plane.y;
        Self {
            first: plane.depth + plane.dx * x + plane.dy * y,
            across: plane.dx * 4.0,
            down: plane.dy * 4.0,
        }
    }

    /// Depth codes of all 64 pixels.
    #[inline(always)]
    fn codes<L: Lanes>(&self, l: L, plane: &DepthPlane) -> L::D {
        const COLUMNS: [f32; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        let columns = l.mul(l.load(&COLUMNS), l.splat(self.across));
        let columns = l.add(l.splat(self.first), columns);
        // Never nearer than the nearest vertex, so that a polygon skipped as hidden would have
        // changed nothing.
        l.depths(columns, self.down, plane.min, plane.max_code)
    }

    /// The least of these codes. Sums round alike everywhere, so it is that of a corner.
    #[inline(always)]
    fn least_code(&self, plane: &DepthPlane) -> i16 {
        let last = (BLOCK - 1) as f32;
        let left = smaller(self.first, self.first + last * self.across);
        let least = left + smaller(0.0, last * self.down);
        smaller(encode(larger(least, plane.min)), plane.max_code)
    }
}

/// Work of updating a block that is covered wholly or in part, about ten nanoseconds per unit.
/// Threads share work by it.
pub(crate) const WORK_OF_FULL: u32 = 2;
const WORK_OF_PARTIAL: u32 = 3;

/// Merges a polygon that covers the whole block; returns the work.
#[inline(always)]
pub(crate) fn cover_full<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    bx: u32,
    by: u32,
    plane: &DepthPlane,
) -> u32 {
    let i = ((by - band.first_row) * band.blocks_x + bx) as usize;
    let margin = band.margin(i, plane.min_code, plane.max_code);
    let to = band.block_mut(i);
    if plane.max_code <= *to.min {
        return 0;
    }
    let slope = Slope::new(plane, bx, by);
    let kind = to.state.kind();
    let mut d = slope.codes(l, plane);
    if (kind == KIND_EMPTY) & (margin == 0) {
        l.dstore(d, &mut to.depth.0);
        *to.min = slope.least_code(plane);
        *to.state = BlockState::DEPTH;
        return WORK_OF_FULL;
    }
    if margin != 0 {
        d = l.dselect(margin, l.dsplat(EMPTY), d);
    }
    if kind != KIND_EMPTY {
        d = l.dmax(d, l.dload(&to.depth.0));
    }
    l.dstore(d, &mut to.depth.0);
    *to.min = l.dreduce_min(d);
    match kind {
        KIND_PARTIAL => layers::forget_hidden(l, to, d),
        KIND_LAYERS => layers::forget_hidden_layers(l, to, d),
        _ => *to.state = BlockState::DEPTH,
    }
    WORK_OF_FULL
}

/// Merges a polygon that covers a part of the block; returns the work.
#[inline(always)]
pub(crate) fn cover_partial<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    bx: u32,
    by: u32,
    plane: &DepthPlane,
    spans: &L::S,
) -> u32 {
    let i = ((by - band.first_row) * band.blocks_x + bx) as usize;
    let (far, near) = (plane.min_code, plane.max_code);
    let margin = band.margin(i, far, near);
    let to = band.block_mut(i);
    if near <= *to.min {
        return 0;
    }
    let ours = Part {
        depth: Slope::new(plane, bx, by).codes(l, plane),
        covered: Covered::new(l, spans, bx),
    };
    if to.state.kind() == KIND_EMPTY {
        begin(l, to, &ours, !margin);
    } else {
        merge(l, to, &ours, !margin);
    }
    WORK_OF_PARTIAL
}

/// A polygon's coverage of a block.
struct Covered<L: Lanes> {
    bits: L::P,
    /// Pixels whose centre is covered.
    center: u64,
    /// Pixels of which all samples are covered. They lie within convex edges, and so does the
    /// centre.
    whole: u64,
    /// Pixels of which any sample or the centre is covered.
    touched: u64,
}

impl<L: Lanes> Covered<L> {
    #[inline(always)]
    fn new(l: L, spans: &L::S, bx: u32) -> Self {
        let (bits, center) = l.within(spans, bx * BLOCK_SAMPLES);
        Self {
            bits,
            center,
            whole: l.pall(bits),
            touched: l.pany(bits) | center,
        }
    }
}

/// A polygon's part of a block: its coverage and its depth.
struct Part<L: Lanes> {
    covered: Covered<L>,
    depth: L::D,
}

/// Merges the first polygon of an empty block, in the pixels `allowed`.
#[inline(always)]
fn begin<L: Lanes>(l: L, to: BlockMut<'_, '_>, ours: &Part<L>, allowed: u64) {
    let Part { covered, depth } = ours;
    let alone = covered.whole & allowed;
    let joined = covered.touched & allowed & !alone;
    let new = l.dselect(alone, *depth, l.dsplat(EMPTY));
    l.dstore(new, &mut to.depth.0);
    if alone == u64::MAX {
        *to.min = l.dreduce_min(new);
    }
    if joined == 0 {
        *to.state = BlockState::DEPTH;
        return;
    }
    let slot = to.slots.next();
    to.slots.take(true);
    let partial = &mut to.slots.partial[slot as usize];
    l.pstore(l.pkeep(covered.bits, joined), &mut partial.bits);
    l.dstore(*depth, &mut partial.depth);
    partial.center = covered.center & joined;
    partial.any = joined;
    *to.state = BlockState::partial(KIND_PARTIAL, slot);
}

/// Merges a further polygon, in the pixels `allowed`.
#[inline(always)]
fn merge<L: Lanes>(l: L, to: BlockMut<'_, '_>, ours: &Part<L>, allowed: u64) {
    let Part { covered, depth: d } = ours;
    let kind = to.state.kind();
    let slot = if kind == KIND_DEPTH {
        let slot = to.slots.next();
        to.slots.take(true);
        slot
    } else {
        to.state.slot()
    };
    let partial = &mut to.slots.partial[slot as usize];
    // Stale memory is not even fetched.
    let begun = if kind == KIND_DEPTH {
        &PartialBlock::NONE
    } else {
        &*partial
    };
    let old = l.dload(&to.depth.0);
    let (theirs, before) = (l.dload(&begun.depth), begun.any);
    let (their_bits, their_center) = (l.pload(&begun.bits), begun.center);
    // The pixels that all parts together complete do not wait for depths: none of their pixels was
    // complete before.
    let complete = l.pall(l.por(covered.bits, their_bits)) & (covered.center | their_center);
    // Only pixels where the polygon is nearer than the depth so far. Those that it covers alone
    // need no partner, and their partial coverage stays apart.
    let nearer = l.dgt(*d, old) & allowed;
    let alone = covered.whole & nearer;
    let joined = covered.touched & nearer & !covered.whole;
    let full = complete & joined;
    let new = l.dselect(alone, *d, old);
    let our_bits = l.pkeep(covered.bits, joined);
    let our_center = covered.center & joined;
    let apart = l.dapart(*d, theirs, APART) & joined & before;
    if (apart != 0) | (kind == KIND_LAYERS) {
        let ours = Layer {
            bits: our_bits,
            center: our_center,
            depth: *d,
        };
        layers::join(l, to, slot, &ours, joined, new);
        return;
    }
    let far = l.dsplat(i16::MAX);
    let depth = l.dmin(l.dselect(joined, *d, far), l.dselect(before, theirs, far));
    let new = l.dselect(full, l.dmax(new, depth), new);
    l.dstore(new, &mut to.depth.0);
    *to.min = l.dreduce_min(new);
    // Drop what is complete, or hidden by now. Partial coverage is nearer than the old depth, and
    // so is what joins it.
    let hidden = alone & !l.dgt(theirs, *d);
    let kept = (joined | before) & !(hidden | full);
    let bits = l.pkeep(l.por(our_bits, their_bits), kept);
    l.pstore(bits, &mut partial.bits);
    partial.center = (our_center | their_center) & kept;
    l.dstore(depth, &mut partial.depth);
    partial.any = kept;
    to.slots.give(slot, kept == 0);
    *to.state = if kept != 0 {
        BlockState::partial(KIND_PARTIAL, slot)
    } else {
        BlockState::DEPTH
    };
}
