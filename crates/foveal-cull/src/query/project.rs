//! Boxes to the screen, eight at a time: the rectangle they can touch and their nearest depth.

use crate::simd::{Lanes, four};

/// Eight boxes by coordinate.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Boxes8 {
    pub(crate) center: [[f32; 8]; 3],
    pub(crate) half: [[f32; 8]; 3],
}

impl Boxes8 {
    /// NaN boxes: never culled.
    pub(crate) const NONE: Self = Self {
        center: [[f32::NAN; 8]; 3],
        half: [[f32::NAN; 8]; 3],
    };

    pub(crate) fn set(&mut self, lane: usize, center: glam::Vec3, half: glam::Vec3) {
        for axis in 0..3 {
            self.center[axis][lane] = center[axis];
            self.half[axis][lane] = half[axis];
        }
    }
}

/// What is known of eight boxes on the screen. Rectangles are samples, already dilated.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Projected8 {
    pub(crate) x0: [f32; 8],
    pub(crate) x1: [f32; 8],
    pub(crate) y0: [f32; 8],
    pub(crate) y1: [f32; 8],
    /// Nearest depth, raised for rounding.
    pub(crate) depth: [f32; 8],
    /// Smallest W: distance for perspective views.
    pub(crate) distance: [f32; 8],
    /// Bit per box: certainly outside the frustum.
    pub(crate) outside: u32,
    /// Bit per box: in front of the near plane in part, or not a volume; the other fields mean nothing.
    pub(crate) crossing: u32,
}

impl Projected8 {
    pub(crate) const NONE: Self = Self {
        x0: [0.0; 8],
        x1: [0.0; 8],
        y0: [0.0; 8],
        y1: [0.0; 8],
        depth: [0.0; 8],
        distance: [0.0; 8],
        outside: 0,
        crossing: 0,
    };
}

/// What boxes are projected with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screen {
    /// Clip rows in the space of the boxes.
    pub(crate) rows: [[f32; 4]; 4],
    /// Samples.
    pub(crate) width: f32,
    pub(crate) height: f32,
    /// Depth of the far plane, lowered a little; 0 when infinite.
    pub(crate) far_depth: f32,
    /// By how much rectangles grow on each side, samples.
    pub(crate) dilate: f32,
}

#[inline(always)]
pub(crate) fn project<L: Lanes>(l: L, s: &Screen, boxes: &Boxes8) -> Projected8 {
    let c = [
        l.load(&boxes.center[0]),
        l.load(&boxes.center[1]),
        l.load(&boxes.center[2]),
    ];
    let h = [
        l.load(&boxes.half[0]),
        l.load(&boxes.half[1]),
        l.load(&boxes.half[2]),
    ];
    let (zc, ze) = (dot(l, &c, &s.rows[2]), edges(l, &h, &s.rows[2]));
    let (wc, we) = (dot(l, &c, &s.rows[3]), edges(l, &h, &s.rows[3]));
    let (zr, wr) = (reach(l, &ze), reach(l, &we));
    let (w_near, w_far) = (l.sub(wc, wr), l.add(wc, wr));
    let z_near = l.add(zc, zr);
    // Wholly nearer than the near plane, or not certainly beyond it.
    let behind = l.lt(w_far, l.sub(zc, zr));
    let beyond = l.lt(z_near, w_near);
    let depth = l.mul(l.div(z_near, w_near), l.splat(1.0 + 1e-6));

    let (xq, xz) = corners(l, &c, &h, &s.rows[0]);
    let (yq, yz) = corners(l, &c, &h, &s.rows[1]);
    let (wq, wz) = corners(l, &c, &h, &s.rows[3]);
    let one = l.splat(1.0);
    let low = four!(k => l.div(one, l.sub(wq[k], wz)));
    let high = four!(k => l.div(one, l.add(wq[k], wz)));
    let (x0, x1) = extent(
        l,
        four!(k => l.mul(l.sub(xq[k], xz), low[k])),
        four!(k => l.mul(l.add(xq[k], xz), high[k])),
    );
    let (y0, y1) = extent(
        l,
        four!(k => l.mul(l.sub(yq[k], yz), low[k])),
        four!(k => l.mul(l.add(yq[k], yz), high[k])),
    );
    let grow = l.splat(s.dilate);
    let (x0, y0) = (l.sub(x0, grow), l.sub(y0, grow));
    let (x1, y1) = (l.add(x1, grow), l.add(y1, grow));
    let zero = l.splat(0.0);
    let off = l.ior(
        l.ior(l.lt(x1, zero), l.lt(l.splat(s.width), x0)),
        l.ior(l.lt(y1, zero), l.lt(l.splat(s.height), y0)),
    );
    let off = l.iand(beyond, l.ior(off, l.lt(depth, l.splat(s.far_depth))));
    let mut p = Projected8::NONE;
    l.store(x0, &mut p.x0);
    l.store(x1, &mut p.x1);
    l.store(y0, &mut p.y0);
    l.store(y1, &mut p.y1);
    l.store(depth, &mut p.depth);
    l.store(w_near, &mut p.distance);
    p.outside = l.movemask(l.ior(behind, off));
    p.crossing = !l.movemask(beyond) & !p.outside & 0xff;
    p
}

#[inline(always)]
fn dot<L: Lanes>(l: L, c: &[L::F; 3], r: &[f32; 4]) -> L::F {
    l.add(
        l.add(l.mul(c[0], l.splat(r[0])), l.mul(c[1], l.splat(r[1]))),
        l.add(l.mul(c[2], l.splat(r[2])), l.splat(r[3])),
    )
}

#[inline(always)]
fn edges<L: Lanes>(l: L, h: &[L::F; 3], r: &[f32; 4]) -> [L::F; 3] {
    [
        l.mul(h[0], l.splat(r[0])),
        l.mul(h[1], l.splat(r[1])),
        l.mul(h[2], l.splat(r[2])),
    ]
}

#[inline(always)]
fn reach<L: Lanes>(l: L, e: &[L::F; 3]) -> L::F {
    l.add(l.add(l.abs(e[0]), l.abs(e[1])), l.abs(e[2]))
}

/// A row at the four corners of the middle section, and its change to the upper ones.
#[inline(always)]
fn corners<L: Lanes>(l: L, c: &[L::F; 3], h: &[L::F; 3], r: &[f32; 4]) -> ([L::F; 4], L::F) {
    let (m, e) = (dot(l, c, r), edges(l, h, r));
    let (a, b) = (l.add(e[0], e[1]), l.sub(e[0], e[1]));
    ([l.add(m, a), l.add(m, b), l.sub(m, b), l.sub(m, a)], e[2])
}

#[inline(always)]
fn extent<L: Lanes>(l: L, a: [L::F; 4], b: [L::F; 4]) -> (L::F, L::F) {
    let lo = l.min(
        l.min(l.min(a[0], a[1]), l.min(a[2], a[3])),
        l.min(l.min(b[0], b[1]), l.min(b[2], b[3])),
    );
    let hi = l.max(
        l.max(l.max(a[0], a[1]), l.max(a[2], a[3])),
        l.max(l.max(b[0], b[1]), l.max(b[2], b[3])),
    );
    (lo, hi)
}
