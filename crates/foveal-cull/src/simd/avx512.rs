//! AVX-512 lanes: whole blocks in two registers, and masks of 64 pixels as they are. Eight-lane
//! work is AVX2's. An [`Avx512`] exists only where the CPU has all that it needs, which is what
//! makes its methods sound.

use super::arrays::{four, two};
use super::avx2;
use super::avx512proof::Avx512;
use super::avx512x16::Wide512;
use super::lanes::{Kernel, Lanes, Vectors};
use super::portable::{FAR, ROWS};
use crate::bounds::Aabb;
use crate::format::CODE_OFFSET;
use core::arch::x86_64::*;

/// The rows of a part, in an order that brings pixels into theirs at last.
const ORDERED: [f64; 40] = {
    let (mut rows, mut i) = (ROWS, 0);
    while i < 32 {
        rows[i] = ROWS[i / 8 * 8 + [0, 4, 2, 6, 1, 5, 3, 7][i % 8]];
        i += 1;
    }
    rows
};

/// Numbers of rows of pixels, four times each: of the upper half of a block and of the lower.
const HALF_ROWS: [[f32; 16]; 2] = {
    let (mut rows, mut i) = ([[0.0; 16]; 2], 0);
    while i < 32 {
        rows[i / 16][i % 16] = (i / 4) as f32;
        i += 1;
    }
    rows
};

impl Avx512 {
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

/// One side of the spans of a row of blocks.
#[derive(Clone, Copy)]
pub(crate) struct Side512 {
    /// The first and third rows of pixels, and the second and fourth, as [`ORDERED`].
    rows: [__m512i; 2],
    centers: __m256i,
}

/// `[e(0), ..., e(4)]`, as [`four!`].
macro_rules! five {
    ($k:ident => $e:expr) => {{
        let [a, b, c, d] = four!($k => $e);
        let $k = 4usize;
        [a, b, c, d, $e]
    }};
}

/// Wraps intrinsics.
macro_rules! avx512 {
    ($e:expr) => {
        // SAFETY: an `Avx512` proves the features; loads and stores go through references to arrays
        // of the same size.
        unsafe { $e }
    };
}

/// Methods that AVX2 has already.
macro_rules! as_avx2 {
    ($($name:ident($($arg:ident: $type:ty),*) $(-> $out:ty)?;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($arg: $type),*) $(-> $out)? {
                self.avx2().$name($($arg),*)
            }
        )*
    };
}

impl Vectors<8> for Avx512 {
    type F = __m256;
    type I = __m256i;
    type M = __m256i;

    as_avx2! {
        fsplat(v: f32) -> __m256;
        fload(v: &[f32; 8]) -> __m256;
        fstore(v: __m256, to: &mut [f32; 8]);
        fadd(a: __m256, b: __m256) -> __m256;
        fsub(a: __m256, b: __m256) -> __m256;
        fmul(a: __m256, b: __m256) -> __m256;
        fdiv(a: __m256, b: __m256) -> __m256;
        fmin(a: __m256, b: __m256) -> __m256;
        fmax(a: __m256, b: __m256) -> __m256;
        fabs(a: __m256) -> __m256;
        flt(a: __m256, b: __m256) -> __m256i;
        fselect(mask: __m256i, a: __m256, b: __m256) -> __m256;
        ftrunc(a: __m256) -> __m256i;
        fcodes(a: __m256) -> __m256i;
        isplat(v: i32) -> __m256i;
        iload(v: &[i32; 8]) -> __m256i;
        istore(v: __m256i, to: &mut [i32; 8]);
        ftranspose(v: &[Aabb; 8]) -> [__m256; 6];
        iadd(a: __m256i, b: __m256i) -> __m256i;
        imin(a: __m256i, b: __m256i) -> __m256i;
        imax(a: __m256i, b: __m256i) -> __m256i;
        imul(a: __m256i, b: __m256i) -> __m256i;
        ishr(a: __m256i, by: __m256i) -> __m256i;
        ibits(a: __m256i) -> __m256i;
        isub(a: __m256i, b: __m256i) -> __m256i;
        mand(a: __m256i, b: __m256i) -> __m256i;
        mor(a: __m256i, b: __m256i) -> __m256i;
        mandnot(a: __m256i, b: __m256i) -> __m256i;
        mbits(a: __m256i) -> u32;
    }
    as_avx2! {
        ilt(a: __m256i, b: __m256i) -> __m256i;
        mall() -> __m256i;
    }
}

