//! What an instruction set with 128-bit registers must do: the seam between
//! [`Narrow`](super::Narrow) and SSE2, NEON and wasm's simd128. As there is no rounding that one of
//! them lacks and no fused multiply-add, all give the same bits.

/// Registers of 128 bits. Names without a letter before them are of `f32`; what is not said is as
/// in [`Lanes`](crate::simd::Lanes).
pub(crate) trait Registers: Copy {
    /// 4 x f32.
    type F: Copy;
    /// 4 x i32.
    type I: Copy;
    /// 2 x f64.
    type Q: Copy;
    /// 8 x i16.
    type H: Copy;
    /// 16 bytes.
    type B: Copy;

    #[inline(always)]
    fn prefetch<T>(self, _soon: &T) {}

    fn splat(self, v: f32) -> Self::F;
    fn load(self, v: &[f32; 4]) -> Self::F;
    fn store(self, v: Self::F, to: &mut [f32; 4]);
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    fn abs(self, a: Self::F) -> Self::F;
    fn lt(self, a: Self::F, b: Self::F) -> Self::I;
    fn select(self, mask: Self::I, a: Self::F, b: Self::F) -> Self::F;
    fn trunc(self, a: Self::F) -> Self::I;
    /// The bits of floats as numbers.
    fn bits(self, a: Self::F) -> Self::I;
    /// `[a0, a1, b2, b3]`.
    fn low_high(self, a: Self::F, b: Self::F) -> Self::F;
    /// `[a2, a3, b0, b1]`.
    fn high_low(self, a: Self::F, b: Self::F) -> Self::F;
    /// `[a0, a2, b0, b2]`.
    fn evens(self, a: Self::F, b: Self::F) -> Self::F;
    /// `[a1, a3, b1, b3]`.
    fn odds(self, a: Self::F, b: Self::F) -> Self::F;

    fn isplat(self, v: i32) -> Self::I;
    fn iload(self, v: &[i32; 4]) -> Self::I;
    fn istore(self, v: Self::I, to: &mut [i32; 4]);
    fn iadd(self, a: Self::I, b: Self::I) -> Self::I;
    fn isub(self, a: Self::I, b: Self::I) -> Self::I;
    fn imul(self, a: Self::I, b: Self::I) -> Self::I;
    /// All ones where `a < b`.
    fn ilt(self, a: Self::I, b: Self::I) -> Self::I;
    fn imin(self, a: Self::I, b: Self::I) -> Self::I;
    fn imax(self, a: Self::I, b: Self::I) -> Self::I;
    fn ishr(self, a: Self::I, by: Self::I) -> Self::I;
    /// `a >> BY` in all lanes.
    fn ishr_all<const BY: i32>(self, a: Self::I) -> Self::I;
    fn iand(self, a: Self::I, b: Self::I) -> Self::I;
    fn ior(self, a: Self::I, b: Self::I) -> Self::I;
    fn iandnot(self, a: Self::I, b: Self::I) -> Self::I;
    /// As floats; from -2^24 to 2^24 this is exact.
    fn floats(self, a: Self::I) -> Self::F;
    /// Sign bits, lane 0 of the first lowest.
    fn signs(self, a: [Self::I; 2]) -> u32;

    fn qload(self, v: &[f64; 2]) -> Self::Q;
    fn qstore(self, v: Self::Q, to: &mut [f64; 2]);
    fn qsplat(self, v: f64) -> Self::Q;
    fn qadd(self, a: Self::Q, b: Self::Q) -> Self::Q;
    fn qsub(self, a: Self::Q, b: Self::Q) -> Self::Q;
    fn qmul(self, a: Self::Q, b: Self::Q) -> Self::Q;
    fn qdiv(self, a: Self::Q, b: Self::Q) -> Self::Q;
    fn qabs(self, a: Self::Q) -> Self::Q;
    fn qlt(self, a: [Self::Q; 2], b: [Self::Q; 2]) -> u32;
    /// As [`Registers::min`].
    fn qmin(self, a: Self::Q, b: Self::Q) -> Self::Q;
    /// As [`Registers::max`].
    fn qmax(self, a: Self::Q, b: Self::Q) -> Self::Q;
    /// Towards zero, of numbers that an `i32` can hold.
    fn qwhole(self, v: [Self::Q; 2]) -> Self::I;

    fn hload(self, v: &[i16; 8]) -> Self::H;
    fn hstore(self, v: Self::H, to: &mut [i16; 8]);
    fn hsplat(self, v: i16) -> Self::H;
    fn hmin(self, a: Self::H, b: Self::H) -> Self::H;
    fn hmax(self, a: Self::H, b: Self::H) -> Self::H;
    /// `a - b`, or the nearest number that an `i16` can hold.
    fn hsub(self, a: Self::H, b: Self::H) -> Self::H;
    /// All ones where `a > b`.
    fn hgt(self, a: Self::H, b: Self::H) -> Self::H;
    fn hselect(self, mask: Self::H, a: Self::H, b: Self::H) -> Self::H;
    /// All ones where the bit is set: eight per register, lane 0 of the first lowest.
    fn hmasks(self, bits: u64) -> [Self::H; 8];
    /// Two times four numbers, each the nearest that an `i16` can hold.
    fn hpack(self, a: [Self::I; 2]) -> Self::H;
    fn hleast(self, a: Self::H) -> i16;
    /// Each the nearest number that a byte can hold, from 0 to 255.
    fn hbytes(self, a: [Self::H; 2]) -> Self::B;

    fn bload(self, v: &[u64; 2]) -> Self::B;
    fn bstore(self, v: Self::B, to: &mut [u64; 2]);
    fn bsplat(self, v: u64) -> Self::B;
    fn band(self, a: Self::B, b: Self::B) -> Self::B;
    fn bor(self, a: Self::B, b: Self::B) -> Self::B;
    /// `!a & b`.
    fn bandnot(self, a: Self::B, b: Self::B) -> Self::B;
    fn bhalves(self, a: Self::B) -> [u64; 2];
    /// A bit per lane of masks, lane 0 of the first lowest.
    fn hbits(self, masks: [Self::H; 8]) -> u64;
    /// From numbers 0 to 32, one per row of eight pixels with four samples each: for every column
    /// of samples, the pixels whose sample is at or right of the n-th of the row.
    fn right_of(self, n: Self::B) -> [Self::B; 4];
}
