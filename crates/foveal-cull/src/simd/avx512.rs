//! AVX-512 lanes: whole blocks in two registers, and masks of 64 pixels as they are. Eight-lane work is AVX2's.
//! An [`Avx512`] exists only where the CPU has all that it needs, which is what makes its methods sound.

use super::avx2::{self, Avx2, FROM};
use super::portable::SAMPLE_ROWS;
use super::{Kernel, Lanes, four, two};
use crate::Aabb;
use crate::depth::CODE_OFFSET;
use core::arch::x86_64::*;

/// Proof that the CPU has AVX-512 F, BW, DQ and VL, and AVX2.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(Avx2);

impl Avx512 {
    /// The proof, where it holds.
    pub(crate) fn detect() -> Option<Self> {
        let all = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        Avx2::detect().filter(|_| all).map(Self)
    }

    /// Runs `kernel` compiled with AVX-512 enabled.
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx2,bmi1,popcnt,lzcnt,avx512f,avx512bw,avx512dq,avx512vl")]
        fn inner<K: Kernel>(lanes: Avx512, kernel: K) -> K::Output {
            kernel.run(lanes)
        }
        // SAFETY: `self` proves that the CPU has these features.
        unsafe { inner(self, kernel) }
    }
}

/// Wraps intrinsics.
macro_rules! avx512 {
    ($e:expr) => {
        // SAFETY: an `Avx512` proves the features; loads and stores go through references to arrays of the
        // same size.
        unsafe { $e }
    };
}

/// Methods that AVX2 has already.
macro_rules! as_avx2 {
    ($($name:ident($($arg:ident: $type:ty),*) $(-> $out:ty)?;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($arg: $type),*) $(-> $out)? {
                self.0.$name($($arg),*)
            }
        )*
    };
}

impl Lanes for Avx512 {
    type F = __m256;
    type I = __m256i;
    type Q = __m256d;
    type D = [__m512i; 2];
    type R = [__m512; 2];
    type P = [__m512i; 2];
    type W = super::avx512x16::Wide512;

    fn apart<K: Kernel>(self, kernel: K) -> K::Output {
        #[inline(never)]
        #[target_feature(enable = "avx2,bmi1,popcnt,lzcnt,avx512f,avx512bw,avx512dq,avx512vl")]
        fn inner<K: Kernel>(lanes: Avx512, kernel: K) -> K::Output {
            kernel.run(lanes)
        }
        // SAFETY: `self` proves that the CPU has these features.
        unsafe { inner(self, kernel) }
    }

    #[inline(always)]
    fn wide(self) -> Self::W {
        super::avx512x16::Wide512(self)
    }
    #[inline(always)]
    fn prefetch<T>(self, soon: &T) {
        super::narrow::sse2::prefetch(soon);
    }

    as_avx2! {
    splat(v: f32) -> __m256;
    load(v: &[f32; 8]) -> __m256;
    store(v: __m256, to: &mut [f32; 8]);
    add(a: __m256, b: __m256) -> __m256;
    sub(a: __m256, b: __m256) -> __m256;
    mul(a: __m256, b: __m256) -> __m256;
    div(a: __m256, b: __m256) -> __m256;
    min(a: __m256, b: __m256) -> __m256;
    max(a: __m256, b: __m256) -> __m256;
    abs(a: __m256) -> __m256;
    lt(a: __m256, b: __m256) -> __m256i;
    select(mask: __m256i, a: __m256, b: __m256) -> __m256;
    trunc(a: __m256) -> __m256i;
    codes(a: __m256) -> __m256i;
    gather(table: &[f32; 256], index: &[u8; 8]) -> __m256;
    isplat(v: i32) -> __m256i;
    qgather(table: &[f64; 256], index: [u8; 4]) -> __m256d;
    qload(v: &[f64; 4]) -> __m256d;
    qstore(v: __m256d, to: &mut [f64; 4]);
    qsplat(v: f64) -> __m256d;
    qadd(a: __m256d, b: __m256d) -> __m256d;
    qsub(a: __m256d, b: __m256d) -> __m256d;
    qmul(a: __m256d, b: __m256d) -> __m256d;
    qdiv(a: __m256d, b: __m256d) -> __m256d;
    qabs(a: __m256d) -> __m256d;
    qlt(a: __m256d, b: __m256d) -> u32;
    qpick(v: __m256d, from: [u8; 4]) -> __m256d;
    qround(v: __m256d) -> [f32; 4];
    iload(v: &[i32; 8]) -> __m256i;
    istore(v: __m256i, to: &mut [i32; 8]);
    unsure(from: __m256, to: __m256, error: f32) -> bool;
    turn(v: &[Aabb; 8]) -> [__m256; 6];
    iadd(a: __m256i, b: __m256i) -> __m256i;
    imin(a: __m256i, b: __m256i) -> __m256i;
    imax(a: __m256i, b: __m256i) -> __m256i;
    imul(a: __m256i, b: __m256i) -> __m256i;
    ishr(a: __m256i, by: __m256i) -> __m256i;
    ibits(a: __m256i) -> __m256i;
    isub(a: __m256i, b: __m256i) -> __m256i;
    iand(a: __m256i, b: __m256i) -> __m256i;
    ior(a: __m256i, b: __m256i) -> __m256i;
    iandnot(a: __m256i, b: __m256i) -> __m256i;
    movemask(a: __m256i) -> u32;
    }

