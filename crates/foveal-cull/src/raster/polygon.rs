//! One convex polygon on the screen: which blocks it touches and how.
//!
//! The polygon is the intersection of half-planes, left and right borders `x = f(y)`, with corners and slopes
//! in `f64`. A point within all half-planes of a convex polygon or of a quad of two triangles is within at least
//! one front-facing triangle, however thin or folded the quad is: the borders wind around it as often as the
//! triangles do. Two polygons that share an edge evaluate the same line, one as left and one as right border,
//! so that no sample between them is lost or counted twice. Per row of blocks the borders give the span of
//! touched and of fully covered blocks.

use super::band::Band;
use super::block::{self, Borders, Plane};
use crate::depth::BLOCK_SAMPLES;
use crate::simd::{Lanes, four, larger, smaller};

/// A front-facing convex polygon.
#[derive(Clone, Copy)]
pub(crate) struct Polygon<L: Lanes> {
    pub(crate) borders: Edges<L>,
    /// Rows below `.0` and not below `.1` count; only set where an edge is horizontal.
    pub(crate) rows: Option<(f32, f32)>,
    pub(crate) plane: Plane,
    /// First and last block, inclusive.
    pub(crate) blocks: [u32; 4],
}

/// Four borders, left two and right two (the same twice where there is one): lines through (x, y), samples,
/// with dx/dy `slope`.
#[derive(Clone, Copy)]
pub(crate) struct Edges<L: Lanes> {
    pub(crate) x: L::Q,
    pub(crate) y: L::Q,
    pub(crate) slope: L::Q,
}

/// Edges with a larger slope are taken for horizontal, and moved inwards by more than they bend away from it.
const FLAT: f64 = 1e9;
const FLAT_MARGIN: f64 = 1e-4;

/// The edges that are left, left, right, right borders, and the corners where these are highest: by a bit per edge
/// that leads down (corner k to k + 1), then one per edge that leads up. None where a side has no border, or three.
const ORDER: [Option<([u8; 4], [u8; 4])>; 256] = {
    let mut order = [None; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut edges, mut counts, mut k) = ([0u8; 4], [0, 0], 0u8);
        while k < 8 {
            let side = k as usize / 4;
            if bits >> k & 1 != 0 {
                if counts[side] == 0 {
                    edges[2 * side] = k % 4;
                }
                edges[2 * side + 1] = k % 4;
                counts[side] += 1;
            }
            k += 1;
        }
        let [a, b, c, d] = edges;
        if counts[0] > 0 && counts[0] < 3 && counts[1] > 0 && counts[1] < 3 {
            order[bits] = Some((edges, [a, b, (c + 1) % 4, (d + 1) % 4]));
        }
        bits += 1;
    }
    order
};

impl<L: Lanes> Edges<L> {
    /// The borders of a polygon of three (the first again as the fourth) or four corners, and the rows that
    /// horizontal edges leave. None where it has no area, or three borders on one side: such a quadrilateral
    /// must be drawn as two triangles.
    #[inline(always)]
    pub(crate) fn of(l: L, x: L::Q, y: L::Q) -> Option<(Self, Option<(f32, f32)>)> {
        const NEXT: [u8; 4] = [1, 2, 3, 0];
        let dx = l.qsub(l.qpick(x, NEXT), x);
        let dy = l.qsub(l.qpick(y, NEXT), y);
        let slope = l.qdiv(dx, dy);
        let (zero, size) = (l.qsplat(0.0), l.qabs(slope));
        let steep = l.qlt(size, l.qsplat(FLAT));
        let down = l.qlt(zero, dy) & steep;
        let up = l.qlt(dy, zero) & steep;
        let (edge, upper) = ORDER[(down | up << 4) as usize]?;
        let edges = Self {
            x: l.qpick(x, upper),
            y: l.qpick(y, upper),
            slope: l.qpick(slope, edge),
        };
        // NaN, where both ends are the same, is not among them.
        let flat = l.qlt(l.qsplat(FLAT * 0.999), size) & !steep;
        let rows = (flat != 0).then(|| {
            let (mut xs, mut ys) = ([0.0; 4], [0.0; 4]);
            l.qstore(x, &mut xs);
            l.qstore(y, &mut ys);
            flat_rows(xs, ys, flat)
        });
        Some((edges, rows))
    }

    /// Moves every border inwards by `by` samples.
    #[inline(always)]
    pub(crate) fn shrink(&mut self, l: L, by: f64) {
        let mut slope = [0.0; 4];
        l.qstore(self.slope, &mut slope);
        let along = four!(i => by * (1.0 + slope[i] * slope[i]).sqrt());
        let [a, b, c, d] = along;
        self.x = l.qadd(self.x, l.qload(&[a, b, -c, -d]));
    }
}

