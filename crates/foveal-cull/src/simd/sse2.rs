//! SSE2, which every x86-64 CPU has: blocks in 128-bit registers, where the compiler does not see by itself how to
//! use them. All else is as the portable lanes have it.

use super::portable::{Portable, SAMPLE_ROWS};
use super::wide::Twice;
use super::{Lanes, four};
use crate::Aabb;
use crate::depth::CODE_OFFSET;
use core::arch::x86_64::*;

/// SSE2 lanes.
#[derive(Clone, Copy)]
pub(crate) struct Sse2;

/// `[e(0), ..., e(7)]`, as [`four!`].
macro_rules! eight {
    ($k:ident => $e:expr) => {{
        let [a, b, c, d] = four!($k => $e);
        let [e, f, g, h] = four!(j => { let $k = j + 4; $e });
        [a, b, c, d, e, f, g, h]
    }};
}

/// Wraps intrinsics.
macro_rules! sse2 {
    ($e:expr) => {
        // SAFETY: every x86-64 CPU has SSE2; loads and stores stay within arrays and slices of the size they need.
        unsafe { $e }
    };
}

/// Methods that need nothing of their own.
macro_rules! as_portable {
    ($($name:ident($($arg:ident: $type:ty),*) $(-> $out:ty)?;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($arg: $type),*) $(-> $out)? {
                Portable.$name($($arg),*)
            }
        )*
    };
}

/// Asks for every line of cache that `soon` begins.
#[inline(always)]
pub(super) fn prefetch<T>(soon: &T) {
    let start: *const i8 = core::ptr::from_ref(soon).cast();
    for line in 0..size_of::<T>().div_ceil(64) {
        sse2!(_mm_prefetch::<_MM_HINT_T0>(start.add(64 * line)));
    }
}

impl Lanes for Sse2 {
    type F = [f32; 8];
    type I = [i32; 8];
    type Q = [f64; 4];
    type D = [__m128i; 8];
    type R = [__m128; 8];
    type P = [u64; 16];
    type W = Twice<Self>;

    #[inline(always)]
    fn wide(self) -> Self::W {
        Twice(self)
    }
    #[inline(always)]
    fn prefetch<T>(self, soon: &T) {
        prefetch(soon);
    }

    as_portable! {
    splat(v: f32) -> [f32; 8];
    load(v: &[f32; 8]) -> [f32; 8];
    store(v: [f32; 8], to: &mut [f32; 8]);
    add(a: [f32; 8], b: [f32; 8]) -> [f32; 8];
    sub(a: [f32; 8], b: [f32; 8]) -> [f32; 8];
    mul(a: [f32; 8], b: [f32; 8]) -> [f32; 8];
    div(a: [f32; 8], b: [f32; 8]) -> [f32; 8];
    min(a: [f32; 8], b: [f32; 8]) -> [f32; 8];
    max(a: [f32; 8], b: [f32; 8]) -> [f32; 8];
    abs(a: [f32; 8]) -> [f32; 8];
    lt(a: [f32; 8], b: [f32; 8]) -> [i32; 8];
    select(mask: [i32; 8], a: [f32; 8], b: [f32; 8]) -> [f32; 8];
    trunc(a: [f32; 8]) -> [i32; 8];
    codes(a: [f32; 8]) -> [i32; 8];
    gather(table: &[f32; 256], index: &[u8; 8]) -> [f32; 8];
    turn(v: &[Aabb; 8]) -> [[f32; 8]; 6];
    isplat(v: i32) -> [i32; 8];
    iadd(a: [i32; 8], b: [i32; 8]) -> [i32; 8];
    imin(a: [i32; 8], b: [i32; 8]) -> [i32; 8];
    imax(a: [i32; 8], b: [i32; 8]) -> [i32; 8];
    imul(a: [i32; 8], b: [i32; 8]) -> [i32; 8];
    ishr(a: [i32; 8], by: [i32; 8]) -> [i32; 8];
    ibits(a: [i32; 8]) -> [i32; 8];
    iload(v: &[i32; 8]) -> [i32; 8];
    istore(v: [i32; 8], to: &mut [i32; 8]);
    isub(a: [i32; 8], b: [i32; 8]) -> [i32; 8];
    iand(a: [i32; 8], b: [i32; 8]) -> [i32; 8];
    ior(a: [i32; 8], b: [i32; 8]) -> [i32; 8];
    iandnot(a: [i32; 8], b: [i32; 8]) -> [i32; 8];
    movemask(a: [i32; 8]) -> u32;
    qgather(table: &[f64; 256], index: [u8; 4]) -> [f64; 4];
    qload(v: &[f64; 4]) -> [f64; 4];
    qstore(v: [f64; 4], to: &mut [f64; 4]);
    qsplat(v: f64) -> [f64; 4];
    qadd(a: [f64; 4], b: [f64; 4]) -> [f64; 4];
    qsub(a: [f64; 4], b: [f64; 4]) -> [f64; 4];
    qmul(a: [f64; 4], b: [f64; 4]) -> [f64; 4];
    qdiv(a: [f64; 4], b: [f64; 4]) -> [f64; 4];
    qabs(a: [f64; 4]) -> [f64; 4];
    qlt(a: [f64; 4], b: [f64; 4]) -> u32;
    qpick(v: [f64; 4], from: [u8; 4]) -> [f64; 4];
    qround(v: [f64; 4]) -> [f32; 4];
    unsure(from: [f32; 8], to: [f32; 8], error: f32) -> bool;
    plane(from: [f32; 8], to: [f32; 8]) -> u64;
    pload(v: &[u64; 16]) -> [u64; 16];
    pstore(v: [u64; 16], to: &mut [u64; 16]);
    pkeep(v: [u64; 16], bits: u64) -> [u64; 16];
    por(a: [u64; 16], b: [u64; 16]) -> [u64; 16];
    pall(v: [u64; 16]) -> u64;
    pany(v: [u64; 16]) -> u64;
    }

