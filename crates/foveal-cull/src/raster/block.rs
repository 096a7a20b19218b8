//! Coverage and depth of one polygon in one 8x8 block, and how both are merged into the buffer.
//!
//! Coverage: the borders are evaluated in float for 32 sample rows (and for the 8 rows through pixel
//! centres), rounded to the first covered sample, and turned into bit planes, one per sample position in a
//! pixel, by byte look-ups. Merging then is plain logic on 64-bit planes.
//!
//! Depth: the polygon's plane at its farthest point within each pixel, no farther than its farthest vertex.

use super::polygon::Polygon;
use crate::depth::{
    BLOCK_SAMPLES, Band, EMPTY, PartialBlock, STATE_DEPTH, STATE_EMPTY, STATE_PARTIAL,
};
use crate::simd::{Lanes, four};

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
    pub(crate) max_code: i16,
}

/// The borders of a polygon, left two and right two, ready for rows of blocks.
pub(crate) struct Borders<L: Lanes> {
    x: [f32; 4],
    y: [f32; 4],
    pub(crate) slope: [f32; 4],
    /// Change from the first sample row to each.
    rows: [L::R; 4],
    /// The same for the rows through pixel centres.
    centers: [L::F; 4],
}

/// Rows through pixel centres, in sample rows from the first.
const CENTER_ROWS: [f32; 8] = [1.5, 5.5, 9.5, 13.5, 17.5, 21.5, 25.5, 29.5];
const COLUMNS: [f32; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

impl<L: Lanes> Borders<L> {
    #[inline(always)]
    pub(crate) fn new(l: L, polygon: &Polygon) -> Self {
        let e = [
            polygon.left.edges[0],
            polygon.left.edges[1],
            polygon.right.edges[0],
            polygon.right.edges[1],
        ];
        let centers = l.load(&CENTER_ROWS);
        Self {
            x: four!(i => e[i].x),
            y: four!(i => e[i].y),
            slope: four!(i => e[i].slope),
            rows: four!(i => l.rows(e[i].slope)),
            centers: four!(i => l.mul(centers, l.splat(e[i].slope))),
        }
    }

    /// Positions at the first sample row of a row of blocks that begins at `top`, samples.
    #[inline(always)]
    pub(crate) fn at(&self, top: f32) -> [f32; 4] {
        let y = top + 0.5;
        four!(i => (y - self.y[i]) * self.slope[i] + self.x[i])
    }
}

/// Coverage of a block: sixteen sample planes and the plane of centres.
#[inline(always)]
fn coverage<L: Lanes>(
    l: L,
    polygon: &Polygon,
    borders: &Borders<L>,
    at: &[f32; 4],
    left: f32,
    top: f32,
) -> (L::P, u64) {
    // Sample n of a row lies at `left + n + 0.5`.
    let at = four!(e => at[e] - (left - 0.5));
    let rows = four!(e => l.radd(l.rsplat(at[e]), borders.rows[e]));
    let centers = four!(e => l.add(l.splat(at[e]), borders.centers[e]));
    let mut from = l.rmax(rows[0], rows[1]);
    let to = l.rmin(rows[2], rows[3]);
    let mut center_from = l.max(centers[0], centers[1]);
    let center_to = l.min(centers[2], centers[3]);
    if let Some((after, last)) = polygon.rows {
        from = l.rlimit(from, top + 0.5, after, last);
        center_from = limit_centers(l, center_from, top + 2.0, after, last);
    }
    // The centre of pixel n is at sample 4 n + 1.5 of the row.
    let pixel = |v: L::F| l.mul(l.add(v, l.splat(1.5)), l.splat(0.25));
    (
        l.planes(from, to),
        l.plane(pixel(center_from), pixel(center_to)),
    )
}

/// Moves the left border out of sight on rows outside the limits; `y` is the first of the eight rows.
#[inline(always)]
fn limit_centers<L: Lanes>(l: L, from: L::F, y: f32, after: f32, last: f32) -> L::F {
    let y = l.add(l.mul(l.load(&COLUMNS), l.splat(4.0)), l.splat(y));
    let inside = l.iandnot(l.lt(l.splat(last), y), l.lt(l.splat(after), y));
    l.select(inside, from, l.splat(1e6))
}

/// Depth codes of the block's 64 pixels.
#[inline(always)]
fn depths<L: Lanes>(l: L, plane: &Plane, bx: u32, by: u32) -> L::D {
    // Centre of the first pixel.
    let x = (bx * BLOCK_SAMPLES) as f32 + 2.0 - plane.x;
    let y = (by * BLOCK_SAMPLES) as f32 + 2.0 - plane.y;
    let first = plane.depth + plane.dx * x + plane.dy * y;
    let columns = l.add(
        l.splat(first),
        l.mul(l.load(&COLUMNS), l.splat(plane.dx * 4.0)),
    );
    // Never nearer than the nearest vertex, so that what is skipped as hidden would have changed nothing.
    l.depths(columns, plane.dy * 4.0, plane.min, plane.max_code)
}

/// Merges a polygon that covers the whole block.
#[inline(always)]
pub(crate) fn cover_full<L: Lanes>(l: L, band: &mut Band<'_>, bx: u32, by: u32, plane: &Plane) {
    let i = ((by - band.first_row) * band.blocks_x + bx) as usize;
    if plane.max_code <= band.min[i] {
        return;
    }
    let mut d = depths(l, plane, bx, by);
    let state = band.state[i];
    let block = &mut band.depth[i].0;
    if state != STATE_EMPTY {
        d = l.dmax(d, l.dload(block));
    }
    l.dstore(d, block);
    band.min[i] = l.dreduce_min(d);
    if state == STATE_PARTIAL {
        forget_hidden(l, &mut band.partial[i], d);
    } else {
        band.state[i] = STATE_DEPTH;
    }
}

/// Drops partial coverage that can no longer bring anything nearer than the depth that is there.
#[inline(always)]
fn forget_hidden<L: Lanes>(l: L, partial: &mut PartialBlock, d: L::D) {
    let old = l.dload(&partial.depth);
    let kept = l.dgt(old, d);
    let planes = l.pkeep(l.pload(&partial.planes), kept);
    l.pstore(planes, &mut partial.planes);
    partial.center &= kept;
    l.dstore(l.dselect(kept, old, l.dsplat(i16::MAX)), &mut partial.depth);
}

/// Merges a polygon that covers a part of the block.
#[inline(always)]
pub(crate) fn cover_partial<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    bx: u32,
    by: u32,
    polygon: &Polygon,
    borders: &Borders<L>,
    at: &[f32; 4],
) {
    let i = ((by - band.first_row) * band.blocks_x + bx) as usize;
    if polygon.plane.max_code <= band.min[i] {
        return;
    }
    let d = depths(l, &polygon.plane, bx, by);
    let (left, top) = ((bx * BLOCK_SAMPLES) as f32, (by * BLOCK_SAMPLES) as f32);
    let (planes, center) = coverage(l, polygon, borders, at, left, top);
    // From here on without a branch: none of the questions has an answer that could be foreseen.
    let state = band.state[i];
    let (block, partial) = (&mut band.depth[i].0, &mut band.partial[i]);
    let known = u64::from(state == STATE_EMPTY).wrapping_sub(1);
    let begun = u64::from(state != STATE_PARTIAL).wrapping_sub(1);
    let far = l.dsplat(i16::MAX);
    let old = l.dselect(known, l.dload(block), l.dsplat(EMPTY));
    // Only pixels where the polygon is nearer than what is proven already. Those that it covers alone need no
    // partner, and what they have so far stays apart from them.
    let nearer = l.dgt(d, old);
    let alone = l.pall(planes) & center & nearer;
    let joined = (l.pany(planes) | center) & nearer & !alone;
    let new = l.dselect(alone, d, old);
    let planes = l.por(
        l.pkeep(planes, joined),
        l.pkeep(l.pload(&partial.planes), begun),
    );
    let center = (center & joined) | (partial.center & begun);
    let depth = l.dmin(
        l.dselect(joined, d, far),
        l.dselect(begun, l.dload(&partial.depth), far),
    );
    let full = l.pall(planes) & center;
    let new = l.dselect(full, l.dmax(new, depth), new);
    // Forget what is complete, or hidden by now.
    let kept = l.dgt(depth, new);
    let planes = l.pkeep(planes, kept);
    let center = center & kept;
    l.dstore(new, block);
    band.min[i] = l.dreduce_min(new);
    l.pstore(planes, &mut partial.planes);
    partial.center = center;
    l.dstore(l.dselect(kept, depth, far), &mut partial.depth);
    let any = l.pany(planes) | center != 0;
    band.state[i] = if any { STATE_PARTIAL } else { STATE_DEPTH };
}
