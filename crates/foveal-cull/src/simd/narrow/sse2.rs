//! SSE2, which every x86-64 CPU has.

use super::registers::Registers;
use crate::simd::arrays::four;
use core::arch::x86_64::*;

#[derive(Clone, Copy, Default)]
pub(crate) struct Sse2;

/// Wraps intrinsics.
macro_rules! sse2 {
    ($e:expr) => {
        // SAFETY: every x86-64 CPU has SSE2; loads and stores go through references to arrays of
        // the same size.
        unsafe { $e }
    };
}

/// Methods that are one instruction.
macro_rules! instructions {
    ($($name:ident($($arg:ident: $type:ty),*) -> $out:ty = $instruction:expr;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($arg: $type),*) -> $out {
                sse2!($instruction)
            }
        )*
    };
}

/// Asks for every line of cache that `soon` begins.
#[inline(always)]
pub(in crate::simd) fn prefetch<T>(soon: &T) {
    let start: *const i8 = core::ptr::from_ref(soon).cast();
    for line in 0..size_of::<T>().div_ceil(64) {
        // SAFETY: an instruction that every x86-64 CPU has, and that reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(64 * line)) };
    }
}

impl Registers for Sse2 {
    type F = __m128;
    type I = __m128i;
    type Q = __m128d;
    type H = __m128i;
    type B = __m128i;

    instructions! {
        splat(v: f32) -> __m128 = _mm_set1_ps(v);
        load(v: &[f32; 4]) -> __m128 = _mm_loadu_ps(v.as_ptr());
        store(v: __m128, to: &mut [f32; 4]) -> () = _mm_storeu_ps(to.as_mut_ptr(), v);
        add(a: __m128, b: __m128) -> __m128 = _mm_add_ps(a, b);
        sub(a: __m128, b: __m128) -> __m128 = _mm_sub_ps(a, b);
        mul(a: __m128, b: __m128) -> __m128 = _mm_mul_ps(a, b);
        div(a: __m128, b: __m128) -> __m128 = _mm_div_ps(a, b);
        min(a: __m128, b: __m128) -> __m128 = _mm_min_ps(a, b);
        max(a: __m128, b: __m128) -> __m128 = _mm_max_ps(a, b);
        abs(a: __m128) -> __m128 = _mm_andnot_ps(_mm_set1_ps(-0.0), a);
        lt(a: __m128, b: __m128) -> __m128i = _mm_castps_si128(_mm_cmplt_ps(a, b));
        trunc(a: __m128) -> __m128i = _mm_cvttps_epi32(a);
        bits(a: __m128) -> __m128i = _mm_castps_si128(a);
        low_high(a: __m128, b: __m128) -> __m128 = _mm_shuffle_ps::<0b11_10_01_00>(a, b);
        high_low(a: __m128, b: __m128) -> __m128 = _mm_shuffle_ps::<0b01_00_11_10>(a, b);
        evens(a: __m128, b: __m128) -> __m128 = _mm_shuffle_ps::<0b10_00_10_00>(a, b);
        odds(a: __m128, b: __m128) -> __m128 = _mm_shuffle_ps::<0b11_01_11_01>(a, b);

        isplat(v: i32) -> __m128i = _mm_set1_epi32(v);
        iload(v: &[i32; 4]) -> __m128i = _mm_loadu_si128(v.as_ptr().cast());
        istore(v: __m128i, to: &mut [i32; 4]) -> () = _mm_storeu_si128(to.as_mut_ptr().cast(), v);
        iadd(a: __m128i, b: __m128i) -> __m128i = _mm_add_epi32(a, b);
        isub(a: __m128i, b: __m128i) -> __m128i = _mm_sub_epi32(a, b);
        iand(a: __m128i, b: __m128i) -> __m128i = _mm_and_si128(a, b);
        ior(a: __m128i, b: __m128i) -> __m128i = _mm_or_si128(a, b);
        iandnot(a: __m128i, b: __m128i) -> __m128i = _mm_andnot_si128(a, b);
        ilt(a: __m128i, b: __m128i) -> __m128i = _mm_cmplt_epi32(a, b);
        imin(a: __m128i, b: __m128i) -> __m128i = either(_mm_cmplt_epi32(a, b), a, b);
        imax(a: __m128i, b: __m128i) -> __m128i = either(_mm_cmpgt_epi32(a, b), a, b);
        floats(a: __m128i) -> __m128 = _mm_cvtepi32_ps(a);

        qload(v: &[f64; 2]) -> __m128d = _mm_loadu_pd(v.as_ptr());
        qstore(v: __m128d, to: &mut [f64; 2]) -> () = _mm_storeu_pd(to.as_mut_ptr(), v);
        qsplat(v: f64) -> __m128d = _mm_set1_pd(v);
        qadd(a: __m128d, b: __m128d) -> __m128d = _mm_add_pd(a, b);
        qsub(a: __m128d, b: __m128d) -> __m128d = _mm_sub_pd(a, b);
        qmul(a: __m128d, b: __m128d) -> __m128d = _mm_mul_pd(a, b);
        qdiv(a: __m128d, b: __m128d) -> __m128d = _mm_div_pd(a, b);
        qabs(a: __m128d) -> __m128d = _mm_andnot_pd(_mm_set1_pd(-0.0), a);
        qmin(a: __m128d, b: __m128d) -> __m128d = _mm_min_pd(a, b);
        qmax(a: __m128d, b: __m128d) -> __m128d = _mm_max_pd(a, b);
        qwhole(v: [__m128d; 2]) -> __m128i = _mm_unpacklo_epi64(
            _mm_cvttpd_epi32(v[0]), _mm_cvttpd_epi32(v[1])
        );

        hload(v: &[i16; 8]) -> __m128i = _mm_loadu_si128(v.as_ptr().cast());
        hstore(v: __m128i, to: &mut [i16; 8]) -> () = _mm_storeu_si128(to.as_mut_ptr().cast(), v);
        hsplat(v: i16) -> __m128i = _mm_set1_epi16(v);
        hmin(a: __m128i, b: __m128i) -> __m128i = _mm_min_epi16(a, b);
        hmax(a: __m128i, b: __m128i) -> __m128i = _mm_max_epi16(a, b);
        hsub(a: __m128i, b: __m128i) -> __m128i = _mm_subs_epi16(a, b);
        hgt(a: __m128i, b: __m128i) -> __m128i = _mm_cmpgt_epi16(a, b);
        hbytes(a: [__m128i; 2]) -> __m128i = _mm_packus_epi16(a[0], a[1]);
        hpack(a: [__m128i; 2]) -> __m128i = _mm_packs_epi32(a[0], a[1]);

        bload(v: &[u64; 2]) -> __m128i = _mm_loadu_si128(v.as_ptr().cast());
        bstore(v: __m128i, to: &mut [u64; 2]) -> () = _mm_storeu_si128(to.as_mut_ptr().cast(), v);
        bsplat(v: u64) -> __m128i = _mm_set1_epi64x(v as i64);
        band(a: __m128i, b: __m128i) -> __m128i = _mm_and_si128(a, b);
        bor(a: __m128i, b: __m128i) -> __m128i = _mm_or_si128(a, b);
        bandnot(a: __m128i, b: __m128i) -> __m128i = _mm_andnot_si128(a, b);
    }

