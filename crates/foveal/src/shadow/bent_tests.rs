//! Surfaces whose normal map bends their normal.

use foveal_scene::{
    Camera, Clearcoat, ColorSpace, Encoding, Light, LightKind, Material, Sampler, Scene, Texture,
    TextureRef,
};
use glam::{Mat3, Vec3, Vec4};

use super::tests::{seen, shadowed};
use crate::forward::twin::quads;
use crate::testing::{f32_of_half, rendered, texels};
use crate::{Antialiasing, EnvironmentSource, Geometry, Settings, Shading, Shadows};

/// A wall that faces +z, whose normal map leans it by an angle towards +x, where a sun stands 30
/// degrees above the wall.
fn wall(lean_rad: f32, material: Material) -> Scene {
    let to_byte = |v: f32| (v * 127.5 + 127.5).round() as u8;
    let [x, z] = [lean_rad.sin(), lean_rad.cos()].map(to_byte);
    let material = Material {
        base_color: Vec4::new(0.8, 0.8, 0.8, 1.0),
        metallic: 0.0,
        roughness: 0.9,
        normal_texture: Some(TextureRef {
            texture: 0,
            uv_set: 0,
            uv_transform: Mat3::IDENTITY,
        }),
        normal_scale: 1.0,
        ..material
    };
    let mut scene = quads(vec![material], &[0.0]);
    scene.textures.push(Texture {
        name: "lean".to_owned(),
        width: 1,
        height: 1,
        color_space: ColorSpace::Linear,
        sampler: Sampler::default(),
        encoding: Encoding::Rgba8,
        levels: vec![vec![x, 128, z, 255]],
    });
    let towards = Vec3::new(30f32.to_radians().cos(), 0.0, 30f32.to_radians().sin());
    scene.lights.push(Light {
        kind: LightKind::Directional,
        color: Vec3::ONE,
        intensity: 3.0,
        position: Vec3::ZERO,
        direction: -towards,
        range_m: None,
        node: None,
    });
    scene
}

fn camera() -> Camera {
    Camera::look_at(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y, 0.4)
}

/// The mean radiance of a picture that the wall fills.
fn brightness(scene: &Scene, settings: &Settings) -> f32 {
    let renderer = rendered(scene, &camera(), settings);
    let radiance: Vec<[u16; 4]> = texels(&renderer.targets().radiance_view);
    let sum: f32 = radiance.iter().map(|texel| f32_of_half(texel[0])).sum();
    sum / radiance.len() as f32
}

fn ways() -> impl Iterator<Item = (Geometry, Shading, Antialiasing)> {
    let paths = [Geometry::Gbuffer, Geometry::Visibility];
    paths.into_iter().flat_map(|path| {
        [
            (path, Shading::Full, Antialiasing::None),
            (path, Shading::Coarse, Antialiasing::None),
            (path, Shading::Variable, Antialiasing::None),
            (path, Shading::Full, Antialiasing::Msaa),
            (path, Shading::Full, Antialiasing::Ssaa),
        ]
    })
}

#[test]
fn a_normal_map_that_leans_to_the_sun_does_not_shade_its_wall() {
    let own_dielectric = Material {
        ior: 1.8,
        ..Material::default()
    };
    let drawn_forward = Material {
        clearcoat: Some(Clearcoat {
            factor: 1.0,
            texture: None,
            roughness: 0.5,
            roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
        }),
        ..Material::default()
    };
    for material in [Material::default(), own_dielectric, drawn_forward] {
        for lean in [0.0f32, 20.0, 45.0, 60.0] {
            let scene = wall(lean.to_radians(), material.clone());
            for (path, mode, antialiasing) in ways() {
                let settings = |shadows| {
                    shadowed(shadows).with(|s| {
                        s.geometry.path = path;
                        s.shading.mode = mode;
                        s.antialiasing.mode = antialiasing;
                        s.lighting.environment = EnvironmentSource::None;
                    })
                };
                let all = brightness(&scene, &settings(Shadows::Off));
                for shadows in [Shadows::Hard, Shadows::Soft, Shadows::Contact] {
                    let part = brightness(&scene, &settings(shadows)) / all;
                    assert!(
                        part > 0.995,
                        "{lean} degrees, {path:?}, {mode:?}, {antialiasing:?}, {shadows:?}: {part}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_vertex_normal_is_kept_beside_the_bent_one() {
    let glowing = Material {
        emissive: Vec3::ONE,
        ..Material::default()
    };
    let own_dielectric = Material {
        ior: 1.8,
        ..Material::default()
    };
    for material in [Material::default(), glowing, own_dielectric] {
        for path in [Geometry::Gbuffer, Geometry::Visibility] {
            let settings = shadowed(Shadows::Off).with(|s| s.geometry.path = path);
            let scene = wall(0.6, material.clone());
            let renderer = rendered(&scene, &camera(), &settings);
            let pixels = seen(&renderer, &camera());
            assert!(pixels.len() > 1000);
            for pixel in pixels {
                let s = pixel.surface;
                let lean = Vec3::new(0.6f32.sin(), 0.0, 0.6f32.cos());
                assert!(s.normal.dot(lean) > 0.999, "{}", s.normal);
                assert!(s.vertex_normal.dot(Vec3::Z) > 0.998, "{}", s.vertex_normal);
                assert_eq!(s.emissive, material.emissive);
            }
        }
    }
}
