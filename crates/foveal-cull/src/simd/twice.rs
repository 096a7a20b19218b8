//! Sixteen lanes as twice eight.

use super::arrays::two;
use super::lanes::Lanes;
use super::wide::Wide;
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

impl<L: Lanes> Wide for Twice<L> {
    type F = [L::F; 2];
    type I = [L::I; 2];

    by_halves! {
        add(a: Self::F, b: Self::F) -> Self::F;
        sub(a: Self::F, b: Self::F) -> Self::F;
        mul(a: Self::F, b: Self::F) -> Self::F;
        div(a: Self::F, b: Self::F) -> Self::F;
        min(a: Self::F, b: Self::F) -> Self::F;
        max(a: Self::F, b: Self::F) -> Self::F;
        abs(a: Self::F) -> Self::F;
        trunc(a: Self::F) -> Self::I;
        codes(a: Self::F) -> Self::I;
        iadd(a: Self::I, b: Self::I) -> Self::I;
        isub(a: Self::I, b: Self::I) -> Self::I;
        imul(a: Self::I, b: Self::I) -> Self::I;
        imin(a: Self::I, b: Self::I) -> Self::I;
        imax(a: Self::I, b: Self::I) -> Self::I;
        ishr(a: Self::I, by: Self::I) -> Self::I;
        ibits(a: Self::I) -> Self::I;
    }

    #[inline(always)]
    fn splat(self, v: f32) -> Self::F {
        [self.0.splat(v); 2]
    }
    #[inline(always)]
    fn load(self, v: &[f32; 16]) -> Self::F {
        let (halves, _) = v.as_chunks::<8>();
        two!(k => self.0.load(&halves[k]))
    }
    #[inline(always)]
    fn store(self, v: Self::F, to: &mut [f32; 16]) {
        let (halves, _) = to.as_chunks_mut::<8>();
        two!(k => self.0.store(v[k], &mut halves[k]));
    }
    #[inline(always)]
    fn pair(self, low: &[f32; 8], high: &[f32; 8]) -> Self::F {
        [self.0.load(low), self.0.load(high)]
    }
    #[inline(always)]
    fn isplat(self, v: i32) -> Self::I {
        [self.0.isplat(v); 2]
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> u32 {
        let [low, high] = two!(k => self.0.movemask(self.0.lt(a[k], b[k])));
        low | high << 8
    }
    #[inline(always)]
    fn select(self, bits: u32, a: Self::F, b: Self::F) -> Self::F {
        two!(k => {
            let mask = self.0.iload(&MASKS[(bits >> (8 * k)) as usize % 256]);
            self.0.select(mask, a[k], b[k])
        })
    }
    #[inline(always)]
    fn negative(self, a: Self::I) -> u32 {
        self.0.movemask(a[0]) | self.0.movemask(a[1]) << 8
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
    fn transpose(self, v: &[Aabb; 16]) -> [Self::F; 6] {
        let (halves, _) = v.as_chunks::<8>();
        let [low, high] = two!(k => self.0.transpose(&halves[k]));
        let [a, b, c, d, e, f] = low;
        let [p, q, r, s, t, u] = high;
        [[a, p], [b, q], [c, r], [d, s], [e, t], [f, u]]
    }
}
