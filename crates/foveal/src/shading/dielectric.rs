//! The CPU twin of how surfaces keep and reflect what KHR_materials_ior and KHR_materials_specular
//! say: `shared/surface.wgsl` and `shared/environment.wgsl`.

use std::f32::consts::PI;

use foveal_generate as generate;
use foveal_scene::{ColorSpace, Scene};
use glam::{Vec2, Vec3, Vec4};

use super::twin::{
    Surface, assert_equals_twin, ggx_lobe, reflect, squared_alpha, unit_from_octahedral,
    unit_from_square, unpack_shared_exponent, unpack_surface,
};
use crate::forward::twin::{front, quads};
use crate::testing::{one_texel, picture, rendered, slot, small, texels};
use crate::{Antialiasing, Geometry, LightingModel, Settings};

/// `PLAIN_DIELECTRIC` in `shared/surface.wgsl`.
pub(crate) const PLAIN_DIELECTRIC: Vec4 = Vec4::new(0.04, 0.04, 0.04, 1.0);

impl Surface {
    pub(crate) fn reflectance_at_normal(&self) -> Vec3 {
        let dielectric = self.dielectric.truncate();
        dielectric.lerp(self.base_color, self.metallic)
    }

    pub(crate) fn reflectance_at_grazing(&self) -> f32 {
        1.0 - (1.0 - self.metallic) * (1.0 - self.dielectric.w)
    }

    /// At right angles and at grazing ones.
    pub(crate) fn kept_from_scattering(&self) -> [f32; 2] {
        let d = self.dielectric;
        [d.truncate().max_element(), d.w]
    }

    /// What is left to be scattered at a fifth power of one minus the cosine.
    pub(crate) fn left_for_scattering(&self, m5: f32) -> f32 {
        let [at_normal, at_grazing] = self.kept_from_scattering();
        1.0 - (at_normal + (at_grazing - at_normal) * m5)
    }
}

fn has_own(words: [u32; 4]) -> bool {
    words[3] & 1 << 29 != 0
}

/// `dielectric_from_bits(dielectric_of(words))` in `shared/surface.wgsl`.
pub(super) fn dielectric_of(words: [u32; 4]) -> Vec4 {
    if !has_own(words) {
        return PLAIN_DIELECTRIC;
    }
    let [_, normal, _, last] = words;
    let largest = (last >> 16 & 255) as f32 / 255.0;
    let next = |bits: u32| largest * (bits & 15) as f32 / 15.0;
    let second = last >> 26 & 3 | last >> 30 << 2;
    let mut root = [largest, next(second), next(normal)];
    // Which channel is the largest.
    root.rotate_right((last >> 24 & 3) as usize);
    let grazing = (normal >> 16 & 15) as f32 / 14.0;
    Vec3::from(root).powf(2.0).extend(grazing.min(1.0))
}

/// The normal from its octahedral map: 16 bits each way, or 12 beside a dielectric.
pub(super) fn normal_of(words: [u32; 4]) -> Vec3 {
    if !has_own(words) {
        return unit_from_octahedral(words[1]);
    }
    let coarse = |bits: u32| f32::from(bits as u16 as i16 >> 4) / 2047.0;
    unit_from_square(Vec2::new(coarse(words[1]), coarse(words[1] >> 16)))
}

/// What a surface emits: nothing where its vertex normal lies there.
pub(super) fn glow_of(words: [u32; 4]) -> Vec3 {
    match has_own(words) && is_no_glow(words[2]) {
        true => Vec3::ZERO,
        false => unpack_shared_exponent(words[2]),
    }
}

/// `is_no_glow` in `shared/surface.wgsl`.
fn is_no_glow(word: u32) -> bool {
    word & 0xfc02_0100 == 0xf800_0000
}

/// The vertex normal where it is not the normal: 6 bits each way.
pub(super) fn vertex_normal_of(words: [u32; 4]) -> Option<Vec3> {
    let [_, _, glow, last] = words;
    let bits = match has_own(words) {
        true => is_no_glow(glow).then_some([glow, glow >> 9]),
        false => (last & 1 << 30 != 0).then_some([last >> 16, last >> 22]),
    }?;
    let part = bits.map(|b| (b & 63) as f32 / 31.0 - 1.0);
    Some(unit_from_square(part.into()))
}

