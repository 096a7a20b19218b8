//! NEON, which every 64-bit ARM CPU for applications has.

use super::registers::Registers;
use crate::simd::arrays::{four, two};
use crate::simd::portable::PIXELS_FROM;
use core::arch::aarch64::*;
use core::arch::asm;

#[derive(Clone, Copy, Default)]
pub(crate) struct Neon;

/// Wraps intrinsics.
macro_rules! neon {
    ($e:expr) => {
        // SAFETY: this is compiled only where NEON is there; loads and stores go through references
        // to arrays of the same size.
        unsafe { $e }
    };
}

/// Methods that are one instruction or few.
macro_rules! instructions {
    ($($name:ident($($arg:ident: $type:ty),*) -> $out:ty = $instruction:expr;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($arg: $type),*) -> $out {
                neon!($instruction)
            }
        )*
    };
}

impl Registers for Neon {
    type F = float32x4_t;
    type I = int32x4_t;
    type Q = float64x2_t;
    type H = int16x8_t;
    type B = uint8x16_t;

    instructions! {
        splat(v: f32) -> float32x4_t = vdupq_n_f32(v);
        load(v: &[f32; 4]) -> float32x4_t = vld1q_f32(v.as_ptr());
        store(v: float32x4_t, to: &mut [f32; 4]) -> () = vst1q_f32(to.as_mut_ptr(), v);
        add(a: float32x4_t, b: float32x4_t) -> float32x4_t = vaddq_f32(a, b);
        sub(a: float32x4_t, b: float32x4_t) -> float32x4_t = vsubq_f32(a, b);
        mul(a: float32x4_t, b: float32x4_t) -> float32x4_t = vmulq_f32(a, b);
        div(a: float32x4_t, b: float32x4_t) -> float32x4_t = vdivq_f32(a, b);
        // Its own minimum and maximum hand on NaN, and tell 0 from -0.
        min(a: float32x4_t, b: float32x4_t) -> float32x4_t = vbslq_f32(vcltq_f32(a, b), a, b);
        max(a: float32x4_t, b: float32x4_t) -> float32x4_t = vbslq_f32(vcgtq_f32(a, b), a, b);
        abs(a: float32x4_t) -> float32x4_t = vabsq_f32(a);
        lt(a: float32x4_t, b: float32x4_t) -> int32x4_t = vreinterpretq_s32_u32(vcltq_f32(a, b));
        select(mask: int32x4_t, a: float32x4_t, b: float32x4_t) -> float32x4_t =
            vbslq_f32(vreinterpretq_u32_s32(mask), a, b);
        // Its own conversion ends at the largest and the smallest number, and makes 0 of NaN.
        trunc(a: float32x4_t) -> int32x4_t = vbslq_s32(
            vcaltq_f32(a, vdupq_n_f32(2_147_483_648.0)), vcvtq_s32_f32(a), vdupq_n_s32(i32::MIN)
        );
        bits(a: float32x4_t) -> int32x4_t = vreinterpretq_s32_f32(a);
        low_high(a: float32x4_t, b: float32x4_t) -> float32x4_t =
            vcombine_f32(vget_low_f32(a), vget_high_f32(b));
        high_low(a: float32x4_t, b: float32x4_t) -> float32x4_t = vextq_f32::<2>(a, b);
        evens(a: float32x4_t, b: float32x4_t) -> float32x4_t = vuzp1q_f32(a, b);
        odds(a: float32x4_t, b: float32x4_t) -> float32x4_t = vuzp2q_f32(a, b);

        isplat(v: i32) -> int32x4_t = vdupq_n_s32(v);
        iload(v: &[i32; 4]) -> int32x4_t = vld1q_s32(v.as_ptr());
        istore(v: int32x4_t, to: &mut [i32; 4]) -> () = vst1q_s32(to.as_mut_ptr(), v);
        iadd(a: int32x4_t, b: int32x4_t) -> int32x4_t = vaddq_s32(a, b);
        isub(a: int32x4_t, b: int32x4_t) -> int32x4_t = vsubq_s32(a, b);
        imul(a: int32x4_t, b: int32x4_t) -> int32x4_t = vmulq_s32(a, b);
        ilt(a: int32x4_t, b: int32x4_t) -> int32x4_t = vreinterpretq_s32_u32(vcltq_s32(a, b));
        imin(a: int32x4_t, b: int32x4_t) -> int32x4_t = vminq_s32(a, b);
        imax(a: int32x4_t, b: int32x4_t) -> int32x4_t = vmaxq_s32(a, b);
        // A negative shift to the left is one to the right.
        ishr(a: int32x4_t, by: int32x4_t) -> int32x4_t = vshlq_s32(a, vnegq_s32(by));
        iand(a: int32x4_t, b: int32x4_t) -> int32x4_t = vandq_s32(a, b);
        ior(a: int32x4_t, b: int32x4_t) -> int32x4_t = vorrq_s32(a, b);
        iandnot(a: int32x4_t, b: int32x4_t) -> int32x4_t = vbicq_s32(b, a);
        floats(a: int32x4_t) -> float32x4_t = vcvtq_f32_s32(a);

        qload(v: &[f64; 2]) -> float64x2_t = vld1q_f64(v.as_ptr());
        qstore(v: float64x2_t, to: &mut [f64; 2]) -> () = vst1q_f64(to.as_mut_ptr(), v);
        qsplat(v: f64) -> float64x2_t = vdupq_n_f64(v);
        qadd(a: float64x2_t, b: float64x2_t) -> float64x2_t = vaddq_f64(a, b);
        qsub(a: float64x2_t, b: float64x2_t) -> float64x2_t = vsubq_f64(a, b);
        qmul(a: float64x2_t, b: float64x2_t) -> float64x2_t = vmulq_f64(a, b);
        qdiv(a: float64x2_t, b: float64x2_t) -> float64x2_t = vdivq_f64(a, b);
        qabs(a: float64x2_t) -> float64x2_t = vabsq_f64(a);
        qmin(a: float64x2_t, b: float64x2_t) -> float64x2_t = vbslq_f64(vcltq_f64(a, b), a, b);
        qmax(a: float64x2_t, b: float64x2_t) -> float64x2_t = vbslq_f64(vcgtq_f64(a, b), a, b);
        qwhole(v: [float64x2_t; 2]) -> int32x4_t =
            vmovn_high_s64(vmovn_s64(vcvtq_s64_f64(v[0])), vcvtq_s64_f64(v[1]));

        hload(v: &[i16; 8]) -> int16x8_t = vld1q_s16(v.as_ptr());
        hstore(v: int16x8_t, to: &mut [i16; 8]) -> () = vst1q_s16(to.as_mut_ptr(), v);
        hsplat(v: i16) -> int16x8_t = vdupq_n_s16(v);
        hmin(a: int16x8_t, b: int16x8_t) -> int16x8_t = vminq_s16(a, b);
        hmax(a: int16x8_t, b: int16x8_t) -> int16x8_t = vmaxq_s16(a, b);
        hsub(a: int16x8_t, b: int16x8_t) -> int16x8_t = vqsubq_s16(a, b);
        hgt(a: int16x8_t, b: int16x8_t) -> int16x8_t = vreinterpretq_s16_u16(vcgtq_s16(a, b));
        hselect(mask: int16x8_t, a: int16x8_t, b: int16x8_t) -> int16x8_t =
            vbslq_s16(vreinterpretq_u16_s16(mask), a, b);
        hbytes(a: [int16x8_t; 2]) -> uint8x16_t = vqmovun_high_s16(vqmovun_s16(a[0]), a[1]);
        hpack(a: [int32x4_t; 2]) -> int16x8_t = vqmovn_high_s32(vqmovn_s32(a[0]), a[1]);
        hleast(a: int16x8_t) -> i16 = vminvq_s16(a);

        bload(v: &[u64; 2]) -> uint8x16_t = vreinterpretq_u8_u64(vld1q_u64(v.as_ptr()));
        bstore(v: uint8x16_t, to: &mut [u64; 2]) -> () =
            vst1q_u64(to.as_mut_ptr(), vreinterpretq_u64_u8(v));
        bsplat(v: u64) -> uint8x16_t = vreinterpretq_u8_u64(vdupq_n_u64(v));
        band(a: uint8x16_t, b: uint8x16_t) -> uint8x16_t = vandq_u8(a, b);
        bor(a: uint8x16_t, b: uint8x16_t) -> uint8x16_t = vorrq_u8(a, b);
        bandnot(a: uint8x16_t, b: uint8x16_t) -> uint8x16_t = vbicq_u8(b, a);
    }

