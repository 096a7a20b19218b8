//! Coverage and depth of one polygon in one 8x8 block, and how both are merged into the buffer.
//!
//! Coverage: for a row of blocks the borders are evaluated in `f64` in its 32 rows of samples (and in the 8 rows through
//! pixel centres), and rounded to the first sample that is covered. In a block these numbers become bits, a few integer
//! operations for all of its 1,024 samples.
//!
//! Depth: the polygon's plane at its farthest point within each pixel, no farther than its farthest vertex.

use super::edges::Edges;
use super::layers::{self, APART, Layer};
use crate::depth::band::{Band, Here};
use crate::depth::block::{
    Held, PartialBlock, STATE_DEPTH, STATE_EMPTY, STATE_LAYERS, STATE_PARTIAL,
};
use crate::format::{BLOCK, BLOCK_SAMPLES, EMPTY, encode};
use crate::simd::{Lanes, larger, smaller};

/// Depth of a polygon as an affine function of pixels, lowered to hold for whole pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// A point on it, samples.
    pub(crate) x: f32,
    pub(crate) y: f32,
    /// Depth there, lowered.
    pub(crate) depth: f32,
    /// Change per sample.
    pub(crate) dx: f32,
    pub(crate) dy: f32,
    /// Farthest and nearest vertex.
    pub(crate) min: f32,
    pub(crate) min_code: i16,
    pub(crate) max_code: i16,
}

/// The borders of a polygon, left two and right two, ready for rows of blocks.
pub(crate) struct Borders<L: Lanes> {
    edges: Edges<L>,
    rows: L::B,
}

impl<L: Lanes> Borders<L> {
    #[inline(always)]
    pub(crate) fn new(l: L, edges: &Edges<L>) -> Self {
        Self {
            edges: *edges,
            rows: l.borders(edges.slope),
        }
    }

    /// Positions at the first sample row of a row of blocks that begins at `top`, samples.
    #[inline(always)]
    pub(crate) fn at(&self, l: L, top: f32) -> L::Q {
        let e = &self.edges;
        let down = l.qsub(l.qsplat(f64::from(top + 0.5)), e.y);
        l.qadd(l.qmul(down, e.slope), e.x)
    }

    /// What it covers in a row of blocks, from the positions there.
    #[inline(always)]
    pub(crate) fn spans(&self, l: L, at: L::Q, rows: Option<(f32, f32)>, top: f32) -> L::S {
        let first = f64::from(top + 0.5);
        let limits = rows.map(|(after, last)| [f64::from(after) - first, f64::from(last) - first]);
        // Sample n of a row lies at n + 0.5.
        l.spans(l.qadd(at, l.qsplat(0.5)), &self.rows, limits)
    }
}

/// Depths of a block's pixels, as an affine function of their columns and rows.
struct Slope {
    /// At the first pixel.
    first: f32,
    /// Change per pixel.
    across: f32,
    down: f32,
}

impl Slope {
    #[inline(always)]
    fn new(plane: &Plane, bx: u32, by: u32) -> Self {
        // Centre of the first pixel.
        let x = (bx * BLOCK_SAMPLES) as f32 + 2.0 - plane.x;
        let y = (by * BLOCK_SAMPLES) as f32 + 2.0 - plane.y;
        Self {
            first: plane.depth + plane.dx * x + plane.dy * y,
            across: plane.dx * 4.0,
            down: plane.dy * 4.0,
        }
    }

    /// Codes of all 64 pixels.
    #[inline(always)]
    fn codes<L: Lanes>(&self, l: L, plane: &Plane) -> L::D {
        const COLUMNS: [f32; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        let columns = l.mul(l.load(&COLUMNS), l.splat(self.across));
        let columns = l.add(l.splat(self.first), columns);
        // Never nearer than the nearest vertex, so that what is skipped as hidden would have changed nothing.
        l.depths(columns, self.down, plane.min, plane.max_code)
    }

    /// The least of these codes: sums round alike everywhere, so it is that of a corner.
    #[inline(always)]
    fn least_code(&self, plane: &Plane) -> i16 {
        let last = (BLOCK - 1) as f32;
        let left = smaller(self.first, self.first + last * self.across);
        let least = left + smaller(0.0, last * self.down);
        smaller(encode(larger(least, plane.min)), plane.max_code)
    }
}

/// What a block takes that is covered wholly or in part, some ten nanoseconds each: threads share by it.
pub(crate) const WORK_OF_FULL: u32 = 2;
const WORK_OF_PARTIAL: u32 = 3;

/// Merges a polygon that covers the whole block; gives the work done.
#[inline(always)]
pub(crate) fn cover_full<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    bx: u32,
    by: u32,
    plane: &Plane,
) -> u32 {
    let i = ((by - band.first_row) * band.blocks_x + bx) as usize;
    let erased = band.erased(i, plane.min_code, plane.max_code);
    let to = band.here(i);
    if plane.max_code <= *to.min {
        return 0;
    }
    let slope = Slope::new(plane, bx, by);
    let state = to.held.state();
    let mut d = slope.codes(l, plane);
    if (state == STATE_EMPTY) & (erased == 0) {
        l.dstore(d, &mut to.depth.0);
        *to.min = slope.least_code(plane);
        *to.held = Held::DEPTH;
        return WORK_OF_FULL;
    }
    if erased != 0 {
        d = l.dselect(erased, l.dsplat(EMPTY), d);
    }
    if state != STATE_EMPTY {
        d = l.dmax(d, l.dload(&to.depth.0));
    }
    l.dstore(d, &mut to.depth.0);
    *to.min = l.dreduce_min(d);
    match state {
        STATE_PARTIAL => layers::forget_hidden(l, to, d),
        STATE_LAYERS => layers::forget_hidden_layers(l, to, d),
        _ => *to.held = Held::DEPTH,
    }
    WORK_OF_FULL
}

