//! Areas, extents and blocks of eight quads on the screen.

use crate::depth::band::Band;
use crate::format::BLOCK_SAMPLES;
use crate::simd::{Lanes, four};

/// Twice the signed area; positive if it faces the eye (y points down).
#[inline(always)]
pub(super) fn area<L: Lanes>(
    l: L,
    x: &[L::F; 4],
    y: &[L::F; 4],
    a: usize,
    b: usize,
    c: usize,
) -> L::F {
    l.sub(
        l.mul(l.sub(x[c], x[a]), l.sub(y[b], y[a])),
        l.mul(l.sub(x[b], x[a]), l.sub(y[c], y[a])),
    )
}

#[inline(always)]
pub(super) fn lowest<L: Lanes>(l: L, v: &[L::F; 4]) -> L::F {
    l.min(l.min(v[0], v[1]), l.min(v[2], v[3]))
}

#[inline(always)]
pub(super) fn highest<L: Lanes>(l: L, v: &[L::F; 4]) -> L::F {
    l.max(l.max(v[0], v[1]), l.max(v[2], v[3]))
}

/// Half-sample steps strictly above the least x and y and up to the greatest. Every sample and
/// pixel centre lies on a step. Clamped to the band.
#[inline(always)]
pub(super) fn steps_of<L: Lanes>(l: L, band: &Band<'_>, [lo, hi]: [[L::F; 2]; 2]) -> [L::I; 4] {
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
#[inline(always)]
pub(super) fn blocks_of<L: Lanes>(l: L, band: &Band<'_>, steps: [L::I; 4]) -> [[i32; 8]; 4] {
    let per_block = l.isplat((2 * BLOCK_SAMPLES).trailing_zeros() as i32);
    let ends = [band.blocks_x, band.first_row + band.rows];
    four!(k => {
        let last = l.isplat(ends[k % 2] as i32 - 1);
        let mut blocks = [0; 8];
        l.istore(l.imin(l.ishr(steps[k], per_block), last), &mut blocks);
        blocks
    })
}

/// Half-sample steps up to `v`, clamped.
#[inline(always)]
fn steps<L: Lanes>(l: L, v: L::F, lo: f32, hi: f32) -> L::I {
    let c = l.min(l.max(v, l.splat(lo)), l.splat(hi));
    l.trunc(l.add(c, c))
}

#[inline(always)]
pub(super) fn out<L: Lanes>(l: L, v: L::F) -> [f32; 8] {
    let mut a = [0.0; 8];
    l.store(v, &mut a);
    a
}
