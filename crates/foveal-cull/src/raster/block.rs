//! Coverage and depth of one polygon in one 8x8 block, and how both are merged into the buffer.
//!
//! Coverage: the borders are evaluated in float for 32 sample rows (and for the 8 rows through pixel
//! centres), relative to the block, rounded to the first covered sample, and turned into bit planes, one per sample
//! position in a pixel, by byte look-ups. Where float cannot tell on which side of a border a sample lies, all
//! is done again in `f64` (about one block in a hundred). Merging then is plain logic on 64-bit planes.
//!
//! Depth: the polygon's plane at its farthest point within each pixel, no farther than its farthest vertex.

use super::layers::{self, APART, Layer};
use super::polygon::{Edges, Polygon};
use crate::depth::{
    BLOCK_SAMPLES, Band, EMPTY, STATE_DEPTH, STATE_EMPTY, STATE_LAYERS, STATE_PARTIAL,
};
use crate::simd::{Lanes, four, larger, smaller};

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
    pub(crate) slope: [f32; 4],
    /// Bound for the rounding of a border anywhere within a block that it crosses, samples along the row.
    error: [f32; 4],
    /// The largest of them, if that is small enough not to be asked which borders cross a block.
    common: Option<f32>,
    /// Change from the first sample row to each.
    rows: [L::R; 4],
    /// The same for the rows through pixel centres.
    centers: [L::F; 4],
}

