//! The coarse test: sixteen boxes at once against the HiZ, by rectangles that enclose the exact
//! ones.
//!
//! Exact rectangles take eight divisions per box. Here a box is bounded by its reach along each
//! axis of the screen, at the distances of its nearest and its farthest point: two divisions, and
//! most boxes are decided. Whatever this test culls, the exact one would cull too; the others are
//! projected again.

use crate::bounds::Aabb;
use crate::depth::hiz::{Hiz, farthest_code};
use crate::depth::hiz_layout::hiz_index;
use crate::format::{BLOCK, BLOCK_SAMPLES, LEAST_DEPTH};
use crate::projection::boxes::{Boxes8, ROUNDING};
use crate::projection::points::pixel_index;
use crate::projection::screen::Screen;
use crate::simd::{F16, I16, M16, Sixteen, four, three, two};

/// The coarse test, prepared for a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoarseTest<'a> {
    /// Rows of the screen, with X and Y in blocks from its centre.
    rows: [[f32; 4]; 4],
    /// Half the screen, blocks.
    half_screen: [f32; 2],
    dilate: f32,
    grow: f32,
    far_depth: f32,
    pub(super) hiz: Hiz<'a>,
}

/// Coarse results of sixteen boxes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Coarse16 {
    /// Depth code that nothing of the box is in front of.
    code: [i32; 16],
    /// Index in the HiZ; after `fetch`, the depth code there.
    at: [i32; 16],
    /// Bit per box: certainly outside the frustum.
    pub(crate) outside: u32,
    /// Bit per box: certainly beyond the near plane.
    beyond: u32,
}

/// The centres of sixteen boxes on the screen.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Centers16 {
    /// Index of the centre's pixel.
    pub(crate) at: [i32; 16],
    /// Its depth code; a very low one beside the screen.
    pub(crate) code: [i32; 16],
    /// Bit per box: the centre is on the screen.
    pub(crate) on: u32,
}

impl Centers16 {
    pub(crate) const NONE: Self = Self {
        at: [0; 16],
        code: [0; 16],
        on: 0,
    };
}

/// Coarse results of the children of two nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoarseNode16 {
    pub(crate) coarse: Coarse16,
    pub(crate) centers: Centers16,
    /// Bit per box: below the size threshold.
    pub(crate) small: u32,
}

impl CoarseNode16 {
    pub(crate) const NONE: Self = Self {
        coarse: Coarse16::NONE,
        centers: Centers16::NONE,
        small: 0,
    };
}

impl Coarse16 {
    pub(crate) const NONE: Self = Self {
        code: [0; 16],
        at: [0; 16],
        outside: 0,
        beyond: 0,
    };

    /// Replaces the indices by the depth codes there.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn fetch(&mut self, hiz: Hiz<'_>) {
        let table = hiz.table();
        for at in &mut self.at {
            *at = farthest_code(table, *at);
        }
    }

    /// Bit per box: certainly occluded. Call `fetch` before.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn hidden<W: Sixteen>(&self, w: W) -> u32 {
        let farther = w.load_ints(&self.code).lt(w.load_ints(&self.at));
        farther.bits() & self.beyond
    }
}

impl<'a> CoarseTest<'a> {
    /// None where the screen has no HiZ.
    pub(crate) fn new(screen: &Screen<'a>) -> Option<Self> {
        let size = BLOCK_SAMPLES as f32;
        let half_screen = [screen.width * 0.5, screen.height * 0.5];
        let mut rows = screen.rows;
        let distance = rows[3];
        for (row, half) in rows.iter_mut().zip(half_screen) {
            for (v, w) in row.iter_mut().zip(distance) {
                *v = (*v - half * w) / size;
            }
        }
        Some(Self {
            rows,
            half_screen: half_screen.map(|m| m / size),
            dilate: screen.dilate / size,
            grow: screen.grow,
            far_depth: screen.far_depth,
            hiz: screen.hiz?,
        })
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn classify<W: Sixteen>(&self, w: W, boxes: &[Aabb; 16]) -> (Coarse16, Centers16) {
        let v = w.transpose(boxes);
        // Centres and half extents, grown as for exact rectangles.
        let half = w.splat(0.5);
        let [lo, hi] = [[v[0], v[1], v[2]], [v[3], v[4], v[5]]];
        let (mut c, mut h, mut largest) = (lo, hi, w.splat(0.0));
        let mut volume = w.all();
        for k in 0..3 {
            let (low, high) = (lo[k] * half, hi[k] * half);
            (c[k], h[k]) = (low + high, high - low);
            volume = volume & !hi[k].lt(lo[k]);
            largest = largest.max(c[k].abs() + h[k]);
        }
        let grow = largest * (2.0 * ROUNDING) + self.grow;
        for h in &mut h {
            *h = *h + grow;
        }
        let (coarse, center) = self.classify_extents(w, c, h, volume);
        (coarse, self.centers(w, center))
    }

    /// Pixels of the centres, from their clip rows.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn centers<W: Sixteen>(&self, w: W, [x, y, z, distance]: [F16<W>; 4]) -> Centers16 {
        let (zero, one) = (w.splat(0.0), w.splat(1.0));
        let per = one / distance;
        let size = BLOCK as f32;
        let x = (x * per + self.half_screen[0]) * size;
        let y = (y * per + self.half_screen[1]) * size;
        let [right, bottom] = self.half_screen.map(|m| 2.0 * m * size);
        let (below_right, below_bottom) = (x.lt(w.splat(right)), y.lt(w.splat(bottom)));
        let on = z.lt(distance) & !x.lt(zero) & !y.lt(zero) & below_right & below_bottom;
        let [x, y] = two!(k => on.select([x, y][k], zero).trunc());
        let depth = on.select((z * per).max(zero), zero);
        let mut centers = Centers16::NONE;
        pixel_index!(w, self.hiz.buffer, x, y).store(&mut centers.at);
        depth.codes().store(&mut centers.code);
        centers.on = on.bits();
        centers
    }

