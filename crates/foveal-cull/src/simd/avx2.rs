//! AVX2 lanes. An [`Avx2`] exists only where the CPU has AVX2, which is what makes its methods
//! sound.

use super::arrays::{four, two};
use super::lanes::{Kernel, Lanes, Vectors};
use super::portable::{FAR, PIXELS_FROM, ROWS};
use super::twice::Twice;
use crate::bounds::Aabb;
use crate::format::CODE_OFFSET;
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

/// One side of the spans of a row of blocks.
#[derive(Clone, Copy)]
pub(crate) struct Side256 {
    /// Words: four rows of pixels of the first and second, the other four; and the same of the
    /// third and fourth.
    rows: [__m256i; 2],
    centers: __m256i,
}

/// Wraps intrinsics.
macro_rules! avx2 {
    ($e:expr) => {
        // SAFETY: `self` proves AVX2; loads and stores go through references to arrays of the same
        // size.
        unsafe { $e }
    };
}

impl Vectors<8> for Avx2 {
    type F = __m256;
    type I = __m256i;
    type M = __m256i;

    #[inline(always)]
    fn fsplat(self, v: f32) -> __m256 {
        avx2!(_mm256_set1_ps(v))
    }
    #[inline(always)]
    fn fload(self, v: &[f32; 8]) -> __m256 {
        avx2!(_mm256_loadu_ps(v.as_ptr()))
    }
    #[inline(always)]
    fn fstore(self, v: __m256, to: &mut [f32; 8]) {
        avx2!(_mm256_storeu_ps(to.as_mut_ptr(), v))
    }
    #[inline(always)]
    fn fadd(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_add_ps(a, b))
    }
    #[inline(always)]
    fn fsub(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_sub_ps(a, b))
    }
    #[inline(always)]
    fn fmul(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_mul_ps(a, b))
    }
    #[inline(always)]
    fn fdiv(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_div_ps(a, b))
    }
    #[inline(always)]
    fn fmin(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_min_ps(a, b))
    }
    #[inline(always)]
    fn fmax(self, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_max_ps(a, b))
    }
    #[inline(always)]
    fn fabs(self, a: __m256) -> __m256 {
        avx2!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), a))
    }
    #[inline(always)]
    fn flt(self, a: __m256, b: __m256) -> __m256i {
        avx2!(_mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b)))
    }
    #[inline(always)]
    fn fselect(self, mask: __m256i, a: __m256, b: __m256) -> __m256 {
        avx2!(_mm256_blendv_ps(b, a, _mm256_castsi256_ps(mask)))
    }
    #[inline(always)]
    fn ftrunc(self, a: __m256) -> __m256i {
        avx2!(_mm256_cvttps_epi32(a))
    }
    #[inline(always)]
    fn fcodes(self, a: __m256) -> __m256i {
        avx2!(_mm256_sub_epi32(
            _mm256_srai_epi32::<12>(_mm256_castps_si256(a)),
            _mm256_set1_epi32(CODE_OFFSET)
        ))
    }
    #[inline(always)]
    fn isplat(self, v: i32) -> __m256i {
        avx2!(_mm256_set1_epi32(v))
    }
    #[inline(always)]
    fn ftranspose(self, v: &[Aabb; 8]) -> [__m256; 6] {
        // A box is six numbers in a row, nothing else.
        const { assert!(size_of::<Aabb>() == 24 && core::mem::offset_of!(Aabb, max) == 12) };
        let p: *const f32 = v.as_ptr().cast();
        avx2!({
            // Four rows in a half of each register: rows 0 and 1 are twelve numbers, a; rows 2 and
            // 3 are b.
            let [a0, b0] = two!(i => half_rows(self, p, 12 * i));
            let [a1, b1] = two!(i => half_rows(self, p, 12 * i + 4));
            let [a2, b2] = two!(i => half_rows(self, p, 12 * i + 8));
            let (xy_a, xy_b) = (
                _mm256_shuffle_ps::<0b11_10_01_00>(a0, a1),
                _mm256_shuffle_ps::<0b11_10_01_00>(b0, b1),
            );
            let (zx_a, zx_b) = (
                _mm256_shuffle_ps::<0b01_00_11_10>(a0, a2),
                _mm256_shuffle_ps::<0b01_00_11_10>(b0, b2),
            );
            let (yz_a, yz_b) = (
                _mm256_shuffle_ps::<0b11_10_01_00>(a1, a2),
                _mm256_shuffle_ps::<0b11_10_01_00>(b1, b2),
            );
            [
                _mm256_shuffle_ps::<0b10_00_10_00>(xy_a, xy_b),
                _mm256_shuffle_ps::<0b11_01_11_01>(xy_a, xy_b),
                _mm256_shuffle_ps::<0b10_00_10_00>(zx_a, zx_b),
                _mm256_shuffle_ps::<0b11_01_11_01>(zx_a, zx_b),
                _mm256_shuffle_ps::<0b10_00_10_00>(yz_a, yz_b),
                _mm256_shuffle_ps::<0b11_01_11_01>(yz_a, yz_b),
            ]
        })
    }
    #[inline(always)]
    fn iadd(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_add_epi32(a, b))
    }
    #[inline(always)]
    fn imin(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_min_epi32(a, b))
    }
    #[inline(always)]
    fn imax(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_max_epi32(a, b))
    }
    #[inline(always)]
    fn imul(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_mullo_epi32(a, b))
    }
    #[inline(always)]
    fn ishr(self, a: __m256i, by: __m256i) -> __m256i {
        avx2!(_mm256_srav_epi32(a, by))
    }
    #[inline(always)]
    fn ibits(self, a: __m256i) -> __m256i {
        // The exponent of the number as a float, which is exact; 0 has none.
        avx2!({
            let exponent = _mm256_srli_epi32::<23>(_mm256_castps_si256(_mm256_cvtepi32_ps(a)));
            _mm256_max_epi32(
                _mm256_sub_epi32(exponent, _mm256_set1_epi32(126)),
                _mm256_setzero_si256(),
            )
        })
    }
    #[inline(always)]
    fn iload(self, v: &[i32; 8]) -> __m256i {
        avx2!(_mm256_loadu_si256(v.as_ptr().cast()))
    }
    #[inline(always)]
    fn istore(self, v: __m256i, to: &mut [i32; 8]) {
        avx2!(_mm256_storeu_si256(to.as_mut_ptr().cast(), v))
    }
    #[inline(always)]
    fn isub(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_sub_epi32(a, b))
    }
    #[inline(always)]
    fn mand(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_and_si256(a, b))
    }
    #[inline(always)]
    fn mor(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_or_si256(a, b))
    }
    #[inline(always)]
    fn mandnot(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_andnot_si256(a, b))
    }
    #[inline(always)]
    fn mbits(self, a: __m256i) -> u32 {
        avx2!(_mm256_movemask_ps(_mm256_castsi256_ps(a)) as u32)
    }
    #[inline(always)]
    fn ilt(self, a: __m256i, b: __m256i) -> __m256i {
        avx2!(_mm256_cmpgt_epi32(b, a))
    }
    #[inline(always)]
    fn mall(self) -> __m256i {
        self.isplat(-1)
    }
}