/// Rows through pixel centres, in sample rows from the first.
const CENTER_ROWS: [f32; 8] = [1.5, 5.5, 9.5, 13.5, 17.5, 21.5, 25.5, 29.5];
/// Of 64 + 48 |slope|: while a border is within a block, its number there, slope times row, their sum and the
/// slope itself are rounded, each by half a unit in the 24th place of at most that much.
const ERROR: f32 = 1.0 / 8_388_608.0;
/// Slopes up to about 16: one block in a hundred is unsure.
const COMMON_ERROR: f32 = 1e-4;
const COLUMNS: [f32; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

impl<L: Lanes> Borders<L> {
    #[inline(always)]
    pub(crate) fn new(l: L, polygon: &Polygon<L>) -> Self {
        let edges = polygon.borders;
        let slope = l.qround(edges.slope);
        let error = four!(i => (64.0 + 48.0 * slope[i].abs()) * ERROR);
        let common = largest(error);
        let centers = l.load(&CENTER_ROWS);
        Self {
            edges,
            slope,
            error,
            common: (common < COMMON_ERROR).then_some(common),
            rows: four!(i => l.rows(slope[i])),
            centers: four!(i => l.mul(centers, l.splat(slope[i]))),
        }
    }

    /// The error of those borders that cross the block; `at` at its first row.
    #[inline(always)]
    fn error_in_block(&self, at: &[f32; 4]) -> f32 {
        let error = four!(e => {
            let end = at[e] + self.slope[e] * 31.0;
            let crosses = (smaller(at[e], end) < 33.0) & (larger(at[e], end) > -1.0);
            if crosses { self.error[e] } else { 0.0 }
        });
        largest(error)
    }

    /// Positions at the first sample row of a row of blocks that begins at `top`, samples.
    #[inline(always)]
    pub(crate) fn at(&self, l: L, top: f32) -> L::Q {
        let e = &self.edges;
        let down = l.qsub(l.qsplat(f64::from(top + 0.5)), e.y);
        l.qadd(l.qmul(down, e.slope), e.x)
    }
}

#[inline(always)]
fn largest([a, b, c, d]: [f32; 4]) -> f32 {
    larger(larger(a, b), larger(c, d))
}

/// Coverage of a block: sixteen sample planes and the plane of centres.
#[inline(always)]
fn coverage<L: Lanes>(
    l: L,
    polygon: &Polygon<L>,
    borders: &Borders<L>,
    exact: L::Q,
    left: f32,
    top: f32,
) -> (L::P, u64) {
    // Sample n of a row lies at `left + n + 0.5`.
    let at = l.qround(l.qsub(exact, l.qsplat(f64::from(left - 0.5))));
    let rows = four!(e => l.radd(l.rsplat(at[e]), borders.rows[e]));
    let centers = four!(e => l.add(l.splat(at[e]), borders.centers[e]));
    let mut from = l.rmax(rows[0], rows[1]);
    let mut to = l.rmin(rows[2], rows[3]);
    let mut center_from = l.max(centers[0], centers[1]);
    let center_to = l.min(centers[2], centers[3]);
    if let Some((after, last)) = polygon.rows {
        from = l.rlimit(from, top + 0.5, after, last);
        center_from = limit_centers(l, center_from, top + 2.0, after, last);
    }
    // The centre of pixel n is at sample 4 n + 1.5 of the row.
    let quarter = |v: L::F| l.mul(l.add(v, l.splat(1.5)), l.splat(0.25));
    let mut center_from = quarter(center_from);
    let mut center_to = quarter(center_to);
    let error = borders
        .common
        .unwrap_or_else(|| borders.error_in_block(&at));
    if l.runsure(from, to, error) | l.unsure(center_from, center_to, error) {
        let numbers = exact_numbers(l, polygon, borders, exact, left, top);
        (from, to) = (l.rload(&numbers.from), l.rload(&numbers.to));
        center_from = l.load(&numbers.center_from);
        center_to = l.load(&numbers.center_to);
    }
    (l.planes(from, to), l.plane(center_from, center_to))
}

/// First covered and first uncovered sample (pixel, for centres) of each row, and a half.
struct Numbers {
    from: [f32; 32],
    to: [f32; 32],
    center_from: [f32; 8],
    center_to: [f32; 8],
}

/// The same as in float, in `f64`.
#[cold]
fn exact_numbers<L: Lanes>(
    l: L,
    polygon: &Polygon<L>,
    borders: &Borders<L>,
    exact: L::Q,
    left: f32,
    top: f32,
) -> Numbers {
    let mut numbers = Numbers {
        from: [0.0; 32],
        to: [0.0; 32],
        center_from: [0.0; 8],
        center_to: [0.0; 8],
    };
    let (mut at, mut slope) = ([0.0; 4], [0.0; 4]);
    l.qstore(l.qsub(exact, l.qsplat(f64::from(left - 0.5))), &mut at);
    l.qstore(borders.edges.slope, &mut slope);
    let ends = |row: f32| {
        let x = four!(e => at[e] + f64::from(row) * slope[e]);
        let y = top + 0.5 + row;
        let inside = polygon
            .rows
            .is_none_or(|(after, last)| after < y && y <= last);
        let from = if inside { x[0].max(x[1]) } else { 1e6 };
        (from, x[2].min(x[3]))
    };
    // Whole numbers and a half, so that rounding them towards zero again is no question.
    let number = |v: f64, most: f64| v.clamp(0.0, most).floor() as f32 + 0.5;
    for row in 0..32 {
        let (from, to) = ends(row as f32);
        // As Lanes::R has its rows.
        let place = row % 4 * 8 + row / 4;
        (numbers.from[place], numbers.to[place]) = (number(from, 32.0), number(to, 32.0));
    }
    for (row, center) in CENTER_ROWS.iter().enumerate() {
        let (from, to) = ends(*center);
        let pixel = |x: f64| number((x + 1.5) * 0.25, 8.0);
        (numbers.center_from[row], numbers.center_to[row]) = (pixel(from), pixel(to));
    }
    numbers
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
    if plane.max_code <= band.min[i] {
        return 0;
    }
    let mut d = depths(l, plane, bx, by);
    let state = band.state[i];
    let erased = band.erased(i, plane.min_code, plane.max_code);
    let block = &mut band.depth[i].0;
    if erased != 0 {
        d = l.dselect(erased, l.dsplat(EMPTY), d);
    }
    if state != STATE_EMPTY {
        d = l.dmax(d, l.dload(block));
    }
    l.dstore(d, block);
    band.min[i] = l.dreduce_min(d);
    match state {
        STATE_PARTIAL => layers::forget_hidden(l, &mut band.partial[i], d),
        STATE_LAYERS => layers::forget_hidden_layers(l, band, i, d),
        _ => band.state[i] = STATE_DEPTH,
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
    polygon: &Polygon<L>,
    borders: &Borders<L>,
    exact: L::Q,
) -> u32 {
    let i = ((by - band.first_row) * band.blocks_x + bx) as usize;
    if polygon.plane.max_code <= band.min[i] {
        return 0;
    }
    let d = depths(l, &polygon.plane, bx, by);
    let erased = band.erased(i, polygon.plane.min_code, polygon.plane.max_code);
    let (left, top) = ((bx * BLOCK_SAMPLES) as f32, (by * BLOCK_SAMPLES) as f32);
    let (planes, center) = coverage(l, polygon, borders, exact, left, top);
    // From here on all but without a branch: hardly any of the questions has an answer that could be foreseen.
    let state = band.state[i];
    let (block, partial) = (&mut band.depth[i].0, &mut band.partial[i]);
    let known = u64::from(state == STATE_EMPTY).wrapping_sub(1);
    let begun = u64::from(state < STATE_PARTIAL).wrapping_sub(1);
    let far = l.dsplat(i16::MAX);
    let old = l.dselect(known, l.dload(block), l.dsplat(EMPTY));
    // Only pixels where the polygon is nearer than what is proven already. Those that it covers alone need no
    // partner, and what they have so far stays apart from them.
    let nearer = l.dgt(d, old) & !erased;
    let theirs = l.dload(&partial.depth);
    let before = partial.any & begun;
    let their_planes = l.pkeep(l.pload(&partial.planes), begun);
    let their_center = partial.center & begun;
    let alone = l.pall(planes) & center & nearer;
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
        layers::join(l, band, i, &ours, joined, new);
        return WORK_OF_PARTIAL;
    }
    let depth = l.dmin(l.dselect(joined, d, far), l.dselect(before, theirs, far));
    let new = l.dselect(full, l.dmax(new, depth), new);
    // Forget what is complete, or hidden by now. What there was is nearer than the old depth, and so is what joins it.
    let hidden = alone & !l.dgt(theirs, d);
    let kept = (joined | before) & !(hidden | full);
    l.dstore(new, block);
    band.min[i] = l.dreduce_min(new);
    l.pstore(
        l.pkeep(l.por(ours, their_planes), kept),
        &mut partial.planes,
    );
    partial.center = (our_center | their_center) & kept;
    l.dstore(depth, &mut partial.depth);
    partial.any = kept;
    band.state[i] = if kept != 0 {
        STATE_PARTIAL
    } else {
        STATE_DEPTH
    };
    WORK_OF_PARTIAL
}
