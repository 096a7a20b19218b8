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
use super::facing::{Facing, ValidityRadius};
use super::points::Points;
use super::polygon::{self, Polygon};
use crate::depth::band::Band;
use crate::format::encode;
use crate::simd::{F8, Lanes, M8, four};

/// Largest distance from a point of a pixel to its nearest sample (half the diagonal of a sample,
/// and a bit). Polygons that shrink by this cover every point between the samples that they cover.
const BETWEEN_SAMPLES: f32 = 0.72;

/// Distance from a pixel's centre along each axis: to its side, and to its outermost samples, which
/// is enough for one exact eye, whose rays go through samples only.
const WHOLE_PIXEL: f32 = 2.0;
const SAMPLES_ONLY: f32 = 1.5 + 1.0 / 64.0;

/// Sets up and draws eight quads from screen positions; returns the number of polygons drawn.
#[cfg_attr(not(unoptimized), inline(always))]
pub(crate) fn draw_eight<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    points: &Points,
    index: [&[u8; 8]; 4],
    kept: Option<(&[[f32; 8]; 2], f32)>,
    facing: Facing,
) -> u64 {
    let radius = facing.radius.filter(|_| kept.is_none());
    let mut corners = Corners::gather(l, points, index);
    let reversed = if facing.two_sided {
        corners.turn_to_eye(l)
    } else {
        !l.all()
    };
    let front = Front::of(l, &corners, kept.map(|(triangles, _)| triangles));
    let any = front.first | front.second;
    if any.bits() == 0 {
        return 0;
    }
    let extent = Extent::of(&corners);
    let steps = steps_of(l, band, extent.ends);
    let [nx0, ny0, nx1, ny1] = steps;
    let on_screen = nx0.lt(nx1) & ny0.lt(ny1);
    let mut live = (any & on_screen).bits();
    if live == 0 {
        return 0;
    }
    let convex = front.convex(l, &corners);
    let mut z = four!(c => l.gather(&points.depth, index[c]));
    if facing.two_sided {
        z = swap(reversed, z);
    }
    let (z_lo, z_hi) = (lowest(&z), highest(&z));
    let plane = Planes::of(l, &corners, &z, &front);
    if let Some(radius) = radius {
        live &= front.survives_shrinking(l, z_hi, &extent, radius).bits();
        if live == 0 {
            return 0;
        }
    }
    let lower = kept.map_or(0.0, |(_, slack)| slack);
    let base = z[0] - plane.slack(l, &extent, z_hi, radius.is_some(), lower);

    // One quad at a time from here.
    let reversed = if facing.two_sided { reversed.bits() } else { 0 };
    let (x0, y0) = (out(corners.x[0]), out(corners.y[0]));
    let (base, gx, gy) = (out(base), out(plane.gx), out(plane.gy));
    let (z_lo, z_hi) = (out(z_lo), out(z_hi));
    let [bx0, by0, bx1, by1] = blocks_of(l, band, steps);
    let (first, second) = (front.first.bits(), front.second.bits());
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
        let x = l.gather_doubles(&points.exact_x, n);
        let y = l.gather_doubles(&points.exact_y, n);
        let (first, last) = if convex & bit != 0 {
            (2, 5)
        } else {
            (
                usize::from(first & bit == 0),
                1 + usize::from(second & bit != 0),
            )
        };
        for (n, shape) in SHAPES[first..last].iter().enumerate() {
            let Some((edges, rows)) = Edges::of(l, x.pick(*shape), y.pick(*shape)) else {
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

/// The corners of eight quads on the screen, rounded, samples.
struct Corners<L: Lanes> {
    x: [F8<L>; 4],
    y: [F8<L>; 4],
}

impl<L: Lanes> Corners<L> {
    #[cfg_attr(not(unoptimized), inline(always))]
    fn gather(l: L, points: &Points, index: [&[u8; 8]; 4]) -> Self {
        Self {
            x: four!(c => l.gather(&points.x, index[c])),
            y: four!(c => l.gather(&points.y, index[c])),
        }
    }

    /// Twice the areas of both triangles.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn areas(&self) -> [F8<L>; 2] {
        [
            area(&self.x, &self.y, 0, 1, 2),
            area(&self.x, &self.y, 0, 2, 3),
        ]
    }

    /// Reverses two-sided quads that face away, and returns which. The larger triangle decides the
    /// side. Its partner, if it faces the other way, is dropped.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn turn_to_eye(&mut self, l: L) -> M8<L> {
        let [f0, f1] = self.areas();
        let reversed = (f0 + f1).lt(l.splat(0.0));
        self.x = swap(reversed, self.x);
        self.y = swap(reversed, self.y);
        reversed
    }
}

/// Which triangles of eight quads face the eye, and twice their areas.
struct Front<L: Lanes> {
    first: M8<L>,
    second: M8<L>,
    areas: [F8<L>; 2],
}

impl<L: Lanes> Front<L> {
    /// `kept`: above zero for triangles that count at all.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn of(l: L, corners: &Corners<L>, kept: Option<&[[f32; 8]; 2]>) -> Self {
        let zero = l.splat(0.0);
        let areas = corners.areas();
        let [mut first, mut second] = [zero.lt(areas[0]), zero.lt(areas[1])];
        if let Some(kept) = kept {
            first = first & zero.lt(l.load(&kept[0]));
            second = second & zero.lt(l.load(&kept[1]));
        }
        Self {
            first,
            second,
            areas,
        }
    }

    /// A bit per quad that is convex on the screen: each of the four triangles that its corners
    /// make faces the eye.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn convex(&self, l: L, corners: &Corners<L>) -> u32 {
        let zero = l.splat(0.0);
        let [f0, f1] = self.areas;
        let f3 = area(&corners.x, &corners.y, 0, 1, 3);
        let f2 = f0 + f1 - f3;
        (self.first & self.second & (zero.lt(f2) & zero.lt(f3))).bits()
    }

    /// Quads that may leave anything when they shrink for a region.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn survives_shrinking(
        &self,
        l: L,
        z_hi: F8<L>,
        extent: &Extent<L>,
        radius: ValidityRadius,
    ) -> M8<L> {
        // A polygon shrinks to nothing unless its area exceeds half its perimeter, which is at
        // least sqrt(2) (w + h), times the distance that it shrinks by.
        let zero = l.splat(0.0);
        let (w, h) = extent.size();
        let by = z_hi * radius.shift + BETWEEN_SAMPLES;
        let least = by * 1.414 * (w + h);
        least.lt(self.areas[0].max(zero) + self.areas[1].max(zero))
    }
}

