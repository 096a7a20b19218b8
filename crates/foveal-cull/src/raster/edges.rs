//! The edges of a convex polygon.

use crate::simd::{Doubles, Lanes, four};

/// Four edges, two left and two right ones (the same twice where there is one): lines through (x,
/// y), samples, with dx/dy `slope`.
#[derive(Clone, Copy)]
pub(crate) struct Edges<L: Lanes> {
    pub(crate) x: Doubles<L>,
    pub(crate) y: Doubles<L>,
    pub(crate) slope: Doubles<L>,
}

/// Edges with a larger slope count as horizontal and move inwards by more than they bend away from
/// it.
const FLAT: f64 = 1e9;
const FLAT_MARGIN: f64 = 1e-4;

/// Which edges are the two left and the two right ones, and their upper corners: by a bit per edge
/// that leads down (corner k to k + 1), then one per edge that leads up. None where a side has no
/// edge, or three.
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
    /// The edges of a polygon of three corners (the first again as the fourth) or four, and the
    /// rows that horizontal edges leave. None without area, or with three edges on one side: such a
    /// quadrilateral must be drawn as two triangles.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn of(l: L, x: Doubles<L>, y: Doubles<L>) -> Option<(Self, Option<(f32, f32)>)> {
        const NEXT: [u8; 4] = [1, 2, 3, 0];
        let dx = x.pick(NEXT) - x;
        let dy = y.pick(NEXT) - y;
        let slope = dx / dy;
        let (zero, size) = (l.double(0.0), slope.abs());
        let steep = size.lt(l.double(FLAT));
        let down = zero.lt(dy) & steep;
        let up = dy.lt(zero) & steep;
        let (edge, upper) = ORDER[(down | up << 4) as usize]?;
        let edges = Self {
            x: x.pick(upper),
            y: y.pick(upper),
            slope: slope.pick(edge),
        };
        // Edges without length have a slope of NaN and are not among them.
        let flat = l.double(FLAT * 0.999).lt(size) & !steep;
        let rows = (flat != 0).then(|| {
            let (mut xs, mut ys) = ([0.0; 4], [0.0; 4]);
            x.store(&mut xs);
            y.store(&mut ys);
            flat_rows(xs, ys, flat)
        });
        Some((edges, rows))
    }

    /// Moves every edge inwards by `by` samples.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn shrink(&mut self, l: L, by: f64) {
        let mut slope = [0.0; 4];
        self.slope.store(&mut slope);
        let along = four!(i => by * (1.0 + slope[i] * slope[i]).sqrt());
        let [a, b, c, d] = along;
        self.x = self.x + l.load_doubles(&[a, b, -c, -d]);
    }
}

#[cold]
fn flat_rows(x: [f64; 4], y: [f64; 4], flat: u32) -> (f32, f32) {
    // Samples lie on half steps, so both limits may be rounded down to one.
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