impl Lanes for Avx2 {
    type Q = __m256d;
    type D = [__m256i; 4];
    type S = [Side256; 2];
    type B = [[__m256d; 10]; 4];
    type P = [__m256i; 4];
    type W = Twice<Self>;
    fn outlined<K: Kernel>(self, kernel: K) -> K::Output {
        #[inline(never)]
        #[target_feature(enable = "avx2,bmi1,popcnt,lzcnt")]
        fn inner<K: Kernel>(lanes: Avx2, kernel: K) -> K::Output {
            kernel.run(lanes)
        }
        // SAFETY: `self` proves that the CPU has these features.
        unsafe { inner(self, kernel) }
    }
    #[inline(always)]
    fn wide(self) -> Self::W {
        Twice(self)
    }
    #[inline(always)]
    fn prefetch<T>(self, soon: &T) {
        super::narrow::sse2::prefetch(soon);
    }
    #[inline(always)]
    fn fgather(self, table: &[f32; 256], index: &[u8; 8]) -> __m256 {
        // SAFETY: AVX2 is proved by `self`; eight bytes are read from an array of eight, and a byte
        // is always a valid index into 256 floats.
        unsafe {
            let i = _mm256_cvtepu8_epi32(_mm_loadl_epi64(index.as_ptr().cast()));
            _mm256_i32gather_ps::<4>(table.as_ptr(), i)
        }
    }
    #[inline(always)]
    fn qgather(self, table: &[f64; 256], index: [u8; 4]) -> __m256d {
        let [a, b, c, d] = four!(k => table[usize::from(index[k])]);
        avx2!(_mm256_setr_pd(a, b, c, d))
    }
    #[inline(always)]
    fn qload(self, v: &[f64; 4]) -> __m256d {
        avx2!(_mm256_loadu_pd(v.as_ptr()))
    }
    #[inline(always)]
    fn qstore(self, v: __m256d, to: &mut [f64; 4]) {
        avx2!(_mm256_storeu_pd(to.as_mut_ptr(), v))
    }
    #[inline(always)]
    fn qsplat(self, v: f64) -> __m256d {
        avx2!(_mm256_set1_pd(v))
    }
    #[inline(always)]
    fn qadd(self, a: __m256d, b: __m256d) -> __m256d {
        avx2!(_mm256_add_pd(a, b))
    }
    #[inline(always)]
    fn qsub(self, a: __m256d, b: __m256d) -> __m256d {
        avx2!(_mm256_sub_pd(a, b))
    }
    #[inline(always)]
    fn qmul(self, a: __m256d, b: __m256d) -> __m256d {
        avx2!(_mm256_mul_pd(a, b))
    }
    #[inline(always)]
    fn qdiv(self, a: __m256d, b: __m256d) -> __m256d {
        avx2!(_mm256_div_pd(a, b))
    }
    #[inline(always)]
    fn qabs(self, a: __m256d) -> __m256d {
        avx2!(_mm256_andnot_pd(_mm256_set1_pd(-0.0), a))
    }
    #[inline(always)]
    fn qlt(self, a: __m256d, b: __m256d) -> u32 {
        avx2!(_mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(a, b)) as u32)
    }
    #[inline(always)]
    fn qpick(self, v: __m256d, from: [u8; 4]) -> __m256d {
        avx2!({
            // Both halves of a number: 2 i and 2 i + 1.
            let i = _mm256_cvtepu8_epi64(_mm_cvtsi32_si128(i32::from_le_bytes(from)));
            let i = _mm256_add_epi64(i, i);
            let both = _mm256_add_epi64(
                _mm256_or_si256(i, _mm256_slli_epi64::<32>(i)),
                _mm256_set1_epi64x(1 << 32),
            );
            _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(v), both))
        })
    }
    #[inline(always)]
    fn dplane(self, columns: __m256, down: f32, floor: f32, cap: i16) -> Self::D {
        avx2!({
            let (floor, cap) = (_mm256_set1_ps(floor), _mm256_set1_epi16(cap));
            let offset = _mm256_set1_epi32(CODE_OFFSET);
            // Half a register is half a row, so that packing two of them gives whole rows in their
            // order.
            let sides = [
                _mm256_permute2f128_ps::<0x00>(columns, columns),
                _mm256_permute2f128_ps::<0x11>(columns, columns),
            ];
            four!(i => {
                let (upper, lower) = ((2 * i) as f32 * down, (2 * i + 1) as f32 * down);
                let below = _mm256_set_m128(_mm_set1_ps(lower), _mm_set1_ps(upper));
                let codes = two!(side => {
                    let v = _mm256_max_ps(_mm256_add_ps(sides[side], below), floor);
                    _mm256_sub_epi32(_mm256_srai_epi32::<12>(_mm256_castps_si256(v)), offset)
                });
                _mm256_min_epi16(_mm256_packs_epi32(codes[0], codes[1]), cap)
            })
        })
    }
    #[inline(always)]
    fn dload(self, v: &[i16; 64]) -> Self::D {
        let p: *const __m256i = v.as_ptr().cast();
        avx2!(four!(i => _mm256_loadu_si256(p.add(i))))
    }
    #[inline(always)]
    fn dstore(self, v: Self::D, to: &mut [i16; 64]) {
        let p: *mut __m256i = to.as_mut_ptr().cast();
        avx2!({
            four!(i => _mm256_storeu_si256(p.add(i), v[i]));
        })
    }
    #[inline(always)]
    fn dsplat(self, v: i16) -> Self::D {
        avx2!([_mm256_set1_epi16(v); 4])
    }
    #[inline(always)]
    fn dmin(self, a: Self::D, b: Self::D) -> Self::D {
        avx2!(four!(i => _mm256_min_epi16(a[i], b[i])))
    }
    #[inline(always)]
    fn dmax(self, a: Self::D, b: Self::D) -> Self::D {
        avx2!(four!(i => _mm256_max_epi16(a[i], b[i])))
    }
    #[inline(always)]
    fn dgt(self, a: Self::D, b: Self::D) -> u64 {
        avx2!({
            let m = four!(i => _mm256_cmpgt_epi16(a[i], b[i]));
            let halves = two!(i => {
                let bytes = _mm256_packs_epi16(m[2 * i], m[2 * i + 1]);
                let bytes = _mm256_permute4x64_epi64::<0b11_01_10_00>(bytes);
                u64::from(_mm256_movemask_epi8(bytes) as u32)
            });
            halves[0] | (halves[1] << 32)
        })
    }
    #[inline(always)]
    fn dapart(self, a: Self::D, b: Self::D, by: i16) -> u64 {
        let distance = avx2!(four!(i => {
            _mm256_max_epi16(_mm256_subs_epi16(a[i], b[i]), _mm256_subs_epi16(b[i], a[i]))
        }));
        self.dgt(distance, self.dsplat(by))
    }
    #[inline(always)]
    fn dselect(self, bits: u64, a: Self::D, b: Self::D) -> Self::D {
        avx2!({
            let bit = _mm256_setr_epi16(
                1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, -32768,
            );
            four!(i => {
                let bits = _mm256_set1_epi16((bits >> (16 * i)) as i16);
                let mask = _mm256_cmpeq_epi16(_mm256_and_si256(bits, bit), bit);
                _mm256_blendv_epi8(b[i], a[i], mask)
            })
        })
    }
    #[inline(always)]
    fn dreduce_min(self, a: Self::D) -> i16 {
        avx2!({
            let m = _mm256_min_epi16(_mm256_min_epi16(a[0], a[1]), _mm256_min_epi16(a[2], a[3]));
            let m = _mm_min_epi16(_mm256_castsi256_si128(m), _mm256_extracti128_si256::<1>(m));
            // The one horizontal minimum there is works on unsigned lanes.
            let m = _mm_minpos_epu16(_mm_xor_si128(m, _mm_set1_epi16(i16::MIN)));
            (_mm_cvtsi128_si32(m) as i16) ^ i16::MIN
        })
    }
    #[inline(always)]
    fn qrows(self, slope: __m256d) -> Self::B {
        let mut edges = [[slope; 10]; 4];
        for (e, edge) in edges.iter_mut().enumerate() {
            let slope = self.qpick(slope, [e as u8; 4]);
            for (edge, rows) in edge.iter_mut().zip(ROWS.as_chunks().0) {
                *edge = self.qmul(self.qload(rows), slope);
            }
        }
        edges
    }
    #[inline(always)]
    fn qspans(self, at: __m256d, edges: &Self::B, limits: Option<[f64; 2]>) -> Self::S {
        let at = four!(e => self.qpick(at, [e as u8; 4]));
        let [mut from, mut to] = [[at[0]; 10]; 2];
        avx2!({
            for k in 0..10 {
                let [a, b, c, d] = four!(e => _mm256_add_pd(at[e], edges[e][k]));
                (from[k], to[k]) = (_mm256_max_pd(a, b), _mm256_min_pd(c, d));
            }
            if let Some([after, last]) = limits {
                for (from, rows) in from.iter_mut().zip(ROWS.as_chunks().0) {
                    let rows = self.qload(rows);
                    let inside = _mm256_and_pd(
                        _mm256_cmp_pd::<_CMP_LT_OQ>(_mm256_set1_pd(after), rows),
                        _mm256_cmp_pd::<_CMP_LE_OQ>(rows, _mm256_set1_pd(last)),
                    );
                    *from = _mm256_blendv_pd(_mm256_set1_pd(FAR), *from, inside);
                }
            }
            let sides = [from, to];
            two!(side => {
                let rows = four!(k => whole(self, sides[side][2 * k], sides[side][2 * k + 1]));
                // The centre of pixel n is at sample 4 n + 1.5 of the row.
                let centers = two!(k => {
                    let v = _mm256_add_pd(sides[side][8 + k], _mm256_set1_pd(1.5));
                    _mm256_mul_pd(v, _mm256_set1_pd(0.25))
                });
                Side256 {
                    rows: two!(k => _mm256_packs_epi32(rows[2 * k], rows[2 * k + 1])),
                    centers: {
                        let n = whole(self, centers[0], centers[1]);
                        _mm256_max_epi32(n, _mm256_setzero_si256())
                    },
                }
            })
        })
    }
    #[inline(always)]
    fn pwithin(self, spans: &Self::S, left: u32) -> (Self::P, u64) {
        avx2!({
            // A byte a row, from 0 to 32.
            let first = _mm256_set1_epi16(left as i16);
            let n = two!(side => {
                let n = two!(k => _mm256_subs_epi16(spans[side].rows[k], first));
                let n = _mm256_permutevar8x32_epi32(
                    _mm256_packus_epi16(n[0], n[1]),
                    _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7),
                );
                _mm256_min_epu8(n, _mm256_set1_epi8(32))
            });
            let table = _mm256_broadcastsi128_si256(_mm_loadu_si128(PIXELS_FROM.as_ptr().cast()));
            let planes = four!(column => {
                let sides = two!(side => {
                    let n = _mm256_add_epi8(n[side], _mm256_set1_epi8(3 - column as i8));
                    let pixel = _mm256_and_si256(_mm256_srli_epi16::<2>(n), _mm256_set1_epi8(0x3f));
                    _mm256_shuffle_epi8(table, pixel)
                });
                _mm256_andnot_si256(sides[1], sides[0])
            });
            let first = _mm256_set1_epi32(left as i32 / 4);
            let [from, to] = two!(side => _mm256_sub_epi32(spans[side].centers, first));
            (planes, self.irows(from, to))
        })
    }
    #[inline(always)]
    fn irows(self, from: __m256i, to: __m256i) -> u64 {
        avx2!({
            let n = [from, to];
            let sides = two!(side => {
                let n = _mm256_max_epi32(n[side], _mm256_setzero_si256());
                shifted(_mm256_set1_epi32(0xff), n)
            });
            let bits = _mm256_andnot_si256(sides[1], sides[0]);
            let bits = _mm256_and_si256(bits, _mm256_set1_epi32(0xff));
            let bytes = _mm256_packus_epi16(_mm256_packs_epi32(bits, bits), bits);
            let low = _mm_cvtsi128_si32(_mm256_castsi256_si128(bytes)) as u32;
            let high = _mm_cvtsi128_si32(_mm256_extracti128_si256::<1>(bytes)) as u32;
            u64::from(low) | (u64::from(high) << 32)
        })
    }
    #[inline(always)]
    fn pload(self, v: &[u64; 16]) -> Self::P {
        let p: *const __m256i = v.as_ptr().cast();
        avx2!(four!(i => _mm256_loadu_si256(p.add(i))))
    }
    #[inline(always)]
    fn pstore(self, v: Self::P, to: &mut [u64; 16]) {
        let p: *mut __m256i = to.as_mut_ptr().cast();
        avx2!({
            four!(i => _mm256_storeu_si256(p.add(i), v[i]));
        })
    }
    #[inline(always)]
    fn pkeep(self, v: Self::P, bits: u64) -> Self::P {
        avx2!({
            let bits = _mm256_set1_epi64x(bits as i64);
            four!(i => _mm256_and_si256(v[i], bits))
        })
    }
    #[inline(always)]
    fn por(self, a: Self::P, b: Self::P) -> Self::P {
        avx2!(four!(i => _mm256_or_si256(a[i], b[i])))
    }
    #[inline(always)]
    fn pall(self, v: Self::P) -> u64 {
        avx2!({
            let q = _mm256_and_si256(_mm256_and_si256(v[0], v[1]), _mm256_and_si256(v[2], v[3]));
            let h = _mm_and_si128(_mm256_castsi256_si128(q), _mm256_extracti128_si256::<1>(q));
            _mm_cvtsi128_si64(_mm_and_si128(h, _mm_unpackhi_epi64(h, h))) as u64
        })
    }
    #[inline(always)]
    fn pany(self, v: Self::P) -> u64 {
        avx2!({
            let q = _mm256_or_si256(_mm256_or_si256(v[0], v[1]), _mm256_or_si256(v[2], v[3]));
            let h = _mm_or_si128(_mm256_castsi256_si128(q), _mm256_extracti128_si256::<1>(q));
            _mm_cvtsi128_si64(_mm_or_si128(h, _mm_unpackhi_epi64(h, h))) as u64
        })
    }
    #[inline(always)]
    fn mload(self, v: &[i32; 8]) -> __m256i {
        self.iload(v)
    }
    #[inline(always)]
    fn mstore(self, v: __m256i, to: &mut [i32; 8]) {
        self.istore(v, to);
    }
}

