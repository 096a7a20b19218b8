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
use crate::simd::{Depths, Doubles, Lanes, Samples, larger, smaller};

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

/// Polygons over more depth codes than this, a thirty-second of an octave, are deep.
const DEEP: i32 = 64;

impl DepthPlane {
    /// Whether its blocks lie at depths so different that it is worth asking for each whether it
    /// is hidden.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn is_deep(&self) -> bool {
        i32::from(self.max_code) - i32::from(self.min_code) > DEEP
    }
}

/// The edges of a polygon, two left and two right ones, prepared for rows of blocks.
pub(crate) struct EdgeRows<L: Lanes> {
    edges: Edges<L>,
    rows: L::B,
}

impl<L: Lanes> EdgeRows<L> {
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn new(edges: &Edges<L>) -> Self {
        Self {
            edges: *edges,
            rows: edges.slope.edge_rows(),
        }
    }

    /// Positions of the edges at the first sample row of a row of blocks that begins at `top`,
    /// samples.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn at(&self, l: L, top: f32) -> Doubles<L> {
        let e = &self.edges;
        let down = l.double(f64::from(top + 0.5)) - e.y;
        down * e.slope + e.x
    }

    /// Spans of covered samples in a row of blocks, from the positions there.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn spans(&self, at: Doubles<L>, rows: Option<(f32, f32)>, top: f32) -> L::S {
        let first = f64::from(top + 0.5);
        let limits = rows.map(|(after, last)| [f64::from(after) - first, f64::from(last) - first]);
        // Sample n of a row lies at n + 0.5.
        (at + 0.5).spans(&self.rows, limits)
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
    #[cfg_attr(not(unoptimized), inline(always))]
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
    #[cfg_attr(not(unoptimized), inline(always))]
    fn codes<L: Lanes>(&self, l: L, plane: &DepthPlane) -> Depths<L> {
        const COLUMNS: [f32; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        let columns = l.load(&COLUMNS) * self.across;
        let columns = l.splat(self.first) + columns;
        // Never nearer than the nearest vertex, so that a polygon skipped as hidden would have
        // changed nothing.
        columns.plane(self.down, plane.min, plane.max_code)
    }

    /// The greatest of these codes, likewise.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn greatest_code(&self, plane: &DepthPlane) -> i16 {
        let last = (BLOCK - 1) as f32;
        let left = larger(self.first, self.first + last * self.across);
        let greatest = left + larger(0.0, last * self.down);
        smaller(encode(larger(greatest, plane.min)), plane.max_code)
    }

    /// The least of these codes. Sums round alike everywhere, so it is that of a corner.
    #[cfg_attr(not(unoptimized), inline(always))]
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
#[cfg_attr(not(unoptimized), inline(always))]
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
    if (kind != KIND_EMPTY) && plane.is_deep() && slope.greatest_code(plane) <= *to.min {
        return 0;
    }
    let mut d = slope.codes(l, plane);
    if (kind == KIND_EMPTY) & (margin == 0) {
        d.store(&mut to.depth.0);
        *to.min = slope.least_code(plane);
        *to.state = BlockState::DEPTH;
        return WORK_OF_FULL;
    }
    if margin != 0 {
        d = Depths::select(margin, l.depth(EMPTY), d);
    }
    if kind != KIND_EMPTY {
        d = d.max(l.load_depths(&to.depth.0));
    }
    d.store(&mut to.depth.0);
    *to.min = d.farthest();
    match kind {
        KIND_PARTIAL => layers::forget_hidden(l, to, d),
        KIND_LAYERS => layers::forget_hidden_layers(l, to, d),
        _ => *to.state = BlockState::DEPTH,
    }
    WORK_OF_FULL
}

/// Merges a polygon that covers a part of the block; returns the work.
#[cfg_attr(not(unoptimized), inline(always))]
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
    let slope = Slope::new(plane, bx, by);
    let kind = to.state.kind();
    if (kind != KIND_EMPTY) && plane.is_deep() && slope.greatest_code(plane) <= *to.min {
        return 0;
    }
    let ours = Part {
        depth: slope.codes(l, plane),
        covered: Covered::new(l, spans, bx),
    };
    match kind {
        KIND_EMPTY => begin(l, to, &ours, !margin),
        KIND_DEPTH => begin_over(l, to, &ours, !margin),
        _ => merge(l, to, &ours, !margin),
    }
    WORK_OF_PARTIAL
}

/// A polygon's coverage of a block.
struct Covered<L: Lanes> {
    bits: Samples<L>,
    /// Pixels whose centre is covered.
    center: u64,
    /// Pixels of which all samples are covered. They lie within convex edges, and so does the
    /// centre.
    whole: u64,
    /// Pixels of which any sample or the centre is covered.
    touched: u64,
}

impl<L: Lanes> Covered<L> {
    #[cfg_attr(not(unoptimized), inline(always))]
    fn new(l: L, spans: &L::S, bx: u32) -> Self {
        let (bits, center) = l.within(spans, bx * BLOCK_SAMPLES);
        Self {
            bits,
            center,
            whole: bits.all(),
            touched: bits.any() | center,
        }
    }
}

/// A polygon's part of a block: its coverage and its depth.
struct Part<L: Lanes> {
    covered: Covered<L>,
    depth: Depths<L>,
}