/// Merges a polygon that covers a part of the block; gives the work done.
#[inline(always)]
pub(crate) fn cover_partial<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    bx: u32,
    by: u32,
    plane: &Plane,
    spans: &L::S,
) -> u32 {
    let i = ((by - band.first_row) * band.blocks_x + bx) as usize;
    let (far, near) = (plane.min_code, plane.max_code);
    let erased = band.erased(i, far, near);
    let to = band.here(i);
    if near <= *to.min {
        return 0;
    }
    let ours = Part {
        depth: Slope::new(plane, bx, by).codes(l, plane),
        covered: Covered::new(l, spans, bx),
    };
    if to.held.state() == STATE_EMPTY {
        begin(l, to, &ours, !erased);
    } else {
        merge(l, to, &ours, !erased);
    }
    WORK_OF_PARTIAL
}

/// What a polygon covers of a block.
struct Covered<L: Lanes> {
    planes: L::P,
    /// Pixels by their centre.
    center: u64,
    /// Pixels of which all samples are covered. These lie within convex borders, and so does the centre.
    whole: u64,
    /// Pixels of which any sample or the centre is covered.
    touched: u64,
}

impl<L: Lanes> Covered<L> {
    #[inline(always)]
    fn new(l: L, spans: &L::S, bx: u32) -> Self {
        let (planes, center) = l.within(spans, bx * BLOCK_SAMPLES);
        Self {
            planes,
            center,
            whole: l.pall(planes),
            touched: l.pany(planes) | center,
        }
    }
}

/// What a polygon brings to a block that it covers in part.
struct Part<L: Lanes> {
    covered: Covered<L>,
    depth: L::D,
}

/// The first polygon in a block that holds nothing, in the pixels `open` to it.
#[inline(always)]
fn begin<L: Lanes>(l: L, to: Here<'_, '_>, ours: &Part<L>, open: u64) {
    let Part { covered, depth } = ours;
    let alone = covered.whole & open;
    let joined = covered.touched & open & !alone;
    let new = l.dselect(alone, *depth, l.dsplat(EMPTY));
    l.dstore(new, &mut to.depth.0);
    if alone == u64::MAX {
        *to.min = l.dreduce_min(new);
    }
    if joined == 0 {
        *to.held = Held::DEPTH;
        return;
    }
    let slot = to.pool.next();
    to.pool.take(true);
    let partial = &mut to.pool.partial[slot as usize];
    l.pstore(l.pkeep(covered.planes, joined), &mut partial.planes);
    l.dstore(*depth, &mut partial.depth);
    partial.center = covered.center & joined;
    partial.any = joined;
    *to.held = Held::partial(STATE_PARTIAL, slot);
}

/// One more polygon in a block, in the pixels `open` to it.
#[inline(always)]
fn merge<L: Lanes>(l: L, to: Here<'_, '_>, ours: &Part<L>, open: u64) {
    let Part { covered, depth: d } = ours;
    let state = to.held.state();
    let slot = if state == STATE_DEPTH {
        let slot = to.pool.next();
        to.pool.take(true);
        slot
    } else {
        to.held.slot()
    };
    let partial = &mut to.pool.partial[slot as usize];
    // What is stale is not even fetched.
    let begun = if state == STATE_DEPTH {
        &PartialBlock::NONE
    } else {
        &*partial
    };
    let old = l.dload(&to.depth.0);
    let (theirs, before) = (l.dload(&begun.depth), begun.any);
    let (their_planes, their_center) = (l.pload(&begun.planes), begun.center);
    // Which pixels all parts together complete does not wait for depths: no pixel that they had completed before
    // is among theirs.
    let complete = l.pall(l.por(covered.planes, their_planes)) & (covered.center | their_center);
    // Only pixels where the polygon is nearer than what is proven already. Those that it covers alone need no
    // partner, and what they have so far stays apart from them.
    let nearer = l.dgt(*d, old) & open;
    let alone = covered.whole & nearer;
    let joined = covered.touched & nearer & !covered.whole;
    let full = complete & joined;
    let new = l.dselect(alone, *d, old);
    let our_planes = l.pkeep(covered.planes, joined);
    let our_center = covered.center & joined;
    let apart = l.dapart(*d, theirs, APART) & joined & before;
    if (apart != 0) | (state == STATE_LAYERS) {
        let ours = Layer {
            planes: our_planes,
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
    // Forget what is complete, or hidden by now. What there was is nearer than the old depth, and so is what joins it.
    let hidden = alone & !l.dgt(theirs, *d);
    let kept = (joined | before) & !(hidden | full);
    let planes = l.pkeep(l.por(our_planes, their_planes), kept);
    l.pstore(planes, &mut partial.planes);
    partial.center = (our_center | their_center) & kept;
    l.dstore(depth, &mut partial.depth);
    partial.any = kept;
    to.pool.give(slot, kept == 0);
    *to.held = if kept != 0 {
        Held::partial(STATE_PARTIAL, slot)
    } else {
        Held::DEPTH
    };
}
