//! Sixteen lanes as twice eight.

use super::arrays::two;
use super::lanes::{Lanes, Sixteen, Vectors};
use crate::bounds::Aabb;

/// Eight lanes, all ones where a bit is set.
const MASKS: [[i32; 8]; 256] = {
    let mut masks = [[0; 8]; 256];
    let mut n = 0;
    while n < 256 * 8 {
        masks[n / 8][n % 8] = -(((n / 8) >> (n % 8) & 1) as i32);
        n += 1;
    }
    masks
};

/// Two registers of eight.
#[derive(Clone, Copy)]
pub(crate) struct Twice<L>(pub(super) L);

macro_rules! by_halves {
    ($($name:ident($($arg:ident: $type:ty),*) -> $out:ty;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($arg: $type),*) -> $out {
                two!(k => self.0.$name($($arg[k]),*))
            }
        )*
    };
}

impl<L: Lanes> Vectors<16> for Twice<L> {
    type F = [L::F; 2];
    type I = [L::I; 2];
    type M = u16;

    by_halves! {
        fadd(a: Self::F, b: Self::F) -> Self::F;
        fsub(a: Self::F, b: Self::F) -> Self::F;
        fmul(a: Self::F, b: Self::F) -> Self::F;
        fdiv(a: Self::F, b: Self::F) -> Self::F;
        fmin(a: Self::F, b: Self::F) -> Self::F;
        fmax(a: Self::F, b: Self::F) -> Self::F;
        fabs(a: Self::F) -> Self::F;
        ftrunc(a: Self::F) -> Self::I;
        fcodes(a: Self::F) -> Self::I;
        iadd(a: Self::I, b: Self::I) -> Self::I;
        isub(a: Self::I, b: Self::I) -> Self::I;
        imul(a: Self::I, b: Self::I) -> Self::I;
        imin(a: Self::I, b: Self::I) -> Self::I;
        imax(a: Self::I, b: Self::I) -> Self::I;
        ishr(a: Self::I, by: Self::I) -> Self::I;
        ibits(a: Self::I) -> Self::I;
    }
    #[inline(always)]
    fn fsplat(self, v: f32) -> Self::F {
        [self.0.fsplat(v); 2]
    }
    #[inline(always)]
    fn fload(self, v: &[f32; 16]) -> Self::F {
        let (halves, _) = v.as_chunks::<8>();
        two!(k => self.0.fload(&halves[k]))
    }
    #[inline(always)]
    fn fstore(self, v: Self::F, to: &mut [f32; 16]) {
        let (halves, _) = to.as_chunks_mut::<8>();
        two!(k => self.0.fstore(v[k], &mut halves[k]));
    }
    #[inline(always)]
    fn isplat(self, v: i32) -> Self::I {
        [self.0.isplat(v); 2]
    }
    #[inline(always)]
    fn flt(self, a: Self::F, b: Self::F) -> u16 {
        bits(self.0, two!(k => self.0.flt(a[k], b[k])))
    }
    #[inline(always)]
    fn fselect(self, mask: u16, a: Self::F, b: Self::F) -> Self::F {
        two!(k => {
            let mask = self.0.mload(&MASKS[usize::from(mask >> (8 * k)) % 256]);
            self.0.fselect(mask, a[k], b[k])
        })
    }
    #[inline(always)]
    fn ilt(self, a: Self::I, b: Self::I) -> u16 {
        bits(self.0, two!(k => self.0.ilt(a[k], b[k])))
    }
    #[inline(always)]
    fn iload(self, v: &[i32; 16]) -> Self::I {
        let (halves, _) = v.as_chunks::<8>();
        two!(k => self.0.iload(&halves[k]))
    }
    #[inline(always)]
    fn istore(self, v: Self::I, to: &mut [i32; 16]) {
        let (halves, _) = to.as_chunks_mut::<8>();
        two!(k => self.0.istore(v[k], &mut halves[k]));
    }
    #[inline(always)]
    fn ftranspose(self, v: &[Aabb; 16]) -> [Self::F; 6] {
        let (halves, _) = v.as_chunks::<8>();
        let [low, high] = two!(k => self.0.ftranspose(&halves[k]));
        let [a, b, c, d, e, f] = low;
        let [p, q, r, s, t, u] = high;
        [[a, p], [b, q], [c, r], [d, s], [e, t], [f, u]]
    }
    #[inline(always)]
    fn mall(self) -> u16 {
        u16::MAX
    }
    #[inline(always)]
    fn mand(self, a: u16, b: u16) -> u16 {
        a & b
    }
    #[inline(always)]
    fn mor(self, a: u16, b: u16) -> u16 {
        a | b
    }
    #[inline(always)]
    fn mandnot(self, a: u16, b: u16) -> u16 {
        !a & b
    }
    #[inline(always)]
    fn mbits(self, a: u16) -> u32 {
        u32::from(a)
    }
}

impl<L: Lanes> Sixteen for Twice<L> {
    #[inline(always)]
    fn fpair(self, low: &[f32; 8], high: &[f32; 8]) -> Self::F {
        [self.0.fload(low), self.0.fload(high)]
    }
}

/// A bit per lane of two masks.
#[inline(always)]
fn bits<L: Lanes>(l: L, [low, high]: [L::M; 2]) -> u16 {
    (l.mbits(low) | l.mbits(high) << 8) as u16
}
