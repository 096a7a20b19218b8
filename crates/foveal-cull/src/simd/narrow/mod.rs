//! Lanes in 128-bit registers, for x86-64 (SSE2), 64-bit ARM (NEON) and WebAssembly with simd128:
//! written once, over [`Registers`].

use super::portable::{FAR, ROWS};
use super::twice::Twice;
use crate::bounds::Aabb;
use crate::format::{BLOCK, BLOCK_SAMPLES, CODE_OFFSET};
use crate::simd::arrays::{four, two};
use crate::simd::lanes::{Lanes, Vectors};
use registers::Registers;

mod registers;

#[cfg(target_arch = "aarch64")]
mod neon;
#[cfg(target_arch = "wasm32")]
mod simd128;
#[cfg(target_arch = "x86_64")]
pub(super) mod sse2;

#[cfg(target_arch = "aarch64")]
type Target = neon::Neon;
#[cfg(target_arch = "wasm32")]
type Target = simd128::Simd128;
#[cfg(target_arch = "x86_64")]
type Target = sse2::Sse2;

/// Two or more registers in place of each wider one.
#[derive(Clone, Copy)]
pub(crate) struct Narrow<R>(R);

impl Narrow<Target> {
    /// With the registers of what this is compiled for.
    pub(super) fn of_target() -> Self {
        Self(Target::default())
    }
}

/// One side of the spans of a row of blocks.
#[derive(Clone, Copy)]
pub(crate) struct Side<R: Registers> {
    /// The rows that are first, second and so on in their pixel.
    rows: [R::H; 4],
    centers: R::H,
}

/// `[e(0), ..., e(7)]`, as [`four!`].
macro_rules! eight {
    ($k:ident => $e:expr) => {{
        let [a, b, c, d] = four!($k => $e);
        let [e, f, g, h] = four!(j => { let $k = j + 4; $e });
        [a, b, c, d, e, f, g, h]
    }};
}

/// Methods that are done register by register, under a registers' name.
macro_rules! by_registers {
    ($all:ident: $($name:ident = $one:ident($($arg:ident: $type:ty),*) -> $out:ty;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($arg: $type),*) -> $out {
                $all!(k => self.0.$one($($arg[k]),*))
            }
        )*
    };
}

impl<R: Registers> Vectors<8> for Narrow<R> {
    type F = [R::F; 2];
    type I = [R::I; 2];
    type M = [R::I; 2];

    by_registers! { two:
        fadd = add(a: Self::F, b: Self::F) -> Self::F;
        fsub = sub(a: Self::F, b: Self::F) -> Self::F;
        fmul = mul(a: Self::F, b: Self::F) -> Self::F;
        fdiv = div(a: Self::F, b: Self::F) -> Self::F;
        fmin = min(a: Self::F, b: Self::F) -> Self::F;
        fmax = max(a: Self::F, b: Self::F) -> Self::F;
        fabs = abs(a: Self::F) -> Self::F;
        flt = lt(a: Self::F, b: Self::F) -> Self::I;
        fselect = select(mask: Self::I, a: Self::F, b: Self::F) -> Self::F;
        ftrunc = trunc(a: Self::F) -> Self::I;
        iadd = iadd(a: Self::I, b: Self::I) -> Self::I;
        isub = isub(a: Self::I, b: Self::I) -> Self::I;
        imul = imul(a: Self::I, b: Self::I) -> Self::I;
        ilt = ilt(a: Self::I, b: Self::I) -> Self::M;
        imin = imin(a: Self::I, b: Self::I) -> Self::I;
        imax = imax(a: Self::I, b: Self::I) -> Self::I;
        ishr = ishr(a: Self::I, by: Self::I) -> Self::I;
        mand = iand(a: Self::I, b: Self::I) -> Self::I;
        mor = ior(a: Self::I, b: Self::I) -> Self::I;
        mandnot = iandnot(a: Self::I, b: Self::I) -> Self::I;
    }
    #[inline(always)]
    fn fsplat(self, v: f32) -> Self::F {
        [self.0.splat(v); 2]
    }
    #[inline(always)]
    fn fload(self, v: &[f32; 8]) -> Self::F {
        let (v, _) = v.as_chunks();
        two!(k => self.0.load(&v[k]))
    }
    #[inline(always)]
    fn fstore(self, v: Self::F, to: &mut [f32; 8]) {
        let (to, _) = to.as_chunks_mut();
        two!(k => self.0.store(v[k], &mut to[k]));
    }
    #[inline(always)]
    fn fcodes(self, a: Self::F) -> Self::I {
        two!(k => self.code(a[k]))
    }
    #[inline(always)]
    fn ftranspose(self, v: &[Aabb; 8]) -> [Self::F; 6] {
        let (v, _) = v.as_chunks();
        let [low, high] = two!(k => self.turn_four(&v[k]));
        let [a, b, c, d, e, f] = low;
        let [p, q, r, s, t, u] = high;
        [[a, p], [b, q], [c, r], [d, s], [e, t], [f, u]]
    }
    #[inline(always)]
    fn isplat(self, v: i32) -> Self::I {
        [self.0.isplat(v); 2]
    }
    #[inline(always)]
    fn iload(self, v: &[i32; 8]) -> Self::I {
        let (v, _) = v.as_chunks();
        two!(k => self.0.iload(&v[k]))
    }
    #[inline(always)]
    fn istore(self, v: Self::I, to: &mut [i32; 8]) {
        let (to, _) = to.as_chunks_mut();
        two!(k => self.0.istore(v[k], &mut to[k]));
    }
    #[inline(always)]
    fn ibits(self, a: Self::I) -> Self::I {
        // The exponent of the number as a float, which is exact; 0 has none.
        two!(k => {
            let exponent = self.0.ishr_all::<23>(self.0.bits(self.0.floats(a[k])));
            self.0.imax(self.0.isub(exponent, self.0.isplat(126)), self.0.isplat(0))
        })
    }
    #[inline(always)]
    fn mbits(self, a: Self::I) -> u32 {
        self.0.signs(a)
    }
    #[inline(always)]
    fn mall(self) -> Self::I {
        self.isplat(-1)
    }
}