    #[inline(always)]
    fn depths(self, columns: [f32; 8], down: f32, floor: f32, cap: i16) -> Self::D {
        sse2!({
            let columns = [floats(&columns, 0), floats(&columns, 4)];
            let (floor, cap) = (_mm_set1_ps(floor), _mm_set1_epi16(cap));
            let offset = _mm_set1_epi32(CODE_OFFSET);
            eight!(row => {
                let down = _mm_set1_ps(row as f32 * down);
                let code = |half: usize| {
                    let v = _mm_max_ps(_mm_add_ps(columns[half], down), floor);
                    _mm_sub_epi32(_mm_srai_epi32::<12>(_mm_castps_si128(v)), offset)
                };
                _mm_min_epi16(_mm_packs_epi32(code(0), code(1)), cap)
            })
        })
    }
    #[inline(always)]
    fn dload(self, v: &[i16; 64]) -> Self::D {
        sse2!({
            let p: *const __m128i = v.as_ptr().cast();
            eight!(i => _mm_loadu_si128(p.add(i)))
        })
    }
    #[inline(always)]
    fn dstore(self, v: Self::D, to: &mut [i16; 64]) {
        sse2!({
            let p: *mut __m128i = to.as_mut_ptr().cast();
            eight!(i => _mm_storeu_si128(p.add(i), v[i]));
        })
    }
    #[inline(always)]
    fn dsplat(self, v: i16) -> Self::D {
        sse2!([_mm_set1_epi16(v); 8])
    }
    #[inline(always)]
    fn dmin(self, a: Self::D, b: Self::D) -> Self::D {
        sse2!(eight!(i => _mm_min_epi16(a[i], b[i])))
    }
    #[inline(always)]
    fn dmax(self, a: Self::D, b: Self::D) -> Self::D {
        sse2!(eight!(i => _mm_max_epi16(a[i], b[i])))
    }
    #[inline(always)]
    fn dgt(self, a: Self::D, b: Self::D) -> u64 {
        sse2!({
            let pair = |i: usize| {
                let (low, high) = (
                    _mm_cmpgt_epi16(a[i], b[i]),
                    _mm_cmpgt_epi16(a[i + 1], b[i + 1]),
                );
                u64::from(_mm_movemask_epi8(_mm_packs_epi16(low, high)) as u16) << (8 * i)
            };
            pair(0) | pair(2) | pair(4) | pair(6)
        })
    }
    #[inline(always)]
    fn dapart(self, a: Self::D, b: Self::D, by: i16) -> u64 {
        let distance = sse2!(eight!(i => {
            _mm_max_epi16(_mm_subs_epi16(a[i], b[i]), _mm_subs_epi16(b[i], a[i]))
        }));
        self.dgt(distance, self.dsplat(by))
    }
    #[inline(always)]
    fn dselect(self, bits: u64, a: Self::D, b: Self::D) -> Self::D {
        sse2!({
            let bit = _mm_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128);
            eight!(i => {
                let bits = _mm_set1_epi16((bits >> (8 * i)) as i16);
                let mask = _mm_cmpeq_epi16(_mm_and_si128(bits, bit), bit);
                _mm_or_si128(_mm_and_si128(mask, a[i]), _mm_andnot_si128(mask, b[i]))
            })
        })
    }
    #[inline(always)]
    fn dreduce_min(self, a: Self::D) -> i16 {
        sse2!({
            let m = four!(i => _mm_min_epi16(a[i], a[i + 4]));
            let m = _mm_min_epi16(_mm_min_epi16(m[0], m[1]), _mm_min_epi16(m[2], m[3]));
            let m = _mm_min_epi16(m, _mm_srli_si128::<8>(m));
            let m = _mm_min_epi16(m, _mm_srli_si128::<4>(m));
            _mm_cvtsi128_si32(_mm_min_epi16(m, _mm_srli_si128::<2>(m))) as i16
        })
    }

    #[inline(always)]
    fn rsplat(self, v: f32) -> Self::R {
        sse2!([_mm_set1_ps(v); 8])
    }
    #[inline(always)]
    fn rows(self, slope: f32) -> Self::R {
        sse2!(eight!(i => _mm_mul_ps(floats(&SAMPLE_ROWS, 4 * i), _mm_set1_ps(slope))))
    }
    #[inline(always)]
    fn radd(self, a: Self::R, b: Self::R) -> Self::R {
        sse2!(eight!(i => _mm_add_ps(a[i], b[i])))
    }
    #[inline(always)]
    fn rmin(self, a: Self::R, b: Self::R) -> Self::R {
        sse2!(eight!(i => _mm_min_ps(a[i], b[i])))
    }
    #[inline(always)]
    fn rmax(self, a: Self::R, b: Self::R) -> Self::R {
        sse2!(eight!(i => _mm_max_ps(a[i], b[i])))
    }
    #[inline(always)]
    fn rload(self, v: &[f32; 32]) -> Self::R {
        eight!(i => floats(v, 4 * i))
    }
    #[inline(always)]
    fn rlimit(self, v: Self::R, first: f32, after: f32, last: f32) -> Self::R {
        sse2!({
            eight!(i => {
                let y = _mm_add_ps(_mm_set1_ps(first), floats(&SAMPLE_ROWS, 4 * i));
                let inside = _mm_and_ps(
                    _mm_cmplt_ps(_mm_set1_ps(after), y),
                    _mm_cmple_ps(y, _mm_set1_ps(last)),
                );
                _mm_or_ps(_mm_and_ps(inside, v[i]), _mm_andnot_ps(inside, _mm_set1_ps(1e6)))
            })
        })
    }
    #[inline(always)]
    fn runsure(self, from: Self::R, to: Self::R, error: f32) -> bool {
        sse2!({
            let least = eight!(i => _mm_min_ps(near_whole(from[i]), near_whole(to[i])));
            let least = four!(i => _mm_min_ps(least[i], least[i + 4]));
            let least = _mm_min_ps(
                _mm_min_ps(least[0], least[1]),
                _mm_min_ps(least[2], least[3]),
            );
            _mm_movemask_ps(_mm_cmplt_ps(least, _mm_set1_ps(error))) != 0
        })
    }
    #[inline(always)]
    fn planes(self, from: Self::R, to: Self::R) -> Self::P {
        sse2!({
            let sides = [numbers(from), numbers(to)];
            // Four rows in a register, a byte per column of samples; turned over, four columns of eight rows.
            let mut planes = [0; 16];
            for k in 0..4 {
                let row = |i: usize| {
                    let n = |side: usize| {
                        super::portable::FROM[usize::from(sides[side][8 * k + i] & 63)]
                    };
                    (n(0) & !n(1)) as i32
                };
                let low = _mm_setr_epi32(row(0), row(1), row(2), row(3));
                let high = _mm_setr_epi32(row(4), row(5), row(6), row(7));
                // Three rounds of shuffling bring the four bytes of a row eight bytes apart.
                let (a, b) = (_mm_unpacklo_epi8(low, high), _mm_unpackhi_epi8(low, high));
                let (c, d) = (_mm_unpacklo_epi8(a, b), _mm_unpackhi_epi8(a, b));
                let (e, f) = (_mm_unpacklo_epi8(c, d), _mm_unpackhi_epi8(c, d));
                let mut columns = [[0u64; 2]; 2];
                for (columns, v) in columns.iter_mut().zip([e, f]) {
                    columns[0] = _mm_cvtsi128_si64(v) as u64;
                    columns[1] = _mm_cvtsi128_si64(_mm_unpackhi_epi64(v, v)) as u64;
                }
                for (column, bits) in columns.as_flattened().iter().enumerate() {
                    planes[4 * column + k] = *bits;
                }
            }
            planes
        })
    }
}

