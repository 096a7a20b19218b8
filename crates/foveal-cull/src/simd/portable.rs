//! The portable lanes: arrays and loops. The meaning of every operation is defined here.

use super::arrays::{larger, smaller};
use super::lanes::{Lanes, Vectors};
use super::twice::Twice;
use crate::bounds::Aabb;
use crate::format::CODE_OFFSET;
use core::array::from_fn;

/// Rows of samples, those that are first, second and so on in their pixel together; then the rows
/// through pixel centres.
pub(super) const ROWS: [f64; 40] = {
    let mut rows = [0.0; 40];
    let mut i = 0;
    while i < 8 {
        let mut k = 0;
        while k < 4 {
            rows[8 * k + i] = (4 * i + k) as f64;
            k += 1;
        }
        rows[32 + i] = 4.0 * i as f64 + 1.5;
        i += 1;
    }
    rows
};

/// Plain arrays.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

/// Pixels at or right of the n-th of their row.
pub(super) const PIXELS_FROM: [u8; 16] = [
    0xff, 0xfe, 0xfc, 0xf8, 0xf0, 0xe0, 0xc0, 0x80, 0, 0, 0, 0, 0, 0, 0, 0,
];

/// Pixels whose sample is at or right of the n-th of their row: a byte per sample column.
pub(super) const FROM: [u32; 64] = {
    let mut from = [0; 64];
    let mut n = 0;
    while n <= 32 {
        let mut column = 0;
        while column < 4 {
            from[n] |= (PIXELS_FROM[(n + 3 - column) >> 2] as u32) << (8 * column);
            column += 1;
        }
        n += 1;
    }
    from
};

/// Beyond all that is on the screen, either way.
pub(super) const FAR: f64 = (1 << 28) as f64;

/// The first sample, or pixel by its centre, of row `i` that is right of an edge.
#[inline(always)]
fn number(v: f64, i: usize) -> i32 {
    // The centre of pixel n is at sample 4 n + 1.5 of the row.
    let v = if i < 32 { v } else { (v + 1.5) * 0.25 };
    smaller(larger(v, -FAR), FAR) as i32
}

impl Vectors<8> for Portable {
    type F = [f32; 8];
    type I = [i32; 8];
    type M = [i32; 8];

    #[inline(always)]
    fn fsplat(self, v: f32) -> Self::F {
        [v; 8]
    }
    #[inline(always)]
    fn fload(self, v: &[f32; 8]) -> Self::F {
        *v
    }
    #[inline(always)]
    fn fstore(self, v: Self::F, to: &mut [f32; 8]) {
        *to = v;
    }
    #[inline(always)]
    fn fadd(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    fn fsub(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    fn fmul(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] * b[i])
    }
    #[inline(always)]
    fn fdiv(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] / b[i])
    }
    #[inline(always)]
    fn fmin(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn fmax(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn fabs(self, a: Self::F) -> Self::F {
        from_fn(|i| a[i].abs())
    }
    #[inline(always)]
    fn flt(self, a: Self::F, b: Self::F) -> Self::I {
        from_fn(|i| -i32::from(a[i] < b[i]))
    }
    #[inline(always)]
    fn fselect(self, mask: Self::I, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if mask[i] < 0 { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn ftrunc(self, a: Self::F) -> Self::I {
        from_fn(|i| {
            if a[i].abs() < 2_147_483_648.0 {
                a[i] as i32
            } else {
                i32::MIN
            }
        })
    }
    #[inline(always)]
    fn fcodes(self, a: Self::F) -> Self::I {
        from_fn(|i| ((a[i].to_bits() as i32) >> 12).wrapping_sub(CODE_OFFSET))
    }
    #[inline(always)]
    fn isplat(self, v: i32) -> Self::I {
        [v; 8]
    }
    #[inline(always)]
    fn ftranspose(self, v: &[Aabb; 8]) -> [Self::F; 6] {
        from_fn(|k| from_fn(|i| if k < 3 { v[i].min[k] } else { v[i].max[k - 3] }))
    }
    #[inline(always)]
    fn iadd(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i].wrapping_add(b[i]))
    }
    #[inline(always)]
    fn imin(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i].min(b[i]))
    }
    #[inline(always)]
    fn imax(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i].max(b[i]))
    }
    #[inline(always)]
    fn imul(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i].wrapping_mul(b[i]))
    }
    #[inline(always)]
    fn ishr(self, a: Self::I, by: Self::I) -> Self::I {
        from_fn(|i| a[i] >> (by[i] & 31))
    }
    #[inline(always)]
    fn ibits(self, a: Self::I) -> Self::I {
        a.map(|v| (32 - v.leading_zeros()) as i32)
    }
    #[inline(always)]
    fn iload(self, v: &[i32; 8]) -> Self::I {
        *v
    }
    #[inline(always)]
    fn istore(self, v: Self::I, to: &mut [i32; 8]) {
        *to = v;
    }
    #[inline(always)]
    fn isub(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i].wrapping_sub(b[i]))
    }
    #[inline(always)]
    fn mand(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i] & b[i])
    }
    #[inline(always)]
    fn mor(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i] | b[i])
    }
    #[inline(always)]
    fn mandnot(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| !a[i] & b[i])
    }
    #[inline(always)]
    fn mbits(self, a: Self::I) -> u32 {
        (0..8).fold(0, |m, i| m | (u32::from(a[i] < 0) << i))
    }
    #[inline(always)]
    fn ilt(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| -i32::from(a[i] < b[i]))
    }
    #[inline(always)]
    fn mall(self) -> Self::I {
        self.isplat(-1)
    }
}

