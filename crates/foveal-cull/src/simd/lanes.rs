//! What an instruction set must do, and the types that kernels are written in: lanes with
//! operators, one set for all instruction sets and widths. Each value carries its [`Vectors`], which
//! takes no memory, so that only a CPU with the instruction set has one. Traits and types name each
//! other, which is why they are one file.

use crate::bounds::Aabb;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Shr, Sub};

/// Work that is written once and compiled per instruction set. `run` must be `#[inline(always)]`.
pub(crate) trait Kernel {
    /// Result of the kernel.
    type Output;
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// `N` lanes of `f32` and `i32`: eight for set-up and projection, sixteen for work that is done to
/// every box. A value proves that the CPU has the instruction set.
///
/// The methods whose names begin with `f`, `i` and `m` are the instruction set's, for floats, whole
/// numbers and masks; what they do is defined by [`Portable`](super::portable::Portable). The
/// others, which kernels use, are the same for all.
pub(crate) trait Vectors<const N: usize>: Copy {
    /// N x f32.
    type F: Copy;
    /// N x i32.
    type I: Copy;
    /// A truth value per lane.
    type M: Copy;

    fn fsplat(self, v: f32) -> Self::F;
    fn fload(self, v: &[f32; N]) -> Self::F;
    fn fstore(self, v: Self::F, to: &mut [f32; N]);
    fn fadd(self, a: Self::F, b: Self::F) -> Self::F;
    fn fsub(self, a: Self::F, b: Self::F) -> Self::F;
    fn fmul(self, a: Self::F, b: Self::F) -> Self::F;
    fn fdiv(self, a: Self::F, b: Self::F) -> Self::F;
    /// `if a < b { a } else { b }` (the second on NaN).
    fn fmin(self, a: Self::F, b: Self::F) -> Self::F;
    /// `if a > b { a } else { b }` (the second on NaN).
    fn fmax(self, a: Self::F, b: Self::F) -> Self::F;
    fn fabs(self, a: Self::F) -> Self::F;
    fn flt(self, a: Self::F, b: Self::F) -> Self::M;
    /// Lanes of `mask` from `a`, others from `b`.
    fn fselect(self, mask: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// Towards zero; lanes out of range give `i32::MIN`.
    fn ftrunc(self, a: Self::F) -> Self::I;
    /// Depth codes before they are clamped (see [`crate::format::encode`]), of depths above zero.
    fn fcodes(self, a: Self::F) -> Self::I;
    /// Boxes by coordinate: smallest x, y and z, largest x, y and z.
    fn ftranspose(self, v: &[Aabb; N]) -> [Self::F; 6];

    fn isplat(self, v: i32) -> Self::I;
    fn iload(self, v: &[i32; N]) -> Self::I;
    fn istore(self, v: Self::I, to: &mut [i32; N]);
    fn iadd(self, a: Self::I, b: Self::I) -> Self::I;
    fn isub(self, a: Self::I, b: Self::I) -> Self::I;
    fn imul(self, a: Self::I, b: Self::I) -> Self::I;
    fn imin(self, a: Self::I, b: Self::I) -> Self::I;
    fn imax(self, a: Self::I, b: Self::I) -> Self::I;
    /// `a >> by`, `by` from 0 to 31.
    fn ishr(self, a: Self::I, by: Self::I) -> Self::I;
    /// Number of bits of a number from 0 to 2^24.
    fn ibits(self, a: Self::I) -> Self::I;
    fn ilt(self, a: Self::I, b: Self::I) -> Self::M;

    /// All lanes.
    fn mall(self) -> Self::M;
    fn mand(self, a: Self::M, b: Self::M) -> Self::M;
    fn mor(self, a: Self::M, b: Self::M) -> Self::M;
    /// `!a & b`.
    fn mandnot(self, a: Self::M, b: Self::M) -> Self::M;
    /// A bit per lane, lane 0 lowest.
    fn mbits(self, a: Self::M) -> u32;

    /// The same number in every lane.
    #[inline(always)]
    fn splat(self, v: f32) -> Floats<Self, N> {
        Floats::new(self, self.fsplat(v))
    }
    #[inline(always)]
    fn load(self, v: &[f32; N]) -> Floats<Self, N> {
        Floats::new(self, self.fload(v))
    }
    /// Boxes by coordinate: smallest x, y and z, largest x, y and z.
    #[inline(always)]
    fn transpose(self, v: &[Aabb; N]) -> [Floats<Self, N>; 6] {
        let [a, b, c, d, e, f] = self.ftranspose(v);
        [
            Floats::new(self, a),
            Floats::new(self, b),
            Floats::new(self, c),
            Floats::new(self, d),
            Floats::new(self, e),
            Floats::new(self, f),
        ]
    }
    /// The same whole number in every lane.
    #[inline(always)]
    fn int(self, v: i32) -> Ints<Self, N> {
        Ints::new(self, self.isplat(v))
    }
    #[inline(always)]
    fn load_ints(self, v: &[i32; N]) -> Ints<Self, N> {
        Ints::new(self, self.iload(v))
    }
    /// The mask of all lanes.
    #[inline(always)]
    fn all(self) -> Mask<Self, N> {
        Mask::new(self, self.mall())
    }
}

/// Sixteen lanes, whose masks are a bit per lane.
pub(crate) trait Sixteen: Vectors<16, M = u16> {
    /// The first eight lanes, and the others.
    fn fpair(self, low: &[f32; 8], high: &[f32; 8]) -> Self::F;