    /// Classifies boxes by centres and half extents, with a bit for each that is valid; also
    /// returns the centres' clip rows.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn classify_extents<W: Sixteen>(
        &self,
        w: W,
        c: [F16<W>; 3],
        h: [F16<W>; 3],
        volume: M16<W>,
    ) -> (Coarse16, [F16<W>; 4]) {
        let center = four!(i => dot(&c, &self.rows[i]));
        let reach = four!(i => reach(&h, &self.rows[i]));
        let lo = four!(i => center[i] - reach[i]);
        let hi = four!(i => center[i] + reach[i]);
        let one = w.splat(1.0);
        let (near, far) = (one / lo[3], one / hi[3]);
        let behind = hi[3].lt(lo[2]) & volume;
        let beyond = hi[2].lt(lo[3]) & volume;
        let depth = hi[2] * near * (1.0 + 2e-6);
        let [x0, y0] = [0, 1].map(|i| self.half_screen[i] - self.dilate);
        let [x1, y1] = [0, 1].map(|i| self.half_screen[i] + self.dilate);
        let x0 = (lo[0] * near).min(lo[0] * far) + x0;
        let y0 = (lo[1] * near).min(lo[1] * far) + y0;
        let x1 = (hi[0] * near).max(hi[0] * far) + x1;
        let y1 = (hi[1] * near).max(hi[1] * far) + y1;
        let zero = w.splat(0.0);
        let [right, bottom] = [0, 1].map(|i| w.splat(2.0 * self.half_screen[i]));
        let off = x1.lt(zero) | right.lt(x0) | y1.lt(zero) | bottom.lt(y0);
        let off = beyond & (off | depth.lt(w.splat(self.far_depth)));
        let last = [
            self.hiz.buffer.blocks_x as f32 - 1.0,
            self.hiz.buffer.blocks_y as f32 - 1.0,
        ];
        let blocks = four!(i => {
            let v = [x0, y0, x1, y1][i];
            v.max(zero).min(w.splat(last[i % 2])).trunc()
        });
        let mut coarse = Coarse16::NONE;
        self.place(w, blocks).store(&mut coarse.at);
        let depth = depth.max(w.splat(LEAST_DEPTH));
        depth.codes().store(&mut coarse.code);
        coarse.outside = (behind | off).bits();
        coarse.beyond = beyond.bits();
        (coarse, center)
    }

    /// Classifies the children of two nodes, whose boxes are grown already.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn classify_nodes<W: Sixteen>(
        &self,
        w: W,
        pair: [&Boxes8; 2],
        small: f32,
    ) -> CoarseNode16 {
        let [a, b] = pair;
        let c = three!(k => w.pair(&a.center[k], &b.center[k]));
        let own = three!(k => w.pair(&a.half[k], &b.half[k]));
        let mut largest = w.splat(0.0);
        for k in 0..3 {
            largest = largest.max(c[k].abs() + own[k]);
        }
        let grow = largest * ROUNDING + self.grow;
        let h = three!(k => own[k] + grow);
        // Boxes that are not volumes have NaN, for which every comparison is false.
        let (coarse, center) = self.classify_extents(w, c, h, w.all());
        let distance = center[3];
        let squares = three!(k => own[k] * own[k]);
        let squared = squares[0] + squares[1] + squares[2];
        let far_enough = w.splat(1.0).lt(distance);
        CoarseNode16 {
            coarse,
            centers: self.centers(w, center),
            small: (far_enough & squared.lt(distance * small)).bits(),
        }
    }
}

impl CoarseTest<'_> {
    /// Index in the HiZ for rectangles of blocks (left, top, right, bottom, inclusive).
    #[cfg_attr(not(unoptimized), inline(always))]
    fn place<W: Sixteen>(&self, w: W, blocks: [I16<W>; 4]) -> I16<W> {
        hiz_index!(w, self.hiz.buffer, blocks)
    }
}

#[cfg_attr(not(unoptimized), inline(always))]
fn dot<W: Sixteen>(c: &[F16<W>; 3], r: &[f32; 4]) -> F16<W> {
    c[0] * r[0] + c[1] * r[1] + (c[2] * r[2] + r[3])
}

#[cfg_attr(not(unoptimized), inline(always))]
fn reach<W: Sixteen>(h: &[F16<W>; 3], r: &[f32; 4]) -> F16<W> {
    h[0] * r[0].abs() + h[1] * r[1].abs() + h[2] * r[2].abs()
}
