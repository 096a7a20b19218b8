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
use crate::format::{BLOCK, BLOCK_SAMPLES};
use crate::projection::boxes::{Boxes8, ROUNDING};
use crate::projection::points::pixel_index;
use crate::projection::screen::Screen;
use crate::simd::{Wide, four, three, two};

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
    #[inline(always)]
    pub(crate) fn fetch(&mut self, hiz: Hiz<'_>) {
        let table = hiz.table();
        for at in &mut self.at {
            *at = farthest_code(table, *at);
        }
    }

    /// Bit per box: certainly occluded. Call `fetch` before.
    #[inline(always)]
    pub(crate) fn hidden<W: Wide>(&self, w: W) -> u32 {
        let farther = w.isub(w.iload(&self.code), w.iload(&self.at));
        w.negative(farther) & self.beyond
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

    #[inline(always)]
    pub(crate) fn classify<W: Wide>(&self, w: W, boxes: &[Aabb; 16]) -> (Coarse16, Centers16) {
        let v = w.transpose(boxes);
        // Centres and half extents, grown as for exact rectangles.
        let half = w.splat(0.5);
        let [lo, hi] = [[v[0], v[1], v[2]], [v[3], v[4], v[5]]];
        let (mut c, mut h, mut largest) = (lo, hi, w.splat(0.0));
        let mut volume = !0;
        for k in 0..3 {
            let (low, high) = (w.mul(lo[k], half), w.mul(hi[k], half));
            (c[k], h[k]) = (w.add(low, high), w.sub(high, low));
            volume &= !w.lt(hi[k], lo[k]);
            largest = w.max(largest, w.add(w.abs(c[k]), h[k]));
        }
        let grow = w.add(w.mul(largest, w.splat(2.0 * ROUNDING)), w.splat(self.grow));
        for h in &mut h {
            *h = w.add(*h, grow);
        }
        let (coarse, center) = self.classify_extents(w, c, h, volume);
        (coarse, self.centers(w, center))
    }

    /// Pixels of the centres, from their clip rows.
    #[inline(always)]
    fn centers<W: Wide>(&self, w: W, [x, y, z, distance]: [W::F; 4]) -> Centers16 {
        let (zero, one) = (w.splat(0.0), w.splat(1.0));
        let per = w.div(one, distance);
        let size = BLOCK as f32;
        let x = w.mul(
            w.add(w.mul(x, per), w.splat(self.half_screen[0])),
            w.splat(size),
        );
        let y = w.mul(
            w.add(w.mul(y, per), w.splat(self.half_screen[1])),
            w.splat(size),
        );
        let [right, bottom] = self.half_screen.map(|m| 2.0 * m * size);
        let (below_right, below_bottom) = (w.lt(x, w.splat(right)), w.lt(y, w.splat(bottom)));
        let on = w.lt(z, distance) & !w.lt(x, zero) & !w.lt(y, zero) & below_right & below_bottom;
        let [x, y] = two!(k => w.trunc(w.select(on, [x, y][k], zero)));
        let depth = w.select(on, w.max(w.mul(z, per), zero), zero);
        let mut centers = Centers16::NONE;
        w.istore(pixel_index!(w, self.hiz.buffer, x, y), &mut centers.at);
        w.istore(w.codes(depth), &mut centers.code);
        centers.on = on;
        centers
    }

    /// Classifies boxes by centres and half extents, with a bit for each that is valid; also
    /// returns the centres' clip rows.
    #[inline(always)]
    fn classify_extents<W: Wide>(
        &self,
        w: W,
        c: [W::F; 3],
        h: [W::F; 3],
        volume: u32,
    ) -> (Coarse16, [W::F; 4]) {
        let center = four!(i => dot(w, &c, &self.rows[i]));
        let reach = four!(i => reach(w, &h, &self.rows[i]));
        let lo = four!(i => w.sub(center[i], reach[i]));
        let hi = four!(i => w.add(center[i], reach[i]));
        let one = w.splat(1.0);
        let (near, far) = (w.div(one, lo[3]), w.div(one, hi[3]));
        let behind = w.lt(hi[3], lo[2]) & volume;
        let beyond = w.lt(hi[2], lo[3]) & volume;
        let depth = w.mul(w.mul(hi[2], near), w.splat(1.0 + 2e-6));
        let [x0, y0] = [0, 1].map(|i| self.half_screen[i] - self.dilate);
        let [x1, y1] = [0, 1].map(|i| self.half_screen[i] + self.dilate);
        let x0 = w.add(w.min(w.mul(lo[0], near), w.mul(lo[0], far)), w.splat(x0));
        let y0 = w.add(w.min(w.mul(lo[1], near), w.mul(lo[1], far)), w.splat(y0));
        let x1 = w.add(w.max(w.mul(hi[0], near), w.mul(hi[0], far)), w.splat(x1));
        let y1 = w.add(w.max(w.mul(hi[1], near), w.mul(hi[1], far)), w.splat(y1));
        let zero = w.splat(0.0);
        let [right, bottom] = [0, 1].map(|i| w.splat(2.0 * self.half_screen[i]));
        let off = w.lt(x1, zero) | w.lt(right, x0) | w.lt(y1, zero) | w.lt(bottom, y0);
        let off = beyond & (off | w.lt(depth, w.splat(self.far_depth)));
        let last = [
            self.hiz.buffer.blocks_x as f32 - 1.0,
            self.hiz.buffer.blocks_y as f32 - 1.0,
        ];
        let blocks = four!(i => {
            let v = [x0, y0, x1, y1][i];
            w.trunc(w.min(w.max(v, zero), w.splat(last[i % 2])))
        });
        let mut coarse = Coarse16::NONE;
        w.istore(self.place(w, blocks), &mut coarse.at);
        w.istore(w.codes(w.max(depth, zero)), &mut coarse.code);
        coarse.outside = behind | off;
        coarse.beyond = beyond;
        (coarse, center)
    }

    /// Classifies the children of two nodes, whose boxes are grown already.
    #[inline(always)]
    pub(crate) fn classify_nodes<W: Wide>(
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
            largest = w.max(largest, w.add(w.abs(c[k]), own[k]));
        }
        let grow = w.add(w.mul(largest, w.splat(ROUNDING)), w.splat(self.grow));
        let h = three!(k => w.add(own[k], grow));
        // Boxes that are not volumes have NaN, for which every comparison is false.
        let (coarse, center) = self.classify_extents(w, c, h, !0);
        let distance = center[3];
        let squares = three!(k => w.mul(own[k], own[k]));
        let squared = w.add(w.add(squares[0], squares[1]), squares[2]);
        let far_enough = w.lt(w.splat(1.0), distance);
        CoarseNode16 {
            coarse,
            centers: self.centers(w, center),
            small: far_enough & w.lt(squared, w.mul(distance, w.splat(small))),
        }
    }
}

impl CoarseTest<'_> {
    /// Index in the HiZ for rectangles of blocks (left, top, right, bottom, inclusive).
    #[inline(always)]
    fn place<W: Wide>(&self, w: W, blocks: [W::I; 4]) -> W::I {
        hiz_index!(w, self.hiz.buffer, blocks)
    }
}

#[inline(always)]
fn dot<W: Wide>(w: W, c: &[W::F; 3], r: &[f32; 4]) -> W::F {
    w.add(
        w.add(w.mul(c[0], w.splat(r[0])), w.mul(c[1], w.splat(r[1]))),
        w.add(w.mul(c[2], w.splat(r[2])), w.splat(r[3])),
    )
}

#[inline(always)]
fn reach<W: Wide>(w: W, h: &[W::F; 3], r: &[f32; 4]) -> W::F {
    w.add(
        w.add(
            w.mul(h[0], w.splat(r[0].abs())),
            w.mul(h[1], w.splat(r[1].abs())),
        ),
        w.mul(h[2], w.splat(r[2].abs())),
    )
}
