//! Areas, extents and blocks of eight quads on the screen.

use crate::depth::band::Band;
use crate::format::BLOCK_SAMPLES;
use crate::simd::{F8, I8, Lanes, four};

/// Twice the signed area; positive if it faces the eye (y points down).
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn area<L: Lanes>(
    x: &[F8<L>; 4],
    y: &[F8<L>; 4],
    a: usize,
    b: usize,
    c: usize,
) -> F8<L> {
    (x[c] - x[a]) * (y[b] - y[a]) - (x[b] - x[a]) * (y[c] - y[a])
}

#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn lowest<L: Lanes>(v: &[F8<L>; 4]) -> F8<L> {
    v[0].min(v[1]).min(v[2].min(v[3]))
}

#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn highest<L: Lanes>(v: &[F8<L>; 4]) -> F8<L> {
    v[0].max(v[1]).max(v[2].max(v[3]))
}

/// Half-sample steps strictly above the least x and y and up to the greatest. Every sample and
/// pixel centre lies on a step. Clamped to the band.
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn steps_of<L: Lanes>(l: L, band: &Band<'_>, [lo, hi]: [[F8<L>; 2]; 2]) -> [I8<L>; 4] {
    let size = BLOCK_SAMPLES as f32;
    let right = band.blocks_x as f32 * size;
    let (top, bottom) = (
        band.first_row as f32 * size,
        (band.first_row + band.rows) as f32 * size,
    );
    [
        steps(l, lo[0], 0.0, right),
        steps(l, lo[1], top, bottom),
        steps(l, hi[0], 0.0, right),
        steps(l, hi[1], top, bottom),
    ]
}

/// First and last block that hold these steps.
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn blocks_of<L: Lanes>(l: L, band: &Band<'_>, steps: [I8<L>; 4]) -> [[i32; 8]; 4] {
    let per_block = l.int((2 * BLOCK_SAMPLES).trailing_zeros() as i32);
    let ends = [band.blocks_x, band.first_row + band.rows];
    four!(k => {
        let last = l.int(ends[k % 2] as i32 - 1);
        let mut blocks = [0; 8];
        (steps[k] >> per_block).min(last).store(&mut blocks);
        blocks
    })
}

/// Half-sample steps up to `v`, clamped.
#[cfg_attr(not(unoptimized), inline(always))]
fn steps<L: Lanes>(l: L, v: F8<L>, lo: f32, hi: f32) -> I8<L> {
    let c = v.max(l.splat(lo)).min(l.splat(hi));
    (c + c).trunc()
}

#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn out<L: Lanes>(v: F8<L>) -> [f32; 8] {
    let mut a = [0.0; 8];
    v.store(&mut a);
    a
}
