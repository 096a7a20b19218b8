//! WebAssembly's 128-bit registers, where the module is compiled with `-C target-feature=+simd128`.

use super::registers::Registers;
use crate::simd::arrays::{four, two};
use crate::simd::portable::PIXELS_FROM;
use core::arch::wasm32::*;

#[derive(Clone, Copy, Default)]
pub(crate) struct Simd128;

/// Methods that are one instruction or few.
macro_rules! instructions {
    ($($name:ident($($arg:ident: $type:ty),*) -> $out:ty = $instruction:expr;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($arg: $type),*) -> $out {
                $instruction
            }
        )*
    };
}

/// Loads and stores.
macro_rules! memory {
    ($($load:ident, $store:ident: $array:ty;)*) => {
        $(
            #[inline(always)]
            fn $load(self, v: &$array) -> v128 {
                // SAFETY: an array of 16 bytes, of any alignment.
                unsafe { v128_load(core::ptr::from_ref(v).cast()) }
            }
            #[inline(always)]
            fn $store(self, v: v128, to: &mut $array) {
                // SAFETY: an array of 16 bytes, of any alignment.
                unsafe { v128_store(core::ptr::from_mut(to).cast(), v) }
            }
        )*
    };
}

impl Registers for Simd128 {
    type F = v128;
    type I = v128;
    type Q = v128;
    type H = v128;
    type B = v128;

    memory! {
        load, store: [f32; 4];
        iload, istore: [i32; 4];
        qload, qstore: [f64; 2];
        hload, hstore: [i16; 8];
        bload, bstore: [u64; 2];
    }
    instructions! {
        splat(v: f32) -> v128 = f32x4_splat(v);
        add(a: v128, b: v128) -> v128 = f32x4_add(a, b);
        sub(a: v128, b: v128) -> v128 = f32x4_sub(a, b);
        mul(a: v128, b: v128) -> v128 = f32x4_mul(a, b);
        div(a: v128, b: v128) -> v128 = f32x4_div(a, b);
        // `pmin(x, y)` is `if y < x { y } else { x }`, `pmax` in the same way.
        min(a: v128, b: v128) -> v128 = f32x4_pmin(b, a);
        max(a: v128, b: v128) -> v128 = f32x4_pmax(b, a);
        abs(a: v128) -> v128 = f32x4_abs(a);
        lt(a: v128, b: v128) -> v128 = f32x4_lt(a, b);
        select(mask: v128, a: v128, b: v128) -> v128 = v128_bitselect(a, b, mask);
        // Its own conversion ends at the largest and the smallest number, and makes 0 of NaN.
        trunc(a: v128) -> v128 = v128_bitselect(
            i32x4_trunc_sat_f32x4(a),
            i32x4_splat(i32::MIN),
            f32x4_lt(f32x4_abs(a), f32x4_splat(2_147_483_648.0))
        );
        bits(a: v128) -> v128 = a;
        low_high(a: v128, b: v128) -> v128 = i32x4_shuffle::<0, 1, 6, 7>(a, b);
        high_low(a: v128, b: v128) -> v128 = i32x4_shuffle::<2, 3, 4, 5>(a, b);
        evens(a: v128, b: v128) -> v128 = i32x4_shuffle::<0, 2, 4, 6>(a, b);
        odds(a: v128, b: v128) -> v128 = i32x4_shuffle::<1, 3, 5, 7>(a, b);

        isplat(v: i32) -> v128 = i32x4_splat(v);
        iadd(a: v128, b: v128) -> v128 = i32x4_add(a, b);
        isub(a: v128, b: v128) -> v128 = i32x4_sub(a, b);
        imul(a: v128, b: v128) -> v128 = i32x4_mul(a, b);
        ilt(a: v128, b: v128) -> v128 = i32x4_lt(a, b);
        imin(a: v128, b: v128) -> v128 = i32x4_min(a, b);
        imax(a: v128, b: v128) -> v128 = i32x4_max(a, b);
        iand(a: v128, b: v128) -> v128 = v128_and(a, b);
        ior(a: v128, b: v128) -> v128 = v128_or(a, b);
        iandnot(a: v128, b: v128) -> v128 = v128_andnot(b, a);
        floats(a: v128) -> v128 = f32x4_convert_i32x4(a);
        signs(a: [v128; 2]) -> u32 = u32::from(i16x8_bitmask(i16x8_narrow_i32x4(a[0], a[1])));

        qsplat(v: f64) -> v128 = f64x2_splat(v);
        qadd(a: v128, b: v128) -> v128 = f64x2_add(a, b);
        qsub(a: v128, b: v128) -> v128 = f64x2_sub(a, b);
        qmul(a: v128, b: v128) -> v128 = f64x2_mul(a, b);
        qdiv(a: v128, b: v128) -> v128 = f64x2_div(a, b);
        qabs(a: v128) -> v128 = f64x2_abs(a);
        qmin(a: v128, b: v128) -> v128 = f64x2_pmin(b, a);
        qmax(a: v128, b: v128) -> v128 = f64x2_pmax(b, a);
        qwhole(v: [v128; 2]) -> v128 = i64x2_shuffle::<0, 2>(
            i32x4_trunc_sat_f64x2_zero(v[0]), i32x4_trunc_sat_f64x2_zero(v[1])
        );

        hsplat(v: i16) -> v128 = i16x8_splat(v);
        hmin(a: v128, b: v128) -> v128 = i16x8_min(a, b);
        hmax(a: v128, b: v128) -> v128 = i16x8_max(a, b);
        hsub(a: v128, b: v128) -> v128 = i16x8_sub_sat(a, b);
        hgt(a: v128, b: v128) -> v128 = i16x8_gt(a, b);
        hselect(mask: v128, a: v128, b: v128) -> v128 = v128_bitselect(a, b, mask);
        hbytes(a: [v128; 2]) -> v128 = u8x16_narrow_i16x8(a[0], a[1]);
        hpack(a: [v128; 2]) -> v128 = i16x8_narrow_i32x4(a[0], a[1]);

        bsplat(v: u64) -> v128 = u64x2_splat(v);
        band(a: v128, b: v128) -> v128 = v128_and(a, b);
        bor(a: v128, b: v128) -> v128 = v128_or(a, b);
        bandnot(a: v128, b: v128) -> v128 = v128_andnot(b, a);
        bhalves(a: v128) -> [u64; 2] = [u64x2_extract_lane::<0>(a), u64x2_extract_lane::<1>(a)];
    }

