//! Which object is under the pointer: the nearest triangle that a ray meets.

use foveal_scene::{Aabb, Mesh, Scene};
use glam::{Mat4, Vec3, Vec4, Vec4Swizzles};

/// A half line through the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ray {
    pub(crate) origin: Vec3,
    /// Of any length.
    pub(crate) direction: Vec3,
}

/// An object that was chosen.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Picked {
    pub(crate) name: String,
    /// Its number in the scene.
    pub(crate) object: usize,
    /// Where it was when it was chosen.
    pub(crate) bounds: Aabb,
    pub(crate) triangles: u64,
}

/// The object whose surface the ray meets first. Faces that are drawn from the front alone are met
/// from there alone.
pub(crate) fn pick(scene: &Scene, ray: Ray) -> Option<Picked> {
    let mut candidates: Vec<(f32, usize)> = (scene.objects.iter().enumerate())
        .filter(|(_, object)| object.visible)
        .filter_map(|(i, object)| Some((ray.enters(object.bounds)?, i)))
        .collect();
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut nearest: Option<(f32, usize)> = None;
    for (enters, index) in candidates {
        if nearest.is_some_and(|(at, _)| enters > at) {
            break;
        }
        let instances = scene.objects[index].instances.clone();
        for instance in &scene.instances[instances.start as usize..instances.end as usize] {
            let object_from_world = instance.world_from_object.inverse();
            if !object_from_world.is_finite() {
                continue;
            }
            // The direction keeps its length in the world, so that distances compare.
            let ray = Ray {
                origin: object_from_world.transform_point3(ray.origin),
                direction: object_from_world.transform_vector3(ray.direction),
            };
            let material = scene.materials.get(instance.material as usize);
            let both_sides = material.is_none_or(|material| material.double_sided);
            let Some(mesh) = scene.meshes.get(instance.mesh as usize) else {
                continue;
            };
            if let Some(at) = ray.meets(mesh, both_sides)
                && nearest.is_none_or(|(before, _)| at < before)
            {
                nearest = Some((at, index));
            }
        }
    }
    let (_, object) = nearest?;
    let found = &scene.objects[object];
    let instances = found.instances.start as usize..found.instances.end as usize;
    let triangles = scene.instances[instances]
        .iter()
        .filter_map(|instance| scene.meshes.get(instance.mesh as usize))
        .map(|mesh| mesh.triangle_count() as u64);
    Some(Picked {
        name: foveal_scene::printable(&found.name),
        object,
        bounds: found.bounds,
        triangles: triangles.sum(),
    })
}

impl Ray {
    /// Through a place of an eye's picture, given as fractions from its top left corner.
    pub(crate) fn through(clip_from_world: &Mat4, [x, y]: [f32; 2]) -> Self {
        let world_from_clip = clip_from_world.inverse();
        let at = |depth| world_from_clip * Vec4::new(2.0 * x - 1.0, 1.0 - 2.0 * y, depth, 1.0);
        // Depth is reversed: the near plane, and the farthest place, which for a pinhole is a
        // direction, w = 0. Two places on the way would differ by less than they are rounded to.
        let (near, far) = (at(1.0), at(0.0));
        Self {
            origin: near.xyz() / near.w,
            direction: far.xyz() * near.w - near.xyz() * far.w,
        }
    }

    /// Where it enters a box, in lengths of its direction; 0 from within.
    fn enters(&self, bounds: Aabb) -> Option<f32> {
        if bounds.is_empty() {
            return None;
        }
        let (mut enter, mut leave) = (0.0f32, f32::INFINITY);
        for axis in 0..3 {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            if direction == 0.0 {
                if origin < bounds.min[axis] || origin > bounds.max[axis] {
                    return None;
                }
                continue;
            }
            let a = (bounds.min[axis] - origin) / direction;
            let b = (bounds.max[axis] - origin) / direction;
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter <= leave).then_some(enter)
    }