impl<R: Registers> Lanes for Narrow<R> {
    type Q = [R::Q; 2];
    type D = [R::H; 8];
    type S = [Side<R>; 2];
    type B = [[R::Q; 20]; 4];
    /// The two planes of a register are neighbours.
    type P = [R::B; 8];
    type W = Twice<Self>;
    by_registers! { two:
        qadd = qadd(a: Self::Q, b: Self::Q) -> Self::Q;
        qsub = qsub(a: Self::Q, b: Self::Q) -> Self::Q;
        qmul = qmul(a: Self::Q, b: Self::Q) -> Self::Q;
        qdiv = qdiv(a: Self::Q, b: Self::Q) -> Self::Q;
        qabs = qabs(a: Self::Q) -> Self::Q;
    }
    by_registers! { eight:
        dmin = hmin(a: Self::D, b: Self::D) -> Self::D;
        dmax = hmax(a: Self::D, b: Self::D) -> Self::D;
        por = bor(a: Self::P, b: Self::P) -> Self::P;
    }
    #[inline(always)]
    fn wide(self) -> Self::W {
        Twice(self)
    }
    #[inline(always)]
    fn prefetch<T>(self, soon: &T) {
        self.0.prefetch(soon);
    }
    #[inline(always)]
    fn fgather(self, table: &[f32; 256], index: &[u8; 8]) -> Self::F {
        two!(k => self.0.load(&four!(i => table[usize::from(index[4 * k + i])])))
    }
    #[inline(always)]
    fn qgather(self, table: &[f64; 256], index: [u8; 4]) -> Self::Q {
        self.qload(&four!(i => table[usize::from(index[i])]))
    }
    #[inline(always)]
    fn qload(self, v: &[f64; 4]) -> Self::Q {
        let (v, _) = v.as_chunks();
        two!(k => self.0.qload(&v[k]))
    }
    #[inline(always)]
    fn qstore(self, v: Self::Q, to: &mut [f64; 4]) {
        let (to, _) = to.as_chunks_mut();
        two!(k => self.0.qstore(v[k], &mut to[k]));
    }
    #[inline(always)]
    fn qsplat(self, v: f64) -> Self::Q {
        [self.0.qsplat(v); 2]
    }
    #[inline(always)]
    fn qlt(self, a: Self::Q, b: Self::Q) -> u32 {
        self.0.qlt(a, b)
    }
    #[inline(always)]
    fn qpick(self, v: Self::Q, from: [u8; 4]) -> Self::Q {
        let mut all = [0.0; 4];
        self.qstore(v, &mut all);
        self.qload(&four!(i => all[usize::from(from[i] & 3)]))
    }
    #[inline(always)]
    fn dplane(self, columns: Self::F, down: f32, floor: f32, cap: i16) -> Self::D {
        let (floor, cap) = (self.0.splat(floor), self.0.hsplat(cap));
        eight!(row => {
            let down = self.0.splat(row as f32 * down);
            let codes = two!(k => self.code(self.0.max(self.0.add(columns[k], down), floor)));
            self.0.hmin(self.0.hpack(codes), cap)
        })
    }
    #[inline(always)]
    fn dload(self, v: &[i16; 64]) -> Self::D {
        let (v, _) = v.as_chunks();
        eight!(k => self.0.hload(&v[k]))
    }
    #[inline(always)]
    fn dstore(self, v: Self::D, to: &mut [i16; 64]) {
        let (to, _) = to.as_chunks_mut();
        eight!(k => self.0.hstore(v[k], &mut to[k]));
    }
    #[inline(always)]
    fn dsplat(self, v: i16) -> Self::D {
        [self.0.hsplat(v); 8]
    }
    #[inline(always)]
    fn dgt(self, a: Self::D, b: Self::D) -> u64 {
        self.0.hbits(eight!(k => self.0.hgt(a[k], b[k])))
    }
    #[inline(always)]
    fn dapart(self, a: Self::D, b: Self::D, by: i16) -> u64 {
        let distance = eight!(k => self.0.hmax(self.0.hsub(a[k], b[k]), self.0.hsub(b[k], a[k])));
        self.dgt(distance, self.dsplat(by))
    }
    #[inline(always)]
    fn dselect(self, bits: u64, a: Self::D, b: Self::D) -> Self::D {
        let masks = self.0.hmasks(bits);
        eight!(k => self.0.hselect(masks[k], a[k], b[k]))
    }
    #[inline(always)]
    fn dreduce_min(self, a: Self::D) -> i16 {
        let m = four!(k => self.0.hmin(a[k], a[k + 4]));
        let m = two!(k => self.0.hmin(m[k], m[k + 2]));
        self.0.hleast(self.0.hmin(m[0], m[1]))
    }
    #[inline(always)]
    fn qrows(self, slope: Self::Q) -> Self::B {
        let slope = self.each(slope);
        let (rows, _) = ROWS.as_chunks();
        let mut edges = [[slope[0]; 20]; 4];
        for (edge, slope) in edges.iter_mut().zip(slope) {
            for (edge, rows) in edge.iter_mut().zip(rows) {
                *edge = self.0.qmul(self.0.qload(rows), slope);
            }
        }
        edges
    }
    #[inline(always)]
    fn qspans(self, at: Self::Q, edges: &Self::B, limits: Option<[f64; 2]>) -> Self::S {
        let at = self.each(at);
        let [mut from, mut to] = [[at[0]; 20]; 2];
        for k in 0..20 {
            let [a, b, c, d] = four!(e => self.0.qadd(at[e], edges[e][k]));
            (from[k], to[k]) = (self.0.qmax(a, b), self.0.qmin(c, d));
        }
        if let Some(limits) = limits {
            self.limit(&mut from, limits);
        }
        [from, to].map(|v| {
            let eight = |v: &[R::Q]| {
                let v = four!(k => {
                    let far = [-FAR, FAR].map(|v| self.0.qsplat(v));
                    self.0.qmin(self.0.qmax(v[k], far[0]), far[1])
                });
                let n = two!(k => self.0.qwhole([v[2 * k], v[2 * k + 1]]));
                self.0.hpack(n)
            };
            // The centre of pixel n is at sample 4 n + 1.5 of the row.
            let centers = four!(k => {
                let v = self.0.qadd(v[16 + k], self.0.qsplat(1.5));
                self.0.qmul(v, self.0.qsplat(0.25))
            });
            Side {
                rows: four!(k => eight(&v[4 * k..4 * k + 4])),
                centers: eight(&centers),
            }
        })
    }
    #[inline(always)]
    fn pwithin(self, spans: &Self::S, left: u32) -> (Self::P, u64) {
        let first = self.0.hsplat(left as i16);
        let most = self.0.hsplat(BLOCK_SAMPLES as i16);
        let [low, high] = two!(k => {
            let [from, to] = two!(side => {
                let n = two!(i => {
                    let n = self.0.hsub(spans[side].rows[2 * k + i], first);
                    self.0.hmin(n, most)
                });
                self.0.right_of(self.0.hbytes(n))
            });
            four!(column => self.0.bandnot(to[column], from[column]))
        });
        let first = self.0.hsplat((left / 4) as i16);
        let n = two!(side => self.0.hsub(spans[side].centers, first));
        (eight!(k => [low, high][k % 2][k / 2]), self.pixels(n))
    }
    #[inline(always)]
    fn irows(self, from: Self::I, to: Self::I) -> u64 {
        self.pixels([self.0.hpack(from), self.0.hpack(to)])
    }
    #[inline(always)]
    fn pload(self, v: &[u64; 16]) -> Self::P {
        let (v, _) = v.as_chunks();
        eight!(k => self.0.bload(&v[k]))
    }
    #[inline(always)]
    fn pstore(self, v: Self::P, to: &mut [u64; 16]) {
        let (to, _) = to.as_chunks_mut();
        eight!(k => self.0.bstore(v[k], &mut to[k]));
    }
    #[inline(always)]
    fn pkeep(self, v: Self::P, bits: u64) -> Self::P {
        let bits = self.0.bsplat(bits);
        eight!(k => self.0.band(v[k], bits))
    }
    #[inline(always)]
    fn pall(self, v: Self::P) -> u64 {
        let all = four!(k => self.0.band(v[k], v[k + 4]));
        let all = two!(k => self.0.band(all[k], all[k + 2]));
        let [low, high] = self.0.bhalves(self.0.band(all[0], all[1]));
        low & high
    }
    #[inline(always)]
    fn pany(self, v: Self::P) -> u64 {
        let any = four!(k => self.0.bor(v[k], v[k + 4]));
        let any = two!(k => self.0.bor(any[k], any[k + 2]));
        let [low, high] = self.0.bhalves(self.0.bor(any[0], any[1]));
        low | high
    }
    #[inline(always)]
    fn mload(self, v: &[i32; 8]) -> Self::M {
        self.iload(v)
    }
    #[inline(always)]
    fn mstore(self, v: Self::M, to: &mut [i32; 8]) {
        self.istore(v, to);
    }
}