    /// The first eight lanes, and the others.
    #[inline(always)]
    fn pair(self, low: &[f32; 8], high: &[f32; 8]) -> Floats<Self, 16> {
        Floats::new(self, self.fpair(low, high))
    }
    /// The mask of the lanes whose bit is set, lane 0 lowest.
    #[inline(always)]
    fn mask(self, bits: u32) -> Mask<Self, 16> {
        Mask::new(self, bits as u16)
    }
}

/// Eight lanes, and what a block is made of: edges in `f64`, depths, samples.
pub(crate) trait Lanes: Vectors<8> {
    /// 4 x f64: the corners or edges of a polygon.
    type Q: Copy;
    /// 64 x i16: a block's pixels, row by row.
    type D: Copy;
    /// 2 x 40 whole numbers: the first covered sample (or pixel, by its centre) of each of a
    /// block's 32 sample rows and 8 rows through pixel centres, and the first one after. At least
    /// 15 bits; what is left of the screen may be 0.
    type S: Copy;
    /// 4 x 40 x f64: the edges of a polygon in a block's 32 sample rows, and in 8 rows through
    /// pixel centres.
    type B: Copy;
    /// 64 x 16 bits: a block's samples as bit planes, in any order.
    type P: Copy;
    /// Sixteen lanes.
    type W: Sixteen;

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

    fn fgather(self, table: &[f32; 256], index: &[u8; 8]) -> Self::F;
    /// A mask from all ones and all zeroes.
    fn mload(self, v: &[i32; 8]) -> Self::M;
    fn mstore(self, v: Self::M, to: &mut [i32; 8]);

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
    fn dplane(self, columns: Self::F, down: f32, floor: f32, cap: i16) -> Self::D;
    fn dload(self, v: &[i16; 64]) -> Self::D;
    fn dstore(self, v: Self::D, to: &mut [i16; 64]);
    fn dsplat(self, v: i16) -> Self::D;
    fn dmin(self, a: Self::D, b: Self::D) -> Self::D;
    fn dmax(self, a: Self::D, b: Self::D) -> Self::D;
    /// A bit per pixel where `a > b`.
    fn dgt(self, a: Self::D, b: Self::D) -> u64;
    /// A bit per pixel where `a` and `b` are further apart than `by`, which is not below zero and
    /// less than the greatest number.
    fn dapart(self, a: Self::D, b: Self::D, by: i16) -> u64;
    /// `a` where the bit is set, else `b`.
    fn dselect(self, bits: u64, a: Self::D, b: Self::D) -> Self::D;
    fn dreduce_min(self, a: Self::D) -> i16;

