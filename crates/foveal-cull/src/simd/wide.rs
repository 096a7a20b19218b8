//! Sixteen lanes, for work that is done to every box: one register where the instruction set has
//! such, else twice eight.

use crate::bounds::Aabb;

/// Sixteen lanes. What a method does is as in [`Lanes`](super::lanes::Lanes); masks are a bit per
/// lane, lane 0 lowest.
pub(crate) trait Wide: Copy {
    /// 16 x f32.
    type F: Copy;
    /// 16 x i32.
    type I: Copy;

    fn splat(self, v: f32) -> Self::F;
    fn load(self, v: &[f32; 16]) -> Self::F;
    fn store(self, v: Self::F, to: &mut [f32; 16]);
    /// The first eight lanes, and the others.
    fn pair(self, low: &[f32; 8], high: &[f32; 8]) -> Self::F;
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    fn abs(self, a: Self::F) -> Self::F;
    fn lt(self, a: Self::F, b: Self::F) -> u32;
    /// `a` where the bit is set, else `b`.
    fn select(self, bits: u32, a: Self::F, b: Self::F) -> Self::F;
    fn trunc(self, a: Self::F) -> Self::I;
    fn codes(self, a: Self::F) -> Self::I;
    fn isplat(self, v: i32) -> Self::I;
    fn iload(self, v: &[i32; 16]) -> Self::I;
    fn istore(self, v: Self::I, to: &mut [i32; 16]);
    fn iadd(self, a: Self::I, b: Self::I) -> Self::I;
    fn isub(self, a: Self::I, b: Self::I) -> Self::I;
    fn imul(self, a: Self::I, b: Self::I) -> Self::I;
    fn imin(self, a: Self::I, b: Self::I) -> Self::I;
    fn imax(self, a: Self::I, b: Self::I) -> Self::I;
    fn ishr(self, a: Self::I, by: Self::I) -> Self::I;
    fn ibits(self, a: Self::I) -> Self::I;
    /// Whether a number is below zero.
    fn negative(self, a: Self::I) -> u32;
    fn transpose(self, v: &[Aabb; 16]) -> [Self::F; 6];
}
