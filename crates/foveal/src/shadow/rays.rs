//! Shadows against rays through the scene's triangles.

use foveal_scene::Scene;
use glam::Vec3;

use super::tests::{Seen, lookup, room, seen, shadowed};
use crate::Shadows;
use crate::testing::rendered;

/// A scene's opaque triangles, world space.
fn triangles(scene: &Scene) -> Vec<[Vec3; 3]> {
    let mut all = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh as usize];
        let at = |i: &u32| {
            let position = Vec3::from(mesh.vertices[*i as usize].position);
            instance.world_from_object.transform_point3(position)
        };
        let corners = mesh.indices.as_chunks::<3>().0;
        all.extend(corners.iter().map(|[a, b, c]| [at(a), at(b), at(c)]));
    }
    all
}

/// Whether any triangle lies between two points (Moeller and Trumbore 1997).
fn is_blocked(triangles: &[[Vec3; 3]], from: Vec3, to: Vec3) -> bool {
    let ray = to - from;
    triangles.iter().any(|&[a, b, c]| {
        let (ab, ac) = (b - a, c - a);
        let p = ray.cross(ac);
        let determinant = ab.dot(p);
        if determinant.abs() < 1e-12 {
            return false;
        }
        let s = from - a;
        let u = s.dot(p) / determinant;
        let q = s.cross(ab);
        let v = ray.dot(q) / determinant;
        let t = ac.dot(q) / determinant;
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < 1.0
    })
}

#[test]
fn shadows_are_those_of_rays() {
    let scene = room();
    let camera = &scene.cameras[0];
    let settings = shadowed(Shadows::Hard).with(|s| {
        s.picture.width = 640;
        s.picture.height = 480;
    });
    let renderer = rendered(&scene, camera, &settings);
    let lookup = lookup(&renderer);
    let triangles = triangles(&scene);
    let lights = renderer.lights().1;
    let (mut looked, mut wrong, mut blocked) = (0, 0, 0);
    for Seen { surface: s, .. } in seen(&renderer, camera).into_iter().step_by(41) {
        for (number, light) in lights.iter().enumerate() {
            let to = match light.kind {
                0 => s.position - 100.0 * Vec3::from(light.direction),
                _ => light.position.into(),
            };
            let towards = (to - s.position).normalize();
            let n_dot_l = s.normal.dot(towards);
            let is_in_cone = light.kind != 2
                || -Vec3::from(light.direction).dot(towards) > light.cone_cos + 0.01;
            // What grazes a surface is lit by next to nothing.
            if n_dot_l < 0.05 || !is_in_cone || to.distance(s.position) < 0.05 {
                continue;
            }
            let is_dark = is_blocked(&triangles, s.position + 2e-3 * s.normal, to);
            let passing = lookup.light_passing(number, light, (s.position, s.vertex_normal));
            looked += 1;
            blocked += u32::from(is_dark);
            wrong += u32::from((passing > 0.5) == is_dark);
        }
    }
    assert!(
        looked > 10_000 && blocked * 20 > looked,
        "{looked}, {blocked}"
    );
    // A shadow's edge runs through some pixels.
    assert!(wrong * 100 <= looked, "{wrong} of {looked} differ");
}