    /// Distances that four edges move from the first row of samples to every other, and to the rows
    /// through pixel centres.
    fn qrows(self, slope: Self::Q) -> Self::B;
    /// Spans right of the first two edges and left of the last two, in `f64`, row by row as
    /// [`Portable`](super::portable::Portable) has it. `at`: where they cross the first row; sample
    /// n is right of what is less than n + 1. `limits`: only rows after the first one and not after
    /// the second count.
    fn qspans(self, at: Self::Q, edges: &Self::B, limits: Option<[f64; 2]>) -> Self::S;
    /// The samples and the pixel centres of the spans in the block that begins at sample `left`.
    fn pwithin(self, spans: &Self::S, left: u32) -> (Self::P, u64);
    /// Eight rows of eight pixels: those from one number to before another.
    fn irows(self, from: Self::I, to: Self::I) -> u64;
    fn pload(self, v: &[u64; 16]) -> Self::P;
    fn pstore(self, v: Self::P, to: &mut [u64; 16]);
    /// Only the pixels whose bit is set.
    fn pkeep(self, v: Self::P, bits: u64) -> Self::P;
    fn por(self, a: Self::P, b: Self::P) -> Self::P;
    /// Pixels of which every sample is set.
    fn pall(self, v: Self::P) -> u64;
    /// Pixels of which any sample is set.
    fn pany(self, v: Self::P) -> u64;

    #[inline(always)]
    fn gather(self, table: &[f32; 256], index: &[u8; 8]) -> Floats<Self, 8> {
        Floats::new(self, self.fgather(table, index))
    }
    /// A mask from all ones and all zeroes.
    #[inline(always)]
    fn load_mask(self, v: &[i32; 8]) -> Mask<Self, 8> {
        Mask::new(self, self.mload(v))
    }
    #[inline(always)]
    fn double(self, v: f64) -> Doubles<Self> {
        Doubles::new(self, self.qsplat(v))
    }
    #[inline(always)]
    fn load_doubles(self, v: &[f64; 4]) -> Doubles<Self> {
        Doubles::new(self, self.qload(v))
    }
    #[inline(always)]
    fn gather_doubles(self, table: &[f64; 256], index: [u8; 4]) -> Doubles<Self> {
        Doubles::new(self, self.qgather(table, index))
    }
    /// The same depth code in every pixel.
    #[inline(always)]
    fn depth(self, v: i16) -> Depths<Self> {
        Depths::new(self, self.dsplat(v))
    }
    #[inline(always)]
    fn load_depths(self, v: &[i16; 64]) -> Depths<Self> {
        Depths::new(self, self.dload(v))
    }
    #[inline(always)]
    fn load_samples(self, v: &[u64; 16]) -> Samples<Self> {
        Samples::new(self, self.pload(v))
    }
    /// The samples and the pixel centres of the spans in the block that begins at sample `left`.
    #[inline(always)]
    fn within(self, spans: &Self::S, left: u32) -> (Samples<Self>, u64) {
        let (samples, centers) = self.pwithin(spans, left);
        (Samples::new(self, samples), centers)
    }
}

/// N x f32.
#[derive(Clone, Copy)]
pub(crate) struct Floats<V: Vectors<N>, const N: usize> {
    with: V,
    v: V::F,
}

/// N x i32, which wrap around.
#[derive(Clone, Copy)]
pub(crate) struct Ints<V: Vectors<N>, const N: usize> {
    with: V,
    v: V::I,
}

/// A truth value per lane.
#[derive(Clone, Copy)]
pub(crate) struct Mask<V: Vectors<N>, const N: usize> {
    with: V,
    v: V::M,
}

/// 4 x f64: the corners or edges of a polygon.
#[derive(Clone, Copy)]
pub(crate) struct Doubles<L: Lanes> {
    with: L,
    v: L::Q,
}

/// The depth codes of a block's 64 pixels.
#[derive(Clone, Copy)]
pub(crate) struct Depths<L: Lanes> {
    with: L,
    v: L::D,
}

/// The 16 samples of each of a block's 64 pixels, a bit each.
#[derive(Clone, Copy)]
pub(crate) struct Samples<L: Lanes> {
    with: L,
    v: L::P,
}

pub(crate) type F8<L> = Floats<L, 8>;
pub(crate) type I8<L> = Ints<L, 8>;
pub(crate) type M8<L> = Mask<L, 8>;
pub(crate) type F16<W> = Floats<W, 16>;
pub(crate) type I16<W> = Ints<W, 16>;
pub(crate) type M16<W> = Mask<W, 16>;

/// Operators between two values of a type, and with the same number in every lane.
macro_rules! operator {
    ($trait:ident $name:ident is $of:ident of $type:ty, for $($generics:tt)*) => {
        impl<$($generics)*> $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self::new(self.with, self.with.$of(self.v, other.v))
            }
        }
    };
    ($trait:ident $name:ident with $one:ident by $splat:ident of $type:ty, for $($generics:tt)*) => {
        impl<$($generics)*> $trait<$one> for $type {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: $one) -> Self {
                self.$name(Self::new(self.with, self.with.$splat(other)))
            }
        }
    };
}