    #[inline(always)]
    fn prefetch<T>(self, soon: &T) {
        let start: *const u8 = core::ptr::from_ref(soon).cast();
        for line in 0..size_of::<T>().div_ceil(64) {
            let at = start.wrapping_add(64 * line);
            // SAFETY: a hint, which reads nothing and changes nothing.
            unsafe {
                asm!("prfm pldl1keep, [{at}]", at = in(reg) at, options(readonly, nostack, preserves_flags));
            }
        }
    }
    #[inline(always)]
    fn ishr_all<const BY: i32>(self, a: int32x4_t) -> int32x4_t {
        neon!(vshrq_n_s32::<BY>(a))
    }
    #[inline(always)]
    fn signs(self, a: [int32x4_t; 2]) -> u32 {
        neon!({
            // The upper halves of the numbers.
            let [low, high] = two!(k => vreinterpretq_s16_s32(a[k]));
            let below = vcltzq_s16(vuzp2q_s16(low, high));
            u32::from(vaddvq_u16(vandq_u16(below, vld1q_u16(BIT16.as_ptr()))))
        })
    }
    #[inline(always)]
    fn qlt(self, a: [float64x2_t; 2], b: [float64x2_t; 2]) -> u32 {
        neon!({
            let [low, high] = two!(k => vreinterpretq_u32_u64(vcltq_f64(a[k], b[k])));
            vaddvq_u32(vandq_u32(
                vuzp1q_u32(low, high),
                vld1q_u32([1, 2, 4, 8].as_ptr()),
            ))
        })
    }
    #[inline(always)]
    fn hmasks(self, bits: u64) -> [int16x8_t; 8] {
        neon!({
            let bytes = vcreate_u8(bits);
            let bit = vld1q_u16(BIT16.as_ptr());
            [
                vdupq_lane_u8::<0>(bytes),
                vdupq_lane_u8::<1>(bytes),
                vdupq_lane_u8::<2>(bytes),
                vdupq_lane_u8::<3>(bytes),
                vdupq_lane_u8::<4>(bytes),
                vdupq_lane_u8::<5>(bytes),
                vdupq_lane_u8::<6>(bytes),
                vdupq_lane_u8::<7>(bytes),
            ]
            .map(|v| vreinterpretq_s16_u16(vtstq_u16(vreinterpretq_u16_u8(v), bit)))
        })
    }
    #[inline(always)]
    fn bhalves(self, a: uint8x16_t) -> [u64; 2] {
        neon!({
            let a = vreinterpretq_u64_u8(a);
            [vgetq_lane_u64::<0>(a), vgetq_lane_u64::<1>(a)]
        })
    }
    #[inline(always)]
    fn hbits(self, masks: [int16x8_t; 8]) -> u64 {
        neon!({
            let bit = vld1q_u8(BIT.as_ptr());
            let bits = four!(k => {
                let [low, high] = two!(i => vreinterpretq_u8_s16(masks[2 * k + i]));
                vandq_u8(vuzp1q_u8(low, high), bit)
            });
            // Eight neighbours become one byte.
            let [low, high] = two!(k => vpaddq_u8(bits[2 * k], bits[2 * k + 1]));
            let bits = vpaddq_u8(low, high);
            vgetq_lane_u64::<0>(vreinterpretq_u64_u8(vpaddq_u8(bits, bits)))
        })
    }
    #[inline(always)]
    fn right_of(self, n: uint8x16_t) -> [uint8x16_t; 4] {
        neon!({
            let table = vld1q_u8(PIXELS_FROM.as_ptr());
            four!(column => {
                let n = vaddq_u8(n, vdupq_n_u8(3 - column as u8));
                vqtbl1q_u8(table, vshrq_n_u8::<2>(n))
            })
        })
    }
}

const BIT: [u8; 16] = [1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128];
const BIT16: [u16; 8] = [1, 2, 4, 8, 16, 32, 64, 128];
