//! Whether a near plane may cut the mesh that an inner shape is inside.
//!
//! A surface that the near plane cuts is open: one sees into the object, and what is behind the
//! boxes in it may be drawn. The same holds for an eye within the object, whose faces are culled
//! from behind. From everywhere else a ray meets the surface before it meets the boxes.

use crate::bounds::Aabb;
use crate::camera::Camera;
use crate::occluder::set::Instance;
use glam::{DVec3, Vec3};

/// Axes of a placement are so far from a plane that its inverse keeps six digits.
const LEAST_VOLUME: f64 = 1e-6;

/// Growth of bounds and distances against rounding, relative.
const ROUNDING: f64 = 1e-6;

/// The same for positions in the world.
const ROUNDING_OF_WORLD: f64 = 1e-14;

/// Whether the near rectangle of any eye of the view region may meet the bounds of an occluder
/// (mesh space), or the way from the eye to it. False only if the bounds lie beyond the near plane
/// as a whole, or if the ball around the eye with all near rectangles lies beside them.
#[inline(never)]
pub(super) fn near_may_cut(camera: &Camera, instance: &Instance, bounds: Aabb) -> bool {
    let [lo, hi] = [bounds.min, bounds.max].map(|p| Vec3::from(p).as_dvec3());
    let (middle, half) = ((lo + hi) * 0.5, (hi - lo) * 0.5);
    let axes = instance.world_from_mesh.matrix3;
    let lengths = axes.x_axis.length() * axes.y_axis.length() * axes.z_axis.length();
    let volume = axes.determinant().abs();
    // Not true of NaN either.
    let regular = volume > LEAST_VOLUME * lengths && lengths.is_finite();
    if !regular {
        return true;
    }
    let world = instance.world_from_mesh.transform_point3(middle);
    let from_eye = world - camera.eye;
    let sides = [
        axes.x_axis * half.x,
        axes.y_axis * half.y,
        axes.z_axis * half.z,
    ];
    let size: f64 = sides.iter().map(|s| s.length()).sum();
    let rounding = (world.abs() + camera.eye.abs()).element_sum() * ROUNDING_OF_WORLD
        + (size + camera.near_reach) * ROUNDING;
    let reach: f64 = sides.iter().map(|s| s.dot(camera.forward).abs()).sum();
    if from_eye.dot(camera.forward) - reach > camera.near + rounding {
        return false;
    }
    // The ball in mesh space has these half extents.
    let radius = camera.near_reach + rounding;
    let inverse = instance.mesh_from_world.matrix3;
    let rows = inverse.transpose();
    let ball = DVec3::new(
        rows.x_axis.length(),
        rows.y_axis.length(),
        rows.z_axis.length(),
    ) * radius;
    let apart = (inverse * from_eye).abs() - half * (1.0 + ROUNDING) - ball;
    !apart.cmpgt(DVec3::ZERO).any()
}
