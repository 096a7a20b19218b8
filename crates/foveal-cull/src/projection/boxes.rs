//! Boxes as centres and half extents, eight at a time.

use crate::bounds::Aabb;
use crate::simd::Lanes;
use glam::Vec3;

/// Relative growth of boxes, more than all rounding.
pub(crate) const ROUNDING: f32 = 6e-7;

/// Eight boxes by coordinate.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Boxes8 {
    pub(crate) center: [[f32; 8]; 3],
    pub(crate) half: [[f32; 8]; 3],
}

impl Boxes8 {
    /// Eight boxes of NaN, which are never culled.
    pub(crate) const NONE: Self = Self {
        center: [[f32::NAN; 8]; 3],
        half: [[f32::NAN; 8]; 3],
    };

    /// Centres and half extents of eight boxes, grown for rounding; NaN for boxes that are not
    /// volumes.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn of<L: Lanes>(l: L, boxes: &[Aabb; 8]) -> Self {
        let v = l.transpose(boxes);
        let half = l.splat(0.5);
        let (mut eight, mut reach) = (Self::NONE, [l.splat(0.0); 2]);
        let mut valid = l.all();
        let (mut center, mut extent) = ([half; 3], [half; 3]);
        for k in 0..3 {
            let (lo, hi) = (v[k] * half, v[k + 3] * half);
            (center[k], extent[k]) = (lo + hi, hi - lo);
            valid = valid & !v[k + 3].lt(v[k]);
            reach = [reach[0].max(center[k].abs()), reach[1].max(extent[k])];
        }
        let grow = (reach[0] + reach[1]) * ROUNDING;
        for k in 0..3 {
            center[k].store(&mut eight.center[k]);
            let grown = valid.select(extent[k] + grow, l.splat(f32::NAN));
            grown.store(&mut eight.half[k]);
        }
        eight
    }

    /// Copies box `from` of `boxes` to box `lane`.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn copy(&mut self, lane: usize, boxes: &Self, from: usize) {
        for axis in 0..3 {
            self.center[axis][lane] = boxes.center[axis][from];
            self.half[axis][lane] = boxes.half[axis][from];
        }
    }

    pub(crate) fn set(&mut self, lane: usize, center: Vec3, half: Vec3) {
        for axis in 0..3 {
            self.center[axis][lane] = center[axis];
            self.half[axis][lane] = half[axis];
        }
    }
}