#[cold]
fn flat_rows(x: [f64; 4], y: [f64; 4], flat: u32) -> (f32, f32) {
    // Samples lie on half steps, so both limits can be rounded down to one.
    let step = |y: f64| ((2.0 * y).floor() * 0.5) as f32;
    let (mut after, mut last) = (f32::NEG_INFINITY, f32::INFINITY);
    for k in (0..4).filter(|&k| flat >> k & 1 != 0) {
        let next = (k + 1) % 4;
        let (x0, y0, x1, y1) = (x[k], y[k], x[next], y[next]);
        let margin = if y0 == y1 { 0.0 } else { FLAT_MARGIN };
        if x1 < x0 {
            after = after.max(step(y0.max(y1) + margin));
        } else {
            last = last.min(step(y0.min(y1) - margin));
        }
    }
    (after, last)
}

/// From a block's border to its first sample, less far more than all rounding, samples.
const MARGIN: f64 = 0.4;

impl<L: Lanes> Polygon<L> {
    /// Moves every border inwards by `by` samples.
    #[inline(always)]
    pub(crate) fn shrink(&mut self, l: L, by: f32) {
        self.borders.shrink(l, by.into());
        if let Some((after, last)) = &mut self.rows {
            *after += by;
            *last -= by;
        }
    }
}

/// Rounded up, where that is a block; casts saturate.
#[inline(always)]
fn up(v: f64) -> u32 {
    let whole = v as u32;
    whole.saturating_add(u32::from(f64::from(whole) < v))
}

/// What the set-up of a polygon takes, and a row of blocks of it, in the unit of [`block::WORK_OF_FULL`].
const WORK_OF_POLYGON: u32 = 5;
const WORK_OF_ROW: u32 = 1;

#[inline(always)]
pub(crate) fn draw<L: Lanes>(l: L, band: &mut Band<'_>, polygon: &Polygon<L>) {
    let [bx0, by0, bx1, by1] = polygon.blocks;
    let size = f64::from(BLOCK_SAMPLES);
    let borders = Borders::new(l, polygon);
    band.work[(by0 - band.first_row) as usize] += WORK_OF_POLYGON;
    for by in by0..=by1 {
        let top = (by * BLOCK_SAMPLES) as f32;
        let exact = borders.at(l, top);
        let (mut first, mut last) = (bx0, bx1);
        let (mut inner_left, mut inner_right) = (f64::INFINITY, f64::NEG_INFINITY);
        if bx0 != bx1 {
            let (mut at, mut end) = ([0.0; 4], [0.0; 4]);
            l.qstore(exact, &mut at);
            // The same borders at the last sample row.
            let down = l.qmul(polygon.borders.slope, l.qsplat(size - 1.0));
            l.qstore(l.qadd(exact, down), &mut end);
            let low = four!(e => smaller(at[e], end[e]));
            let high = four!(e => larger(at[e], end[e]));
            let outer_left = larger(low[0], low[1]);
            inner_left = larger(high[0], high[1]) - MARGIN;
            let outer_right = smaller(high[2], high[3]);
            inner_right = smaller(low[2], low[3]) + MARGIN;
            if let Some((y0, y1)) = polygon.rows
                && (top < y0 || top + BLOCK_SAMPLES as f32 > y1)
            {
                inner_left = f64::INFINITY;
            }
            // Casts saturate; borders far off the screen stay far off.
            first = first.max(((outer_left + MARGIN) * (1.0 / size)) as u32);
            let end = (outer_right - MARGIN) * (1.0 / size);
            if end < 0.0 {
                continue;
            }
            last = last.min(end as u32);
        }
        // Blocks from `inner` on, and before `after`, are covered wholly.
        let end = last + 1;
        let inner = first.max(up(inner_left * (1.0 / size)));
        let after = inner.max(end.min((inner_right * (1.0 / size)) as u32));
        let mut work = WORK_OF_ROW;
        for bx in inner..after {
            work += block::cover_full(l, band, bx, by, &polygon.plane);
        }
        let whole = after - inner;
        // Those that are left, as if the others were not there; across a whole screen, none.
        let left = first..end - whole;
        if !left.is_empty() {
            let spans = borders.spans(l, exact, polygon.rows, top);
            for bx in left {
                let bx = if bx < inner { bx } else { bx + whole };
                work += block::cover_partial(l, band, bx, by, &polygon.plane, &spans);
            }
        }
        band.work[(by - band.first_row) as usize] += work;
    }
}