/// The grid of spheres, each with another dielectric.
fn grid() -> Scene {
    let mut scene = generate::materials_grid();
    for (i, material) in (0..).zip(&mut scene.materials) {
        material.ior = [1.0, 1.33, 1.45, 1.8, 2.4, 0.0][i % 6];
        material.specular = [1.0, 0.5, 0.0, 0.25][i % 4];
        material.specular_color = [
            Vec3::ONE,
            Vec3::new(1.0, 0.6, 0.3),
            Vec3::new(0.2, 2.5, 9.0),
            Vec3::new(0.5, 0.1, 0.8),
        ][i / 2 % 4];
    }
    scene
}

/// What a material without textures says of its dielectric.
fn expected(material: &foveal_scene::Material) -> Vec4 {
    let color = (material.specular_color * material.ior_reflectance()).min(Vec3::ONE);
    color.extend(1.0) * material.specular
}

fn ways() -> impl Iterator<Item = Settings> {
    let paths = [Geometry::Gbuffer, Geometry::Visibility];
    let modes = [Antialiasing::None, Antialiasing::Msaa, Antialiasing::Ssaa];
    paths.into_iter().flat_map(move |path| {
        modes.into_iter().map(move |mode| {
            small(151, 101).with(|s| {
                s.geometry.path = path;
                s.antialiasing.mode = mode;
            })
        })
    })
}

#[test]
fn every_way_of_geometry_keeps_a_dielectric() {
    let scene = grid();
    for settings in ways() {
        let renderer = rendered(&scene, &scene.cameras[0], &settings);
        let gbuffer = &renderer.targets().gbuffer;
        let words: Vec<[u32; 4]> = texels(&gbuffer.surface_view);
        let identity: Vec<[u32; 2]> = texels(&gbuffer.identity_view);
        let mut seen = std::collections::BTreeSet::new();
        for (words, [instance, _]) in words.into_iter().zip(identity) {
            if instance == 0 {
                continue;
            }
            let instance = &scene.instances[instance as usize - 1];
            let material = &scene.materials[instance.material as usize];
            if material.metallic == 1.0 {
                continue;
            }
            let found = unpack_surface(words, Vec3::ZERO).dielectric;
            let expected = expected(material);
            // Square roots: a 255th of the largest channel, a 15th of it for the others.
            let root = expected.truncate().powf(0.5);
            let off = (found.truncate().powf(0.5) - root).abs().max_element();
            let most = 0.003 + root.max_element() / 29.0;
            let white = root.min_element() == root.max_element();
            let grazing = (found.w - expected.w).abs();
            let close = off <= if white { 0.003 } else { most };
            assert!(close && grazing < 0.04, "{found} not {expected}");
            seen.insert(instance.material);
        }
        assert!(seen.len() >= 20, "{} materials", seen.len());
    }
}

#[test]
fn shading_equals_its_twin_for_dielectrics_of_all_kinds() {
    let scene = grid();
    for model in [LightingModel::Ggx, LightingModel::BlinnPhong] {
        let settings = small(97, 65).with(|s| s.lighting.model = model);
        assert_equals_twin(&scene, &scene.cameras[0], &settings);
    }
}