impl Lanes for Portable {
    type Q = [f64; 4];
    type D = [i16; 64];
    type S = [[i32; 40]; 2];
    type B = [[f64; 40]; 4];
    type P = [u64; 16];
    type W = Twice<Self>;
    #[inline(always)]
    fn wide(self) -> Self::W {
        Twice(self)
    }
    #[inline(always)]
    fn fgather(self, table: &[f32; 256], index: &[u8; 8]) -> Self::F {
        from_fn(|i| table[usize::from(index[i])])
    }
    #[inline(always)]
    fn qgather(self, table: &[f64; 256], index: [u8; 4]) -> Self::Q {
        index.map(|i| table[usize::from(i)])
    }
    #[inline(always)]
    fn qload(self, v: &[f64; 4]) -> Self::Q {
        *v
    }
    #[inline(always)]
    fn qstore(self, v: Self::Q, to: &mut [f64; 4]) {
        *to = v;
    }
    #[inline(always)]
    fn qsplat(self, v: f64) -> Self::Q {
        [v; 4]
    }
    #[inline(always)]
    fn qadd(self, a: Self::Q, b: Self::Q) -> Self::Q {
        from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    fn qsub(self, a: Self::Q, b: Self::Q) -> Self::Q {
        from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    fn qmul(self, a: Self::Q, b: Self::Q) -> Self::Q {
        from_fn(|i| a[i] * b[i])
    }
    #[inline(always)]
    fn qdiv(self, a: Self::Q, b: Self::Q) -> Self::Q {
        from_fn(|i| a[i] / b[i])
    }
    #[inline(always)]
    fn qabs(self, a: Self::Q) -> Self::Q {
        a.map(f64::abs)
    }
    #[inline(always)]
    fn qlt(self, a: Self::Q, b: Self::Q) -> u32 {
        (0..4).fold(0, |m, i| m | (u32::from(a[i] < b[i]) << i))
    }
    #[inline(always)]
    fn qpick(self, v: Self::Q, from: [u8; 4]) -> Self::Q {
        from.map(|i| v[usize::from(i & 3)])
    }
    #[inline(always)]
    fn dplane(self, columns: [f32; 8], down: f32, floor: f32, cap: i16) -> Self::D {
        from_fn(|i| {
            let v = columns[i % 8] + (i / 8) as f32 * down;
            let v = if v > floor { v } else { floor };
            let code = ((v.to_bits() as i32) >> 12) - CODE_OFFSET;
            (code.clamp(-32768, 32767) as i16).min(cap)
        })
    }
    #[inline(always)]
    fn dload(self, v: &[i16; 64]) -> Self::D {
        *v
    }
    #[inline(always)]
    fn dstore(self, v: Self::D, to: &mut [i16; 64]) {
        *to = v;
    }
    #[inline(always)]
    fn dsplat(self, v: i16) -> Self::D {
        [v; 64]
    }
    #[inline(always)]
    fn dmin(self, a: Self::D, b: Self::D) -> Self::D {
        from_fn(|i| a[i].min(b[i]))
    }
    #[inline(always)]
    fn dmax(self, a: Self::D, b: Self::D) -> Self::D {
        from_fn(|i| a[i].max(b[i]))
    }
    #[inline(always)]
    fn dgt(self, a: Self::D, b: Self::D) -> u64 {
        let mut bits = [0; 8];
        for (row, bits) in bits.iter_mut().enumerate() {
            // Bytes of 0 or 1, gathered into one by a product.
            let mut ones = [0u8; 8];
            for (column, one) in ones.iter_mut().enumerate() {
                *one = u8::from(a[8 * row + column] > b[8 * row + column]);
            }
            *bits = (u64::from_le_bytes(ones).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8;
        }
        u64::from_le_bytes(bits)
    }
    #[inline(always)]
    fn dapart(self, a: Self::D, b: Self::D, by: i16) -> u64 {
        let distance = |i: usize| a[i].saturating_sub(b[i]).max(b[i].saturating_sub(a[i]));
        self.dgt(from_fn(distance), [by; 64])
    }
    #[inline(always)]
    fn dselect(self, bits: u64, a: Self::D, b: Self::D) -> Self::D {
        let mut selected = [0; 64];
        for (row, bits) in bits.to_le_bytes().into_iter().enumerate() {
            let bits = i16::from(bits);
            for column in 0..8 {
                let (i, bit) = (8 * row + column, 1 << column);
                let mask = if bits & bit == bit { -1i16 } else { 0 };
                selected[i] = (mask & a[i]) | (!mask & b[i]);
            }
        }
        selected
    }
    #[inline(always)]
    fn dreduce_min(self, a: Self::D) -> i16 {
        a.iter().fold(i16::MAX, |m, &v| m.min(v))
    }
    #[inline(always)]
    fn qrows(self, slope: [f64; 4]) -> Self::B {
        slope.map(|slope| ROWS.map(|row| row * slope))
    }
    #[inline(always)]
    fn qspans(self, at: [f64; 4], edges: &Self::B, limits: Option<[f64; 2]>) -> Self::S {
        let edge = |e: usize, i: usize| at[e] + edges[e][i];
        let mut spans = [[0; 40]; 2];
        for i in 0..40 {
            let inside = limits.is_none_or(|[after, last]| after < ROWS[i] && ROWS[i] <= last);
            let from = larger(edge(0, i), edge(1, i));
            spans[0][i] = number(if inside { from } else { FAR }, i);
            spans[1][i] = number(smaller(edge(2, i), edge(3, i)), i);
        }
        spans
    }
    #[inline(always)]
    fn pwithin(self, [from, to]: &Self::S, left: u32) -> (Self::P, u64) {
        let left = left as i32;
        let sample = |n: i32| (n - left).clamp(0, 32) as usize;
        // A byte per column of samples.
        let rows: [u32; 32] = from_fn(|i| FROM[sample(from[i]) & 63] & !FROM[sample(to[i]) & 63]);
        let mut planes = [0; 16];
        for k in 0..4 {
            let rows: &[u32; 8] = &from_fn(|i| rows[8 * k + i]);
            for column in 0..4 {
                planes[4 * column + k] =
                    u64::from_le_bytes(from_fn(|i| (rows[i] >> (8 * column)) as u8));
            }
        }
        let pixel = |side: &[i32; 40]| from_fn(|i| side[32 + i] - left / 4);
        (planes, self.irows(pixel(from), pixel(to)))
    }
    #[inline(always)]
    fn irows(self, from: [i32; 8], to: [i32; 8]) -> u64 {
        let pixels = |n: i32| (0xff_u32 << n.clamp(0, 8)) as u8;
        u64::from_le_bytes(from_fn(|i| pixels(from[i]) & !pixels(to[i])))
    }
    #[inline(always)]
    fn pload(self, v: &[u64; 16]) -> Self::P {
        *v
    }
    #[inline(always)]
    fn pstore(self, v: Self::P, to: &mut [u64; 16]) {
        *to = v;
    }
    #[inline(always)]
    fn pkeep(self, v: Self::P, bits: u64) -> Self::P {
        v.map(|plane| plane & bits)
    }
    #[inline(always)]
    fn por(self, a: Self::P, b: Self::P) -> Self::P {
        from_fn(|i| a[i] | b[i])
    }
    #[inline(always)]
    fn pall(self, v: Self::P) -> u64 {
        v.iter().fold(u64::MAX, |all, plane| all & plane)
    }
    #[inline(always)]
    fn pany(self, v: Self::P) -> u64 {
        v.iter().fold(0, |any, plane| any | plane)
    }
    #[inline(always)]
    fn mload(self, v: &[i32; 8]) -> Self::M {
        self.iload(v)
    }
    #[inline(always)]
    fn mstore(self, v: Self::M, to: &mut [i32; 8]) {
        self.istore(v, to);
    }
}