impl<R: Registers> Narrow<R> {
    #[inline(always)]
    fn code(self, v: R::F) -> R::I {
        let bits = self.0.ishr_all::<12>(self.0.bits(v));
        self.0.isub(bits, self.0.isplat(CODE_OFFSET))
    }

    /// [`Vectors::ftranspose`] of four.
    #[inline(always)]
    fn turn_four(self, v: &[Aabb; 4]) -> [R::F; 6] {
        // Six registers of four numbers in a row hold four boxes: two boxes are three of these.
        let rows = four!(i => [v[i].min, v[i].max]);
        let numbers: [[f32; 4]; 6] = core::array::from_fn(|k| {
            core::array::from_fn(|i| {
                let n = 4 * k + i;
                rows[n / 6][n % 6 / 3][n % 3]
            })
        });
        let pair = |k: usize| {
            let [a, b, c] = [0, 1, 2].map(|i| self.0.load(&numbers[3 * k + i]));
            // x and y of the smallest corners, z of these and x of the largest, y and z of the
            // largest.
            [
                self.0.low_high(a, b),
                self.0.high_low(a, c),
                self.0.low_high(b, c),
            ]
        };
        let ([xy, zx, yz], [xy_b, zx_b, yz_b]) = (pair(0), pair(1));
        [
            self.0.evens(xy, xy_b),
            self.0.odds(xy, xy_b),
            self.0.evens(zx, zx_b),
            self.0.odds(zx, zx_b),
            self.0.evens(yz, yz_b),
            self.0.odds(yz, yz_b),
        ]
    }