/// Four numbers of a list from `at` on.
#[inline(always)]
fn floats(v: &[f32], at: usize) -> __m128 {
    sse2!({
        let v = &v[at..at + 4];
        _mm_loadu_ps(v.as_ptr())
    })
}

/// Half a step beyond the numbers that count at most, where rounding is no question.
#[inline(always)]
fn clamped(v: __m128) -> __m128 {
    sse2!(_mm_min_ps(
        _mm_max_ps(v, _mm_set1_ps(-0.5)),
        _mm_set1_ps(32.5)
    ))
}

/// Distance to the nearest whole number.
#[inline(always)]
fn near_whole(v: __m128) -> __m128 {
    sse2!({
        let v = clamped(v);
        let whole = _mm_cvtepi32_ps(_mm_cvtps_epi32(v));
        _mm_andnot_ps(_mm_set1_ps(-0.0), _mm_sub_ps(v, whole))
    })
}

/// Numbers from 0 to 32.
#[inline(always)]
fn numbers(v: [__m128; 8]) -> [u8; 32] {
    sse2!({
        let n = eight!(i => _mm_cvttps_epi32(clamped(v[i])));
        let half = |i: usize| {
            _mm_packus_epi16(
                _mm_packs_epi32(n[i], n[i + 1]),
                _mm_packs_epi32(n[i + 2], n[i + 3]),
            )
        };
        let mut to = [0; 32];
        let p: *mut __m128i = to.as_mut_ptr().cast();
        _mm_storeu_si128(p, half(0));
        _mm_storeu_si128(p.add(1), half(4));
        to
    })
}