impl Lanes for Avx512 {
    type Q = __m256d;
    type D = [__m512i; 2];
    type S = [Side512; 2];
    type B = [[__m512d; 5]; 4];
    type P = [__m512i; 2];
    type W = Wide512;
    fn outlined<K: Kernel>(self, kernel: K) -> K::Output {
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
        Wide512(self)
    }
    #[inline(always)]
    fn prefetch<T>(self, soon: &T) {
        super::narrow::sse2::prefetch(soon);
    }
    as_avx2! {
        fgather(table: &[f32; 256], index: &[u8; 8]) -> __m256;
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
    }
    #[inline(always)]
    fn dplane(self, columns: __m256, down: f32, floor: f32, cap: i16) -> Self::D {
        avx512!({
            // A quarter of a register is half a row, so that packing two of them gives whole rows
            // in their order.
            let sides = [
                _mm512_broadcast_f32x4(_mm256_castps256_ps128(columns)),
                _mm512_broadcast_f32x4(_mm256_extractf128_ps::<1>(columns)),
            ];
            let (down, floor) = (_mm512_set1_ps(down), _mm512_set1_ps(floor));
            let offset = _mm512_set1_epi32(CODE_OFFSET);
            two!(half => {
                let rows = _mm512_loadu_ps(HALF_ROWS[half].as_ptr());
                let below = _mm512_mul_ps(rows, down);
                let codes = two!(side => {
                    let v = _mm512_max_ps(_mm512_add_ps(sides[side], below), floor);
                    _mm512_sub_epi32(_mm512_srai_epi32::<12>(_mm512_castps_si512(v)), offset)
                });
                let codes = _mm512_packs_epi32(codes[0], codes[1]);
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
        let [low, high] = avx512!(two!(i => {
            let distance = _mm512_abs_epi16(_mm512_subs_epi16(a[i], b[i]));
            _mm512_cmpgt_epu16_mask(distance, _mm512_set1_epi16(by))
        }));
        u64::from(low) | (u64::from(high) << 32)
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
    fn qrows(self, slope: __m256d) -> Self::B {
        let rows = ORDERED.as_ptr();
        avx512!({
            four!(e => {
                let slope = lane(self, slope, e);
                five!(k => _mm512_mul_pd(_mm512_loadu_pd(rows.add(8 * k)), slope))
            })
        })
    }
    #[inline(always)]
    fn qspans(self, at: __m256d, edges: &Self::B, limits: Option<[f64; 2]>) -> Self::S {
        avx512!({
            let at = four!(e => lane(self, at, e));
            let mut from = five!(k => _mm512_max_pd(
                _mm512_add_pd(at[0], edges[0][k]),
                _mm512_add_pd(at[1], edges[1][k]),
            ));
            let to = five!(k => _mm512_min_pd(
                _mm512_add_pd(at[2], edges[2][k]),
                _mm512_add_pd(at[3], edges[3][k]),
            ));
            if let Some(limits) = limits {
                from = five!(k => limited(self, from[k], limits, k));
            }
            let sides = [from, to];
            two!(side => {
                let v = sides[side];
                // The centre of pixel n is at sample 4 n + 1.5 of the row.
                let center = _mm512_add_pd(v[4], _mm512_set1_pd(1.5));
                Side512 {
                    rows: two!(k => {
                        let n = _mm512_castsi256_si512(whole(self, v[k]));
                        let n = _mm512_inserti64x4::<1>(n, whole(self, v[k + 2]));
                        _mm512_max_epi32(n, _mm512_setzero_si512())
                    }),
                    centers: {
                        let n = whole(self, _mm512_mul_pd(center, _mm512_set1_pd(0.25)));
                        _mm256_max_epi32(n, _mm256_setzero_si256())
                    },
                }
            })
        })
    }
    #[inline(always)]
    fn pwithin(self, spans: &Self::S, left: u32) -> (Self::P, u64) {
        avx512!({
            // A number a row, 32 samples: the first and third rows of pixels, and the second and
            // fourth.
            let first = _mm512_set1_epi32(left as i32);
            let rows = two!(k => {
                let [from, to] = two!(side => {
                    // Numbers have 15 bits.
                    let n = _mm512_subs_epu16(spans[side].rows[k], first);
                    shifted(_mm512_set1_epi32(-1), n)
                });
                _mm512_andnot_si512(to, from)
            });
            // A word a row and pair of pixels: their samples in the first two rows, and in the
            // others.
            let (low, high) = (
                _mm512_unpacklo_epi8(rows[0], rows[1]),
                _mm512_unpackhi_epi8(rows[0], rows[1]),
            );
            let above = _mm512_inserti64x4::<1>(low, _mm512_castsi512_si256(high));
            let below = _mm512_shuffle_i64x2::<0b11_10_11_10>(low, high);
            // A word a pixel: those of even and odd columns, and then in a row.
            let half = _mm512_set1_epi16(0x0f0f);
            let even = select(self, half, above, _mm512_slli_epi16::<4>(below));
            let odd = select(self, half, _mm512_srli_epi16::<4>(above), below);
            let planes = [
                _mm512_unpacklo_epi16(even, odd),
                _mm512_unpackhi_epi16(even, odd),
            ];
            let first = _mm256_set1_epi32(left as i32 / 4);
            let [from, to] = two!(side => {
                let n = _mm256_subs_epu16(spans[side].centers, first);
                avx2::shifted(_mm256_set1_epi32(0xff), n)
            });
            let rows = _mm256_cvtepi32_epi8(_mm256_andnot_si256(to, from));
            (planes, _mm_cvtsi128_si64(rows) as u64)
        })
    }
    #[inline(always)]
    fn irows(self, from: __m256i, to: __m256i) -> u64 {
        avx512!({
            let n = [from, to];
            let [from, to] = two!(side => {
                let n = _mm256_max_epi32(n[side], _mm256_setzero_si256());
                avx2::shifted(_mm256_set1_epi32(0xff), n)
            });
            _mm_cvtsi128_si64(_mm256_cvtepi32_epi8(_mm256_andnot_si256(to, from))) as u64
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
        avx512!([
            _mm512_maskz_mov_epi16(bits as u32, v[0]),
            _mm512_maskz_mov_epi16((bits >> 32) as u32, v[1])
        ])
    }
    #[inline(always)]
    fn por(self, a: Self::P, b: Self::P) -> Self::P {
        avx512!([_mm512_or_si512(a[0], b[0]), _mm512_or_si512(a[1], b[1])])
    }
    #[inline(always)]
    fn pall(self, v: Self::P) -> u64 {
        let all = self.dsplat(-1);
        let [low, high] = avx512!([
            _mm512_cmpeq_epi16_mask(v[0], all[0]),
            _mm512_cmpeq_epi16_mask(v[1], all[1])
        ]);
        u64::from(low) | (u64::from(high) << 32)
    }
    #[inline(always)]
    fn pany(self, v: Self::P) -> u64 {
        let [low, high] = avx512!([
            _mm512_test_epi16_mask(v[0], v[0]),
            _mm512_test_epi16_mask(v[1], v[1])
        ]);
        u64::from(low) | (u64::from(high) << 32)
    }
    as_avx2! {
        mload(v: &[i32; 8]) -> __m256i;
        mstore(v: __m256i, to: &mut [i32; 8]);
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

/// One of four numbers, eight times.
#[inline(always)]
fn lane(_: Avx512, v: __m256d, k: usize) -> __m512d {
    avx512!(_mm512_permutexvar_pd(
        _mm512_set1_epi64(k as i64),
        _mm512_castpd256_pd512(v)
    ))
}

/// `v`, but far off for rows beyond the limits; the rows are those of part `k`.
#[inline(always)]
fn limited(_: Avx512, v: __m512d, [after, last]: [f64; 2], k: usize) -> __m512d {
    let rows: &[f64; 8] = &ORDERED.as_chunks().0[k];
    avx512!({
        let rows = _mm512_loadu_pd(rows.as_ptr());
        let inside = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(_mm512_set1_pd(after), rows)
            & _mm512_cmp_pd_mask::<_CMP_LE_OQ>(rows, _mm512_set1_pd(last));
        _mm512_mask_blend_pd(inside, _mm512_set1_pd(FAR), v)
    })
}

/// Beyond the screen to the right, in 15 bits.
const RIGHT: f64 = 32767.0;

/// Rounded towards zero, no greater than [`RIGHT`]. What is far to the left is below zero.
#[inline(always)]
fn whole(_: Avx512, v: __m512d) -> __m256i {
    avx512!(_mm512_cvttpd_epi32(_mm512_min_pd(_mm512_set1_pd(RIGHT), v)))
}

/// `a` where a bit is set, else `b`.
#[inline(always)]
fn select(_: Avx512, bits: __m512i, a: __m512i, b: __m512i) -> __m512i {
    avx512!(_mm512_ternarylogic_epi32::<0xca>(bits, a, b))
}

/// Numbers shifted to the left, by 32 or more to nothing. [`_mm512_sllv_epi32`] is the same, but is
/// compiled to this instruction, a comparison with 32, and a choice.
#[inline]
#[target_feature(enable = "avx512f")]
fn shifted(v: __m512i, by: __m512i) -> __m512i {
    let to;
    // SAFETY: the attribute says that the CPU has AVX-512; nothing but one register changes.
    unsafe {
        core::arch::asm!(
            "vpsllvd {to}, {v}, {by}",
            to = lateout(zmm_reg) to,
            v = in(zmm_reg) v,
            by = in(zmm_reg) by,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    to
}
