//! Projection of boxes to the screen, eight at a time.

use super::boxes::Boxes8;
use super::points::{Corners8, pixel_index};
use super::screen::Screen;
use crate::format::SAMPLES;
use crate::simd::{Lanes, four};

/// Eight boxes on the screen. Rectangles are in samples, already dilated.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Projected8 {
    pub(crate) x0: [f32; 8],
    pub(crate) x1: [f32; 8],
    pub(crate) y0: [f32; 8],
    pub(crate) y1: [f32; 8],
    /// Nearest depth, raised for rounding.
    pub(crate) depth: [f32; 8],
    /// Pixels of the rectangle on the screen, inclusive: left, top, right, bottom.
    pub(crate) pixels: [[i32; 8]; 4],
    /// Depth code of the nearest depth.
    pub(crate) code: [i32; 8],
    /// Pixel of the box's centre (right, down) and its depth code; a very low code beside the
    /// screen. Only set where the screen has a HiZ.
    pub(crate) center: [[i32; 8]; 3],
    /// Bit per box: certainly outside the frustum.
    pub(crate) outside: u32,
    /// Bit per box: in part nearer than the near plane, or invalid. The other fields are then
    /// meaningless.
    pub(crate) crossing: u32,
    /// Bit per box: certainly occluded, by the HiZ. Only set where the screen has one.
    pub(crate) hidden: u32,
}

impl Projected8 {
    pub(crate) const NONE: Self = Self {
        x0: [0.0; 8],
        x1: [0.0; 8],
        y0: [0.0; 8],
        y1: [0.0; 8],
        depth: [0.0; 8],
        pixels: [[0; 8]; 4],
        code: [0; 8],
        center: [[0; 8]; 3],
        outside: 0,
        crossing: 0,
        hidden: 0,
    };
}

/// Projects eight boxes, with their centres.
#[inline(always)]
pub(crate) fn project<L: Lanes>(l: L, s: &Screen<'_>, boxes: &Boxes8) -> Projected8 {
    let mut p = outline(l, s, boxes, None);
    if s.hiz.is_some() {
        p.center = centers(l, s, boxes);
    }
    p
}

