//! Sixteen lanes of AVX-512.

use super::arrays::four;
use super::avx512proof::Avx512;
use super::lanes::{Sixteen, Vectors};
use crate::bounds::Aabb;
use crate::format::CODE_OFFSET;
use core::arch::x86_64::*;

/// An [`Avx512`] proves the features.
#[derive(Clone, Copy)]
pub(crate) struct Wide512(pub(super) Avx512);

/// Wraps intrinsics.
macro_rules! avx512 {
    ($e:expr) => {
        // SAFETY: `self` proves the features; loads and stores go through references to arrays of
        // the same size.
        unsafe { $e }
    };
}

impl Vectors<16> for Wide512 {
    type F = __m512;
    type I = __m512i;
    type M = u16;

    #[inline(always)]
    fn fsplat(self, v: f32) -> __m512 {
        avx512!(_mm512_set1_ps(v))
    }
    #[inline(always)]
    fn fload(self, v: &[f32; 16]) -> __m512 {
        avx512!(_mm512_loadu_ps(v.as_ptr()))
    }
    #[inline(always)]
    fn fstore(self, v: __m512, to: &mut [f32; 16]) {
        avx512!(_mm512_storeu_ps(to.as_mut_ptr(), v))
    }
    #[inline(always)]
    fn fadd(self, a: __m512, b: __m512) -> __m512 {
        avx512!(_mm512_add_ps(a, b))
    }
    #[inline(always)]
    fn fsub(self, a: __m512, b: __m512) -> __m512 {
        avx512!(_mm512_sub_ps(a, b))
    }
    #[inline(always)]
    fn fmul(self, a: __m512, b: __m512) -> __m512 {
        avx512!(_mm512_mul_ps(a, b))
    }
    #[inline(always)]
    fn fdiv(self, a: __m512, b: __m512) -> __m512 {
        avx512!(_mm512_div_ps(a, b))
    }
    #[inline(always)]
    fn fmin(self, a: __m512, b: __m512) -> __m512 {
        avx512!(_mm512_min_ps(a, b))
    }
    #[inline(always)]
    fn fmax(self, a: __m512, b: __m512) -> __m512 {
        avx512!(_mm512_max_ps(a, b))
    }
    #[inline(always)]
    fn fabs(self, a: __m512) -> __m512 {
        avx512!(_mm512_abs_ps(a))
    }
    #[inline(always)]
    fn flt(self, a: __m512, b: __m512) -> u16 {
        avx512!(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b))
    }
    #[inline(always)]
    fn fselect(self, mask: u16, a: __m512, b: __m512) -> __m512 {
        avx512!(_mm512_mask_blend_ps(mask, b, a))
    }
    #[inline(always)]
    fn ftrunc(self, a: __m512) -> __m512i {
        avx512!(_mm512_cvttps_epi32(a))
    }
    #[inline(always)]
    fn fcodes(self, a: __m512) -> __m512i {
        avx512!(_mm512_sub_epi32(
            _mm512_srai_epi32::<12>(_mm512_castps_si512(a)),
            _mm512_set1_epi32(CODE_OFFSET)
        ))
    }
    #[inline(always)]
    fn isplat(self, v: i32) -> __m512i {
        avx512!(_mm512_set1_epi32(v))
    }
    #[inline(always)]
    fn iload(self, v: &[i32; 16]) -> __m512i {
        avx512!(_mm512_loadu_si512(v.as_ptr().cast()))
    }
    #[inline(always)]
    fn istore(self, v: __m512i, to: &mut [i32; 16]) {
        avx512!(_mm512_storeu_si512(to.as_mut_ptr().cast(), v))
    }
    #[inline(always)]
    fn iadd(self, a: __m512i, b: __m512i) -> __m512i {
        avx512!(_mm512_add_epi32(a, b))
    }
    #[inline(always)]
    fn isub(self, a: __m512i, b: __m512i) -> __m512i {
        avx512!(_mm512_sub_epi32(a, b))
    }
    #[inline(always)]
    fn imul(self, a: __m512i, b: __m512i) -> __m512i {
        avx512!(_mm512_mullo_epi32(a, b))
    }
    #[inline(always)]
    fn imin(self, a: __m512i, b: __m512i) -> __m512i {
        avx512!(_mm512_min_epi32(a, b))
    }
    #[inline(always)]
    fn imax(self, a: __m512i, b: __m512i) -> __m512i {
        avx512!(_mm512_max_epi32(a, b))
    }
    #[inline(always)]
    fn ishr(self, a: __m512i, by: __m512i) -> __m512i {
        avx512!(_mm512_srav_epi32(a, by))
    }
    #[inline(always)]
    fn ilt(self, a: __m512i, b: __m512i) -> u16 {
        avx512!(_mm512_cmplt_epi32_mask(a, b))
    }
    #[inline(always)]
    fn ibits(self, a: __m512i) -> __m512i {
        // As for AVX2.
        avx512!({
            let exponent = _mm512_srli_epi32::<23>(_mm512_castps_si512(_mm512_cvtepi32_ps(a)));
            let bits = _mm512_sub_epi32(exponent, _mm512_set1_epi32(126));
            _mm512_max_epi32(bits, _mm512_setzero_si512())
        })
    }
    #[inline(always)]
    fn ftranspose(self, v: &[Aabb; 16]) -> [__m512; 6] {
        // A box is six numbers in a row, nothing else.
        const { assert!(size_of::<Aabb>() == 24 && core::mem::offset_of!(Aabb, max) == 12) };
        let p: *const f32 = v.as_ptr().cast();
        avx512!({
            // Two boxes are twelve numbers: a row of three pieces of four. A register holds the
            // same piece of every fourth row: rows 0, 2, 4, 6 (a) and 1, 3, 5, 7 (b).
            let [a0, a1, a2, _] = four!(i => pieces(self, p, 4 * (i % 3)));
            let [b0, b1, b2, _] = four!(i => pieces(self, p, 12 + 4 * (i % 3)));
            let (xy_a, xy_b) = (
                _mm512_shuffle_ps::<0b11_10_01_00>(a0, a1),
                _mm512_shuffle_ps::<0b11_10_01_00>(b0, b1),
            );
            let (zx_a, zx_b) = (
                _mm512_shuffle_ps::<0b01_00_11_10>(a0, a2),
                _mm512_shuffle_ps::<0b01_00_11_10>(b0, b2),
            );
            let (yz_a, yz_b) = (
                _mm512_shuffle_ps::<0b11_10_01_00>(a1, a2),
                _mm512_shuffle_ps::<0b11_10_01_00>(b1, b2),
            );
            [
                _mm512_shuffle_ps::<0b10_00_10_00>(xy_a, xy_b),
                _mm512_shuffle_ps::<0b11_01_11_01>(xy_a, xy_b),
                _mm512_shuffle_ps::<0b10_00_10_00>(zx_a, zx_b),
                _mm512_shuffle_ps::<0b11_01_11_01>(zx_a, zx_b),
                _mm512_shuffle_ps::<0b10_00_10_00>(yz_a, yz_b),
                _mm512_shuffle_ps::<0b11_01_11_01>(yz_a, yz_b),
            ]
        })
    }
    #[inline(always)]
    fn mall(self) -> u16 {
        u16::MAX
    }
    #[inline(always)]
    fn mand(self, a: u16, b: u16) -> u16 {
        a & b
    }
    #[inline(always)]
    fn mor(self, a: u16, b: u16) -> u16 {
        a | b
    }
    #[inline(always)]
    fn mandnot(self, a: u16, b: u16) -> u16 {
        !a & b
    }
    #[inline(always)]
    fn mbits(self, a: u16) -> u32 {
        u32::from(a)
    }
}

impl Sixteen for Wide512 {
    #[inline(always)]
    fn fpair(self, low: &[f32; 8], high: &[f32; 8]) -> __m512 {
        avx512!({
            let low = _mm512_castps256_ps512(_mm256_loadu_ps(low.as_ptr()));
            _mm512_insertf32x8::<1>(low, _mm256_loadu_ps(high.as_ptr()))
        })
    }
}

/// Four numbers each of a table of 96, at `at` and every 24 further.
#[inline(always)]
fn pieces(_: Wide512, table: *const f32, at: usize) -> __m512 {
    debug_assert!(at + 76 <= 96);
    // SAFETY: the caller holds a `Wide512` and a table of 96, of which this reads no further than
    // `at + 76`.
    unsafe {
        let [a, b, c, d] = four!(k => _mm_loadu_ps(table.add(at + 24 * k)));
        let low = _mm512_insertf32x4::<1>(_mm512_castps128_ps512(a), b);
        _mm512_insertf32x4::<3>(_mm512_insertf32x4::<2>(low, c), d)
    }
}