/// The extents of eight quads on the screen.
struct Extent<L: Lanes> {
    /// Least x and y, greatest x and y.
    ends: [[F8<L>; 2]; 2],
}

impl<L: Lanes> Extent<L> {
    #[cfg_attr(not(unoptimized), inline(always))]
    fn of(corners: &Corners<L>) -> Self {
        let (x, y) = (&corners.x, &corners.y);
        Self {
            ends: [[lowest(x), lowest(y)], [highest(x), highest(y)]],
        }
    }

    /// Width and height.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn size(&self) -> (F8<L>, F8<L>) {
        let [[x_lo, y_lo], [x_hi, y_hi]] = self.ends;
        (x_hi - x_lo, y_hi - y_lo)
    }
}

/// The depth planes of eight quads: through the first corner and the larger (or only) front
/// triangle.
struct Planes<L: Lanes> {
    /// Change per sample.
    gx: F8<L>,
    gy: F8<L>,
    /// One divided by twice the triangle's area.
    inverse_area: F8<L>,
    /// How far the corner that is not of the triangle lies behind the plane.
    fold: F8<L>,
}

impl<L: Lanes> Planes<L> {
    #[cfg_attr(not(unoptimized), inline(always))]
    fn of(l: L, corners: &Corners<L>, z: &[F8<L>; 4], front: &Front<L>) -> Self {
        let (x, y) = (&corners.x, &corners.y);
        let [f0, f1] = front.areas;
        let second = !front.first | front.second & f0.lt(f1);
        let (bx, cx, ox) = pick(second, x);
        let (by, cy, oy) = pick(second, y);
        let (bz, cz, oz) = pick(second, z);
        let (bx, by, bz) = (bx - x[0], by - y[0], bz - z[0]);
        let (cx, cy, cz) = (cx - x[0], cy - y[0], cz - z[0]);
        let inverse_area = l.splat(1.0) / second.select(f1, f0);
        let gx = (cz * by - bz * cy) * inverse_area;
        let gy = (bz * cx - cz * bx) * inverse_area;
        let at_other = z[0] + (gx * (ox - x[0]) + gy * (oy - y[0]));
        let (both, zero) = (front.first & front.second, l.splat(0.0));
        Self {
            gx,
            gy,
            inverse_area,
            fold: both.select((at_other - oz).max(zero), zero),
        }
    }

    /// What the planes are lowered by, so that they hold for whole pixels however they are rounded.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn slack(
        &self,
        l: L,
        extent: &Extent<L>,
        z_hi: F8<L>,
        whole_pixels: bool,
        lower: f32,
    ) -> F8<L> {
        let (w, h) = extent.size();
        let (ax, ay) = (self.gx.abs(), self.gy.abs());
        let relative =
            l.splat(1.0 / 262_144.0) + l.splat(1.0 / 256.0) * (w + h) * self.inverse_area;
        let variation = ax * (w + 4.0) + ay * (h + 4.0);
        let rounding = relative * variation + z_hi * (1.0 / 1_048_576.0);
        let reach = l.splat(if whole_pixels {
            WHOLE_PIXEL
        } else {
            SAMPLES_ONLY
        });
        self.fold + (rounding + lower) + reach * (ax + ay)
    }
}

/// Parts of a quad, by corners: the triangles alone; then the whole, and the triangles again for a
/// whole with three edges on one side.
const SHAPES: [[u8; 4]; 5] = {
    let (first, second) = ([0, 1, 2, 0], [0, 2, 3, 0]);
    [first, second, [0, 1, 2, 3], first, second]
};

#[cfg_attr(not(unoptimized), inline(always))]
fn swap<L: Lanes>(reversed: M8<L>, v: [F8<L>; 4]) -> [F8<L>; 4] {
    [
        v[0],
        reversed.select(v[3], v[1]),
        v[2],
        reversed.select(v[1], v[3]),
    ]
}

/// Second, third and left-over corner of the triangle that gives the plane.
#[cfg_attr(not(unoptimized), inline(always))]
fn pick<L: Lanes>(second: M8<L>, v: &[F8<L>; 4]) -> (F8<L>, F8<L>, F8<L>) {
    (
        second.select(v[2], v[1]),
        second.select(v[3], v[2]),
        second.select(v[1], v[3]),
    )
}
