//! What holds for the market.

use std::sync::LazyLock;

use glam::Vec3;

use super::*;
use foveal_scene::{Instance, Object};

/// The default market, made once for all tests.
fn market() -> &'static Scene {
    static MARKET: LazyLock<Scene> = LazyLock::new(|| demo(&DemoOptions::default()).unwrap());
    &MARKET
}

fn of_size(instances: u32) -> Scene {
    let options = DemoOptions {
        instances,
        ..DemoOptions::default()
    };
    demo(&options).unwrap()
}

fn triangles<'a>(scene: &'a Scene, instance: &'a Instance) -> impl Iterator<Item = [Vec3; 3]> + 'a {
    let mesh = &scene.meshes[instance.mesh as usize];
    mesh.indices.as_chunks::<3>().0.iter().map(|t| {
        t.map(|i| {
            let p = mesh.vertices[i as usize].position.into();
            instance.world_from_object.transform_point3(p)
        })
    })
}

/// Distance from a point to a triangle: to its plane where the foot lies inside, else to its edges.
fn distance(p: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let n = (b - a).cross(c - a).normalize_or_zero();
    let inside = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|&(from, to)| (to - from).cross(p - from).dot(n) >= 0.0);
    if inside && n != Vec3::ZERO {
        return (p - a).dot(n).abs();
    }
    [(a, b), (b, c), (c, a)]
        .map(|(from, to)| {
            let edge = to - from;
            let t = ((p - from).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
            p.distance(from + edge * t)
        })
        .into_iter()
        .fold(f32::INFINITY, f32::min)
}

/// Distance to the nearest surface, `reach` if there is none nearer; steam and the ground aside.
fn clearance(scene: &Scene, p: Vec3, reach: f32) -> f32 {
    scene
        .instances
        .iter()
        .filter(|i| {
            let near = i.bounds.min - reach;
            let far = i.bounds.max + reach;
            p.cmpge(near).all() && p.cmple(far).all()
        })
        .filter(|i| scene.meshes[i.mesh as usize].name != "steam")
        .flat_map(|i| triangles(scene, i))
        .map(|t| distance(p, t))
        .fold(reach, f32::min)
}

#[test]
fn the_number_of_instances_is_the_wanted_one() {
    for wanted in [1_000, 1_300, 2_500, 20_000, 100_000] {
        let count = of_size(wanted).instances.len() as f32;
        let error = (count / wanted as f32 - 1.0).abs();
        assert!(error < 0.02, "{count} of {wanted}");
    }
    assert!((4_900..=5_100).contains(&market().instances.len()));
}

#[test]
fn wrong_sizes_are_refused() {
    let ask = |instances, lights| {
        let seed = 1;
        demo(&DemoOptions {
            instances,
            lights,
            seed,
        })
    };
    assert!(matches!(
        ask(999, 0),
        Err(GenerateError::InstanceCount { .. })
    ));
    assert!(matches!(
        ask(100_001, 0),
        Err(GenerateError::InstanceCount { .. })
    ));
    assert!(matches!(
        ask(1_000, 201),
        Err(GenerateError::LightCount { most: 200, .. })
    ));
    assert_eq!(ask(1_000, 0).unwrap().lights.len(), 1);
}

#[test]
fn another_seed_gives_another_market_of_the_same_size() {
    let options = DemoOptions {
        seed: 2,
        ..DemoOptions::default()
    };
    let other = demo(&options).unwrap();
    assert!((4_900..=5_100).contains(&other.instances.len()));
    assert_ne!(other.instances, market().instances);
}

#[test]
fn few_meshes_are_used_many_times() {
    let scene = market();
    assert!(scene.meshes.len() <= 72);
    let used: std::collections::BTreeSet<_> = scene.instances.iter().map(|i| i.mesh).collect();
    assert_eq!(used.len(), scene.meshes.len(), "a mesh is never placed");
}

#[test]
fn each_light_shines_within_a_glowing_mesh() {
    let scene = market();
    let points: Vec<_> = scene
        .lights
        .iter()
        .filter(|l| l.kind == LightKind::Point)
        .collect();
    assert_eq!(points.len(), 200);
    for light in points {
        assert!((4.0..=10.0).contains(&light.range_m.unwrap()));
        let glows = scene.instances.iter().any(|i| {
            scene.materials[i.material as usize].emissive != Vec3::ZERO
                && i.bounds.min.cmple(light.position).all()
                && i.bounds.max.cmpge(light.position).all()
        });
        assert!(glows, "no lantern at {}", light.position);
    }
}

