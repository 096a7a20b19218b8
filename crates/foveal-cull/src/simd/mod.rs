//! Lanes: the one seam between the kernels and instruction sets.
//!
//! Kernels are written once, generic over [`Lanes`], and instantiated for the portable implementation
//! (plain arrays, which the compiler turns into SSE2, NEON or wasm SIMD) and for AVX2. There is no fused
//! multiply-add and no approximate reciprocal anywhere, so that every instruction set gives the same bits.

pub(crate) mod portable;

#[cfg(target_arch = "x86_64")]
#[allow(
    unsafe_code,
    reason = "the one place for intrinsics; every method is held to the portable twin by a test"
)]
pub(crate) mod avx2;

/// `[e(0), e(1), e(2), e(3)]`. Kernels use this and `#[inline(always)]` functions in place of closures: what
/// is not inlined loses the instruction set.
macro_rules! four {
    ($k:ident => $e:expr) => {
        [
            {
                let $k = 0usize;
                $e
            },
            {
                let $k = 1usize;
                $e
            },
            {
                let $k = 2usize;
                $e
            },
            {
                let $k = 3usize;
                $e
            },
        ]
    };
}
pub(crate) use four;

/// Work that is written once and compiled per instruction set. `run` must be `#[inline(always)]`.
pub(crate) trait Kernel {
    /// What it gives back.
    type Output;
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// An instruction set that this machine has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InstructionSet {
    /// Plain arrays as the compiler vectorizes them for the target (SSE2 on x86-64).
    Portable,
    /// 256-bit AVX2.
    Avx2,
}

impl InstructionSet {
    /// The fastest one that this CPU has.
    #[must_use]
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if avx2::Avx2::detect().is_some() {
            return Self::Avx2;
        }
        Self::Portable
    }

    /// Runs a kernel with this instruction set (with the portable one where the CPU lacks it).
    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[cfg(target_arch = "x86_64")]
        if self == Self::Avx2
            && let Some(lanes) = avx2::Avx2::detect()
        {
            return lanes.run(kernel);
        }
        kernel.run(portable::Portable)
    }
}

/// Eight 32-bit lanes, sixteen 16-bit lanes, thirty-two bytes.
pub(crate) trait Lanes: Copy {
    /// 8 x f32.
    type F: Copy;
    /// 8 x i32.
    type I: Copy;
    /// 16 x i16.
    type H: Copy;
    /// 32 x u8.
    type B: Copy;

    fn splat(self, v: f32) -> Self::F;
    fn load(self, v: &[f32; 8]) -> Self::F;
    fn store(self, v: Self::F, to: &mut [f32; 8]);
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// `if a < b { a } else { b }` (the second on NaN).
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// `if a > b { a } else { b }` (the second on NaN).
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    fn abs(self, a: Self::F) -> Self::F;
    /// All ones where `a < b`.
    fn lt(self, a: Self::F, b: Self::F) -> Self::I;
    /// `mask` lanes from `a`, others from `b`; masks are all ones or all zeroes.
    fn select(self, mask: Self::I, a: Self::F, b: Self::F) -> Self::F;
    /// Towards zero; lanes out of range give `i32::MIN`.
    fn trunc(self, a: Self::F) -> Self::I;
    fn bits(self, a: Self::F) -> Self::I;
    fn gather(self, table: &[f32; 256], index: &[u8; 8]) -> Self::F;

    fn isplat(self, v: i32) -> Self::I;
    fn isub(self, a: Self::I, b: Self::I) -> Self::I;
    fn iand(self, a: Self::I, b: Self::I) -> Self::I;
    fn ior(self, a: Self::I, b: Self::I) -> Self::I;
    fn ixor(self, a: Self::I, b: Self::I) -> Self::I;
    /// `!a & b`.
    fn iandnot(self, a: Self::I, b: Self::I) -> Self::I;
    /// Arithmetic shift right by 12.
    fn isra12(self, a: Self::I) -> Self::I;
    /// Sign bits, lane 0 lowest.
    fn movemask(self, a: Self::I) -> u32;

    /// Sixteen lanes from two times eight, saturating, `a` first.
    fn pack16(self, a: Self::I, b: Self::I) -> Self::H;
    fn hload(self, v: &[i16; 16]) -> Self::H;
    fn hstore(self, v: Self::H, to: &mut [i16; 16]);
    fn hsplat(self, v: i16) -> Self::H;
    fn hmin(self, a: Self::H, b: Self::H) -> Self::H;
    fn hmax(self, a: Self::H, b: Self::H) -> Self::H;
    /// All ones where `a > b`.
    fn hgt(self, a: Self::H, b: Self::H) -> Self::H;
    fn hselect(self, mask: Self::H, a: Self::H, b: Self::H) -> Self::H;
    /// One bit per lane (of a mask), lane 0 lowest.
    fn hbits(self, mask: Self::H) -> u16;
    /// A mask from one bit per lane.
    fn hmask(self, bits: u16) -> Self::H;
    fn hreduce_min(self, a: Self::H) -> i16;

    /// Thirty-two bytes from four times eight lanes that are all in `0..=127`.
    fn pack8(self, v: [Self::I; 4]) -> Self::B;
    fn bsplat(self, v: u8) -> Self::B;
    fn badd(self, a: Self::B, b: Self::B) -> Self::B;
    fn band(self, a: Self::B, b: Self::B) -> Self::B;
    fn bor(self, a: Self::B, b: Self::B) -> Self::B;
    /// `!a & b`.
    fn bandnot(self, a: Self::B, b: Self::B) -> Self::B;
    /// `a >> 2`, per byte.
    fn bshr2(self, a: Self::B) -> Self::B;
    /// All ones where `a > b` (both below 128).
    fn bgt(self, a: Self::B, b: Self::B) -> Self::B;
    fn bselect(self, mask: Self::B, a: Self::B, b: Self::B) -> Self::B;
    /// `table[index]`, each index below 16.
    fn blookup(self, table: &[u8; 16], index: Self::B) -> Self::B;
    fn bload(self, v: &[u64; 4]) -> Self::B;
    fn bstore(self, v: Self::B, to: &mut [u64; 4]);
    /// The four 64-bit quarters ANDed.
    fn band_fold(self, v: Self::B) -> u64;
    /// The four 64-bit quarters ORed.
    fn bor_fold(self, v: Self::B) -> u64;
    fn bsplat64(self, v: u64) -> Self::B;
}
