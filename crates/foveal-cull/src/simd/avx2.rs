//! AVX2 lanes. An [`Avx2`] exists only where the CPU has AVX2, which is what makes its methods sound.

use super::{Kernel, Lanes};
use core::arch::x86_64::*;

/// Proof that the CPU has AVX2.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// The proof, where it holds.
    pub(crate) fn detect() -> Option<Self> {
        (is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("popcnt")
            && is_x86_feature_detected!("lzcnt"))
        .then_some(Self(()))
    }

    /// Runs `kernel` compiled with AVX2 enabled.
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx2,bmi1,popcnt,lzcnt")]
        fn inner<K: Kernel>(lanes: Avx2, kernel: K) -> K::Output {
            kernel.run(lanes)
        }
        // SAFETY: `self` proves that the CPU has these features.
        unsafe { inner(self, kernel) }
    }
}

/// Wraps intrinsics.
macro_rules! avx2 {
    ($e:expr) => {
        // SAFETY: `self` proves AVX2; loads and stores go through references to arrays of the same size.
        unsafe { $e }
    };
}

impl Lanes for Avx2 {
    type F = __m256;
    type I = __m256i;
    type H = __m256i;
    type B = __m256i;

    #[inline(always)]
    fn splat(self, v: f32) -> __m256 {
        avx2!(_mm256_set1_ps(v))
    }
    #[inline(always)]
    fn load(self, v: &[f32; 8]) -> __m256 {
        avx2!(_mm256_loadu_ps(v.as_ptr()))
    }
    #[inline(always)]
    fn store(self, v: __m256, to: &mut [f32; 8]) {
        avx2!(_mm256_storeu_ps(to.as_mut_ptr(), v))
    }
    #[inline(always)]
    fn add(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_add_ps(a, b))
    }
    #[inline(always)]
    fn sub(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_sub_ps(a, b))
    }
    #[inline(always)]
    fn mul(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_mul_ps(a, b))
    }
    #[inline(always)]
    fn div(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_div_ps(a, b))
    }
    #[inline(always)]
    fn min(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_min_ps(a, b))
    }
    #[inline(always)]
    fn max(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_max_ps(a, b))
    }
    #[inline(always)]
    fn abs(self, a: __m256) -> __m256 {
        avx2!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), a))
    }
    #[inline(always)]
    fn lt(self, a: __m256, b: __m256) -> __m256i {
        avx2!(_mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b)))
    }
    #[inline(always)]
    fn select(self, mask: __m256i, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_blendv_ps(b, a, _mm256_castsi256_ps(mask)))
    }
    #[inline(always)]
    fn trunc(self, a: __m256) -> __m256i {
        avx2!(_mm256_cvttps_epi32(a))
    }
    #[inline(always)]
    fn bits(self, a: __m256) -> __m256i {
        avx2!(_mm256_castps_si256(a))
    }
    #[inline(always)]
    fn gather(self, table: &[f32; 256], index: &[u8; 8]) -> __m256 {
        // SAFETY: AVX2 is proved by `self`; eight bytes are read from an array of eight, and a byte is
        // always a valid index into 256 floats.
        unsafe {
            let i = _mm256_cvtepu8_epi32(_mm_loadl_epi64(index.as_ptr().cast()));
            _mm256_i32gather_ps::<4>(table.as_ptr(), i)
        }
    }

    #[inline(always)]
    fn isplat(self, v: i32) -> __m256i {
        avx2!(_mm256_set1_epi32(v))
    }
    #[inline(always)]
    fn isub(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_sub_epi32(a, b))
    }
    #[inline(always)]
    fn iand(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_and_si256(a, b))
    }
    #[inline(always)]
    fn ior(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_or_si256(a, b))
    }
    #[inline(always)]
    fn ixor(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_xor_si256(a, b))
    }
    #[inline(always)]
    fn iandnot(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_andnot_si256(a, b))
    }
    #[inline(always)]
    fn isra12(self, a: __m256i) -> __m256i {
        avx2!(_mm256_srai_epi32::<12>(a))
    }
    #[inline(always)]
    fn movemask(self, a: __m256i) -> u32 {
        avx2!(_mm256_movemask_ps(_mm256_castsi256_ps(a)) as u32)
    }

    #[inline(always)]
    fn pack16(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_permute4x64_epi64::<0b11_01_10_00>(
            _mm256_packs_epi32(a, b)
        ))
    }
    #[inline(always)]
    fn hload(self, v: &[i16; 16]) -> __m256i {
        avx2!(_mm256_loadu_si256(v.as_ptr().cast()))
    }
    #[inline(always)]
    fn hstore(self, v: __m256i, to: &mut [i16; 16]) {
        avx2!(_mm256_storeu_si256(to.as_mut_ptr().cast(), v))
    }
    #[inline(always)]
    fn hsplat(self, v: i16) -> __m256i {
        avx2!(_mm256_set1_epi16(v))
    }
    #[inline(always)]
    fn hmin(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_min_epi16(a, b))
    }
    #[inline(always)]
    fn hmax(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_max_epi16(a, b))
    }
    #[inline(always)]
    fn hgt(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_cmpgt_epi16(a, b))
    }
    #[inline(always)]
    fn hselect(self, mask: __m256i, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_blendv_epi8(b, a, mask))
    }
    #[inline(always)]
    fn hbits(self, mask: __m256i) -> u16 {
        avx2!(_mm_movemask_epi8(_mm_packs_epi16(
            _mm256_castsi256_si128(mask),
            _mm256_extracti128_si256::<1>(mask)
        )) as u16)
    }
    #[inline(always)]
    fn hmask(self, bits: u16) -> __m256i {
        avx2!({
            let lanes = _mm256_setr_epi16(
                1,
                2,
                4,
                8,
                16,
                32,
                64,
                128,
                256,
                512,
                1024,
                2048,
                4096,
                8192,
                16384,
                i16::MIN,
            );
            _mm256_cmpeq_epi16(
                _mm256_and_si256(_mm256_set1_epi16(bits as i16), lanes),
                lanes,
            )
        })
    }
    #[inline(always)]
    fn hreduce_min(self, a: __m256i) -> i16 {
        avx2!({
            // minpos works on unsigned lanes: flip the sign bit.
            let m = _mm_min_epi16(_mm256_castsi256_si128(a), _mm256_extracti128_si256::<1>(a));
            let m = _mm_minpos_epu16(_mm_xor_si128(m, _mm_set1_epi16(i16::MIN)));
            (_mm_cvtsi128_si32(m) as i16) ^ i16::MIN
        })
    }

    #[inline(always)]
    fn pack8(self, v: [__m256i; 4]) -> __m256i {
        avx2!({
            let h = _mm256_packs_epi32(v[0], v[1]);
            let g = _mm256_packs_epi32(v[2], v[3]);
            let b = _mm256_packs_epi16(h, g);
            // Groups of four bytes now come as 0 2 4 6 | 1 3 5 7 (in units of four rows).
            _mm256_permutevar8x32_epi32(b, _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7))
        })
    }
    #[inline(always)]
    fn bsplat(self, v: u8) -> __m256i {
        avx2!(_mm256_set1_epi8(v as i8))
    }
    #[inline(always)]
    fn badd(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_add_epi8(a, b))
    }
    #[inline(always)]
    fn band(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_and_si256(a, b))
    }
    #[inline(always)]
    fn bor(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_or_si256(a, b))
    }
    #[inline(always)]
    fn bandnot(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_andnot_si256(a, b))
    }
    #[inline(always)]
    fn bshr2(self, a: __m256i) -> __m256i {
        avx2!(_mm256_and_si256(
            _mm256_srli_epi16::<2>(a),
            _mm256_set1_epi8(0x3f)
        ))
    }
    #[inline(always)]
    fn bgt(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_cmpgt_epi8(a, b))
    }
    #[inline(always)]
    fn bselect(self, mask: __m256i, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_blendv_epi8(b, a, mask))
    }
    #[inline(always)]
    fn blookup(self, table: &[u8; 16], index: __m256i) -> __m256i {
        avx2!(_mm256_shuffle_epi8(
            _mm256_broadcastsi128_si256(_mm_loadu_si128(table.as_ptr().cast())),
            index
        ))
    }
    #[inline(always)]
    fn bload(self, v: &[u64; 4]) -> __m256i {
        avx2!(_mm256_loadu_si256(v.as_ptr().cast()))
    }
    #[inline(always)]
    fn bstore(self, v: __m256i, to: &mut [u64; 4]) {
        avx2!(_mm256_storeu_si256(to.as_mut_ptr().cast(), v))
    }
    #[inline(always)]
    fn band_fold(self, v: __m256i) -> u64 {
        avx2!({
            let h = _mm_and_si128(_mm256_castsi256_si128(v), _mm256_extracti128_si256::<1>(v));
            _mm_cvtsi128_si64(_mm_and_si128(h, _mm_unpackhi_epi64(h, h))) as u64
        })
    }
    #[inline(always)]
    fn bor_fold(self, v: __m256i) -> u64 {
        avx2!({
            let h = _mm_or_si128(_mm256_castsi256_si128(v), _mm256_extracti128_si256::<1>(v));
            _mm_cvtsi128_si64(_mm_or_si128(h, _mm_unpackhi_epi64(h, h))) as u64
        })
    }
    #[inline(always)]
    fn bsplat64(self, v: u64) -> __m256i {
        avx2!(_mm256_set1_epi64x(v as i64))
    }
}
