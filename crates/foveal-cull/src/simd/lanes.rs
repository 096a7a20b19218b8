//! Lanes: the operations that kernels are written in.

use super::wide::Wide;
use crate::bounds::Aabb;

/// Work that is written once and compiled per instruction set. `run` must be `#[inline(always)]`.
pub(crate) trait Kernel {
    /// Result of the kernel.
    type Output;
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Eight lanes for set-up and projection, and the parts of a block: pixels, sample rows, bit
/// planes.
pub(crate) trait Lanes: Copy {
    /// 8 x f32.
    type F: Copy;
    /// 8 x i32.
    type I: Copy;
    /// 4 x f64: the corners or edges of a polygon.
    type Q: Copy;
    /// 64 x i16: a block's pixels, row by row.
    type D: Copy;
    /// 2 x 40 whole numbers: the first covered sample (or pixel, by its centre) of each of a
    /// block's 32 sample rows and 8 rows through pixel centres, and the first one after. At least
    /// 16 bits.
    type S: Copy;
    /// 4 x 40 x f64: the edges of a polygon in a block's 32 sample rows, and in 8 rows through
    /// pixel centres.
    type B: Copy;
    /// 64 x 16 bits: a block's samples as bit planes, in any order.
    type P: Copy;
    /// Sixteen lanes.
    type W: Wide;

    fn wide(self) -> Self::W;

    /// Runs a kernel in a function of its own. Rare work is kept out of line, so that it does not
    /// spoil the code around it.
    #[inline(never)]
    fn outlined<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }

    /// Prefetches memory. Changes nothing.
    #[inline(always)]
    fn prefetch<T>(self, _soon: &T) {}

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
    /// Depth codes before they are clamped (see [`crate::format::encode`]), of depths above zero.
    fn codes(self, a: Self::F) -> Self::I;
    fn gather(self, table: &[f32; 256], index: &[u8; 8]) -> Self::F;

    /// Eight boxes by coordinate: smallest x, y and z, largest x, y and z.
    fn transpose(self, v: &[Aabb; 8]) -> [Self::F; 6];

    fn isplat(self, v: i32) -> Self::I;
    fn iadd(self, a: Self::I, b: Self::I) -> Self::I;
    fn imin(self, a: Self::I, b: Self::I) -> Self::I;
    fn imax(self, a: Self::I, b: Self::I) -> Self::I;
    fn imul(self, a: Self::I, b: Self::I) -> Self::I;
    /// `a >> by`, `by` from 0 to 31.
    fn ishr(self, a: Self::I, by: Self::I) -> Self::I;
    /// Number of bits of a number from 0 to 2^24.
    fn ibits(self, a: Self::I) -> Self::I;
    fn iload(self, v: &[i32; 8]) -> Self::I;
    fn istore(self, v: Self::I, to: &mut [i32; 8]);
    fn isub(self, a: Self::I, b: Self::I) -> Self::I;
    fn iand(self, a: Self::I, b: Self::I) -> Self::I;
    fn ior(self, a: Self::I, b: Self::I) -> Self::I;
    /// `!a & b`.
    fn iandnot(self, a: Self::I, b: Self::I) -> Self::I;
    /// Sign bits, lane 0 lowest.
    fn movemask(self, a: Self::I) -> u32;

    fn qgather(self, table: &[f64; 256], index: [u8; 4]) -> Self::Q;
    fn qload(self, v: &[f64; 4]) -> Self::Q;
    fn qstore(self, v: Self::Q, to: &mut [f64; 4]);
    fn qsplat(self, v: f64) -> Self::Q;
    fn qadd(self, a: Self::Q, b: Self::Q) -> Self::Q;
    fn qsub(self, a: Self::Q, b: Self::Q) -> Self::Q;
    fn qmul(self, a: Self::Q, b: Self::Q) -> Self::Q;
    fn qdiv(self, a: Self::Q, b: Self::Q) -> Self::Q;
    fn qabs(self, a: Self::Q) -> Self::Q;
    /// A bit per lane where `a < b`, lane 0 lowest.
    fn qlt(self, a: Self::Q, b: Self::Q) -> u32;
    /// Number `i` of the result is number `from[i]`, of which the two lowest bits count.
    fn qpick(self, v: Self::Q, from: [u8; 4]) -> Self::Q;

    /// Pixels from a value for each column at the top, and its change per row: as depth codes (see
    /// [`crate::format`]), no value below `floor` and no code above `cap`.
    fn depths(self, columns: Self::F, down: f32, floor: f32, cap: i16) -> Self::D;
    fn dload(self, v: &[i16; 64]) -> Self::D;
    fn dstore(self, v: Self::D, to: &mut [i16; 64]);
    fn dsplat(self, v: i16) -> Self::D;
    fn dmin(self, a: Self::D, b: Self::D) -> Self::D;
    fn dmax(self, a: Self::D, b: Self::D) -> Self::D;
    /// A bit per pixel where `a > b`.
    fn dgt(self, a: Self::D, b: Self::D) -> u64;
    /// A bit per pixel where `a` and `b` are further apart than `by`.
    fn dapart(self, a: Self::D, b: Self::D, by: i16) -> u64;
    /// `a` where the bit is set, else `b`.
    fn dselect(self, bits: u64, a: Self::D, b: Self::D) -> Self::D;
    fn dreduce_min(self, a: Self::D) -> i16;

    /// Distances that four edges move from the first row of samples to every other, and to the rows
    /// through pixel centres.
    fn edge_rows(self, slope: Self::Q) -> Self::B;
    /// Spans right of the first two edges and left of the last two, in `f64`, row by row as
    /// [`Portable`](super::portable::Portable) has it. `at`: where they cross the first row; sample
    /// n is right of what is less than n + 1. `limits`: only rows after the first one and not after
    /// the second count.
    fn spans(self, at: Self::Q, edges: &Self::B, limits: Option<[f64; 2]>) -> Self::S;
    /// The samples and the pixel centres of the spans in the block that begins at sample `left`.
    fn within(self, spans: &Self::S, left: u32) -> (Self::P, u64);
    /// Eight rows of eight pixels: those from one number to before another.
    fn bit_rows(self, from: Self::I, to: Self::I) -> u64;
    fn pload(self, v: &[u64; 16]) -> Self::P;
    fn pstore(self, v: Self::P, to: &mut [u64; 16]);
    /// Only the pixels whose bit is set.
    fn pkeep(self, v: Self::P, bits: u64) -> Self::P;
    fn por(self, a: Self::P, b: Self::P) -> Self::P;
    /// Pixels of which every sample is set.
    fn pall(self, v: Self::P) -> u64;
    /// Pixels of which any sample is set.
    fn pany(self, v: Self::P) -> u64;
}