operator! { Add add is fadd of Floats<V, N>, for V: Vectors<N>, const N: usize }
operator! { Sub sub is fsub of Floats<V, N>, for V: Vectors<N>, const N: usize }
operator! { Mul mul is fmul of Floats<V, N>, for V: Vectors<N>, const N: usize }
operator! { Div div is fdiv of Floats<V, N>, for V: Vectors<N>, const N: usize }
operator! { Add add with f32 by fsplat of Floats<V, N>, for V: Vectors<N>, const N: usize }
operator! { Sub sub with f32 by fsplat of Floats<V, N>, for V: Vectors<N>, const N: usize }
operator! { Mul mul with f32 by fsplat of Floats<V, N>, for V: Vectors<N>, const N: usize }
operator! { Add add is iadd of Ints<V, N>, for V: Vectors<N>, const N: usize }
operator! { Sub sub is isub of Ints<V, N>, for V: Vectors<N>, const N: usize }
operator! { Mul mul is imul of Ints<V, N>, for V: Vectors<N>, const N: usize }
operator! { Shr shr is ishr of Ints<V, N>, for V: Vectors<N>, const N: usize }
operator! { Add add with i32 by isplat of Ints<V, N>, for V: Vectors<N>, const N: usize }
operator! { Sub sub with i32 by isplat of Ints<V, N>, for V: Vectors<N>, const N: usize }
operator! { Mul mul with i32 by isplat of Ints<V, N>, for V: Vectors<N>, const N: usize }
operator! { Shr shr with i32 by isplat of Ints<V, N>, for V: Vectors<N>, const N: usize }
operator! { BitAnd bitand is mand of Mask<V, N>, for V: Vectors<N>, const N: usize }
operator! { BitOr bitor is mor of Mask<V, N>, for V: Vectors<N>, const N: usize }
operator! { Add add is qadd of Doubles<L>, for L: Lanes }
operator! { Sub sub is qsub of Doubles<L>, for L: Lanes }
operator! { Mul mul is qmul of Doubles<L>, for L: Lanes }
operator! { Div div is qdiv of Doubles<L>, for L: Lanes }
operator! { Add add with f64 by qsplat of Doubles<L>, for L: Lanes }
operator! { Sub sub with f64 by qsplat of Doubles<L>, for L: Lanes }
operator! { Mul mul with f64 by qsplat of Doubles<L>, for L: Lanes }
operator! { BitOr bitor is por of Samples<L>, for L: Lanes }

