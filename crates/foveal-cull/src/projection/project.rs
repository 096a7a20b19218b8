//! Projection of boxes to the screen, eight at a time.

use super::boxes::Boxes8;
use super::points::{Corners8, pixel_index};
use super::screen::Screen;
use crate::format::{LEAST_DEPTH, SAMPLES};
use crate::simd::{F8, Lanes, four};

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
#[cfg_attr(not(unoptimized), inline(always))]
pub(crate) fn project<L: Lanes>(l: L, s: &Screen<'_>, boxes: &Boxes8) -> Projected8 {
    let mut p = outline(l, s, boxes, None);
    if s.hiz.is_some() {
        p.center = centers(l, s, boxes);
    }
    p
}

/// Projects eight boxes without their centres; with their corners if asked for, where the screen
/// has a HiZ.
#[cfg_attr(not(unoptimized), inline(always))]
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
        l.load(&boxes.half[0]) + grow,
        l.load(&boxes.half[1]) + grow,
        l.load(&boxes.half[2]) + grow,
    ];
    let (zc, ze) = (dot(&c, &s.rows[2]), edges(&h, &s.rows[2]));
    let (wc, we) = (dot(&c, &s.rows[3]), edges(&h, &s.rows[3]));
    let (zr, wr) = (reach(&ze), reach(&we));
    let (w_near, w_far) = (wc - wr, wc + wr);
    let z_near = zc + zr;
    // Wholly nearer than the near plane; and certainly beyond it.
    let behind = w_far.lt(zc - zr);
    let beyond = z_near.lt(w_near);
    let depth = z_near / w_near * (1.0 + 1e-6);

    let (xq, xz) = corners(&c, &h, &s.rows[0]);
    let (yq, yz) = corners(&c, &h, &s.rows[1]);
    let (wq, wz) = corners(&c, &h, &s.rows[3]);
    let one = l.splat(1.0);
    let low = four!(k => one / (wq[k] - wz));
    let high = four!(k => one / (wq[k] + wz));
    let x_low = four!(k => (xq[k] - xz) * low[k]);
    let x_high = four!(k => (xq[k] + xz) * high[k]);
    let y_low = four!(k => (yq[k] - yz) * low[k]);
    let y_high = four!(k => (yq[k] + yz) * high[k]);
    let (x0, x1) = extent(x_low, x_high);
    let (y0, y1) = extent(y_low, y_high);
    let dilate = l.splat(s.dilate);
    let (x0, y0) = (x0 - dilate, y0 - dilate);
    let (x1, y1) = (x1 + dilate, y1 + dilate);
    let zero = l.splat(0.0);
    let off = x1.lt(zero) | l.splat(s.width).lt(x0) | (y1.lt(zero) | l.splat(s.height).lt(y0));
    let off = beyond & (off | depth.lt(l.splat(s.far_depth)));
    let mut p = Projected8::NONE;
    p.outside = (behind | off).bits();
    p.crossing = !beyond.bits() & !p.outside & 0xff;
    x0.store(&mut p.x0);
    x1.store(&mut p.x1);
    y0.store(&mut p.y0);
    y1.store(&mut p.y1);
    depth.store(&mut p.depth);
    let pixel = l.splat(1.0 / SAMPLES as f32);
    let right = l.splat(s.width / SAMPLES as f32 - 1.0);
    let bottom = l.splat(s.height / SAMPLES as f32 - 1.0);
    let clamped = four!(i => {
        let v = [x0, y0, x1, y1][i] * pixel;
        let last = [right, bottom, right, bottom][i];
        v.max(zero).min(last).trunc()
    });
    for (v, to) in clamped.iter().zip(&mut p.pixels) {
        (*v).store(to);
    }
    let code = depth.max(l.splat(LEAST_DEPTH)).codes();
    code.store(&mut p.code);
    let Some(hiz) = s.hiz else {
        return p;
    };
    p.hidden = hiz.occluded(l, clamped, &p.code) & beyond.bits() & !p.outside;
    if let Some(corners_of) = corners_of {
        let (zq, zz) = corners(&c, &h, &s.rows[2]);
        let z_low = four!(k => (zq[k] - zz) * low[k]);
        let z_high = four!(k => (zq[k] + zz) * high[k]);
        let sides = [[x_low, y_low, z_low], [x_high, y_high, z_high]];
        for (side, [x, y, z]) in sides.into_iter().enumerate() {
            for k in 0..4 {
                let (x, y) = (x[k] * pixel, y[k] * pixel);
                let beside = x.lt(zero) | (right + one).lt(x) | (y.lt(zero) | (bottom + one).lt(y));
                let z = beside.select(zero, z[k].max(zero));
                let x = x.max(zero).min(right).trunc();
                let y = y.max(zero).min(bottom).trunc();
                let at = pixel_index!(l, hiz.buffer, x, y);
                at.store(&mut corners_of.at[4 * side + k]);
                z.codes().store(&mut corners_of.code[4 * side + k]);
            }
        }
    }
    p
}

