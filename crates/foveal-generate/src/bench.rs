//! The two scenes of the stereo benchmark: few large draws, and many small ones.

use glam::{Mat3, Vec2, Vec3};

use super::build::{MeshBuilder, SceneBuilder, named};
use super::hash::Rng;
use super::lights::point;
use super::texture::{Texel, bake};
use super::trig::{pitch, shift, sin_cos_turns, yaw};
use foveal_scene::{Camera, Environment, Material, Mesh, Scene, TextureRef};

/// 20 objects of 7,872 triangles each with 20 different materials. Camera: `bench`.
#[must_use]
pub fn materials() -> Scene {
    let mut scene = SceneBuilder::new("materials");
    let materials = twenty_materials(&mut scene);
    let meshes = [
        scene.mesh(sphere(96, 42)),
        scene.mesh(knot(2, 3, 164, 24)),
        scene.mesh(knot(3, 5, 328, 12)),
    ];
    for (i, material) in materials.into_iter().enumerate() {
        let (row, column) = (i / 5, i % 5);
        let place = shift(1.5 * (column as f32 - 2.0), 1.5 * (1.5 - row as f32), 0.0);
        let mesh = meshes[(column + 2 * row) % meshes.len()];
        let turned = place * yaw(0.09 * i as f32) * pitch(0.03 * i as f32);
        scene.object(
            format!("object {i}"),
            None,
            Some(false),
            &[(mesh, material)],
            turned,
        );
    }
    surroundings(&mut scene, 4.0, Vec3::new(0.0, 0.0, 9.2));
    finish(scene)
}

/// 2,000 objects of 1,024 triangles each, with 20 materials. Camera: `bench`.
#[must_use]
pub fn materials2() -> Scene {
    let mut scene = SceneBuilder::new("materials2");
    let materials = twenty_materials(&mut scene);
    let meshes = [
        scene.mesh(sphere(32, 17)),
        scene.mesh(knot(2, 3, 64, 8)),
        scene.mesh(knot(3, 2, 128, 4)),
    ];
    for i in 0..2000usize {
        let (column, row, layer) = (i % 20, i / 20 % 10, i / 200);
        let mut rng = Rng::new(0, i as u64);
        let place = Vec3::new(column as f32 - 9.5, row as f32 - 4.5, -(layer as f32)) * 1.5;
        let shake = Vec3::new(rng.range(-0.25, 0.25), rng.range(-0.25, 0.25), 0.0);
        let mesh = meshes[rng.below(meshes.len())];
        let material = materials[rng.below(materials.len())];
        let turned = shift(place.x, place.y, place.z)
            * glam::Mat4::from_translation(shake)
            * yaw(rng.unit())
            * pitch(rng.unit());
        scene.object(
            format!("object {i}"),
            None,
            Some(false),
            &[(mesh, material)],
            turned,
        );
    }
    surroundings(&mut scene, 14.0, Vec3::new(0.0, 1.5, 17.0));
    finish(scene)
}

/// A sphere of 2 · segments · (rings − 1) triangles.
fn sphere(segments: u32, rings: u32) -> Mesh {
    let mut mesh = MeshBuilder::new();
    mesh.ellipsoid(Vec3::ZERO, Vec3::splat(0.55), segments, rings);
    mesh.finish("sphere")
}

/// A (p, q) torus knot of 2 · along · around triangles.
fn knot(p: u32, q: u32, along: u32, around: u32) -> Mesh {
    let center = |s: f32| {
        let (sin_p, cos_p) = sin_cos_turns(s * p as f32);
        let (sin_q, cos_q) = sin_cos_turns(s * q as f32);
        let r = 0.36 + 0.13 * cos_q;
        Vec3::new(r * cos_p, r * sin_p, 0.13 * sin_q)
    };
    let mut mesh = MeshBuilder::new();
    mesh.sheet(
        around,
        along,
        |t, s| {
            let axis = (center(s + 1e-3) - center(s - 1e-3)).normalize();
            // Away from the knot's own axis: never parallel to the path on these knots.
            let out = (center(s) - axis * axis.dot(center(s))).normalize();
            let (sin, cos) = sin_cos_turns(t);
            center(s) + (out * cos + axis.cross(out) * sin) * 0.085
        },
        |t, s| Vec2::new(t * 0.53, s * 3.0),
    );
    mesh.finish(&format!("torus knot {p}, {q}"))
}

