//! Lights in pictures: how far they shine, and how near.

use foveal_scene::{Camera, Light, LightKind, Material, Projection, Scene};
use glam::{Vec3, Vec4};

use crate::forward::twin::quads;
use crate::testing::{Film, f32_of_half, small};
use crate::{EnvironmentSource, Settings, Shading, Shadows};

const SIDE: u32 = 33;

/// A square of side 2 around the origin, lit from above it along z; how much of the world's
/// height the camera shows, from 1 m above.
fn lit_square(light_z: f32, intensity: f32, height_m: f32) -> (Scene, Camera) {
    let material = Material {
        base_color: Vec4::ONE,
        metallic: 0.0,
        roughness: 1.0,
        specular: 0.0,
        ..Material::default()
    };
    let mut scene = quads(vec![material], &[0.0]);
    scene.lights = vec![Light {
        kind: LightKind::Point,
        color: Vec3::ONE,
        intensity,
        position: Vec3::Z * light_z,
        direction: -Vec3::Z,
        range_m: None,
        node: None,
    }];
    let mut camera = Camera::look_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0);
    camera.projection = Projection::Orthographic {
        height_m,
        near_m: 0.1,
        far_m: 2.0,
    };
    (scene, camera)
}

fn settings(exposure_stops: f32) -> Settings {
    small(SIDE, SIDE).with(|s| {
        s.picture.exposure_stops = exposure_stops;
        s.lighting.environment = EnvironmentSource::None;
        s.lighting.shadows = Shadows::Off;
    })
}

fn radiance(film: &Film) -> Vec<f32> {
    let texels = film.radiance();
    texels.into_iter().map(|t| f32_of_half(t[0])).collect()
}

/// Radiance of a white surface that is scattered of a light's irradiance.
fn scattered(to_light: Vec3, intensity: f32) -> f32 {
    let squared = to_light.length_squared();
    intensity * to_light.z / squared.sqrt() / squared / std::f32::consts::PI
}

#[test]
fn lights_without_a_range_shine_as_far_as_an_exposure_shows() {
    let (scene, camera) = lit_square(48.0, 1.0, 1.0);
    let expected = scattered(Vec3::Z * 48.0, 1.0);
    for mode in [Shading::Full, Shading::Coarse] {
        let exposed = |stops: f32| {
            settings(stops).with(|s| {
                s.shading.mode = mode;
                s.coarse.history = true;
            })
        };
        let mut film = Film::new(&scene, &exposed(0.0));
        film.draw(&camera);
        // Far below what a picture of 8 bits shows.
        assert!(radiance(&film).iter().all(|&r| r == 0.0));
        let set = |film: &mut Film, stops: f32| {
            let settings = exposed(stops);
            pollster::block_on(film.renderer.set_settings(&settings)).expect("they fit");
            film.draw(&camera);
        };
        set(&mut film, 8.0);
        for found in radiance(&film) {
            assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
        }
        // A pose is lit for the exposure, too, and so is a scene that is set anew.
        pollster::block_on(film.renderer.update_pose(&scene)).expect("it fits");
        film.draw(&camera);
        assert!(radiance(&film)[0] > 0.9 * expected);
        pollster::block_on(film.renderer.set_scene(&scene)).expect("it fits");
        film.draw(&camera);
        assert!(radiance(&film)[0] > 0.9 * expected);
        set(&mut film, 0.0);
        assert!(radiance(&film).iter().all(|&r| r == 0.0));
    }
}

#[test]
fn light_that_one_lamp_alone_hardly_shows_is_not_cut_off() {
    // White scatters 1 / 800 of it; highlights and many such lamps show.
    let (scene, camera) = lit_square(16.0, 1.0, 1.0);
    let mut film = Film::new(&scene, &settings(0.0));
    film.draw(&camera);
    let expected = scattered(Vec3::Z * 16.0, 1.0);
    for found in radiance(&film) {
        assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    }
}

#[test]
fn exposures_up_to_0_change_no_range() {
    let (scene, _) = lit_square(16.0, 3.0, 1.0);
    let at = |stops: f32| super::LightUniform::all(&scene.lights, stops)[0];
    assert_eq!(at(0.0).range, (3.0f32 * 2048.0).sqrt());
    assert_eq!(at(-8.0), at(0.0));
    assert_eq!(at(2.0).range, 2.0 * at(0.0).range);
    // The farthest that half-precision radiance holds.
    assert_eq!(at(64.0), at(16.0));
}

#[test]
fn a_light_two_millimetres_before_a_surface_lights_it_by_the_inverse_square() {
    let (z, intensity, height_m) = (2e-3, 1e-4, 16e-3);
    let (scene, camera) = lit_square(z, intensity, height_m);
    let mut film = Film::new(&scene, &settings(0.0));
    film.draw(&camera);
    for (i, found) in (0..).zip(radiance(&film)) {
        let [x, y] = [i % SIDE, i / SIDE].map(|p| (p as f32 + 0.5) / SIDE as f32 - 0.5);
        let expected = scattered(Vec3::new(-x, y, z / height_m) * height_m, intensity);
        assert!(
            (found / expected - 1.0).abs() < 0.03,
            "{x} {y}: {found} {expected}"
        );
    }
}

#[test]
fn an_infinite_range_is_that_of_a_light_without_one() {
    let (mut scene, _) = lit_square(1.0, 5.0, 2.0);
    let range = |scene: &Scene| super::LightUniform::all(&scene.lights, 0.0)[0].range;
    scene.lights[0].range_m = None;
    let derived = range(&scene);
    scene.lights[0].range_m = Some(f32::INFINITY);
    assert!(derived.is_finite() && range(&scene) == derived);
}
