//! Deferred shading beside its twin, by every light and by clusters.

use foveal_generate as generate;
use foveal_scene::{Light, LightKind, Projection};
use glam::Vec3;

use super::twin::{HEIGHT, WIDTH, assert_equals_twin};
use crate::testing::{picture, radiance, rendered, small, texels};
use crate::{DebugView, LightAssignment, LightingModel, Settings};

#[test]
fn shading_equals_its_twin_for_both_lighting_models() {
    let scene = generate::cornell();
    for lighting in [LightingModel::Ggx, LightingModel::BlinnPhong] {
        assert_equals_twin(
            &scene,
            &scene.cameras[0],
            &small(WIDTH, HEIGHT).with(|s| s.lighting.model = lighting),
        );
    }
}

#[test]
fn shading_equals_its_twin_for_metals_and_an_orthographic_camera() {
    let scene = generate::materials_grid();
    let mut camera = scene.cameras[0].clone();
    assert_equals_twin(&scene, &camera, &small(WIDTH, HEIGHT));
    camera.projection = Projection::Orthographic {
        height_m: 7.0,
        near_m: 0.1,
        far_m: 50.0,
    };
    assert_equals_twin(&scene, &camera, &small(WIDTH, HEIGHT));
}

#[test]
fn clustered_and_brute_lighting_give_the_same_bytes() {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 150, 7);
    for camera in [scene.cameras[0].clone(), scene.overview_camera()] {
        let settings = Settings::default().with(|s| {
            s.picture.width = 200;
            s.picture.height = 150;
        });
        let clustered = rendered(&scene, &camera, &settings);
        let brute = rendered(
            &scene,
            &camera,
            &settings.with(|s| s.lighting.assignment = LightAssignment::Brute),
        );
        assert_eq!(
            texels::<[u16; 4]>(&clustered.targets().radiance_view),
            texels::<[u16; 4]>(&brute.targets().radiance_view)
        );
        assert_eq!(picture(&clustered), picture(&brute));
    }
}

#[test]
fn directional_lights_behind_others_light_as_their_twin() {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 20, 7);
    let sun = scene
        .lights
        .iter()
        .find(|l| l.kind == LightKind::Directional);
    let sun = sun.expect("the room has one").clone();
    // More than a word of the clusters' bits holds.
    for i in 0..45_u8 {
        let direction = Vec3::new(f32::from(i) * 0.02 - 0.5, -1.0, 0.3).normalize();
        let intensity = sun.intensity * 0.02;
        scene.lights.push(Light {
            direction,
            intensity,
            ..sun.clone()
        });
    }
    let camera = &scene.cameras[0];
    for assignment in [LightAssignment::Clustered, LightAssignment::Brute] {
        let settings = small(WIDTH, HEIGHT).with(|s| s.lighting.assignment = assignment);
        assert_equals_twin(&scene, camera, &settings);
    }
}

#[test]
fn views_do_not_shade() {
    let scene = generate::cornell();
    let settings = small(WIDTH, HEIGHT).with(|s| s.picture.view = DebugView::Depth);
    let mut renderer = rendered(&scene, &scene.cameras[0], &settings);
    assert!(radiance(&renderer).iter().all(|r| *r == Vec3::ZERO));
    assert_eq!(renderer.redraw(&scene.cameras[0]).shaded_samples, 0);
}
