//! Where points and boxes lie in an eye's frustum, in `f64`.

use foveal_cull::{Aabb, Eye};
use glam::{DAffine3, DVec3, DVec4, Vec3};

/// Clip space with x and y in -w..w, and z >= 0 in front of the near plane.
pub fn clip_position(eye: &Eye, world: DVec3) -> DVec4 {
    let pose = DAffine3::from(eye.world_from_eye);
    let p = pose.matrix3.transpose() * (world - pose.translation);
    let [l, r, b, t] = eye.projection.extents();
    let [near, _] = eye.projection.near_far_m();
    let w = if eye.projection.is_orthographic() {
        1.0
    } else {
        -p.z
    };
    DVec4::new(
        (2.0 * p.x - (r + l) * w) / (r - l),
        (2.0 * p.y - (t + b) * w) / (t - b),
        -p.z - near,
        w,
    )
}

/// Whether one plane of the frustum has the whole box behind it. Such a box is certainly not seen;
/// others may still miss the frustum.
pub(super) fn is_outside(eye: &Eye, bounds: &Aabb) -> bool {
    let [near, far] = eye.projection.near_far_m();
    let behind = corners(bounds).map(|corner| {
        let p = clip_position(eye, corner);
        [
            p.z,
            far - near - p.z,
            p.w + p.x,
            p.w - p.x,
            p.w + p.y,
            p.w - p.y,
        ]
        .map(|distance| distance < 0.0)
    });
    (0..6).any(|plane| behind.iter().all(|corner| corner[plane]))
}

/// The eight corners; bit 0 of the number takes the larger x, bit 1 y, bit 2 z.
pub fn corners(bounds: &Aabb) -> [DVec3; 8] {
    let (lo, hi) = (bounds.min, bounds.max);
    let [lo, hi] = [lo, hi].map(|corner| Vec3::from(corner).as_dvec3());
    std::array::from_fn(|i| {
        let pick = |bit: usize, a: f64, b: f64| if i & bit == 0 { a } else { b };
        DVec3::new(
            pick(1, lo.x, hi.x),
            pick(2, lo.y, hi.y),
            pick(4, lo.z, hi.z),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_cull::Projection;

    #[test]
    fn boxes_beyond_each_side_are_outside() {
        let projection = Projection::perspective(1.5, 1.0, 1.0, 100.0);
        let eye = Eye::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, projection);
        let at = |x: f32, y: f32, z: f32| {
            let center = Vec3::new(x, y, z);
            is_outside(&eye, &Aabb::new(center - 1.0, center + 1.0))
        };
        for (x, y, z) in [
            (0.0, 0.0, 5.0),
            (0.0, 0.0, -200.0),
            (50.0, 0.0, -10.0),
            (-50.0, 0.0, -10.0),
            (0.0, 50.0, -10.0),
            (0.0, -50.0, -10.0),
        ] {
            assert!(at(x, y, z), "{x} {y} {z}");
        }
        assert!(!at(0.0, 0.0, -1.0) && !at(0.0, 0.0, -100.0) && !at(9.0, 0.0, -10.0));
    }
}
