//! The types that kernels are written in: lanes with operators, one set for all instruction sets
//! and widths. Each value carries its [`Vectors`], which takes no memory, so that only a CPU with
//! the instruction set has one.

use super::lanes::{Lanes, Sixteen, Vectors};
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Shr, Sub};

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
