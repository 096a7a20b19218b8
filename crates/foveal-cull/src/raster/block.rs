//! Coverage and depth of one polygon in one 8x8 block, and how both are merged into the buffer.
//!
//! Coverage: for a row of blocks the borders are evaluated in `f64` in its 32 rows of samples (and in the 8 rows through
//! pixel centres), and rounded to the first sample that is covered. In a block these numbers become bits, a few integer
//! operations for all of its 1,024 samples.
//!
//! Depth: the polygon's plane at its farthest point within each pixel, no farther than its farthest vertex.

use super::band::Band;
use super::layers::{self, APART, Layer};
use super::polygon::{Edges, Polygon};
use crate::depth::{
    BLOCK_SAMPLES, DepthBlock, EMPTY, Held, PartialBlock, STATE_EMPTY, STATE_LAYERS, STATE_PARTIAL,
};
use crate::simd::Lanes;

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
    pub(crate) fn new(l: L, polygon: &Polygon<L>) -> Self {
        Self {
            edges: polygon.borders,
            rows: l.borders(polygon.borders.slope),
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

/// Depth codes of the block's 64 pixels.
#[inline(always)]
fn depths<L: Lanes>(l: L, plane: &Plane, bx: u32, by: u32) -> L::D {
    const COLUMNS: [f32; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    // Centre of the first pixel.
    let x = (bx * BLOCK_SAMPLES) as f32 + 2.0 - plane.x;
    let y = (by * BLOCK_SAMPLES) as f32 + 2.0 - plane.y;
    let first = plane.depth + plane.dx * x + plane.dy * y;
    let columns = l.mul(l.load(&COLUMNS), l.splat(plane.dx * 4.0));
    let columns = l.add(l.splat(first), columns);
    // Never nearer than the nearest vertex, so that what is skipped as hidden would have changed nothing.
    l.depths(columns, plane.dy * 4.0, plane.min, plane.max_code)
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
    let state = to.held.state();
    let mut d = depths(l, plane, bx, by);
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
    let d = depths(l, plane, bx, by);
    let (planes, center) = l.within(spans, bx * BLOCK_SAMPLES);
    // From here on all but without a branch: hardly any of the questions has an answer that could be foreseen.
    let state = to.held.state();
    let begins = state < STATE_PARTIAL;
    let free = to.pool.next();
    to.pool.take(begins);
    let fresh = u32::from(begins).wrapping_neg();
    let slot = (free & fresh) | (to.held.slot() & !fresh);
    let partial = &mut to.pool.partial[slot as usize];
    // What is stale is not even fetched.
    let known = if state == STATE_EMPTY {
        &DepthBlock::EMPTY
    } else {
        &*to.depth
    };
    let begun = if begins {
        &PartialBlock::NONE
    } else {
        &*partial
    };
    let old = l.dload(&known.0);
    let (theirs, before) = (l.dload(&begun.depth), begun.any);
    let (their_planes, their_center) = (l.pload(&begun.planes), begun.center);
    // Only pixels where the polygon is nearer than what is proven already. Those that it covers alone need no
    // partner, and what they have so far stays apart from them.
    let nearer = l.dgt(d, old) & !erased;
    // All samples of a pixel within convex borders: so is its centre.
    let alone = l.pall(planes) & nearer;
    // With those alone, so that one does not wait for the other.
    let complete = l.pall(l.por(l.pkeep(planes, nearer), their_planes));
    let full = complete & ((center & nearer) | their_center) & !alone;
    let joined = (l.pany(planes) | center) & nearer & !alone;
    let new = l.dselect(alone, d, old);
    let (ours, our_center) = (l.pkeep(planes, nearer & !alone), center & joined);
    let apart = l.dapart(d, theirs, APART) & joined & before;
    if (apart != 0) | (state == STATE_LAYERS) {
        let ours = Layer {
            planes: ours,
            center: our_center,
            depth: d,
        };
        layers::join(l, to, slot, &ours, joined, new);
        return WORK_OF_PARTIAL;
    }
    let far = l.dsplat(i16::MAX);
    let depth = l.dmin(l.dselect(joined, d, far), l.dselect(before, theirs, far));
    let new = l.dselect(full, l.dmax(new, depth), new);
    // Forget what is complete, or hidden by now. What there was is nearer than the old depth, and so is what joins it.
    let hidden = alone & !l.dgt(theirs, d);
    let kept = (joined | before) & !(hidden | full);
    l.dstore(new, &mut to.depth.0);
    *to.min = l.dreduce_min(new);
    let planes = l.pkeep(l.por(ours, their_planes), kept);
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
    WORK_OF_PARTIAL
}
