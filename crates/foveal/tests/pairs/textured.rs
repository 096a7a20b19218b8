//! A scene of textures by chance: at every place of a material, lobes' included, filtered, wrapped,
//! turned and scaled in many ways.

use std::collections::BTreeSet;

use foveal_generate as generate;
use foveal_scene::{
    AlphaMode, Anisotropy, Clearcoat, ColorSpace, Encoding, Filter, Iridescence, Material, Sampler,
    Scene, Sheen, Texture, TextureRef, Transmission, Wrap,
};
use glam::{Mat3, Vec2, Vec3, Vec4};
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};

/// Textures of each colour space.
const TEXTURES: u32 = 5;
/// Texels a side.
const SIDE: u32 = 16;

struct Dice(TestRng);

impl Dice {
    fn number(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / (1 << 24) as f32
    }

    fn is(&mut self, part: f32) -> bool {
        self.number() < part
    }

    fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.0.next_u32() as usize % of.len()]
    }

    fn color(&mut self) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| self.number()))
    }

    fn texture(&mut self, name: String, color_space: ColorSpace) -> Texture {
        let (wraps, filters) = (
            [Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge],
            [Filter::Nearest, Filter::Linear],
        );
        let mip = self.one(&[None, Some(Filter::Nearest), Some(Filter::Linear)]);
        // Lumps of four texels, and normals that lean by up to 45 degrees.
        let lump = |at: u32| (at % SIDE) / 4 + at / SIDE / 4 * (SIDE / 4);
        let lumps: Vec<[u8; 4]> = (0..SIDE * SIDE / 16)
            .map(|_| [(); 4].map(|()| 64 + (self.0.next_u32() % 128) as u8))
            .collect();
        let mut levels = vec![
            (0..SIDE * SIDE)
                .flat_map(|at| lumps[lump(at) as usize])
                .collect::<Vec<u8>>(),
        ];
        let mut side = SIDE as usize;
        while mip.is_some() && side > 1 {
            let finer = levels.last().expect("level 0");
            side /= 2;
            let mean = |at: usize| {
                let (x, y, channel) = (at / 4 % side, at / 4 / side, at % 4);
                let texel =
                    |dx, dy| u32::from(finer[((2 * y + dy) * 2 * side + 2 * x + dx) * 4 + channel]);
                ((texel(0, 0) + texel(1, 0) + texel(0, 1) + texel(1, 1)) / 4) as u8
            };
            levels.push((0..side * side * 4).map(mean).collect());
        }
        Texture {
            name,
            width: SIDE,
            height: SIDE,
            color_space,
            sampler: Sampler {
                wrap_u: self.one(&wraps),
                wrap_v: self.one(&wraps),
                mag: self.one(&filters),
                min: self.one(&filters),
                mip,
            },
            encoding: Encoding::Rgba8,
            levels,
        }
    }

    fn slot(&mut self, color_space: ColorSpace) -> Option<TextureRef> {
        let first = match color_space {
            ColorSpace::Srgb => 0,
            ColorSpace::Linear => TEXTURES,
        };
        let transform = Mat3::from_scale_angle_translation(
            Vec2::new(self.one(&[-1.0, 0.5, 1.0, 2.0]), self.one(&[0.5, 1.0, 3.0])),
            6.3 * self.number(),
            Vec2::new(self.number(), self.number()),
        );
        let slot = TextureRef {
            texture: first + self.0.next_u32() % TEXTURES,
            uv_set: self.one(&[0, 0, 1]),
            uv_transform: if self.is(0.5) {
                transform
            } else {
                Mat3::IDENTITY
            },
        };
        self.is(0.6).then_some(slot)
    }

    fn lobes(&mut self, material: &mut Material) {
        let (srgb, linear) = (ColorSpace::Srgb, ColorSpace::Linear);
        if self.is(0.3) {
            material.clearcoat = Some(Clearcoat {
                factor: 1.0,
                texture: self.slot(linear),
                roughness: 0.4,
                roughness_texture: self.slot(linear),
                normal_texture: self.slot(linear),
                normal_scale: 0.5,
            });
        }
        if self.is(0.3) {
            material.sheen = Some(Sheen {
                color: self.color(),
                color_texture: self.slot(srgb),
                roughness: 0.6,
                roughness_texture: self.slot(linear),
            });
        }
        if self.is(0.3) {
            material.anisotropy = Some(Anisotropy {
                strength: 0.7,
                rotation_rad: 6.3 * self.number(),
                texture: self.slot(linear),
            });
        }
        if self.is(0.2) {
            material.iridescence = Some(Iridescence {
                factor: 0.8,
                texture: self.slot(linear),
                ior: 1.4,
                thickness_min_nm: 200.0,
                thickness_max_nm: 500.0,
                thickness_texture: self.slot(linear),
            });
        }
        if self.is(0.2) {
            material.transmission = Some(Transmission {
                factor: 0.8,
                texture: self.slot(linear),
                thickness_m: self.one(&[0.0, 0.3]),
                thickness_texture: self.slot(linear),
                attenuation_distance_m: 0.5,
                attenuation_color: self.color(),
            });
        }
    }

    fn material(&mut self, name: String) -> Material {
        let (srgb, linear) = (ColorSpace::Srgb, ColorSpace::Linear);
        let mut material = Material {
            name,
            base_color: self.color().extend(0.8),
            base_color_texture: self.slot(srgb),
            metallic: self.number(),
            roughness: 0.3 + 0.7 * self.number(),
            metallic_roughness_texture: self.slot(linear),
            ior: self.one(&[1.5, 1.0, 1.8]),
            specular_color: self.one(&[Vec3::ONE, Vec3::new(1.0, 0.6, 0.4)]),
            specular_texture: self.slot(linear).filter(|_| self.is(0.3)),
            specular_color_texture: self.slot(srgb).filter(|_| self.is(0.3)),
            normal_texture: self.slot(linear),
            normal_scale: 0.5,
            occlusion_texture: self.slot(linear),
            occlusion_strength: self.number(),
            emissive: 0.3 * self.color(),
            emissive_texture: self.slot(srgb),
            alpha_mode: self.one(&[
                AlphaMode::Opaque,
                AlphaMode::Opaque,
                AlphaMode::Mask { cutoff: 0.35 },
                AlphaMode::Blend,
            ]),
            double_sided: self.is(0.5),
            unlit: self.is(0.05),
            ..Material::default()
        };
        if self.is(0.6) {
            self.lobes(&mut material);
            while !fits_reduced(&material) {
                let slot = self.one(&[0, 1, 2, 3, 4]);
                *[
                    &mut material.base_color_texture,
                    &mut material.metallic_roughness_texture,
                    &mut material.normal_texture,
                    &mut material.occlusion_texture,
                    &mut material.emissive_texture,
                ][slot] = None;
            }
        }
        material
    }
}

