//! Set-up of eight quads at once.
//!
//! A quad is drawn whole where both triangles face the eye and its outline is convex on the screen,
//! otherwise triangle by triangle. Its depth is the plane of its larger triangle, lowered by how
//! far the fourth vertex lies behind it, by half a pixel of slope, and by a bound on the rounding
//! of the gradient.
//!
//! Vertices are transformed in `f64`, and edges are made of that: a sample is covered if the
//! reference says so too. Everything else (bounds, facing, depth) is rounded to `f32` and judged
//! with slack.

use super::block::DepthPlane;
use super::edges::Edges;
use super::extent::{area, blocks_of, highest, lowest, out, steps_of};
use super::facing::Facing;
use super::points::Points;
use super::polygon::{self, Polygon};
use crate::depth::band::Band;
use crate::format::encode;
use crate::simd::{Lanes, four};

/// Largest distance from a point of a pixel to its nearest sample (half the diagonal of a sample,
/// and a bit). Polygons that shrink by this cover every point between the samples that they cover.
const BETWEEN_SAMPLES: f32 = 0.72;

/// Distance from a pixel's centre along each axis: to its side, and to its outermost samples, which
/// is enough for one exact eye, whose rays go through samples only.
const WHOLE_PIXEL: f32 = 2.0;
const SAMPLES_ONLY: f32 = 1.5 + 1.0 / 64.0;