/// Projects eight boxes without their centres; with their corners if asked for, where the screen
/// has a HiZ.
#[inline(always)]
pub(crate) fn outline<L: Lanes>(
    l: L,
    s: &Screen<'_>,
    boxes: &Boxes8,
    corners_of: Option<&mut Corners8>,
) -> Projected8 {
    let c = [
        l.load(&boxes.center[0]),
        l.load(&boxes.center[1]),
        l.load(&boxes.center[2]),
    ];
    let grow = l.splat(s.grow);
    let h = [
        l.add(l.load(&boxes.half[0]), grow),
        l.add(l.load(&boxes.half[1]), grow),
        l.add(l.load(&boxes.half[2]), grow),
    ];
    let (zc, ze) = (dot(l, &c, &s.rows[2]), edges(l, &h, &s.rows[2]));
    let (wc, we) = (dot(l, &c, &s.rows[3]), edges(l, &h, &s.rows[3]));
    let (zr, wr) = (reach(l, &ze), reach(l, &we));
    let (w_near, w_far) = (l.sub(wc, wr), l.add(wc, wr));
    let z_near = l.add(zc, zr);
    // Wholly nearer than the near plane; and certainly beyond it.
    let behind = l.lt(w_far, l.sub(zc, zr));
    let beyond = l.lt(z_near, w_near);
    let depth = l.mul(l.div(z_near, w_near), l.splat(1.0 + 1e-6));

    let (xq, xz) = corners(l, &c, &h, &s.rows[0]);
    let (yq, yz) = corners(l, &c, &h, &s.rows[1]);
    let (wq, wz) = corners(l, &c, &h, &s.rows[3]);
    let one = l.splat(1.0);
    let low = four!(k => l.div(one, l.sub(wq[k], wz)));
    let high = four!(k => l.div(one, l.add(wq[k], wz)));
    let x_low = four!(k => l.mul(l.sub(xq[k], xz), low[k]));
    let x_high = four!(k => l.mul(l.add(xq[k], xz), high[k]));
    let y_low = four!(k => l.mul(l.sub(yq[k], yz), low[k]));
    let y_high = four!(k => l.mul(l.add(yq[k], yz), high[k]));
    let (x0, x1) = extent(l, x_low, x_high);
    let (y0, y1) = extent(l, y_low, y_high);
    let dilate = l.splat(s.dilate);
    let (x0, y0) = (l.sub(x0, dilate), l.sub(y0, dilate));
    let (x1, y1) = (l.add(x1, dilate), l.add(y1, dilate));
    let zero = l.splat(0.0);
    let off = l.ior(
        l.ior(l.lt(x1, zero), l.lt(l.splat(s.width), x0)),
        l.ior(l.lt(y1, zero), l.lt(l.splat(s.height), y0)),
    );
    let off = l.iand(beyond, l.ior(off, l.lt(depth, l.splat(s.far_depth))));
    let mut p = Projected8::NONE;
    p.outside = l.movemask(l.ior(behind, off));
    p.crossing = !l.movemask(beyond) & !p.outside & 0xff;
    l.store(x0, &mut p.x0);
    l.store(x1, &mut p.x1);
    l.store(y0, &mut p.y0);
    l.store(y1, &mut p.y1);
    l.store(depth, &mut p.depth);
    let pixel = l.splat(1.0 / SAMPLES as f32);
    let right = l.splat(s.width / SAMPLES as f32 - 1.0);
    let bottom = l.splat(s.height / SAMPLES as f32 - 1.0);
    let clamped = four!(i => {
        let v = l.mul([x0, y0, x1, y1][i], pixel);
        let last = [right, bottom, right, bottom][i];
        l.trunc(l.min(l.max(v, zero), last))
    });
    for (v, to) in clamped.iter().zip(&mut p.pixels) {
        l.istore(*v, to);
    }
    let code = l.codes(l.max(depth, zero));
    l.istore(code, &mut p.code);
    let Some(hiz) = s.hiz else {
        return p;
    };
    p.hidden = hiz.occluded(l, clamped, &p.code) & l.movemask(beyond) & !p.outside;
    if let Some(corners_of) = corners_of {
        let (zq, zz) = corners(l, &c, &h, &s.rows[2]);
        let z_low = four!(k => l.mul(l.sub(zq[k], zz), low[k]));
        let z_high = four!(k => l.mul(l.add(zq[k], zz), high[k]));
        let sides = [[x_low, y_low, z_low], [x_high, y_high, z_high]];
        for (side, [x, y, z]) in sides.into_iter().enumerate() {
            for k in 0..4 {
                let (x, y) = (l.mul(x[k], pixel), l.mul(y[k], pixel));
                let beside = l.ior(
                    l.ior(l.lt(x, zero), l.lt(l.add(right, one), x)),
                    l.ior(l.lt(y, zero), l.lt(l.add(bottom, one), y)),
                );
                let z = l.select(beside, zero, l.max(z[k], zero));
                let x = l.trunc(l.min(l.max(x, zero), right));
                let y = l.trunc(l.min(l.max(y, zero), bottom));
                let at = pixel_index!(l, hiz.buffer, x, y);
                l.istore(at, &mut corners_of.at[4 * side + k]);
                l.istore(l.codes(z), &mut corners_of.code[4 * side + k]);
            }
        }
    }
    p
}

/// Pixel of each box's centre (right, down) and its depth code; a very low code if it is not on the
/// screen.
#[inline(always)]
fn centers<L: Lanes>(l: L, s: &Screen<'_>, boxes: &Boxes8) -> [[i32; 8]; 3] {
    let c = [
        l.load(&boxes.center[0]),
        l.load(&boxes.center[1]),
        l.load(&boxes.center[2]),
    ];
    let [x, y, z, w] = four!(i => dot(l, &c, &s.rows[i]));
    let (zero, one) = (l.splat(0.0), l.splat(1.0));
    let behind = l.iandnot(l.lt(z, w), l.isplat(-1));
    let w = l.div(l.splat(1.0 / SAMPLES as f32), w);
    let (x, y) = (l.mul(x, w), l.mul(y, w));
    let z = l.mul(z, l.mul(w, l.splat(SAMPLES as f32)));
    let right = l.splat(s.width / SAMPLES as f32 - 1.0);
    let bottom = l.splat(s.height / SAMPLES as f32 - 1.0);
    let beside = l.ior(
        l.ior(l.lt(x, zero), l.lt(l.add(right, one), x)),
        l.ior(l.lt(y, zero), l.lt(l.add(bottom, one), y)),
    );
    let z = l.select(l.ior(behind, beside), zero, l.max(z, zero));
    let mut center = [[0; 8]; 3];
    l.istore(l.trunc(l.min(l.max(x, zero), right)), &mut center[0]);
    l.istore(l.trunc(l.min(l.max(y, zero), bottom)), &mut center[1]);
    l.istore(l.codes(z), &mut center[2]);
    center
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

/// A clip row at the four corners of the box's central section, and its change to the upper
/// corners.
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