/// Pixel of each box's centre (right, down) and its depth code; a very low code if it is not on the
/// screen.
#[cfg_attr(not(unoptimized), inline(always))]
fn centers<L: Lanes>(l: L, s: &Screen<'_>, boxes: &Boxes8) -> [[i32; 8]; 3] {
    let c = [
        l.load(&boxes.center[0]),
        l.load(&boxes.center[1]),
        l.load(&boxes.center[2]),
    ];
    let [x, y, z, w] = four!(i => dot(&c, &s.rows[i]));
    let (zero, one) = (l.splat(0.0), l.splat(1.0));
    let behind = !z.lt(w);
    let w = l.splat(1.0 / SAMPLES as f32) / w;
    let (x, y) = (x * w, y * w);
    let z = z * (w * SAMPLES as f32);
    let right = l.splat(s.width / SAMPLES as f32 - 1.0);
    let bottom = l.splat(s.height / SAMPLES as f32 - 1.0);
    let beside = x.lt(zero) | (right + one).lt(x) | (y.lt(zero) | (bottom + one).lt(y));
    let z = (behind | beside).select(zero, z.max(zero));
    let mut center = [[0; 8]; 3];
    x.max(zero).min(right).trunc().store(&mut center[0]);
    y.max(zero).min(bottom).trunc().store(&mut center[1]);
    z.codes().store(&mut center[2]);
    center
}

#[cfg_attr(not(unoptimized), inline(always))]
fn dot<L: Lanes>(c: &[F8<L>; 3], r: &[f32; 4]) -> F8<L> {
    c[0] * r[0] + c[1] * r[1] + (c[2] * r[2] + r[3])
}

#[cfg_attr(not(unoptimized), inline(always))]
fn edges<L: Lanes>(h: &[F8<L>; 3], r: &[f32; 4]) -> [F8<L>; 3] {
    [h[0] * r[0], h[1] * r[1], h[2] * r[2]]
}

#[cfg_attr(not(unoptimized), inline(always))]
fn reach<L: Lanes>(e: &[F8<L>; 3]) -> F8<L> {
    e[0].abs() + e[1].abs() + e[2].abs()
}

/// A clip row at the four corners of the box's central section, and its change to the upper
/// corners.
#[cfg_attr(not(unoptimized), inline(always))]
fn corners<L: Lanes>(c: &[F8<L>; 3], h: &[F8<L>; 3], r: &[f32; 4]) -> ([F8<L>; 4], F8<L>) {
    let (m, e) = (dot(c, r), edges(h, r));
    let (a, b) = (e[0] + e[1], e[0] - e[1]);
    ([m + a, m + b, m - b, m - a], e[2])
}

#[cfg_attr(not(unoptimized), inline(always))]
fn extent<L: Lanes>(a: [F8<L>; 4], b: [F8<L>; 4]) -> (F8<L>, F8<L>) {
    let lo = a[0]
        .min(a[1])
        .min(a[2].min(a[3]))
        .min(b[0].min(b[1]).min(b[2].min(b[3])));
    let hi = a[0]
        .max(a[1])
        .max(a[2].max(a[3]))
        .max(b[0].max(b[1]).max(b[2].max(b[3])));
    (lo, hi)
}