/// Sets up and draws eight quads from screen positions; returns the number of polygons drawn.
#[inline(always)]
pub(crate) fn draw_eight<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    points: &Points,
    index: [&[u8; 8]; 4],
    kept: Option<(&[[f32; 8]; 2], f32)>,
    facing: Facing,
) -> u64 {
    let (two_sided, radius) = (facing.two_sided, facing.radius.filter(|_| kept.is_none()));
    let mut x = four!(c => l.gather(&points.x, index[c]));
    let mut y = four!(c => l.gather(&points.y, index[c]));
    let zero = l.splat(0.0);
    let mut f0 = area(l, &x, &y, 0, 1, 2);
    let mut f1 = area(l, &x, &y, 0, 2, 3);
    let mut reversed = l.isplat(0);
    if two_sided {
        // The larger triangle decides the side. Its partner, if it faces the other way, is dropped.
        reversed = l.lt(l.add(f0, f1), zero);
        x = swap(l, reversed, x);
        y = swap(l, reversed, y);
        f0 = area(l, &x, &y, 0, 1, 2);
        f1 = area(l, &x, &y, 0, 2, 3);
    }
    let mut front0 = l.lt(zero, f0);
    let mut front1 = l.lt(zero, f1);
    if let Some(([first, second], _)) = kept {
        front0 = l.iand(front0, l.lt(zero, l.load(first)));
        front1 = l.iand(front1, l.lt(zero, l.load(second)));
    }
    let front = l.ior(front0, front1);
    if l.movemask(front) == 0 {
        return 0;
    }
    let (x_lo, x_hi, y_lo, y_hi) = (lowest(l, &x), highest(l, &x), lowest(l, &y), highest(l, &y));
    let steps = steps_of(l, band, [[x_lo, y_lo], [x_hi, y_hi]]);
    let [nx0, ny0, nx1, ny1] = steps;
    // `a - b` is negative where a < b.
    let live = l.iand(front, l.iand(l.isub(nx0, nx1), l.isub(ny0, ny1)));
    let mut live = l.movemask(live);
    if live == 0 {
        return 0;
    }
    let f3 = area(l, &x, &y, 0, 1, 3);
    let f2 = l.sub(l.add(f0, f1), f3);
    let convex = l.movemask(l.iand(
        l.iand(front0, front1),
        l.iand(l.lt(zero, f2), l.lt(zero, f3)),
    ));
    let mut z = four!(c => l.gather(&points.depth, index[c]));
    if two_sided {
        z = swap(l, reversed, z);
    }
    let (z_lo, z_hi) = (lowest(l, &z), highest(l, &z));
    // The plane through v0 and the larger (or only) front triangle.
    let second = l.ior(
        l.iandnot(front0, l.isplat(-1)),
        l.iand(front1, l.lt(f0, f1)),
    );
    let (bx, cx, ox) = pick(l, second, &x);
    let (by, cy, oy) = pick(l, second, &y);
    let (bz, cz, oz) = pick(l, second, &z);
    let f = l.select(second, f1, f0);
    let (bx, by, bz) = (l.sub(bx, x[0]), l.sub(by, y[0]), l.sub(bz, z[0]));
    let (cx, cy, cz) = (l.sub(cx, x[0]), l.sub(cy, y[0]), l.sub(cz, z[0]));
    let inv = l.div(l.splat(1.0), f);
    let gx = l.mul(l.sub(l.mul(cz, by), l.mul(bz, cy)), inv);
    let gy = l.mul(l.sub(l.mul(bz, cx), l.mul(cz, bx)), inv);
    let at_other = l.add(
        z[0],
        l.add(l.mul(gx, l.sub(ox, x[0])), l.mul(gy, l.sub(oy, y[0]))),
    );
    let both = l.iand(front0, front1);
    let fold = l.select(both, l.max(l.sub(at_other, oz), zero), zero);
    let (w, h) = (l.sub(x_hi, x_lo), l.sub(y_hi, y_lo));
    if let Some(radius) = radius {
        // A polygon shrinks to nothing unless its area exceeds half its perimeter, which is at
        // least sqrt(2) (w + h), times the distance that it shrinks by.
        let by = l.add(l.mul(z_hi, l.splat(radius.shift)), l.splat(BETWEEN_SAMPLES));
        let least = l.mul(l.mul(by, l.splat(1.414)), l.add(w, h));
        let twice_area = l.add(l.max(f0, zero), l.max(f1, zero));
        live &= l.movemask(l.lt(least, twice_area));
        if live == 0 {
            return 0;
        }
    }
    let (ax, ay) = (l.abs(gx), l.abs(gy));
    let relative = l.add(
        l.splat(1.0 / 262_144.0),
        l.mul(l.mul(l.splat(1.0 / 256.0), l.add(w, h)), inv),
    );
    let variation = l.add(
        l.mul(ax, l.add(w, l.splat(4.0))),
        l.mul(ay, l.add(h, l.splat(4.0))),
    );
    let rounding = l.add(
        l.mul(relative, variation),
        l.mul(z_hi, l.splat(1.0 / 1_048_576.0)),
    );
    let reach = l.splat(if radius.is_some() {
        WHOLE_PIXEL
    } else {
        SAMPLES_ONLY
    });
    let lower = kept.map_or(0.0, |(_, slack)| slack);
    let slack = l.add(
        l.add(fold, l.add(rounding, l.splat(lower))),
        l.mul(reach, l.add(ax, ay)),
    );
    let base = l.sub(z[0], slack);

    // One quad at a time from here.
    let reversed = if two_sided { l.movemask(reversed) } else { 0 };
    let (x0, y0) = (out(l, x[0]), out(l, y[0]));
    let (base, gx, gy, z_lo, z_hi) = (
        out(l, base),
        out(l, gx),
        out(l, gy),
        out(l, z_lo),
        out(l, z_hi),
    );
    let [bx0, by0, bx1, by1] = blocks_of(l, band, steps);
    let (front0, front1) = (l.movemask(front0), l.movemask(front1));
    let mut drawn = 0;
    while live != 0 {
        let i = live.trailing_zeros() as usize;
        live &= live - 1;
        let bit = 1u32 << i;
        let plane = DepthPlane {
            x: x0[i],
            y: y0[i],
            depth: base[i],
            dx: gx[i],
            dy: gy[i],
            min: (z_lo[i] - lower).max(0.0),
            min_code: encode(z_lo[i] - lower),
            max_code: encode(z_hi[i]),
        };
        let blocks = [bx0[i] as u32, by0[i] as u32, bx1[i] as u32, by1[i] as u32];
        // Hidden behind everything that is there: changes nothing.
        if band.hides(blocks, plane.max_code) {
            continue;
        }
        let swapped = usize::from(reversed & bit != 0) * 2;
        let n = four!(k => index[if k % 2 == 1 { k ^ swapped } else { k }][i]);
        let x = l.qgather(&points.exact_x, n);
        let y = l.qgather(&points.exact_y, n);
        let (first, last) = if convex & bit != 0 {
            (2, 5)
        } else {
            (
                usize::from(front0 & bit == 0),
                1 + usize::from(front1 & bit != 0),
            )
        };
        for (n, shape) in SHAPES[first..last].iter().enumerate() {
            let (x, y) = (l.qpick(x, *shape), l.qpick(y, *shape));
            let Some((edges, rows)) = Edges::of(l, x, y) else {
                continue;
            };
            let mut polygon = Polygon {
                edges,
                rows,
                plane,
                blocks,
            };
            if let Some(radius) = radius {
                // Every point that stays is hidden from all eyes within the radius: their rays to
                // what lies behind it cross this very polygon (Wonka, Wimmer and Schmalstieg 2000,
                // with a polygon for the occluder).
                let near = z_hi[i] * radius.per_depth;
                if near > 0.5 {
                    continue;
                }
                polygon.shrink(
                    l,
                    z_hi[i] * radius.shift / (1.0 - near) * 1.001 + BETWEEN_SAMPLES,
                );
            }
            drawn += 1;
            polygon::draw(l, band, &polygon);
            if first + n == 2 {
                break;
            }
        }
    }
    drawn
}

/// Parts of a quad, by corners: the triangles alone; then the whole, and the triangles again for a
/// whole with three edges on one side.
const SHAPES: [[u8; 4]; 5] = {
    let (first, second) = ([0, 1, 2, 0], [0, 2, 3, 0]);
    [first, second, [0, 1, 2, 3], first, second]
};

#[inline(always)]
fn swap<L: Lanes>(l: L, reversed: L::I, v: [L::F; 4]) -> [L::F; 4] {
    [
        v[0],
        l.select(reversed, v[3], v[1]),
        v[2],
        l.select(reversed, v[1], v[3]),
    ]
}

/// Second, third and left-over corner of the triangle that gives the plane.
#[inline(always)]
fn pick<L: Lanes>(l: L, second: L::I, v: &[L::F; 4]) -> (L::F, L::F, L::F) {
    (
        l.select(second, v[2], v[1]),
        l.select(second, v[3], v[2]),
        l.select(second, v[1], v[3]),
    )
}
