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
    #[inline(always)]
    pub(crate) fn of<L: Lanes>(l: L, boxes: &[Aabb; 8]) -> Self {
        let v = l.transpose(boxes);
        let half = l.splat(0.5);
        let (mut eight, mut reach) = (Self::NONE, [l.splat(0.0); 2]);
        let mut valid = l.isplat(-1);
        let (mut center, mut extent) = ([half; 3], [half; 3]);
        for k in 0..3 {
            let (lo, hi) = (l.mul(v[k], half), l.mul(v[k + 3], half));
            (center[k], extent[k]) = (l.add(lo, hi), l.sub(hi, lo));
            valid = l.iandnot(l.lt(v[k + 3], v[k]), valid);
            reach = [
                l.max(reach[0], l.abs(center[k])),
                l.max(reach[1], extent[k]),
            ];
        }
        let grow = l.mul(l.add(reach[0], reach[1]), l.splat(ROUNDING));
        for k in 0..3 {
            l.store(center[k], &mut eight.center[k]);
            let grown = l.select(valid, l.add(extent[k], grow), l.splat(f32::NAN));
            l.store(grown, &mut eight.half[k]);
        }
        eight
    }

    /// Copies box `from` of `boxes` to box `lane`.
    #[inline(always)]
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