/// Four numbers of a table of 48 at `at`, and four at `at + 24`.
#[inline(always)]
fn half_rows(_: Avx2, table: *const f32, at: usize) -> __m256 {
    debug_assert!(at + 28 <= 48);
    // SAFETY: the caller holds an `Avx2` and a table of 48, of which this reads no further than `at
    // + 28`.
    unsafe { _mm256_loadu2_m128(table.add(at + 24), table.add(at)) }
}

/// Rounded towards zero, no greater than [`FAR`]. What is far to the left is far below zero.
#[inline(always)]
fn whole(_: Avx2, low: __m256d, high: __m256d) -> __m256i {
    avx2!({
        let v = [low, high];
        let [low, high] = two!(k => {
            _mm256_cvttpd_epi32(_mm256_min_pd(_mm256_set1_pd(FAR), v[k]))
        });
        _mm256_set_m128i(high, low)
    })
}

/// Numbers shifted to the left, by 32 or more to nothing. [`_mm256_sllv_epi32`] is the same, but is
/// compiled to this instruction, a comparison with 32, and a choice.
#[inline]
#[target_feature(enable = "avx2")]
pub(super) fn shifted(v: __m256i, by: __m256i) -> __m256i {
    let to;
    // SAFETY: the attribute says that the CPU has AVX2; nothing but one register changes.
    unsafe {
        core::arch::asm!(
            "vpsllvd {to}, {v}, {by}",
            to = lateout(ymm_reg) to,
            v = in(ymm_reg) v,
            by = in(ymm_reg) by,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    to
}
