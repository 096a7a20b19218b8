//! One convex polygon on the screen: which blocks it touches and how.
//!
//! The polygon is the intersection of half-planes, left and right borders `x = f(y)`. Two polygons that
//! share an edge evaluate the same line with the same arithmetic, one as left and one as right border, so
//! that no sample between them is lost or counted twice. Per row of blocks the borders give the span of
//! touched and of fully covered blocks.

use super::block::{self, Borders, Plane};
use crate::depth::{BLOCK_SAMPLES, Band};
use crate::simd::Lanes;

/// A border: the line through (x, y), samples, with dx/dy `slope`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Edge {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) slope: f32,
}

/// Borders of one side: two (the same twice where there is one).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Side {
    pub(crate) edges: [Edge; 2],
    count: usize,
}

impl Side {
    #[inline(always)]
    fn push(&mut self, edge: Edge) {
        if self.count == 0 {
            self.edges = [edge; 2];
        } else {
            self.edges[1] = edge;
        }
        self.count += 1;
    }
}

/// A front-facing convex polygon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polygon {
    pub(crate) left: Side,
    pub(crate) right: Side,
    /// Rows strictly below `.0` and not below `.1` count; only set where an edge is horizontal.
    pub(crate) rows: Option<(f32, f32)>,
    pub(crate) plane: Plane,
    /// First and last block, inclusive.
    pub(crate) blocks: [u32; 4],
}

impl Polygon {
    pub(crate) fn new(plane: Plane, blocks: [u32; 4]) -> Self {
        Self {
            left: Side::default(),
            right: Side::default(),
            rows: None,
            plane,
            blocks,
        }
    }

    /// Adds the edge from (x0, y0) to (x1, y1); `slope` is its dx/dy.
    #[inline(always)]
    pub(crate) fn edge(&mut self, x0: f32, y0: f32, x1: f32, y1: f32, slope: f32) -> bool {
        if y1 > y0 {
            self.left.push(Edge {
                x: x0,
                y: y0,
                slope,
            });
        } else if y1 < y0 {
            self.right.push(Edge {
                x: x1,
                y: y1,
                slope,
            });
        } else {
            return x0 != x1;
        }
        false
    }
}

/// Slack of the block classification against the rounding of row ends, samples.
const SLACK: f32 = 1.0;

impl Polygon {
    /// Moves every border inwards by `by` samples.
    #[inline(always)]
    pub(crate) fn shrink(&mut self, by: f32, top: f32, bottom: f32) {
        for e in &mut self.left.edges {
            e.x += by * (1.0 + e.slope * e.slope).sqrt();
        }
        for e in &mut self.right.edges {
            e.x -= by * (1.0 + e.slope * e.slope).sqrt();
        }
        if self.rows.is_some() {
            self.rows = Some((top + by, bottom - by));
        }
    }

    /// Whether each side has one or two borders. A quadrilateral with three on one side must be drawn as two
    /// triangles; one without a side has no area.
    #[inline(always)]
    pub(crate) fn is_drawable(&self) -> bool {
        (1..=2).contains(&self.left.count) && (1..=2).contains(&self.right.count)
    }
}

#[inline(always)]
pub(crate) fn draw<L: Lanes>(l: L, band: &mut Band<'_>, polygon: &Polygon) {
    let [bx0, by0, bx1, by1] = polygon.blocks;
    let size = BLOCK_SAMPLES as f32;
    let borders = Borders::new(l, polygon);
    for by in by0..=by1 {
        let top = (by * BLOCK_SAMPLES) as f32;
        let at = borders.at(top);
        let (mut first, mut last) = (bx0, bx1);
        let (mut inner_left, mut inner_right) = (f32::INFINITY, f32::NEG_INFINITY);
        if bx0 != bx1 {
            // The same borders at the last sample row.
            let end: [f32; 4] = core::array::from_fn(|e| at[e] + borders.slope[e] * (size - 1.0));
            let outer_left = at[0].min(end[0]).max(at[1].min(end[1]));
            inner_left = at[0].max(end[0]).max(at[1].max(end[1])) + SLACK;
            let outer_right = at[2].max(end[2]).min(at[3].max(end[3]));
            inner_right = at[2].min(end[2]).min(at[3].min(end[3])) - SLACK;
            if let Some((y0, y1)) = polygon.rows
                && (top < y0 || top + size > y1)
            {
                inner_left = f32::INFINITY;
            }
            // Casts saturate; borders far off the screen stay far off.
            first = first.max(((outer_left - SLACK) * (1.0 / size)) as u32);
            let end = (outer_right + SLACK) * (1.0 / size);
            if end < 0.0 {
                continue;
            }
            last = last.min(end as u32);
        }
        // A row of a polygon costs about as much as two blocks.
        band.work[(by - band.first_row) as usize] += 3 + last.saturating_sub(first);
        for bx in first..=last {
            let left = (bx * BLOCK_SAMPLES) as f32;
            if left >= inner_left && left + size <= inner_right {
                block::cover_full(l, band, bx, by, &polygon.plane);
            } else {
                block::cover_partial(l, band, bx, by, polygon, &borders, &at);
            }
        }
    }
}