    #[inline(always)]
    fn depths(self, columns: __m256, down: f32, floor: f32, cap: i16) -> Self::D {
        avx512!({
            let columns = _mm512_broadcast_f32x8(columns);
            let (down, floor) = (_mm512_set1_ps(down), _mm512_set1_ps(floor));
            let offset = _mm512_set1_epi32(CODE_OFFSET);
            let first = _mm512_zextps256_ps512(_mm256_setzero_ps());
            let first = _mm512_insertf32x8::<1>(first, _mm256_set1_ps(1.0));
            let rows = four!(i => {
                let rows = _mm512_add_ps(first, _mm512_set1_ps((2 * i) as f32));
                let v = _mm512_add_ps(columns, _mm512_mul_ps(rows, down));
                let bits = _mm512_castps_si512(_mm512_max_ps(v, floor));
                _mm512_cvtsepi32_epi16(_mm512_sub_epi32(_mm512_srai_epi32::<12>(bits), offset))
            });
            two!(i => {
                let codes = _mm512_castsi256_si512(rows[2 * i]);
                let codes = _mm512_inserti64x4::<1>(codes, rows[2 * i + 1]);
                _mm512_min_epi16(codes, _mm512_set1_epi16(cap))
            })
        })
    }
    #[inline(always)]
    fn dload(self, v: &[i16; 64]) -> Self::D {
        load(self, v.as_ptr().cast())
    }
    #[inline(always)]
    fn dstore(self, v: Self::D, to: &mut [i16; 64]) {
        store(self, v, to.as_mut_ptr().cast());
    }
    #[inline(always)]
    fn dsplat(self, v: i16) -> Self::D {
        avx512!([_mm512_set1_epi16(v); 2])
    }
    #[inline(always)]
    fn dmin(self, a: Self::D, b: Self::D) -> Self::D {
        avx512!([_mm512_min_epi16(a[0], b[0]), _mm512_min_epi16(a[1], b[1])])
    }
    #[inline(always)]
    fn dmax(self, a: Self::D, b: Self::D) -> Self::D {
        avx512!([_mm512_max_epi16(a[0], b[0]), _mm512_max_epi16(a[1], b[1])])
    }
    #[inline(always)]
    fn dgt(self, a: Self::D, b: Self::D) -> u64 {
        let [low, high] = avx512!([
            _mm512_cmpgt_epi16_mask(a[0], b[0]),
            _mm512_cmpgt_epi16_mask(a[1], b[1])
        ]);
        u64::from(low) | (u64::from(high) << 32)
    }
    #[inline(always)]
    fn dapart(self, a: Self::D, b: Self::D, by: i16) -> u64 {
        let distance = avx512!(two!(i => {
            _mm512_max_epi16(_mm512_subs_epi16(a[i], b[i]), _mm512_subs_epi16(b[i], a[i]))
        }));
        self.dgt(distance, self.dsplat(by))
    }
    #[inline(always)]
    fn dselect(self, bits: u64, a: Self::D, b: Self::D) -> Self::D {
        avx512!([
            _mm512_mask_blend_epi16(bits as u32, b[0], a[0]),
            _mm512_mask_blend_epi16((bits >> 32) as u32, b[1], a[1])
        ])
    }
    #[inline(always)]
    fn dreduce_min(self, a: Self::D) -> i16 {
        avx512!({
            let m = _mm512_min_epi16(a[0], a[1]);
            let m = _mm256_min_epi16(_mm512_castsi512_si256(m), _mm512_extracti64x4_epi64::<1>(m));
            let m = _mm_min_epi16(_mm256_castsi256_si128(m), _mm256_extracti128_si256::<1>(m));
            // The one horizontal minimum there is works on unsigned lanes.
            let m = _mm_minpos_epu16(_mm_xor_si128(m, _mm_set1_epi16(i16::MIN)));
            (_mm_cvtsi128_si32(m) as i16) ^ i16::MIN
        })
    }