    #[inline(always)]
    fn ishr_all<const BY: i32>(self, a: v128) -> v128 {
        i32x4_shr(a, BY as u32)
    }
    #[inline(always)]
    fn ishr(self, a: v128, by: v128) -> v128 {
        // There is only one count for all lanes.
        i32x4(
            i32x4_extract_lane::<0>(a) >> (i32x4_extract_lane::<0>(by) & 31),
            i32x4_extract_lane::<1>(a) >> (i32x4_extract_lane::<1>(by) & 31),
            i32x4_extract_lane::<2>(a) >> (i32x4_extract_lane::<2>(by) & 31),
            i32x4_extract_lane::<3>(a) >> (i32x4_extract_lane::<3>(by) & 31),
        )
    }
    #[inline(always)]
    fn qlt(self, a: [v128; 2], b: [v128; 2]) -> u32 {
        let [low, high] = two!(k => u32::from(i64x2_bitmask(f64x2_lt(a[k], b[k]))));
        low | high << 2
    }
    #[inline(always)]
    fn hmasks(self, bits: u64) -> [v128; 8] {
        let bit = i16x8(1, 2, 4, 8, 16, 32, 64, 128);
        let mask = |k: usize| i16x8_eq(v128_and(u16x8_splat((bits >> (8 * k)) as u16), bit), bit);
        [
            mask(0),
            mask(1),
            mask(2),
            mask(3),
            mask(4),
            mask(5),
            mask(6),
            mask(7),
        ]
    }
    #[inline(always)]
    fn hleast(self, a: v128) -> i16 {
        let m = i16x8_min(a, i64x2_shuffle::<1, 1>(a, a));
        let m = i16x8_min(m, i32x4_shuffle::<1, 1, 1, 1>(m, m));
        i16x8_extract_lane::<0>(i16x8_min(m, i16x8_shuffle::<1, 1, 1, 1, 1, 1, 1, 1>(m, m)))
    }
    #[inline(always)]
    fn hbits(self, masks: [v128; 8]) -> u64 {
        let [a, b, c, d] = four!(k => {
            u64::from(i8x16_bitmask(i8x16_narrow_i16x8(masks[2 * k], masks[2 * k + 1]))) << (16 * k)
        });
        a | b | c | d
    }
    #[inline(always)]
    fn right_of(self, n: v128) -> [v128; 4] {
        // SAFETY: sixteen bytes.
        let table = unsafe { v128_load(PIXELS_FROM.as_ptr().cast()) };
        four!(column => {
            i8x16_swizzle(table, u8x16_shr(u8x16_add(n, u8x16_splat(3 - column as u8)), 2))
        })
    }
}
