//! What shaders are told of a material, and what class it is of.

use bytemuck::{Pod, Zeroable};
use foveal_scene::{AlphaMode, Encoding, Material, Texture, TextureRef};
use glam::{Mat3, Vec2};

/// Mirrors `Material` in `shared/material.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct MaterialUniform {
    pub(crate) base_color: [f32; 4],
    pub(crate) emissive: [f32; 3],
    pub(crate) metallic: f32,
    pub(crate) roughness: f32,
    pub(crate) normal_scale: f32,
    pub(crate) occlusion_strength: f32,
    pub(crate) alpha_cutoff: f32,
    pub(crate) uv: [[[f32; 4]; 2]; SLOTS],
    pub(crate) layers: [u32; 2],
    pub(crate) number: u32,
    pub(crate) procedural_seed: u32,
    pub(crate) tangent_turn: [f32; 3],
    pub(crate) procedural_frequency: f32,
    pub(crate) specular_color: [f32; 3],
    pub(crate) specular: f32,
    pub(crate) without_lobes: f32,
    pub(crate) padding: [u32; 3],
}

/// Places for textures in a material.
pub(crate) const SLOTS: usize = 7;

/// A material's texture slots in the order of the shader's bindings.
pub(super) fn slots(material: &Material) -> [Option<TextureRef>; SLOTS] {
    [
        material.base_color_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
        material.occlusion_texture,
        material.emissive_texture,
        material.specular_texture,
        material.specular_color_texture,
    ]
}

/// Each slot's flag.
const HAS_TEXTURE: [u32; SLOTS] = [1, 2, 4, 8, 16, 512, 1024];

const IS_UNLIT: u32 = 32;
const IS_PROCEDURAL: u32 = 64;
const HAS_UV_MAP: u32 = 128;
const HAS_OWN_UV_MAPS: u32 = 256;
const IS_SPECULAR: u32 = 2048;
const NORMAL_OF_TWO: u32 = 65536;

/// Whether a normal map has x and y alone.
pub(super) fn is_of_two(slot: Option<TextureRef>, textures: &[Texture]) -> bool {
    let texture = slot.and_then(|slot| textures.get(slot.texture as usize));
    texture.is_some_and(|texture| texture.encoding == Encoding::Bc5)
}

/// Bits by which the shader is specialized: one per texture slot in use, and one each for an unlit
/// material, a procedural one, texture coordinates other than the first set as it is, coordinates
/// that differ between textures, a dielectric reflectance of its own, and a normal map of x and y
/// alone. `textures`: the scene's, with or without texels.
pub(crate) fn material_class(material: &Material, textures: &[Texture]) -> u32 {
    let slots = slots(material);
    let in_use = slots
        .iter()
        .zip(HAS_TEXTURE)
        .map(|(slot, flag)| if slot.is_some() { flag } else { 0 });
    // In some pose they may be anywhere.
    let moves = material.animated.uv_transforms;
    let flags = [
        (material.unlit, IS_UNLIT),
        (material.procedural.is_some(), IS_PROCEDURAL),
        (moves || slots.iter().flatten().any(has_uv_map), HAS_UV_MAP),
        (moves || shared_uv_map(&slots).is_none(), HAS_OWN_UV_MAPS),
        (material.has_own_specular(), IS_SPECULAR),
        (is_of_two(material.normal_texture, textures), NORMAL_OF_TWO),
    ];
    let flags = flags.iter().map(|&(is, bit)| if is { bit } else { 0 });
    in_use.sum::<u32>() | flags.sum::<u32>()
}

fn has_uv_map(slot: &TextureRef) -> bool {
    slot.uv_set != 0 || slot.uv_transform != Mat3::IDENTITY
}

/// What all slots in use share, if they do.
fn shared_uv_map(slots: &[Option<TextureRef>; SLOTS]) -> Option<[[f32; 4]; 2]> {
    let mut maps = slots.iter().flatten().map(|&slot| uv_rows(slot));
    let first = maps.next().unwrap_or([[0.0; 4]; 2]);
    maps.all(|map| map == first).then_some(first)
}

impl MaterialUniform {
    /// `layers`: where the slots' textures lie in their arrays, each below 256.
    pub(crate) fn new(material: &Material, number: u32, layers: [u32; SLOTS]) -> Self {
        let [a, b, c, d, e, f, g] = layers.map(|layer| layer as u8);
        let slots = slots(material);
        let own = slots.map(|slot| slot.map_or([[0.0; 4]; 2], uv_rows));
        Self {
            base_color: material.base_color.to_array(),
            emissive: material.emissive.to_array(),
            metallic: material.metallic,
            roughness: material.roughness,
            normal_scale: material.normal_scale,
            occlusion_strength: material.occlusion_strength,
            alpha_cutoff: match material.alpha_mode {
                AlphaMode::Mask { cutoff } => cutoff,
                AlphaMode::Opaque | AlphaMode::Blend => 0.0,
            },
            uv: shared_uv_map(&slots).map_or(own, |map| [map; SLOTS]),
            layers: [
                u32::from_le_bytes([a, b, c, d]),
                u32::from_le_bytes([e, f, g, 0]),
            ],
            number,
            procedural_seed: material.procedural.map_or(0, |p| p.seed),
            tangent_turn: Vec2::from_angle(material.tangent_turn_rad)
                .extend(if material.tangents_mirrored {
                    -1.0
                } else {
                    1.0
                })
                .to_array(),
            procedural_frequency: material.procedural.map_or(0.0, |p| p.frequency),
            specular_color: (material.specular_color * material.ior_reflectance()).to_array(),
            specular: material.specular,
            without_lobes: f32::from(u8::from(!material.has_lobes() || material.unlit)),
            padding: [0; 3],
        }
    }
}

impl MaterialUniform {
    /// The same place on the device with the numbers that the material has in another pose.
    pub(super) fn with_numbers_of(&self, material: &Material) -> Self {
        Self {
            layers: self.layers,
            without_lobes: self.without_lobes,
            ..Self::new(material, self.number, [0; SLOTS])
        }
    }

    /// Whether only emission, or the base colour of what is no metal, is another than before: light
    /// that is kept holds for both. A metal's base colour is in the light that it mirrors.
    pub(super) fn differs_in_color_alone(&self, before: &Self) -> bool {
        let is_metal = self.metallic > 0.0;
        let same = Self {
            base_color: if is_metal {
                self.base_color
            } else {
                before.base_color
            },
            emissive: before.emissive,
            ..*self
        };
        bytemuck::bytes_of(&same) == bytemuck::bytes_of(before)
    }

    /// Whether holes that alpha cuts may lie elsewhere than before.
    pub(super) fn has_other_holes(&self, before: &Self) -> bool {
        let of = |m: &Self| (m.base_color[3], m.alpha_cutoff, m.uv[0]);
        of(self) != of(before)
    }
}

pub(super) fn uv_rows(slot: TextureRef) -> [[f32; 4]; 2] {
    let m = slot.uv_transform;
    [
        [m.x_axis.x, m.y_axis.x, m.z_axis.x, slot.uv_set as f32],
        [m.x_axis.y, m.y_axis.y, m.z_axis.y, 0.0],
    ]
}
