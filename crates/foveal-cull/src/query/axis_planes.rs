//! Planes across the world's axes on the screen, and rays that enter boxes between such planes.

use super::plane_lanes::{Affine, AxisPlaneLanes, ROUNDING};
use crate::camera::Camera;
use crate::format::{EMPTY, encode};
use glam::{DMat3, DVec3, Vec3};

/// Planes across the world's axes on the screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxisPlanes {
    /// Per axis: depth of the plane at 1 m (perspective) or at 0 m (orthographic) from the eye.
    axes: [Affine; 3],
    /// Orthographic: change of depth per metre, NaN for an axis that is almost perpendicular to the
    /// view direction. Perspective views divide by the metres instead.
    per_metre: Option<[f32; 3]>,
    /// From the eye to the boxes' origin, metres.
    pub(super) from_eye: Vec3,
    /// The same by lane, for all planes of one box at once.
    pub(super) lanes: AxisPlaneLanes,
}

impl AxisPlanes {
    /// `None` for a view that cannot be inverted.
    pub(crate) fn new(camera: &Camera, origin: DVec3, width: f32, height: f32) -> Option<Self> {
        let [x, y, z, w] = camera.rows;
        let last = if camera.orthographic {
            camera.forward
        } else {
            w.truncate()
        };
        // Rows X, Y, and distance. The inverse takes (x, y, distance) to a point relative to the
        // eye.
        let inverse = DMat3::from_cols(x.truncate(), y.truncate(), last)
            .transpose()
            .inverse();
        if !inverse.is_finite() {
            return None;
        }
        let affine = |at: DVec3| {
            let terms = at.x.abs() * f64::from(width) + at.y.abs() * f64::from(height) + at.z.abs();
            Affine {
                x: at.x as f32,
                y: at.y as f32,
                at_zero: at.z as f32,
                error: ROUNDING * terms as f32,
            }
        };
        let from_eye = (origin - camera.eye).as_vec3();
        let rows = [0, 1, 2].map(|axis| inverse.row(axis));
        if !camera.orthographic {
            return Some(Self::of(
                rows.map(|r| affine(r * camera.near)),
                None,
                from_eye,
            ));
        }
        // A point is at (x - X.w, y - Y.w) on the screen and at distance t: p = a (x - X.w) + b (y
        // - Y.w) + f t. At p = k, t = (k - a (x - X.w) - b (y - Y.w)) / f, and the depth falls by
        // `fall` per metre of t.
        let fall = z.truncate().dot(camera.forward);
        let per_metre = rows.map(|r| {
            if r.z.abs() < 1e-5 {
                f64::NAN
            } else {
                fall / r.z
            }
        });
        let axes = [0, 1, 2].map(|axis| {
            let (r, k) = (rows[axis], per_metre[axis]);
            let shift = r.x * x.w + r.y * y.w;
            affine(DVec3::new(-r.x * k, -r.y * k, shift * k + z.w))
        });
        Some(Self::of(axes, Some(per_metre.map(|v| v as f32)), from_eye))
    }

    fn of(axes: [Affine; 3], per_metre: Option<[f32; 3]>, from_eye: Vec3) -> Self {
        Self {
            axes,
            per_metre,
            from_eye,
            lanes: AxisPlaneLanes::new(&axes, per_metre),
        }
    }

    /// Depth code at which the ray through (x, y) enters a box; the lowest code where it misses.
    /// Rounded neither up nor down: enough to call a box visible, which is always safe.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn entry(&self, x: f32, y: f32, center: Vec3, half: Vec3) -> i16 {
        let center = center + self.from_eye;
        // Distances along the ray in units that grow with distance: from the last front plane to
        // the first back plane.
        let (mut enter, mut leave) = (0.0f32, f32::INFINITY);
        for axis in 0..3 {
            let a = &self.axes[axis];
            let depth = a.x * x + a.y * y + a.at_zero;
            let (lo, hi) = (center[axis] - half[axis], center[axis] + half[axis]);
            let (lo, hi) = match self.per_metre {
                None => {
                    let per_depth = 1.0 / depth;
                    (lo * per_depth, hi * per_depth)
                }
                Some(k) if k[axis].is_nan() => continue,
                Some(k) => (1.0 - (depth + k[axis] * lo), 1.0 - (depth + k[axis] * hi)),
            };
            enter = enter.max(lo.min(hi));
            leave = leave.min(lo.max(hi));
        }
        if enter >= leave {
            return EMPTY;
        }
        encode(match self.per_metre {
            None => 1.0 / enter,
            Some(_) => 1.0 - enter,
        })
    }
}