    /// Rows of eight pixels, from numbers to before others.
    #[inline(always)]
    fn pixels(self, n: [R::H; 2]) -> u64 {
        // The last sample of the n-th pixel is at or right of sample 4 n, that of the pixel before
        // is not.
        let n = two!(side => {
            let n = self.0.hmin(n[side], self.0.hsplat(BLOCK as i16));
            let less = self.0.hsub(self.0.hsplat(0), n);
            self.0.hsub(self.0.hsub(n, less), self.0.hsub(less, n))
        });
        let [.., pixels] = self.0.right_of(self.0.hbytes(n));
        let [from, to] = self.0.bhalves(pixels);
        from & !to
    }

    /// Each of four numbers by itself, in all lanes.
    #[inline(always)]
    fn each(self, v: [R::Q; 2]) -> [R::Q; 4] {
        let mut all = [0.0; 4];
        self.qstore(v, &mut all);
        four!(k => self.0.qsplat(all[k]))
    }

    /// Moves the left edge far off in rows beyond the limits.
    #[cold]
    fn limit(self, from: &mut [R::Q; 20], [after, last]: [f64; 2]) {
        for (from, rows) in from.iter_mut().zip(ROWS.as_chunks::<2>().0) {
            let mut v = [0.0; 2];
            self.0.qstore(*from, &mut v);
            for (v, row) in v.iter_mut().zip(rows) {
                if *row <= after || last < *row {
                    *v = FAR;
                }
            }
            *from = self.0.qload(&v);
        }
    }
}
