//! Spheres of all metallic and roughness values.

use glam::{Mat4, Vec3, Vec4};

use super::build::{MeshBuilder, SceneBuilder, named};
use super::lights::point;
use foveal_scene::{Camera, Environment, Material, Scene};

/// Five by five spheres: metallic grows upwards, roughness to the right, both from 0 to 1.
/// Camera: `front`.
#[must_use]
pub fn materials_grid() -> Scene {
    let mut scene = SceneBuilder::new("materials-grid");
    let mut sphere = MeshBuilder::new();
    sphere.ellipsoid(Vec3::ZERO, Vec3::splat(0.42), 48, 24);
    let sphere = scene.mesh(sphere.finish("sphere"));
    for row in 0..5u8 {
        for column in 0..5u8 {
            let (metallic, roughness) = (f32::from(row) / 4.0, f32::from(column) / 4.0);
            let material = scene.material(Material {
                name: format!("metallic {metallic} roughness {roughness}"),
                base_color: Vec4::new(0.85, 0.45, 0.25, 1.0),
                metallic,
                roughness,
                ..Material::default()
            });
            let place = Vec3::new(f32::from(column) - 2.0, f32::from(row) - 2.0, 0.0);
            scene.object(
                format!("sphere {row} {column}"),
                None,
                None,
                &[(sphere, material)],
                Mat4::from_translation(place),
            );
        }
    }
    lit_from_the_front(scene, 7.2)
}

/// The scene under three lights and a dim sky, seen from in front at a distance in metres.
pub(super) fn lit_from_the_front(mut scene: SceneBuilder, distance_m: f32) -> Scene {
    for (position, color, intensity) in [
        ([-3.0, 3.0, 4.0], [1.0, 0.95, 0.9], 30.0),
        ([3.5, 1.0, 3.0], [0.5, 0.7, 1.0], 12.0),
        ([0.0, -3.5, 2.5], [1.0, 0.5, 0.3], 6.0),
    ] {
        scene.light(point(position.into(), color.into(), intensity, 20.0));
    }
    let eye = Vec3::new(0.0, 0.0, distance_m);
    let camera = Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 40f32.to_radians());
    scene.camera(named(camera, "front"));
    let mut scene = scene.finish();
    scene.environment = Environment {
        zenith: Vec3::new(0.20, 0.26, 0.36),
        horizon: Vec3::new(0.30, 0.28, 0.26),
        nadir: Vec3::new(0.08, 0.07, 0.06),
    };
    scene
}