    /// Where it meets a mesh first: Möller and Trumbore.
    fn meets(&self, mesh: &Mesh, both_sides: bool) -> Option<f32> {
        let place = |index: u32| Vec3::from(mesh.vertices[index as usize].position);
        let mut nearest: Option<f32> = None;
        for &[a, b, c] in mesh.indices.as_chunks::<3>().0 {
            let (a, b, c) = (place(a), place(b), place(c));
            let (ab, ac) = (b - a, c - a);
            let across = self.direction.cross(ac);
            let determinant = ab.dot(across);
            if determinant == 0.0 || determinant < 0.0 && !both_sides {
                continue;
            }
            let from_a = self.origin - a;
            let u = from_a.dot(across) / determinant;
            let along = from_a.cross(ab);
            let v = self.direction.dot(along) / determinant;
            let at = ac.dot(along) / determinant;
            let is_inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
            if is_inside && at > 0.0 && nearest.is_none_or(|before| at < before) {
                nearest = Some(at);
            }
        }
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_generate as generate;
    use foveal_scene::{Camera, Projection};

    #[test]
    fn the_nearest_surface_is_met_not_the_nearest_box() {
        let scene = generate::cornell();
        let camera = &scene.cameras[0];
        // From the first camera's eye to the middle of each object that it sees.
        let mut met = std::collections::HashSet::new();
        for object in &scene.objects {
            let ray = Ray {
                origin: camera.eye(),
                direction: object.bounds.center() - camera.eye(),
            };
            let Some(picked) = pick(&scene, ray) else {
                continue;
            };
            assert_eq!(picked.name, scene.objects[picked.object].name);
            assert!(picked.triangles > 0);
            met.insert(picked.object);
        }
        // The room's box surrounds all; still other things are met.
        assert!(met.len() > 2, "{met:?}");
    }

    #[test]
    fn what_is_clicked_is_what_is_seen_there() {
        let scene = generate::cornell();
        let mut parallel = scene.cameras[0].clone();
        parallel.projection = Projection::Orthographic {
            height_m: 3.0,
            near_m: 0.1,
            far_m: 50.0,
        };
        for camera in [&scene.cameras[0], &parallel] {
            let named = |place| {
                let picked = pick(&scene, Ray::through(&camera.clip_from_world(1.5), place));
                picked.map(|picked| picked.name)
            };
            assert_eq!(named([0.4, 0.5]).as_deref(), Some("tall block"));
        }
        // Only a pinhole's rays reach what runs along the view.
        for (place, name) in [([0.5, 0.97], "floor"), ([0.1, 0.5], "left wall")] {
            let ray = Ray::through(&scene.cameras[0].clip_from_world(1.5), place);
            assert_eq!(pick(&scene, ray).unwrap().name, name);
        }
    }

    #[test]
    fn rays_of_a_pinhole_far_from_the_origin_keep_their_directions() {
        let eye = Vec3::new(5000.0, 100.0, 5000.0);
        let mut camera = Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 1.0);
        camera.projection = Projection::Perspective {
            fov_y_rad: 1.0,
            near_m: 0.01,
        };
        let slope = 0.5f32.tan();
        for [x, y] in [[0.5, 0.5], [0.0, 1.0], [0.3, 0.8], [1.0, 0.1]] {
            let ray = Ray::through(&camera.clip_from_world(1.5), [x, y]);
            let in_view = Vec3::new((2.0 * x - 1.0) * 1.5 * slope, (1.0 - 2.0 * y) * slope, -1.0);
            let wanted = camera.world_from_view.transform_vector3(in_view);
            let between = ray.direction.as_dvec3().angle_between(wanted.as_dvec3());
            assert!(between.to_degrees() < 0.005, "{x} {y}: {between}");
            assert!(ray.origin.distance(eye) < 0.03, "{:?}", ray.origin);
        }
    }

    #[test]
    fn nothing_is_met_by_looking_away() {
        let scene = generate::cornell();
        let ray = Ray {
            origin: scene.bounds().max + Vec3::ONE,
            direction: Vec3::ONE,
        };
        assert_eq!(pick(&scene, ray), None);
    }
}