impl<V: Vectors<N>, const N: usize> Floats<V, N> {
    #[inline(always)]
    pub(super) fn new(with: V, v: V::F) -> Self {
        Self { with, v }
    }
    #[inline(always)]
    pub(crate) fn store(self, to: &mut [f32; N]) {
        self.with.fstore(self.v, to);
    }
    /// `if self < other { self } else { other }` (the second on NaN).
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self::new(self.with, self.with.fmin(self.v, other.v))
    }
    /// `if self > other { self } else { other }` (the second on NaN).
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self::new(self.with, self.with.fmax(self.v, other.v))
    }
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self::new(self.with, self.with.fabs(self.v))
    }
    #[inline(always)]
    pub(crate) fn lt(self, other: Self) -> Mask<V, N> {
        Mask::new(self.with, self.with.flt(self.v, other.v))
    }
    /// Where a number is neither infinite nor NaN.
    #[inline(always)]
    pub(crate) fn is_finite(self) -> Mask<V, N> {
        let zero = self.with.fsub(self.v, self.v);
        Mask::new(self.with, self.with.flt(zero, self.with.fsplat(1.0)))
    }
    /// Towards zero; lanes out of range give `i32::MIN`.
    #[inline(always)]
    pub(crate) fn trunc(self) -> Ints<V, N> {
        Ints::new(self.with, self.with.ftrunc(self.v))
    }
    /// Depth codes before they are clamped (see [`crate::format::encode`]), of depths above zero.
    #[inline(always)]
    pub(crate) fn codes(self) -> Ints<V, N> {
        Ints::new(self.with, self.with.fcodes(self.v))
    }
}

impl<L: Lanes> Floats<L, 8> {
    /// The pixels of a block from a value for each column at the top, and its change per row: as
    /// depth codes, no value below `floor` and no code above `cap`.
    #[inline(always)]
    pub(crate) fn plane(self, down: f32, floor: f32, cap: i16) -> Depths<L> {
        Depths::new(self.with, self.with.dplane(self.v, down, floor, cap))
    }
}

impl<V: Vectors<N>, const N: usize> Ints<V, N> {
    #[inline(always)]
    pub(super) fn new(with: V, v: V::I) -> Self {
        Self { with, v }
    }
    #[inline(always)]
    pub(crate) fn store(self, to: &mut [i32; N]) {
        self.with.istore(self.v, to);
    }
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self::new(self.with, self.with.imin(self.v, other.v))
    }
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self::new(self.with, self.with.imax(self.v, other.v))
    }
    /// Number of bits of a number from 0 to 2^24.
    #[inline(always)]
    pub(crate) fn significant_bits(self) -> Self {
        Self::new(self.with, self.with.ibits(self.v))
    }
    #[inline(always)]
    pub(crate) fn lt(self, other: Self) -> Mask<V, N> {
        Mask::new(self.with, self.with.ilt(self.v, other.v))
    }
}

impl<L: Lanes> Ints<L, 8> {
    /// Eight rows of eight pixels: those from one number to before another.
    #[inline(always)]
    pub(crate) fn rows_to(self, end: Self) -> u64 {
        self.with.irows(self.v, end.v)
    }
}

impl<V: Vectors<N>, const N: usize> Mask<V, N> {
    #[inline(always)]
    pub(super) fn new(with: V, v: V::M) -> Self {
        Self { with, v }
    }
    /// A bit per lane, lane 0 lowest.
    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        self.with.mbits(self.v)
    }
    /// Lanes of the mask from `a`, others from `b`.
    #[inline(always)]
    pub(crate) fn select(self, a: Floats<V, N>, b: Floats<V, N>) -> Floats<V, N> {
        Floats::new(self.with, self.with.fselect(self.v, a.v, b.v))
    }
}

impl<V: Vectors<N>, const N: usize> Not for Mask<V, N> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self::new(self.with, self.with.mandnot(self.v, self.with.mall()))
    }
}

impl<L: Lanes> Mask<L, 8> {
    /// All ones and all zeroes.
    #[inline(always)]
    pub(crate) fn store(self, to: &mut [i32; 8]) {
        self.with.mstore(self.v, to);
    }
}

