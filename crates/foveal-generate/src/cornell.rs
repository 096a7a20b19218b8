//! A small box room with two blocks: every kind of light on few triangles.

use glam::{Vec3, Vec4};

use super::build::{MeshBuilder, SceneBuilder, named};
use super::lights::point;
use super::trig::stand;
use foveal_scene::{Camera, Environment, Light, LightKind, Material, Scene};

/// A box room 4 m wide, 3 m high and 4 m deep, open towards +z, with two blocks; four point
/// lights, a spot light and a directional one. Camera: `front`.
#[must_use]
pub fn cornell() -> Scene {
    let mut scene = SceneBuilder::new("cornell");
    let mut paint = |name: &str, color: [f32; 3], roughness: f32, emissive: f32| {
        let color = Vec3::from(color);
        scene.material(Material {
            name: name.to_owned(),
            base_color: color.extend(1.0),
            metallic: 0.0,
            roughness,
            emissive: color * emissive,
            ..Material::default()
        })
    };
    let white = paint("white", [0.73, 0.71, 0.68], 0.9, 0.0);
    let red = paint("red", [0.63, 0.06, 0.05], 0.9, 0.0);
    let green = paint("green", [0.14, 0.45, 0.09], 0.9, 0.0);
    let glossy = paint("glossy", [0.60, 0.62, 0.66], 0.25, 0.0);
    let lamp = paint("lamp", [1.0, 0.86, 0.66], 1.0, 4.0);

    let (x, y, z) = (Vec3::X * 4.0, Vec3::Y * 3.0, Vec3::Z * 4.0);
    let left_back = Vec3::new(-2.0, 0.0, -2.0);
    let walls = [
        ("floor", white, left_back + z, x, -z),
        ("ceiling", white, left_back + y, x, z),
        ("back wall", white, left_back, x, y),
        ("left wall", red, left_back + z, -z, y),
        ("right wall", green, left_back + x, z, y),
    ];
    for (name, material, corner, right, up) in walls {
        let mut mesh = MeshBuilder::new();
        mesh.panel(corner, right, up);
        let mesh = scene.mesh(mesh.finish(name));
        let parts = [(mesh, material)];
        scene.object(
            name.to_owned(),
            Some("room"),
            Some(true),
            &parts,
            glam::Mat4::IDENTITY,
        );
    }
    let blocks = [
        (
            "tall block",
            white,
            Vec3::new(0.55, 1.75, 0.55),
            Vec3::new(-0.7, 0.0, -0.7),
            0.05,
        ),
        (
            "short block",
            glossy,
            Vec3::new(0.5, 0.9, 0.5),
            Vec3::new(0.75, 0.0, 0.35),
            -0.045,
        ),
        (
            "lamp",
            lamp,
            Vec3::new(0.5, 0.04, 0.5),
            Vec3::new(0.0, 2.95, 0.0),
            0.0,
        ),
    ];
    for (name, material, extent, place, turns) in blocks {
        let half = Vec3::new(extent.x, 0.0, extent.z);
        let mut mesh = MeshBuilder::new();
        mesh.bevel_box(
            -half,
            half + Vec3::Y * extent.y,
            0.02 * f32::from(u8::from(extent.y > 0.1)),
        );
        let mesh = scene.mesh(mesh.finish(name));
        let parts = [(mesh, material)];
        scene.object(
            name.to_owned(),
            Some("blocks"),
            Some(false),
            &parts,
            stand(place, turns),
        );
    }

    for (position, color, intensity) in [
        ([0.0, 2.6, 0.0], [1.0, 0.86, 0.66], 4.0),
        ([-1.5, 0.5, 1.2], [0.25, 0.75, 1.0], 0.8),
        ([1.6, 1.6, -1.5], [1.0, 0.3, 0.7], 1.0),
        ([0.3, 0.3, 1.4], [1.0, 0.6, 0.2], 0.5),
    ] {
        scene.light(point(position.into(), color.into(), intensity, 6.0));
    }
    scene.light(Light {
        kind: LightKind::Spot {
            inner_rad: 0.25,
            outer_rad: 0.5,
        },
        direction: Vec3::new(0.6, -1.0, 0.1).normalize(),
        ..point(
            Vec3::new(-0.9, 2.8, 0.2),
            Vec3::new(0.9, 1.0, 0.6),
            8.0,
            8.0,
        )
    });
    scene.light(Light {
        kind: LightKind::Directional,
        direction: Vec3::new(-0.3, -0.6, -1.0).normalize(),
        range_m: None,
        ..point(Vec3::ZERO, Vec3::new(0.6, 0.7, 1.0), 0.4, 0.0)
    });
    let eye = Vec3::new(0.0, 1.5, 5.6);
    let camera = Camera::look_at(eye, Vec3::new(0.0, 1.45, 0.0), Vec3::Y, 45f32.to_radians());
    scene.camera(named(camera, "front"));
    let mut scene = scene.finish();
    scene.environment = Environment {
        zenith: Vec4::new(0.05, 0.06, 0.08, 0.0).truncate(),
        horizon: Vec3::new(0.06, 0.06, 0.06),
        nadir: Vec3::new(0.03, 0.03, 0.03),
    };
    scene
}