    #[inline(always)]
    fn rsplat(self, v: f32) -> Self::R {
        avx512!([_mm512_set1_ps(v); 2])
    }
    #[inline(always)]
    fn rows(self, slope: f32) -> Self::R {
        let rows = sample_rows(self);
        avx512!(two!(k => _mm512_mul_ps(rows[k], _mm512_set1_ps(slope))))
    }
    #[inline(always)]
    fn radd(self, a: Self::R, b: Self::R) -> Self::R {
        avx512!([_mm512_add_ps(a[0], b[0]), _mm512_add_ps(a[1], b[1])])
    }
    #[inline(always)]
    fn rmin(self, a: Self::R, b: Self::R) -> Self::R {
        avx512!([_mm512_min_ps(a[0], b[0]), _mm512_min_ps(a[1], b[1])])
    }
    #[inline(always)]
    fn rmax(self, a: Self::R, b: Self::R) -> Self::R {
        avx512!([_mm512_max_ps(a[0], b[0]), _mm512_max_ps(a[1], b[1])])
    }
    #[inline(always)]
    fn rload(self, v: &[f32; 32]) -> Self::R {
        let p = v.as_ptr();
        avx512!([_mm512_loadu_ps(p), _mm512_loadu_ps(p.add(16))])
    }
    #[inline(always)]
    fn runsure(self, from: Self::R, to: Self::R, error: f32) -> bool {
        avx512!({
            let least = two!(k => _mm512_min_ps(
                near_whole(self, clamped(self, from[k])),
                near_whole(self, clamped(self, to[k])),
            ));
            let least = _mm512_min_ps(least[0], least[1]);
            _mm512_cmp_ps_mask::<_CMP_LT_OQ>(least, _mm512_set1_ps(error)) != 0
        })
    }
    #[inline(always)]
    fn rlimit(self, v: Self::R, first: f32, after: f32, last: f32) -> Self::R {
        let rows = sample_rows(self);
        avx512!(two!(k => {
            let y = _mm512_add_ps(_mm512_set1_ps(first), rows[k]);
            let inside = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(_mm512_set1_ps(after), y)
                & _mm512_cmp_ps_mask::<_CMP_LE_OQ>(y, _mm512_set1_ps(last));
            _mm512_mask_blend_ps(inside, _mm512_set1_ps(1e6), v[k])
        }))
    }
    #[inline(always)]
    fn planes(self, from: Self::R, to: Self::R) -> Self::P {
        let n = [bytes(self, from), bytes(self, to)];
        avx512!({
            let table = _mm512_broadcast_i32x4(_mm_loadu_si128(FROM.as_ptr().cast()));
            two!(pair => {
                // Two columns of samples in a register.
                let add = _mm512_castsi256_si512(_mm256_set1_epi8(3 - 2 * pair as i8));
                let add = _mm512_inserti64x4::<1>(add, _mm256_set1_epi8(2 - 2 * pair as i8));
                let sides = two!(side => {
                    let n = _mm512_srli_epi16::<2>(_mm512_add_epi8(n[side], add));
                    _mm512_shuffle_epi8(table, _mm512_and_si512(n, _mm512_set1_epi8(0x3f)))
                });
                _mm512_andnot_si512(sides[1], sides[0])
            })
        })
    }
    #[inline(always)]
    fn plane(self, from: __m256, to: __m256) -> u64 {
        avx512!({
            let v = [from, to];
            let sides = two!(side => {
                let n = _mm256_cvttps_epi32(avx2::clamped(self.0, v[side], 8.5));
                _mm256_sllv_epi32(_mm256_set1_epi32(0xff), n)
            });
            _mm_cvtsi128_si64(_mm256_cvtepi32_epi8(_mm256_andnot_si256(
                sides[1], sides[0],
            ))) as u64
        })
    }
    #[inline(always)]
    fn pload(self, v: &[u64; 16]) -> Self::P {
        load(self, v.as_ptr().cast())
    }
    #[inline(always)]
    fn pstore(self, v: Self::P, to: &mut [u64; 16]) {
        store(self, v, to.as_mut_ptr().cast());
    }
    #[inline(always)]
    fn pkeep(self, v: Self::P, bits: u64) -> Self::P {
        avx512!({
            let bits = _mm512_set1_epi64(bits as i64);
            [_mm512_and_si512(v[0], bits), _mm512_and_si512(v[1], bits)]
        })
    }
    #[inline(always)]
    fn por(self, a: Self::P, b: Self::P) -> Self::P {
        avx512!([_mm512_or_si512(a[0], b[0]), _mm512_or_si512(a[1], b[1])])
    }
    #[inline(always)]
    fn pall(self, v: Self::P) -> u64 {
        avx512!({
            let q = _mm512_and_si512(v[0], v[1]);
            let q = _mm256_and_si256(_mm512_castsi512_si256(q), _mm512_extracti64x4_epi64::<1>(q));
            let h = _mm_and_si128(_mm256_castsi256_si128(q), _mm256_extracti128_si256::<1>(q));
            _mm_cvtsi128_si64(_mm_and_si128(h, _mm_unpackhi_epi64(h, h))) as u64
        })
    }
    #[inline(always)]
    fn pany(self, v: Self::P) -> u64 {
        avx512!({
            let q = _mm512_or_si512(v[0], v[1]);
            let q = _mm256_or_si256(_mm512_castsi512_si256(q), _mm512_extracti64x4_epi64::<1>(q));
            let h = _mm_or_si128(_mm256_castsi256_si128(q), _mm256_extracti128_si256::<1>(q));
            _mm_cvtsi128_si64(_mm_or_si128(h, _mm_unpackhi_epi64(h, h))) as u64
        })
    }
}