impl<W: Sixteen> Mask<W, 16> {
    /// With the lanes flipped whose bit is set.
    #[inline(always)]
    pub(crate) fn flipped(self, bits: u32) -> Self {
        Self::new(self.with, self.v ^ bits as u16)
    }
}

impl<L: Lanes> Doubles<L> {
    #[inline(always)]
    pub(super) fn new(with: L, v: L::Q) -> Self {
        Self { with, v }
    }
    #[inline(always)]
    pub(crate) fn store(self, to: &mut [f64; 4]) {
        self.with.qstore(self.v, to);
    }
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self::new(self.with, self.with.qabs(self.v))
    }
    /// A bit per lane where `self < other`, lane 0 lowest.
    #[inline(always)]
    pub(crate) fn lt(self, other: Self) -> u32 {
        self.with.qlt(self.v, other.v)
    }
    /// Number `i` of the result is number `from[i]`, of which the two lowest bits count.
    #[inline(always)]
    pub(crate) fn pick(self, from: [u8; 4]) -> Self {
        Self::new(self.with, self.with.qpick(self.v, from))
    }
    /// Of slopes of edges: how far the edges move from the first row of samples to every other, and
    /// to the rows through pixel centres.
    #[inline(always)]
    pub(crate) fn edge_rows(self) -> L::B {
        self.with.qrows(self.v)
    }
    /// Of four edges' places in the first row, of which sample n is right of what is less than
    /// n + 1: the spans right of the first two and left of the last two. Only rows after the first
    /// of `limits` and not after the second count.
    #[inline(always)]
    pub(crate) fn spans(self, edges: &L::B, limits: Option<[f64; 2]>) -> L::S {
        self.with.qspans(self.v, edges, limits)
    }
}

impl<L: Lanes> Depths<L> {
    #[inline(always)]
    pub(super) fn new(with: L, v: L::D) -> Self {
        Self { with, v }
    }
    #[inline(always)]
    pub(crate) fn store(self, to: &mut [i16; 64]) {
        self.with.dstore(self.v, to);
    }
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self::new(self.with, self.with.dmin(self.v, other.v))
    }
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self::new(self.with, self.with.dmax(self.v, other.v))
    }
    /// Pixels where this is nearer.
    #[inline(always)]
    pub(crate) fn gt(self, other: Self) -> u64 {
        self.with.dgt(self.v, other.v)
    }
    /// Pixels where the two are further apart than `by`.
    #[inline(always)]
    pub(crate) fn apart(self, other: Self, by: i16) -> u64 {
        self.with.dapart(self.v, other.v, by)
    }
    /// `a` in the pixels, `b` in the others.
    #[inline(always)]
    pub(crate) fn select(pixels: u64, a: Self, b: Self) -> Self {
        Self::new(a.with, a.with.dselect(pixels, a.v, b.v))
    }
    /// The farthest of all pixels.
    #[inline(always)]
    pub(crate) fn farthest(self) -> i16 {
        self.with.dreduce_min(self.v)
    }
}

impl<L: Lanes> Samples<L> {
    #[inline(always)]
    pub(super) fn new(with: L, v: L::P) -> Self {
        Self { with, v }
    }
    #[inline(always)]
    pub(crate) fn store(self, to: &mut [u64; 16]) {
        self.with.pstore(self.v, to);
    }
    /// Only those of the pixels whose bit is set.
    #[inline(always)]
    pub(crate) fn keep(self, pixels: u64) -> Self {
        Self::new(self.with, self.with.pkeep(self.v, pixels))
    }
    /// Pixels of which every sample is set.
    #[inline(always)]
    pub(crate) fn all(self) -> u64 {
        self.with.pall(self.v)
    }
    /// Pixels of which any sample is set.
    #[inline(always)]
    pub(crate) fn any(self) -> u64 {
        self.with.pany(self.v)
    }
}
