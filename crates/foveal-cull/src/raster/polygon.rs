//! One convex polygon on the screen: which blocks it touches, and how.
//!
//! The polygon is the intersection of half-planes, left and right edges `x = f(y)`, with corners
//! and slopes in `f64`. A point inside all half-planes of a quad of two triangles is inside at
//! least one front-facing triangle, however thin or folded the quad is, since the edges wind around
//! it as often as the triangles do. Two polygons that share an edge evaluate the same line, one as
//! left and one as right edge, so that no sample between them is lost or counted twice. Per row of
//! blocks the edges give the span of touched and of fully covered blocks.

use super::block::{self, DepthPlane, EdgeRows};
use super::edges::Edges;
use crate::depth::band::Band;
use crate::format::BLOCK_SAMPLES;
use crate::simd::{Lanes, four, larger, smaller};

/// A front-facing convex polygon.
#[derive(Clone, Copy)]
pub(crate) struct Polygon<L: Lanes> {
    pub(crate) edges: Edges<L>,
    /// Only rows below `.0` and not below `.1` count. Set where an edge is horizontal.
    pub(crate) rows: Option<(f32, f32)>,
    pub(crate) plane: DepthPlane,
    /// First and last block, inclusive.
    pub(crate) blocks: [u32; 4],
}

/// Distance from a block's side to its first sample, less far more than all rounding, samples.
const MARGIN: f64 = 0.4;

impl<L: Lanes> Polygon<L> {
    /// Moves every edge inwards by `by` samples.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn shrink(&mut self, l: L, by: f32) {
        self.edges.shrink(l, by.into());
        if let Some((after, last)) = &mut self.rows {
            // It was rounded down to a half step, which `by` is not.
            *after += by + 0.5;
            *last -= by;
        }
    }
}

/// Rounded up. Casts saturate.
#[cfg_attr(not(unoptimized), inline(always))]
fn up(v: f64) -> u32 {
    let whole = v as u32;
    whole.saturating_add(u32::from(f64::from(whole) < v))
}

/// Work of setting up a polygon, and of a row of blocks of it, in the unit of
/// [`block::WORK_OF_FULL`].
const WORK_OF_POLYGON: u32 = 5;
const WORK_OF_ROW: u32 = 1;

#[cfg_attr(not(unoptimized), inline(always))]
pub(crate) fn draw<L: Lanes>(l: L, band: &mut Band<'_>, polygon: &Polygon<L>) {
    let [bx0, by0, bx1, by1] = polygon.blocks;
    let size = f64::from(BLOCK_SAMPLES);
    let edges = EdgeRows::new(&polygon.edges);
    band.work[(by0 - band.first_row) as usize] += WORK_OF_POLYGON;
    for by in by0..=by1 {
        let top = (by * BLOCK_SAMPLES) as f32;
        let exact = edges.at(l, top);
        let (mut first, mut last) = (bx0, bx1);
        let (mut inner_left, mut inner_right) = (f64::INFINITY, f64::NEG_INFINITY);
        if bx0 != bx1 {
            let (mut at, mut end) = ([0.0; 4], [0.0; 4]);
            exact.store(&mut at);
            // The same edges at the last sample row.
            let down = polygon.edges.slope * (size - 1.0);
            (exact + down).store(&mut end);
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
            // Casts saturate; edges far off the screen stay far off.
            first = first.max(((outer_left + MARGIN) * (1.0 / size)) as u32);
            let end = (outer_right - MARGIN) * (1.0 / size);
            if end < 0.0 {
                continue;
            }
            last = last.min(end as u32);
        }
        // Blocks from `inner` to before `after` are covered wholly.
        let end = last + 1;
        let inner = first.max(up(inner_left * (1.0 / size)));
        let after = inner.max(end.min((inner_right * (1.0 / size)) as u32));
        let mut work = WORK_OF_ROW;
        for bx in inner..after {
            work += block::cover_full(l, band, bx, by, &polygon.plane);
        }
        let whole = after - inner;
        // The remaining blocks, numbered as if the others were not there. A polygon across the
        // whole screen has none.
        let left = first..end - whole;
        if !left.is_empty() {
            let spans = edges.spans(exact, polygon.rows, top);
            for bx in left {
                let bx = if bx < inner { bx } else { bx + whole };
                work += block::cover_partial(l, band, bx, by, &polygon.plane, &spans);
            }
        }
        band.work[(by - band.first_row) as usize] += work;
        if work > WORK_OF_ROW
            && let Some(record) = &mut band.record
        {
            record.add(by, [first, last], work);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{DepthPlane, Edges, Polygon};
    use crate::simd::Lanes;
    use crate::simd::portable::Portable;

    /// Samples lie on half steps; a horizontal edge that moves inwards leaves none beyond it.
    #[test]
    fn shrinking_moves_horizontal_edges_by_all_of_it() {
        let l = Portable;
        for i in 0..400 {
            let (top, by) = (10.0 + f64::from(i) * 0.0173, 0.72 + i as f32 * 0.0031);
            let bottom = top + 20.0;
            let x = l.load_doubles(&[0.0, 0.0, 30.0, 30.0]);
            let y = l.load_doubles(&[top, bottom, bottom, top]);
            let (edges, rows) = Edges::of(l, x, y).unwrap();
            let plane = DepthPlane {
                x: 0.0,
                y: 0.0,
                depth: 1.0,
                dx: 0.0,
                dy: 0.0,
                min: 1.0,
                min_code: 1,
                max_code: 1,
            };
            let blocks = [0; 4];
            let mut polygon = Polygon {
                edges,
                rows,
                plane,
                blocks,
            };
            polygon.shrink(l, by);
            let (after, last) = polygon.rows.unwrap();
            assert!(
                f64::from(after) >= top + f64::from(by) - 1e-5,
                "{top}, {by}: {after}"
            );
            assert!(
                f64::from(last) <= bottom - f64::from(by) + 1e-5,
                "{bottom}, {by}: {last}"
            );
        }
    }
}
