//! Coverage and depth of one polygon in one 8x8 block, and how both are merged into the buffer.
//!
//! Coverage: the borders are evaluated in float for 32 sample rows (and for the 8 rows through pixel
//! centres), rounded to the first covered sample, and turned into bit planes, one per sample position in a
//! pixel, by two 16-entry byte look-ups per side. Merging then is plain logic on 64-bit planes.
//!
//! Depth: the polygon's plane at its farthest point within each pixel, no farther than its farthest vertex.

use super::polygon::Polygon;
use crate::depth::{
    BLOCK_SAMPLES, Band, CODE_OFFSET, EMPTY, STATE_DEPTH, STATE_EMPTY, STATE_PARTIAL,
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
    /// Change over four sample rows per lane.
    lanes: [L::F; 4],
    /// Change over one sample row.
    step: [L::F; 4],
}

const LANE_ROWS: [f32; 8] = [0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0];
const LANE_COLUMNS: [f32; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
/// Pixels at or right of the n-th column.
const FROM: [u8; 16] = [
    0xff, 0xfe, 0xfc, 0xf8, 0xf0, 0xe0, 0xc0, 0x80, 0, 0, 0, 0, 0, 0, 0, 0,
];

impl<L: Lanes> Borders<L> {
    #[inline(always)]
    pub(crate) fn new(l: L, polygon: &Polygon) -> Self {
        let e = [
            polygon.left.edges[0],
            polygon.left.edges[1],
            polygon.right.edges[0],
            polygon.right.edges[1],
        ];
        let rows = l.load(&LANE_ROWS);
        let step = four!(i => l.splat(e[i].slope));
        Self {
            x: four!(i => e[i].x),
            y: four!(i => e[i].y),
            slope: four!(i => e[i].slope),
            lanes: four!(i => l.mul(rows, step[i])),
            step,
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
pub(crate) struct Mask<L: Lanes> {
    pub(crate) planes: [L::B; 4],
    pub(crate) center: u64,
}

/// First covered sample per row (0 to 32), for the four sample rows of each pixel row, and first covered
/// pixel centre (0 to 8).
struct Bounds<L: Lanes> {
    rows: [L::F; 4],
    center: L::F,
}

/// One border in a block that begins at `left`.
#[inline(always)]
fn border<L: Lanes>(l: L, borders: &Borders<L>, at: &[f32; 4], e: usize, left: f32) -> Bounds<L> {
    let step = borders.step[e];
    let r0 = l.add(l.splat(at[e] - (left - 0.5)), borders.lanes[e]);
    let r1 = l.add(r0, step);
    let r2 = l.add(r1, step);
    let r3 = l.add(r2, step);
    Bounds {
        rows: [r0, r1, r2, r3],
        center: l.add(r1, l.mul(step, l.splat(0.5))),
    }
}

/// Planes of "at or right of the bound": by sample column, then centres.
#[inline(always)]
fn planes<L: Lanes>(l: L, b: &Bounds<L>) -> ([L::B; 4], u64) {
    let (zero, end) = (l.splat(0.0), l.splat(32.0));
    let n = l.pack8(four!(k => l.trunc(l.min(l.max(b.rows[k], zero), end))));
    let whole = l.blookup(&FROM, l.bshr2(n));
    let next = l.badd(whole, whole);
    let part = l.band(n, l.bsplat(3));
    let columns = [
        l.bselect(l.bgt(part, l.bsplat(0)), next, whole),
        l.bselect(l.bgt(part, l.bsplat(1)), next, whole),
        l.bselect(l.bgt(part, l.bsplat(2)), next, whole),
        whole,
    ];
    let c = l.mul(l.add(b.center, l.splat(1.5)), l.splat(0.25));
    let c = l.trunc(l.min(l.max(c, zero), l.splat(8.0)));
    let c = l.blookup(&FROM, l.pack8([c; 4]));
    (columns, l.band_fold(c))
}

/// Moves the left border out of sight on rows outside the limits; `y` is the first of the eight rows.
#[inline(always)]
fn limit<L: Lanes>(l: L, lo: L::F, y: f32, (y0, y1): (f32, f32)) -> L::F {
    let y = l.add(l.load(&LANE_ROWS), l.splat(y));
    let inside = l.iandnot(l.lt(l.splat(y1), y), l.lt(l.splat(y0), y));
    l.select(inside, lo, l.splat(1e6))
}

#[inline(always)]
fn mask<L: Lanes>(
    l: L,
    polygon: &Polygon,
    borders: &Borders<L>,
    at: &[f32; 4],
    left: f32,
    top: f32,
) -> Mask<L> {
    let (l0, l1) = (
        border(l, borders, at, 0, left),
        border(l, borders, at, 1, left),
    );
    let (r0, r1) = (
        border(l, borders, at, 2, left),
        border(l, borders, at, 3, left),
    );
    let mut lo = Bounds {
        rows: four!(k => l.max(l0.rows[k], l1.rows[k])),
        center: l.max(l0.center, l1.center),
    };
    let hi = Bounds {
        rows: four!(k => l.min(r0.rows[k], r1.rows[k])),
        center: l.min(r0.center, r1.center),
    };
    if let Some(limits) = polygon.rows {
        lo.rows = four!(k => limit(l, lo.rows[k], top + 0.5 + k as f32, limits));
        lo.center = limit(l, lo.center, top + 2.0, limits);
    }
    let (a, ca) = planes(l, &lo);
    let (b, cb) = planes(l, &hi);
    Mask {
        planes: four!(c => l.bandnot(b[c], a[c])),
        center: ca & !cb,
    }
}

#[inline(always)]
fn depth_row<L: Lanes>(l: L, columns: L::F, floor: L::F, offset: L::I, down: f32) -> L::I {
    let d = l.max(l.add(columns, l.splat(down)), floor);
    l.isub(l.isra12(l.bits(d)), offset)
}

/// Depth codes of the block's 64 pixels.
#[inline(always)]
fn depth<L: Lanes>(l: L, plane: &Plane, bx: u32, by: u32) -> [L::H; 4] {
    // Centre of the first pixel.
    let x = (bx * BLOCK_SAMPLES) as f32 + 2.0 - plane.x;
    let y = (by * BLOCK_SAMPLES) as f32 + 2.0 - plane.y;
    let first = plane.depth + plane.dx * x + plane.dy * y;
    let (dx, dy) = (plane.dx * 4.0, plane.dy * 4.0);
    let columns = l.add(l.splat(first), l.mul(l.load(&LANE_COLUMNS), l.splat(dx)));
    let (floor, offset) = (l.splat(plane.min), l.isplat(CODE_OFFSET));
    // Never nearer than the nearest vertex, so that what is skipped as hidden would have changed nothing.
    let nearest = l.hsplat(plane.max_code);
    four!(i => l.hmin(l.pack16(depth_row(l, columns, floor, offset, dy * (2 * i) as f32), depth_row(l, columns, floor, offset, dy * (2 * i + 1) as f32)), nearest))
}

#[inline(always)]
fn spread<L: Lanes>(l: L, bits: u64, i: usize) -> L::H {
    l.hmask((bits >> (16 * i)) as u16)
}

#[inline(always)]
fn gather_bits<L: Lanes>(l: L, masks: [L::H; 4]) -> u64 {
    let m = four!(i => u64::from(l.hbits(masks[i])) << (16 * i));
    (m[0] | m[1]) | (m[2] | m[3])
}

#[inline(always)]
fn reduce<L: Lanes>(l: L, d: &[L::H; 4]) -> i16 {
    l.hreduce_min(l.hmin(l.hmin(d[0], d[1]), l.hmin(d[2], d[3])))
}

/// Merges a polygon that covers the whole block.
#[inline(always)]
pub(crate) fn cover_full<L: Lanes>(l: L, band: &mut Band<'_>, bx: u32, by: u32, plane: &Plane) {
    let i = ((by - band.first_row) * band.blocks_x + bx) as usize;
    if plane.max_code <= band.min[i] {
        return;
    }
    let mut d = depth(l, plane, bx, by);
    let state = band.state[i];
    let block = &mut band.depth[i].0;
    if state != STATE_EMPTY {
        for k in 0..4 {
            d[k] = l.hmax(d[k], l.hload(&block[k]));
        }
    }
    for k in 0..4 {
        l.hstore(d[k], &mut block[k]);
    }
    band.min[i] = reduce(l, &d);
    if state == STATE_PARTIAL {
        let partial = &mut band.partial[i];
        forget_hidden(l, partial, &d);
    } else {
        band.state[i] = STATE_DEPTH;
    }
}

/// Drops partial coverage that can no longer bring anything nearer than the depth that is there.
#[inline(always)]
fn forget_hidden<L: Lanes>(l: L, partial: &mut crate::depth::PartialBlock, d: &[L::H; 4]) {
    let kept = gather_bits(l, four!(k => l.hgt(l.hload(&partial.depth[k]), d[k])));
    let keep = l.bsplat64(kept);
    for c in 0..4 {
        l.bstore(
            l.band(l.bload(&partial.planes[c]), keep),
            &mut partial.planes[c],
        );
    }
    partial.center &= kept;
    let far = l.hsplat(i16::MAX);
    for k in 0..4 {
        let p = l.hselect(spread(l, kept, k), l.hload(&partial.depth[k]), far);
        l.hstore(p, &mut partial.depth[k]);
    }
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
    let d = depth(l, &polygon.plane, bx, by);
    let state = band.state[i];
    let block = &mut band.depth[i].0;
    let old: [L::H; 4] = if state == STATE_EMPTY {
        [l.hsplat(EMPTY); 4]
    } else {
        four!(k => l.hload(&block[k]))
    };
    // Only pixels where the polygon is nearer than what is proven already.
    let nearer = gather_bits(l, four!(k => l.hgt(d[k], old[k])));
    if nearer == 0 {
        return;
    }
    let Mask {
        mut planes,
        mut center,
    } = mask(
        l,
        polygon,
        borders,
        at,
        (bx * BLOCK_SAMPLES) as f32,
        (by * BLOCK_SAMPLES) as f32,
    );
    let near = l.bsplat64(nearer);
    planes = four!(c => l.band(planes[c], near));
    center &= nearer;
    let touched =
        l.bor_fold(l.bor(l.bor(planes[0], planes[1]), l.bor(planes[2], planes[3]))) | center;
    if touched == 0 {
        return;
    }
    let alone =
        l.band_fold(l.band(l.band(planes[0], planes[1]), l.band(planes[2], planes[3]))) & center;
    let partial = &mut band.partial[i];
    let far = l.hsplat(i16::MAX);
    // Pixels that it covers alone need no partner, and what they have so far stays apart from them.
    let mut new = old;
    if alone != 0 {
        for k in 0..4 {
            new[k] = l.hselect(spread(l, alone, k), d[k], old[k]);
        }
        let others = l.bsplat64(!alone);
        planes = four!(c => l.band(planes[c], others));
        center &= !alone;
    }
    let mut depths: [L::H; 4] = [far; 4];
    if state == STATE_PARTIAL {
        for c in 0..4 {
            planes[c] = l.bor(planes[c], l.bload(&partial.planes[c]));
        }
        center |= partial.center;
        depths = four!(k => l.hload(&partial.depth[k]));
    }
    let joined = touched & !alone;
    for k in 0..4 {
        depths[k] = l.hselect(spread(l, joined, k), l.hmin(depths[k], d[k]), depths[k]);
    }
    let full =
        l.band_fold(l.band(l.band(planes[0], planes[1]), l.band(planes[2], planes[3]))) & center;
    if full | alone != 0 {
        for k in 0..4 {
            new[k] = l.hselect(spread(l, full, k), l.hmax(new[k], depths[k]), new[k]);
            l.hstore(new[k], &mut block[k]);
        }
        band.min[i] = reduce(l, &new);
        // Forget what is complete, or hidden by now.
        let kept = gather_bits(l, four!(k => l.hgt(depths[k], new[k])));
        let keep = l.bsplat64(kept);
        planes = four!(c => l.band(planes[c], keep));
        center &= kept;
        for k in 0..4 {
            depths[k] = l.hselect(spread(l, kept, k), depths[k], far);
        }
    } else if state == STATE_EMPTY {
        for k in 0..4 {
            l.hstore(old[k], &mut block[k]);
        }
    }
    for c in 0..4 {
        l.bstore(planes[c], &mut partial.planes[c]);
    }
    partial.center = center;
    for k in 0..4 {
        l.hstore(depths[k], &mut partial.depth[k]);
    }
    let any = l.bor_fold(l.bor(l.bor(planes[0], planes[1]), l.bor(planes[2], planes[3]))) | center;
    band.state[i] = if any == 0 { STATE_DEPTH } else { STATE_PARTIAL };
}