/// Plastics, metals and, every fourth, a hammered surface with textures.
fn twenty_materials(scene: &mut SceneBuilder) -> Vec<u32> {
    let hammered = bake("hammered", 128, 0.25, |p| {
        let cell = super::texture::dent(p);
        let mut texel = Texel::new(Vec3::splat(0.75 + 0.25 * cell));
        texel.height_m = 0.004 * cell;
        texel.roughness = 0.25 + 0.4 * (1.0 - cell);
        texel.metallic = 1.0;
        texel
    });
    let slot = |texture| {
        Some(TextureRef {
            texture,
            uv_set: 0,
            uv_transform: Mat3::from_diagonal(Vec3::new(4.0, 4.0, 1.0)),
        })
    };
    let color = slot(scene.texture(hammered.color));
    let normal = slot(scene.texture(hammered.normal));
    let orm = slot(scene.texture(hammered.orm));
    (0..20u8)
        .map(|i| {
            let hue = f32::from(i) / 20.0;
            // Three cosines a third of a turn apart: a wheel of colours.
            let channel = |phase: f32| 0.45 + 0.42 * sin_cos_turns(hue + phase).1;
            let base_color = Vec3::new(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0));
            let textured = i % 4 == 3;
            scene.material(Material {
                name: format!("material {i}"),
                base_color: base_color.extend(1.0),
                metallic: if i % 2 == 1 { 1.0 } else { 0.0 },
                roughness: if textured {
                    1.0
                } else {
                    0.1 + 0.08 * f32::from(i % 10)
                },
                base_color_texture: color.filter(|_| textured),
                normal_texture: normal.filter(|_| textured),
                metallic_roughness_texture: orm.filter(|_| textured),
                ..Material::default()
            })
        })
        .collect()
}

fn surroundings(scene: &mut SceneBuilder, reach: f32, eye: Vec3) {
    for (place, color) in [
        ([-1.0, 0.8, 0.6], [1.0, 0.8, 0.55]),
        ([1.0, 0.7, 0.7], [0.5, 0.7, 1.0]),
        ([0.2, -0.9, 0.6], [1.0, 0.35, 0.6]),
        ([0.0, 0.2, 1.0], [0.8, 1.0, 0.85]),
    ] {
        let range_m = 5.0 * reach;
        scene.light(point(
            Vec3::from(place) * reach,
            color.into(),
            2.2 * reach * reach,
            range_m,
        ));
    }
    let camera = Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 45f32.to_radians());
    scene.camera(named(camera, "bench"));
}

fn finish(scene: SceneBuilder) -> Scene {
    let mut scene = scene.finish();
    scene.environment = Environment {
        zenith: Vec3::new(0.14, 0.17, 0.24),
        horizon: Vec3::new(0.20, 0.19, 0.19),
        nadir: Vec3::new(0.05, 0.05, 0.05),
    };
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_is_twenty_large_objects() {
        let scene = materials();
        assert_eq!(scene.objects.len(), 20);
        assert_eq!(scene.instances.len(), 20);
        assert_eq!(scene.materials.len(), 20);
        assert!(scene.meshes.iter().all(|m| m.triangle_count() == 7872));
        let mut used: Vec<_> = scene.instances.iter().map(|i| i.material).collect();
        used.dedup();
        assert_eq!(used.len(), 20);
    }

    #[test]
    fn materials2_is_two_thousand_small_objects() {
        let scene = materials2();
        assert_eq!(scene.objects.len(), 2000);
        assert_eq!(scene.instances.len(), 2000);
        assert!(scene.meshes.iter().all(|m| m.triangle_count() == 1024));
    }
}
