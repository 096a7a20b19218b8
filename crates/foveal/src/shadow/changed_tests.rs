//! Places where kept light is shaded again: they hold every pixel that a moved shadow changes.

use foveal_scene::{Camera, LightKind, Scene};
use glam::Vec3;

use super::contact_tests::{floor, level};
use super::culling_tests::{add, shift};
use super::tests::{Seen, seen, shadowed};
use crate::testing::{Film, rendered};
use crate::{Shading, Shadows};

/// A board between a floor and its lamp, which reaches little farther.
fn board_above_a_floor(kind: LightKind) -> Scene {
    let mut scene = floor(Vec3::new(3.0, 4.0, 0.0));
    add(&mut scene, [level([2.7, 3.3], 1.5, [-0.3, 0.3])]);
    scene.lights[0].range_m = Some(4.3);
    scene.lights[0].kind = kind;
    scene.lights[0].direction = Vec3::new(0.2, -1.0, 0.1).normalize();
    scene
}

#[test]
fn places_where_light_has_changed_hold_all_that_lookups_blur() {
    for kind in [LightKind::Directional, LightKind::Point] {
        for shadows in [Shadows::Hard, Shadows::Soft, Shadows::Contact] {
            let mut scene = board_above_a_floor(kind);
            let (eye, at) = (Vec3::new(-4.0, 6.0, 0.1), Vec3::new(2.5, 0.0, 0.0));
            let camera = Camera::look_at(eye, at, Vec3::Y, 0.7);
            let settings = shadowed(shadows).with(|s| {
                s.lighting.shadow_atlas = 256;
                s.lighting.light_radius_m = 0.05;
                s.lighting.sun_angle_deg = 1.0;
                s.shading.mode = Shading::Coarse;
                s.coarse.history = true;
            });
            let full = settings.clone().with(|s| s.shading.mode = Shading::Full);
            let before = rendered(&scene, &camera, &full);
            let mut film = Film::new(&scene, &settings);
            film.draw(&camera);
            shift(&mut scene, 1..2, Vec3::new(0.05, 0.0, 0.02));
            pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
            film.draw(&camera);
            let places = &film.renderer.history().changed_places;
            assert!(!places.is_empty());
            let after = rendered(&scene, &camera, &full);
            let pixels = seen(&before, &camera)
                .into_iter()
                .zip(seen(&after, &camera));
            let mut differing = 0;
            // By more than rounding.
            let differs = |(a, b): &(Seen, Seen)| {
                !a.radiance
                    .abs_diff_eq(b.radiance, 0.01 * a.radiance.max_element())
            };
            for (a, b) in pixels.filter(differs) {
                differing += 1;
                let is_known = places.iter().any(|&[x, y, z, r]| {
                    let center = Vec3::new(x, y, z);
                    let at = [a.surface.position, b.surface.position];
                    at.iter().any(|p| p.distance(center) <= r)
                });
                let at = b.surface.position;
                assert!(is_known, "{kind:?}, {shadows:?}: {at} of {places:?}");
            }
            assert!(differing > 8, "{kind:?}, {shadows:?}: {differing}");
        }
    }
}