#[test]
fn between_metal_and_dielectric_surfaces_reflect_the_mix_of_both() {
    let reflected = |s: &Surface, v: Vec3, l: Vec3| {
        let n_dot_l = s.normal.dot(l);
        let [left, specular] = reflect(LightingModel::Ggx, s, v, l, n_dot_l);
        left * (1.0 - s.metallic) * s.base_color / PI + specular
    };
    let toward = |x: f32, z: f32| Vec3::new(x, 0.3, z).normalize();
    let mut dimmer = 0.0f32;
    for dielectric in [PLAIN_DIELECTRIC, Vec4::new(0.3, 0.1, 0.05, 0.6)] {
        for metallic in [0.0, 0.25, 0.5, 0.8, 1.0] {
            let s = Surface {
                position: Vec3::ZERO,
                normal: Vec3::Z,
                vertex_normal: Vec3::Z,
                base_color: Vec3::new(0.9, 0.5, 0.2),
                metallic,
                roughness: 0.5,
                occlusion: 1.0,
                emissive: Vec3::ZERO,
                dielectric,
            };
            for (v, l) in [
                (toward(0.1, 1.0), toward(-0.4, 1.0)),
                (toward(-1.0, 0.2), toward(1.0, 0.3)),
            ] {
                let m5 = (1.0 - v.dot((v + l).normalize())).powi(5);
                let lobe = ggx_lobe(s.normal, v, l, s.normal.dot(l), squared_alpha(&s));
                let fresnel = |f0: Vec3, f90: f32| f0 + (f90 - f0) * m5;
                // glTF 2.0, appendix B: each by itself, then mixed.
                let f = fresnel(dielectric.truncate(), dielectric.w);
                let scattered = (1.0 - f.max_element()) * s.base_color / PI;
                let metal = fresnel(s.base_color, 1.0) * lobe;
                let mixed = (scattered + f * lobe).lerp(metal, metallic);
                let found = reflected(&s, v, l);
                assert!(found.abs_diff_eq(mixed, 1e-5), "{found} not {mixed}");
                // Where the Fresnel term of the mixed reflectance dims what is scattered.
                let f = fresnel(s.reflectance_at_normal(), s.reflectance_at_grazing());
                let d = dielectric.truncate();
                let kept = (1.0 - metallic) * (d.max_element() - d) * (1.0 - m5);
                let left = (1.0 - f - kept) * (1.0 - metallic);
                let before = left * s.base_color / PI + f * lobe;
                let pure = metallic == 0.0 || metallic == 1.0;
                assert!(
                    !pure || found.abs_diff_eq(before, 1e-5),
                    "{found} not {before}"
                );
                dimmer = dimmer.max((found - before).max_element());
            }
        }
    }
    assert!(dimmer > 0.02, "{dimmer}");
}

#[test]
fn a_plain_dielectric_is_no_own_one() {
    let scene = generate::materials_grid();
    for settings in ways() {
        let renderer = rendered(&scene, &scene.cameras[0], &settings);
        let words: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_view);
        assert!(!words.into_iter().any(has_own));
    }
}

#[test]
fn without_reflection_what_is_not_metal_shows_no_light_of_its_surface() {
    let mut scene = generate::materials_grid();
    for material in &mut scene.materials {
        material.metallic = 0.0;
        material.base_color = Vec4::new(0.0, 0.0, 0.0, 1.0);
        material.specular = 0.0;
    }
    let black = rendered(&scene, &scene.cameras[0], &small(151, 101));
    let depth: Vec<f32> = texels(&black.targets().gbuffer.depth_view);
    for (texel, depth) in picture(&black).chunks_exact(4).zip(depth) {
        assert!(depth == 0.0 || texel[..3] == [0; 3], "{texel:?}");
    }
}

#[test]
fn textures_of_strength_and_colour_are_read() {
    let material = foveal_scene::Material {
        metallic: 0.0,
        specular: 0.5,
        specular_color: Vec3::new(10.0, 4.0, 20.0),
        specular_texture: slot(0),
        specular_color_texture: slot(1),
        ..foveal_scene::Material::default()
    };
    let mut scene = quads(vec![material], &[0.0]);
    // Red, green and blue of the strength are not looked at.
    scene.textures = vec![
        one_texel(ColorSpace::Linear, [9, 80, 200, 204]),
        one_texel(ColorSpace::Srgb, [255, 188, 137, 255]),
    ];
    for settings in ways() {
        let renderer = rendered(&scene, &front(), &settings);
        let words: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_view);
        let found = unpack_surface(words[50 * 151 + 75], Vec3::ZERO).dielectric;
        let linear = Vec3::new(1.0, 0.5029, 0.2502);
        let color = linear * 0.04 * Vec3::new(10.0, 4.0, 20.0);
        let expected = color.extend(1.0) * 0.4;
        let root = (found.truncate().powf(0.5) - expected.truncate().powf(0.5)).abs();
        let grazing = (found.w - expected.w).abs();
        let close = root.max_element() < 0.4 / 29.0 && grazing < 0.04;
        assert!(close, "{found} not {expected}");
    }
}