    #[inline(always)]
    fn prefetch<T>(self, soon: &T) {
        prefetch(soon);
    }
    #[inline(always)]
    fn select(self, mask: __m128i, a: __m128, b: __m128) -> __m128 {
        sse2!({
            let mask = _mm_castsi128_ps(mask);
            _mm_or_ps(_mm_and_ps(mask, a), _mm_andnot_ps(mask, b))
        })
    }
    #[inline(always)]
    fn imul(self, a: __m128i, b: __m128i) -> __m128i {
        // Products of lanes 0 and 2, of which the lower halves count, and of 1 and 3.
        sse2!({
            let even = _mm_mul_epu32(a, b);
            let odd = _mm_mul_epu32(_mm_srli_epi64::<32>(a), _mm_srli_epi64::<32>(b));
            let halves = [even, odd].map(|v| _mm_shuffle_epi32::<0b10_00>(v));
            _mm_unpacklo_epi32(halves[0], halves[1])
        })
    }
    #[inline(always)]
    fn ishr(self, a: __m128i, by: __m128i) -> __m128i {
        // There is only one count for all lanes, the lower half of a register.
        sse2!({
            let high = _mm_unpackhi_epi64(by, by);
            let shifted = [
                _mm_sra_epi32(a, _mm_shufflelo_epi16::<0b01_01_01_00>(by)),
                _mm_sra_epi32(a, _mm_shufflelo_epi16::<0b11_11_11_10>(by)),
                _mm_sra_epi32(a, _mm_shufflelo_epi16::<0b01_01_01_00>(high)),
                _mm_sra_epi32(a, _mm_shufflelo_epi16::<0b11_11_11_10>(high)),
            ];
            let low = _mm_castsi128_ps(_mm_unpacklo_epi64(shifted[0], shifted[1]));
            let high = _mm_castsi128_ps(_mm_unpackhi_epi64(shifted[2], shifted[3]));
            _mm_castps_si128(_mm_shuffle_ps::<0b11_00_11_00>(low, high))
        })
    }
    #[inline(always)]
    fn ishr_all<const BY: i32>(self, a: __m128i) -> __m128i {
        sse2!(_mm_srai_epi32::<BY>(a))
    }
    #[inline(always)]
    fn signs(self, [low, high]: [__m128i; 2]) -> u32 {
        sse2!({
            let [low, high] = [low, high].map(|v| _mm_movemask_ps(_mm_castsi128_ps(v)) as u32);
            low | high << 4
        })
    }
    #[inline(always)]
    fn qlt(self, a: [__m128d; 2], b: [__m128d; 2]) -> u32 {
        sse2!({
            let [low, high] = [0, 1].map(|k| _mm_movemask_pd(_mm_cmplt_pd(a[k], b[k])) as u32);
            low | high << 2
        })
    }
    #[inline(always)]
    fn hmasks(self, bits: u64) -> [__m128i; 8] {
        sse2!({
            // Every byte four times, then each four all over a register.
            let bytes = _mm_cvtsi64_si128(bits as i64);
            let twice = _mm_unpacklo_epi8(bytes, bytes);
            let (low, high) = (
                _mm_unpacklo_epi16(twice, twice),
                _mm_unpackhi_epi16(twice, twice),
            );
            let bit = _mm_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128);
            [
                _mm_shuffle_epi32::<0b00_00_00_00>(low),
                _mm_shuffle_epi32::<0b01_01_01_01>(low),
                _mm_shuffle_epi32::<0b10_10_10_10>(low),
                _mm_shuffle_epi32::<0b11_11_11_11>(low),
                _mm_shuffle_epi32::<0b00_00_00_00>(high),
                _mm_shuffle_epi32::<0b01_01_01_01>(high),
                _mm_shuffle_epi32::<0b10_10_10_10>(high),
                _mm_shuffle_epi32::<0b11_11_11_11>(high),
            ]
            .map(|v| _mm_cmpeq_epi16(_mm_and_si128(v, bit), bit))
        })
    }
    #[inline(always)]
    fn hselect(self, mask: __m128i, a: __m128i, b: __m128i) -> __m128i {
        either(mask, a, b)
    }
    #[inline(always)]
    fn hleast(self, a: __m128i) -> i16 {
        sse2!({
            let m = _mm_min_epi16(a, _mm_srli_si128::<8>(a));
            let m = _mm_min_epi16(m, _mm_srli_si128::<4>(m));
            _mm_cvtsi128_si32(_mm_min_epi16(m, _mm_srli_si128::<2>(m))) as i16
        })
    }
    #[inline(always)]
    fn bhalves(self, a: __m128i) -> [u64; 2] {
        sse2!([a, _mm_unpackhi_epi64(a, a)].map(|v| _mm_cvtsi128_si64(v) as u64))
    }
    #[inline(always)]
    fn hbits(self, masks: [__m128i; 8]) -> u64 {
        let [a, b, c, d] = sse2!(four!(i => {
            let bytes = _mm_packs_epi16(masks[2 * i], masks[2 * i + 1]);
            u64::from(_mm_movemask_epi8(bytes) as u16) << (16 * i)
        }));
        a | b | c | d
    }
    #[inline(always)]
    fn right_of(self, n: __m128i) -> [__m128i; 4] {
        // There is no shift byte by byte and no table. Sample n is in pixel n / 4: its bit is
        // doubled step by step.
        sse2!({
            let of = |v: __m128i, bit: i8| _mm_and_si128(v, _mm_set1_epi8(bit));
            let has = |bit: i8| _mm_cmpeq_epi8(of(n, bit), _mm_set1_epi8(bit));
            let one = _mm_set1_epi8(1);
            let bit = _mm_sub_epi8(one, has(4));
            let bit = either(has(8), _mm_slli_epi16::<2>(bit), bit);
            let bit = either(has(16), _mm_slli_epi16::<4>(bit), bit);
            // Beyond the last pixel there is none.
            let bit = _mm_andnot_si128(has(32), bit);
            // It and all above; but in the columns before that of sample n it is out itself.
            let pixels = _mm_sub_epi8(_mm_setzero_si128(), bit);
            let column = of(n, 3);
            four!(c => {
                let before = _mm_cmpgt_epi8(column, _mm_set1_epi8(c as i8));
                _mm_andnot_si128(_mm_and_si128(before, bit), pixels)
            })
        })
    }
}

/// `a` where the mask is set, else `b`.
#[inline(always)]
fn either(mask: __m128i, a: __m128i, b: __m128i) -> __m128i {
    sse2!(_mm_or_si128(
        _mm_and_si128(mask, a),
        _mm_andnot_si128(mask, b)
    ))
}