/// `from` must be the start of an array of 128 bytes.
#[inline(always)]
fn load(_: Avx512, from: *const __m512i) -> [__m512i; 2] {
    avx512!([_mm512_loadu_si512(from), _mm512_loadu_si512(from.add(1))])
}

/// `to` must be the start of an array of 128 bytes.
#[inline(always)]
fn store(_: Avx512, v: [__m512i; 2], to: *mut __m512i) {
    avx512!({
        _mm512_storeu_si512(to, v[0]);
        _mm512_storeu_si512(to.add(1), v[1]);
    });
}

/// From half a step before the first number that counts to half a step after the last.
#[inline(always)]
fn clamped(_: Avx512, v: __m512) -> __m512 {
    avx512!(_mm512_min_ps(
        _mm512_max_ps(v, _mm512_set1_ps(-0.5)),
        _mm512_set1_ps(32.5)
    ))
}

/// Distance to the nearest whole number.
#[inline(always)]
fn near_whole(_: Avx512, v: __m512) -> __m512 {
    avx512!(_mm512_abs_ps(_mm512_reduce_ps::<
        { _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC },
    >(v)))
}

#[inline(always)]
fn sample_rows(_: Avx512) -> [__m512; 2] {
    let p = SAMPLE_ROWS.as_ptr();
    avx512!([_mm512_loadu_ps(p), _mm512_loadu_ps(p.add(16))])
}

/// Sample numbers from 0 to 32, a byte each, in the order of the rows; twice.
#[inline(always)]
fn bytes(l: Avx512, v: [__m512; 2]) -> __m512i {
    avx512!({
        let n = two!(k => {
            _mm512_cvtepi32_epi8(_mm512_cvttps_epi32(clamped(l, v[k])))
        });
        _mm512_broadcast_i64x4(_mm256_inserti128_si256::<1>(
            _mm256_castsi128_si256(n[0]),
            n[1],
        ))
    })
}