/// Whether the reduced renderer has a place for each texture.
fn fits_reduced(material: &Material) -> bool {
    let own = [
        material.base_color_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
        material.occlusion_texture,
        material.emissive_texture,
        material.specular_texture,
        material.specular_color_texture,
    ];
    let of_lobes = material.lobe_textures().into_iter().flatten();
    let of_lobes: BTreeSet<u32> = of_lobes.map(|slot| slot.texture).collect();
    let read = of_lobes.len().min(Material::MAX_LOBE_TEXTURES);
    own.iter().flatten().count() + read <= own.len()
}

/// The spheres of `lobes` with materials by chance.
pub(crate) fn textured() -> Scene {
    let mut dice = Dice(TestRng::from_seed(RngAlgorithm::ChaCha, &[5; 32]));
    let mut scene = generate::lobes();
    for color_space in [ColorSpace::Srgb, ColorSpace::Linear] {
        for number in 0..TEXTURES {
            let name = format!("{color_space:?} {number}");
            scene.textures.push(dice.texture(name, color_space));
        }
    }
    for (number, material) in scene.materials.iter_mut().enumerate() {
        *material = dice.material(format!("by chance {number}"));
    }
    for vertex in scene.meshes.iter_mut().flat_map(|mesh| &mut mesh.vertices) {
        let [u, v] = vertex.uv[0];
        vertex.uv[1] = [1.0 - v, 0.5 * u];
        let tint = Vec4::splat(0.7) + 0.3 * Vec4::new(u.fract(), v.fract(), 0.5, 1.0);
        vertex.color = tint.to_array().map(|part| (part * 65535.0) as u16);
    }
    scene
}