#[test]
fn cameras_stand_clear() {
    for instances in [1_000, 20_000] {
        let scene = of_size(instances);
        assert_eq!(scene.cameras[0].name, "alley");
        for camera in &scene.cameras {
            let room = clearance(&scene, camera.eye(), 0.5);
            assert!(room > 0.25, "{}: {room}", camera.name);
        }
    }
}

#[test]
fn the_walk_passes_through_nothing() {
    let scene = market();
    let mut last = demo_path(&DemoOptions::default(), 0.0).eye();
    for i in 0..=900u16 {
        let eye = demo_path(&DemoOptions::default(), f32::from(i) / 900.0).eye();
        // Steps shorter than the clearance: what lies between two samples is clear too.
        assert!(eye.distance(last) < 0.3);
        assert!(clearance(scene, eye, 0.4) > 0.3, "at {i}: {eye}");
        last = eye;
    }
}

#[test]
fn the_walk_is_smooth_and_bounded() {
    let options = DemoOptions::default();
    for i in 1..1000u16 {
        let at = |i: u16| demo_path(&options, f32::from(i) / 1000.0);
        let turn = at(i - 1)
            .world_from_view
            .z_axis
            .dot(at(i).world_from_view.z_axis);
        assert!(turn > 0.999, "jerk at {i}");
    }
    assert_eq!(demo_path(&options, -1.0), demo_path(&options, 0.0));
    assert_eq!(demo_path(&options, 2.0), demo_path(&options, 1.0));
}

/// Möller and Trumbore 1997; true when the segment meets the triangle.
fn meets(from: Vec3, to: Vec3, [a, b, c]: [Vec3; 3]) -> bool {
    let (along, e1, e2) = (to - from, b - a, c - a);
    let p = along.cross(e2);
    let det = e1.dot(p);
    if det.abs() < 1e-9 {
        return false;
    }
    let s = from - a;
    let (u, q) = (s.dot(p) / det, s.cross(e1));
    let (v, t) = (along.dot(q) / det, e2.dot(q) / det);
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (1e-4..0.999).contains(&t)
}

#[test]
fn walls_hide_most_stalls_from_the_alley() {
    let scene = of_size(20_000);
    let eye = scene.cameras[0].eye();
    let instances = |o: &Object| {
        let range = o.instances.start as usize..o.instances.end as usize;
        &scene.instances[range]
    };
    let walls: Vec<[Vec3; 3]> = scene
        .objects
        .iter()
        .filter(|o| o.occluder == Some(true))
        .flat_map(instances)
        .flat_map(|i| triangles(&scene, i))
        .collect();
    let stalls: Vec<_> = scene
        .objects
        .iter()
        .filter(|o| o.name.starts_with("stall "))
        .collect();
    let hidden = stalls
        .iter()
        .filter(|o| {
            let high = o.bounds.center() + Vec3::Y;
            walls.iter().any(|&t| meets(eye, high, t))
        })
        .count();
    let share = hidden as f32 / stalls.len() as f32;
    assert!(stalls.len() > 300, "{}", stalls.len());
    assert!(share > 0.75, "only {share} hidden");
}

#[test]
fn every_material_path_is_exercised() {
    use foveal_scene::AlphaMode;
    let scene = market();
    let some = |f: &dyn Fn(&foveal_scene::Material) -> bool| {
        let shown = scene
            .instances
            .iter()
            .map(|i| &scene.materials[i.material as usize]);
        shown.into_iter().any(f)
    };
    assert!(some(&|m| m.alpha_mode == AlphaMode::Opaque));
    assert!(some(&|m| matches!(m.alpha_mode, AlphaMode::Mask { .. })));
    assert!(some(&|m| m.alpha_mode == AlphaMode::Blend));
    assert!(some(&|m| m.emissive_texture.is_some()));
    assert!(some(&|m| m.normal_texture.is_some()));
    assert!(some(&|m| m.metallic_roughness_texture.is_some()));
    assert!(some(&|m| m.double_sided));
    assert!(some(&|m| m.unlit));
}