/// Merges the first polygon of an empty block, in the pixels `allowed`.
#[cfg_attr(not(unoptimized), inline(always))]
fn begin<L: Lanes>(l: L, to: BlockMut<'_, '_>, ours: &Part<L>, allowed: u64) {
    let Part { covered, depth } = ours;
    let alone = covered.whole & allowed;
    let joined = covered.touched & allowed & !alone;
    let new = Depths::select(alone, *depth, l.depth(EMPTY));
    new.store(&mut to.depth.0);
    if alone == u64::MAX {
        *to.min = new.farthest();
    }
    if joined == 0 {
        *to.state = BlockState::DEPTH;
        return;
    }
    let slot = to.slots.next();
    to.slots.take(true);
    let partial = &mut to.slots.partial[slot as usize];
    covered.bits.keep(joined).store(&mut partial.bits);
    (*depth).store(&mut partial.depth);
    partial.center = covered.center & joined;
    partial.any = joined;
    *to.state = BlockState::partial(KIND_PARTIAL, slot);
}

/// Merges a polygon into a block that has depth and no partial coverage, in the pixels `allowed`.
#[cfg_attr(not(unoptimized), inline(always))]
fn begin_over<L: Lanes>(l: L, to: BlockMut<'_, '_>, ours: &Part<L>, allowed: u64) {
    let Part { covered, depth } = ours;
    let old = l.load_depths(&to.depth.0);
    let nearer = depth.gt(old) & allowed;
    let alone = covered.whole & nearer;
    let joined = covered.touched & nearer & !covered.whole;
    let new = Depths::select(alone, *depth, old);
    new.store(&mut to.depth.0);
    *to.min = new.farthest();
    // Without a branch: what is written into a slot that is not taken is never read.
    let slot = to.slots.next();
    let any = joined != 0;
    to.slots.take(any);
    let partial = &mut to.slots.partial[slot as usize];
    covered.bits.keep(joined).store(&mut partial.bits);
    (*depth).store(&mut partial.depth);
    partial.center = covered.center & joined;
    partial.any = joined;
    *to.state = if any {
        BlockState::partial(KIND_PARTIAL, slot)
    } else {
        BlockState::DEPTH
    };
}

/// Merges a polygon into a block with partial coverage, in the pixels `allowed`.
#[cfg_attr(not(unoptimized), inline(always))]
fn merge<L: Lanes>(l: L, to: BlockMut<'_, '_>, ours: &Part<L>, allowed: u64) {
    let kind = to.state.kind();
    let slot = to.state.slot();
    let partial = &mut to.slots.partial[slot as usize];
    let theirs = Waiting::load(l, partial);
    let old = l.load_depths(&to.depth.0);
    let pixels = Pixels::of(ours, &theirs, old, allowed);
    let new = Depths::select(pixels.alone, ours.depth, old);
    let joining = ours.covered.bits.keep(pixels.joined);
    let joining_center = ours.covered.center & pixels.joined;
    let apart = ours.depth.apart(theirs.depth, APART) & pixels.joined & theirs.any;
    if (apart != 0) | (kind == KIND_LAYERS) {
        let ours = Layer {
            bits: joining,
            center: joining_center,
            depth: ours.depth,
        };
        layers::join(l, to, slot, &ours, pixels.joined, new);
        return;
    }
    // The farther of both where both have samples, and the depth of what is complete with it.
    let far = l.depth(i16::MAX);
    let depth = Depths::select(pixels.joined, ours.depth, far).min(Depths::select(
        theirs.any,
        theirs.depth,
        far,
    ));
    let new = Depths::select(pixels.full, new.max(depth), new);
    new.store(&mut to.depth.0);
    *to.min = new.farthest();
    // Drop what is complete, or hidden by now. Partial coverage is nearer than the old depth, and
    // so is what joins it.
    let hidden = pixels.alone & !theirs.depth.gt(ours.depth);
    let kept = (pixels.joined | theirs.any) & !(hidden | pixels.full);
    (joining | theirs.bits).keep(kept).store(&mut partial.bits);
    partial.center = (joining_center | theirs.center) & kept;
    depth.store(&mut partial.depth);
    partial.any = kept;
    to.slots.give(slot, kept == 0);
    *to.state = if kept != 0 {
        BlockState::partial(KIND_PARTIAL, slot)
    } else {
        BlockState::DEPTH
    };
}

/// The partial coverage of a block, which waits for further polygons.
struct Waiting<L: Lanes> {
    bits: Samples<L>,
    center: u64,
    depth: Depths<L>,
    /// Pixels that have any.
    any: u64,
}

impl<L: Lanes> Waiting<L> {
    #[cfg_attr(not(unoptimized), inline(always))]
    fn load(l: L, from: &PartialBlock) -> Self {
        Self {
            bits: l.load_samples(&from.bits),
            center: from.center,
            depth: l.load_depths(&from.depth),
            any: from.any,
        }
    }
}

/// What a polygon does to the pixels of a block. It changes only those where it is nearer than the
/// depth so far.
struct Pixels {
    /// It covers them alone. They need no partner, and their partial coverage stays apart.
    alone: u64,
    /// It joins their partial coverage, or begins it.
    joined: u64,
    /// Those of the joined pixels whose coverage it completes.
    full: u64,
}

impl Pixels {
    #[cfg_attr(not(unoptimized), inline(always))]
    fn of<L: Lanes>(ours: &Part<L>, theirs: &Waiting<L>, old: Depths<L>, allowed: u64) -> Self {
        let covered = &ours.covered;
        // The pixels that all parts together complete do not wait for depths: none of their pixels
        // was complete before.
        let complete = (covered.bits | theirs.bits).all() & (covered.center | theirs.center);
        let nearer = ours.depth.gt(old) & allowed;
        let joined = covered.touched & nearer & !covered.whole;
        Self {
            alone: covered.whole & nearer,
            joined,
            full: complete & joined,
        }
    }
}
