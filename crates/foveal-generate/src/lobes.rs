//! Spheres with lobes beside metallic-roughness.

use glam::{Mat4, Vec3, Vec4};

use super::build::{MeshBuilder, SceneBuilder};
use super::materials_grid::lit_from_the_front;
use foveal_scene::{Anisotropy, Clearcoat, Iridescence, Material, Scene, Sheen, Transmission};

/// Six rows of five spheres, from the bottom: red paint under a clear coat of roughness 0 to 1;
/// blue cloth with sheen of roughness 0.2 to 1; brushed metal of anisotropy 0 to 1; dielectrics of
/// index 1 to 2.4; glass of roughness 0 to 1 before a bar; films of 150 to 750 nanometres on metal and,
/// every other one, on a dark dielectric. Camera: `front`.
#[must_use]
pub fn lobes() -> Scene {
    let mut scene = SceneBuilder::new("lobes");
    let mut sphere = MeshBuilder::new();
    sphere.ellipsoid(Vec3::ZERO, Vec3::splat(0.42), 64, 32);
    let sphere = scene.mesh(sphere.finish("sphere"));
    for row in 0..6u8 {
        for column in 0..5u8 {
            let part = f32::from(column) / 4.0;
            let material = scene.material(match row {
                0 => coated(part),
                1 => cloth(part),
                2 => brushed(part),
                3 => dielectric(part),
                4 => glass(part),
                _ => filmed(part, column % 2 == 0),
            });
            let place = Vec3::new(f32::from(column) - 2.0, f32::from(row) - 2.5, 0.0);
            let name = format!("sphere {row} {column}");
            let transform = Mat4::from_translation(place);
            scene.object(name, None, None, &[(sphere, material)], transform);
        }
    }
    let mut bar = MeshBuilder::new();
    bar.block(Vec3::new(-2.6, 1.75, -1.3), Vec3::new(2.6, 2.0, -1.2));
    let bar = scene.mesh(bar.finish("bar"));
    let orange = scene.material(Material {
        name: "bar".to_owned(),
        base_color: Vec4::new(0.9, 0.35, 0.05, 1.0),
        metallic: 0.0,
        roughness: 0.7,
        ..Material::default()
    });
    let at = Mat4::IDENTITY;
    scene.object("bar".to_owned(), None, None, &[(bar, orange)], at);
    lit_from_the_front(scene, 8.8)
}

fn coated(part: f32) -> Material {
    Material {
        name: format!("coat of roughness {part}"),
        base_color: Vec4::new(0.6, 0.04, 0.03, 1.0),
        metallic: 0.3,
        roughness: 0.5,
        clearcoat: Some(Clearcoat {
            factor: 1.0,
            texture: None,
            roughness: part,
            roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
        }),
        ..Material::default()
    }
}

fn cloth(part: f32) -> Material {
    Material {
        name: format!("sheen of roughness {}", 0.2 + 0.8 * part),
        base_color: Vec4::new(0.03, 0.05, 0.25, 1.0),
        metallic: 0.0,
        roughness: 0.9,
        sheen: Some(Sheen {
            color: Vec3::new(0.9, 0.8, 0.7),
            color_texture: None,
            roughness: 0.2 + 0.8 * part,
            roughness_texture: None,
        }),
        ..Material::default()
    }
}

fn brushed(part: f32) -> Material {
    Material {
        name: format!("anisotropy {part}"),
        base_color: Vec4::new(0.9, 0.75, 0.55, 1.0),
        metallic: 1.0,
        roughness: 0.35,
        anisotropy: (part > 0.0).then_some(Anisotropy {
            strength: part,
            rotation_rad: 0.0,
            texture: None,
        }),
        ..Material::default()
    }
}

fn dielectric(part: f32) -> Material {
    Material {
        name: format!("index of refraction {}", 1.0 + 1.4 * part),
        base_color: Vec4::new(0.1, 0.1, 0.1, 1.0),
        metallic: 0.0,
        roughness: 0.3,
        ior: 1.0 + 1.4 * part,
        ..Material::default()
    }
}

fn glass(part: f32) -> Material {
    Material {
        name: format!("glass of roughness {part}"),
        base_color: Vec4::ONE,
        metallic: 0.0,
        roughness: part,
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
            thickness_m: 0.6,
            thickness_texture: None,
            attenuation_distance_m: 0.8,
            attenuation_color: Vec3::new(0.5, 0.85, 0.7),
        }),
        ..Material::default()
    }
}

fn filmed(part: f32, metal: bool) -> Material {
    let thickness_nm = 150.0 + 600.0 * part;
    let base = if metal { 0.5 } else { 0.01 };
    Material {
        name: format!("film of {thickness_nm} nanometres"),
        base_color: Vec3::splat(base).extend(1.0),
        metallic: if metal { 1.0 } else { 0.0 },
        roughness: 0.3,
        iridescence: Some(Iridescence {
            factor: 1.0,
            texture: None,
            ior: 1.8,
            thickness_min_nm: 100.0,
            thickness_max_nm: thickness_nm,
            thickness_texture: None,
        }),
        ..Material::default()
    }
}
