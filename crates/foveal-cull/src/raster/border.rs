//! Erasing: the pixels that the border of a sheet comes too near to.
//!
//! A border erases only what lies as deep as the sheet can be where that border is within reach of it; where the cluster folds,
//! its farther part stays.

use super::sheet::AROUND_SAMPLE;
use crate::depth::{BLOCK_SAMPLES, Band, SAMPLES, encode};
use crate::simd::{Lanes, larger, smaller};

/// More than all rounding, samples.
const MARGIN: f32 = 0.0625;

/// How far borders reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Of a point at depth 1, along x and y, samples.
    pub(super) shifts: [f32; 2],
    /// Most change of depth per sample on the sheet, along x plus along y.
    pub(super) steepness: f32,
    /// Where the cluster is drawn: first and last block, inclusive.
    pub(super) blocks: [u32; 4],
}

/// Erases the pixels to which an edge comes within its shift.
#[inline(always)]
pub(super) fn erase<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    erased: &mut Vec<u32>,
    a: [f32; 3],
    b: [f32; 3],
    reach: Reach,
) {
    const PIXELS: [f32; 8] = [0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0];
    let near = larger(a[2], b[2]);
    let [reach_x, reach_y] = [0, 1].map(|k: usize| near * reach.shifts[k] * 1.001 + MARGIN);
    let (x_lo, x_hi) = (smaller(a[0], b[0]), larger(a[0], b[0]));
    let (y_lo, y_hi) = (smaller(a[1], b[1]), larger(a[1], b[1]));
    let [first_x, first_y, last_x, last_y] = reach.blocks;
    if x_hi + reach_x < (first_x * BLOCK_SAMPLES) as f32
        || y_hi + reach_y < (first_y * BLOCK_SAMPLES) as f32
        || x_lo - reach_x >= ((last_x + 1) * BLOCK_SAMPLES) as f32
        || y_lo - reach_y >= ((last_y + 1) * BLOCK_SAMPLES) as f32
    {
        return;
    }
    // Casts saturate.
    let size = BLOCK_SAMPLES as f32;
    let scale = 1.0 / size;
    let column = |x: f32| ((x * scale) as u32).clamp(first_x, last_x);
    let row = |y: f32| ((y * scale) as u32).clamp(first_y, last_y);
    let (by0, by1) = (row(y_lo - reach_y), row(y_hi + reach_y));
    let blocks = [column(x_lo - reach_x), by0, column(x_hi + reach_x), by1];
    // What lies behind all that is known there is hidden whatever this edge does; what lies before it, the edge is
    // behind.
    let code = encode(near * 1.001).saturating_add(1);
    if band.hides(blocks, code) {
        return;
    }
    // As deep as the sheet can be where the edge is within reach of it.
    let around = reach.steepness * (AROUND_SAMPLE + larger(reach_x, reach_y)) + near * 1e-5;
    let depths = (
        encode(smaller(a[2], b[2]) - around),
        encode(near + around).saturating_add(1),
    );
    let slope = (b[0] - a[0]) / (b[1] - a[1]);
    // Of an edge that is all but level every row has the whole.
    let level = slope.is_nan() || slope.abs() > 1e4;
    let (lo, hi) = (l.splat(x_lo), l.splat(x_hi));
    for by in by0..=by1 {
        let top = (by * BLOCK_SAMPLES) as f32;
        // Where the edge is within reach of the row of blocks: its ends there, since it is straight.
        let (mut bx0, mut bx1) = (blocks[0], blocks[2]);
        if bx0 != bx1 && !level {
            let p = smaller(larger(top - reach_y, y_lo), y_hi) - a[1];
            let q = smaller(larger(top + (size + reach_y), y_lo), y_hi) - a[1];
            let (p, q) = (a[0] + p * slope, a[0] + q * slope);
            bx0 = column(smaller(larger(smaller(p, q), x_lo), x_hi) - reach_x);
            bx1 = column(smaller(larger(larger(p, q), x_lo), x_hi) + reach_x);
        }
        let rows = l.add(l.load(&PIXELS), l.splat(top));
        let (above, below) = (
            l.sub(rows, l.splat(reach_y)),
            l.add(rows, l.splat(reach_y + SAMPLES as f32)),
        );
        let beside = l.ior(l.lt(l.splat(y_hi), above), l.lt(below, l.splat(y_lo)));
        let (mut from, mut to) = (lo, hi);
        if !level {
            let (top, bottom) = (l.splat(y_lo), l.splat(y_hi));
            let p = l.sub(l.min(l.max(above, top), bottom), l.splat(a[1]));
            let q = l.sub(l.min(l.max(below, top), bottom), l.splat(a[1]));
            let p = l.add(l.splat(a[0]), l.mul(p, l.splat(slope)));
            let q = l.add(l.splat(a[0]), l.mul(q, l.splat(slope)));
            from = l.min(l.max(l.min(p, q), lo), hi);
            to = l.min(l.max(l.max(p, q), lo), hi);
        }
        let from = l.select(beside, l.splat(1e9), l.sub(from, l.splat(reach_x)));
        let to = l.select(beside, l.splat(-1e9), l.add(to, l.splat(reach_x)));
        for bx in bx0..=bx1 {
            let i = ((by - band.first_row) * band.blocks_x + bx) as usize;
            if code <= band.min[i] {
                continue;
            }
            let left = l.splat((bx * BLOCK_SAMPLES) as f32);
            let pixel = l.splat(1.0 / SAMPLES as f32);
            let first = l.mul(l.sub(from, left), pixel);
            let last = l.mul(l.sub(to, left), pixel);
            let bits = l.plane(first, l.add(last, l.splat(1.0)));
            if bits != 0 {
                let (pixels, border) = (&mut band.erased[i], &mut band.border[i]);
                if *pixels == 0 {
                    erased.push(i as u32);
                    *border = [i16::MAX, i16::MIN];
                }
                *pixels |= bits;
                *border = [border[0].min(depths.0), border[1].max(depths.1)];
            }
        }
    }
}
