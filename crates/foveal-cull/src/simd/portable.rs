//! The portable lanes: arrays and loops. The meaning of every operation is defined here.

use super::Lanes;
use core::array::from_fn;

/// Plain arrays.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

impl Lanes for Portable {
    type F = [f32; 8];
    type I = [i32; 8];
    type H = [i16; 16];
    type B = [u8; 32];

    #[inline(always)]
    fn splat(self, v: f32) -> Self::F {
        [v; 8]
    }
    #[inline(always)]
    fn load(self, v: &[f32; 8]) -> Self::F {
        *v
    }
    #[inline(always)]
    fn store(self, v: Self::F, to: &mut [f32; 8]) {
        *to = v;
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] * b[i])
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] / b[i])
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn abs(self, a: Self::F) -> Self::F {
        from_fn(|i| a[i].abs())
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::I {
        from_fn(|i| -i32::from(a[i] < b[i]))
    }
    #[inline(always)]
    fn select(self, mask: Self::I, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if mask[i] < 0 { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn trunc(self, a: Self::F) -> Self::I {
        from_fn(|i| {
            if a[i].abs() < 2_147_483_648.0 {
                a[i] as i32
            } else {
                i32::MIN
            }
        })
    }
    #[inline(always)]
    fn bits(self, a: Self::F) -> Self::I {
        from_fn(|i| a[i].to_bits() as i32)
    }
    #[inline(always)]
    fn gather(self, table: &[f32; 256], index: &[u8; 8]) -> Self::F {
        from_fn(|i| table[usize::from(index[i])])
    }

    #[inline(always)]
    fn isplat(self, v: i32) -> Self::I {
        [v; 8]
    }
    #[inline(always)]
    fn isub(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i].wrapping_sub(b[i]))
    }
    #[inline(always)]
    fn iand(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i] & b[i])
    }
    #[inline(always)]
    fn ior(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i] | b[i])
    }
    #[inline(always)]
    fn ixor(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| a[i] ^ b[i])
    }
    #[inline(always)]
    fn iandnot(self, a: Self::I, b: Self::I) -> Self::I {
        from_fn(|i| !a[i] & b[i])
    }
    #[inline(always)]
    fn isra12(self, a: Self::I) -> Self::I {
        from_fn(|i| a[i] >> 12)
    }
    #[inline(always)]
    fn movemask(self, a: Self::I) -> u32 {
        (0..8).fold(0, |m, i| m | (u32::from(a[i] < 0) << i))
    }

    #[inline(always)]
    fn pack16(self, a: Self::I, b: Self::I) -> Self::H {
        from_fn(|i| if i < 8 { a[i] } else { b[i - 8] }.clamp(-32768, 32767) as i16)
    }
    #[inline(always)]
    fn hload(self, v: &[i16; 16]) -> Self::H {
        *v
    }
    #[inline(always)]
    fn hstore(self, v: Self::H, to: &mut [i16; 16]) {
        *to = v;
    }
    #[inline(always)]
    fn hsplat(self, v: i16) -> Self::H {
        [v; 16]
    }
    #[inline(always)]
    fn hmin(self, a: Self::H, b: Self::H) -> Self::H {
        from_fn(|i| a[i].min(b[i]))
    }
    #[inline(always)]
    fn hmax(self, a: Self::H, b: Self::H) -> Self::H {
        from_fn(|i| a[i].max(b[i]))
    }
    #[inline(always)]
    fn hgt(self, a: Self::H, b: Self::H) -> Self::H {
        from_fn(|i| -i16::from(a[i] > b[i]))
    }
    #[inline(always)]
    fn hselect(self, mask: Self::H, a: Self::H, b: Self::H) -> Self::H {
        from_fn(|i| (mask[i] & a[i]) | (!mask[i] & b[i]))
    }
    #[inline(always)]
    fn hbits(self, mask: Self::H) -> u16 {
        (0..16).fold(0, |m, i| m | (u16::from(mask[i] < 0) << i))
    }
    #[inline(always)]
    fn hmask(self, bits: u16) -> Self::H {
        from_fn(|i| -(((bits >> i) & 1) as i16))
    }
    #[inline(always)]
    fn hreduce_min(self, a: Self::H) -> i16 {
        a.iter().fold(i16::MAX, |m, &v| m.min(v))
    }

    #[inline(always)]
    fn pack8(self, v: [Self::I; 4]) -> Self::B {
        from_fn(|i| v[i / 8][i % 8] as u8)
    }
    #[inline(always)]
    fn bsplat(self, v: u8) -> Self::B {
        [v; 32]
    }
    #[inline(always)]
    fn badd(self, a: Self::B, b: Self::B) -> Self::B {
        from_fn(|i| a[i].wrapping_add(b[i]))
    }
    #[inline(always)]
    fn band(self, a: Self::B, b: Self::B) -> Self::B {
        from_fn(|i| a[i] & b[i])
    }
    #[inline(always)]
    fn bor(self, a: Self::B, b: Self::B) -> Self::B {
        from_fn(|i| a[i] | b[i])
    }
    #[inline(always)]
    fn bandnot(self, a: Self::B, b: Self::B) -> Self::B {
        from_fn(|i| !a[i] & b[i])
    }
    #[inline(always)]
    fn bshr2(self, a: Self::B) -> Self::B {
        from_fn(|i| a[i] >> 2)
    }
    #[inline(always)]
    fn bgt(self, a: Self::B, b: Self::B) -> Self::B {
        from_fn(|i| if a[i] > b[i] { 0xff } else { 0 })
    }
    #[inline(always)]
    fn bselect(self, mask: Self::B, a: Self::B, b: Self::B) -> Self::B {
        from_fn(|i| (mask[i] & a[i]) | (!mask[i] & b[i]))
    }
    #[inline(always)]
    fn blookup(self, table: &[u8; 16], index: Self::B) -> Self::B {
        from_fn(|i| table[usize::from(index[i] & 15)])
    }
    #[inline(always)]
    fn bload(self, v: &[u64; 4]) -> Self::B {
        from_fn(|i| (v[i / 8] >> (8 * (i % 8))) as u8)
    }
    #[inline(always)]
    fn bstore(self, v: Self::B, to: &mut [u64; 4]) {
        *to = quarters(v);
    }
    #[inline(always)]
    fn band_fold(self, v: Self::B) -> u64 {
        let q = quarters(v);
        (q[0] & q[1]) & (q[2] & q[3])
    }
    #[inline(always)]
    fn bor_fold(self, v: Self::B) -> u64 {
        let q = quarters(v);
        (q[0] | q[1]) | (q[2] | q[3])
    }
    #[inline(always)]
    fn bsplat64(self, v: u64) -> Self::B {
        from_fn(|i| (v >> (8 * (i % 8))) as u8)
    }
}

#[inline(always)]
fn quarters(v: [u8; 32]) -> [u64; 4] {
    from_fn(|q| u64::from_le_bytes(from_fn(|i| v[8 * q + i])))
}
