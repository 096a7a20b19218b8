//! Boxes around the children of a node.

use glam::Vec3;

use crate::projection::boxes::Boxes8;

/// Half the surface of a box; 0 for an empty group and one without end.
#[inline(always)]
pub(super) fn half_area(half: Vec3) -> f64 {
    let half = half.as_dvec3();
    let area = half.x * half.y + half.y * half.z + half.z * half.x;
    if area.is_finite() { area } else { 0.0 }
}

/// Centre and half extent of the box around the children of a node, grown for rounding; NaN where
/// there are none. Children are volumes; NaN in lanes without one is skipped.
#[inline(always)]
pub(super) fn around(boxes: &Boxes8) -> (Vec3, Vec3) {
    let (mut center, mut half) = (Vec3::NAN, Vec3::NAN);
    for axis in 0..3 {
        let (c, h) = (&boxes.center[axis], &boxes.half[axis]);
        // Comparisons with NaN are false.
        let mut low: [f32; 8] = core::array::from_fn(|i| {
            let v = c[i] - h[i];
            if v < f32::INFINITY { v } else { f32::INFINITY }
        });
        let mut high: [f32; 8] = core::array::from_fn(|i| {
            let v = c[i] + h[i];
            if v > f32::NEG_INFINITY {
                v
            } else {
                f32::NEG_INFINITY
            }
        });
        for step in [4, 2, 1] {
            for i in 0..step {
                let (a, b) = (low[i], low[i + step]);
                low[i] = if b < a { b } else { a };
                let (a, b) = (high[i], high[i + step]);
                high[i] = if b > a { b } else { a };
            }
        }
        let (low, high) = (low[0], high[0]);
        // An empty group is from infinity to -infinity.
        if low > high {
            return (Vec3::NAN, Vec3::NAN);
        }
        let (c, h) = (
            (low + high) * 0.5,
            (high - low) * 0.5 * (1.0 + 1e-6) + (low.abs() + high.abs()) * 1e-7,
        );
        // Boxes that are too large for f32 make a group without end, not an empty one.
        (center[axis], half[axis]) = if c.is_finite() && h.is_finite() {
            (c, h)
        } else {
            (0.0, f32::INFINITY)
        };
    }
    (center, half)
}
