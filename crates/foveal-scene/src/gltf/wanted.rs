//! Which textures the materials need.
//!
//! One picture gives several [`Texture`](crate::Texture)s when it is used with several samplers or
//! meanings (colour, cut-out, data, normals); equal uses share one.

use std::collections::HashMap;

use super::document::Document;
use super::materials::MaterialDef;
use super::slots::SlotDef;
use crate::mip::Content;
use crate::{AlphaMode, ColorSpace, Material, Sampler, TextureRef};

/// Why a material reads a texture; what its mip levels depend on.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum Role {
    Color,
    /// The threshold's bits; `None` for blending.
    Cutout(Option<u32>),
    Data,
    Normal,
    /// Glossiness in alpha, times a factor of these bits: read as roughness, in green.
    Glossiness(u32),
}

impl Role {
    /// A picture's RGBA texels as the textures of this role have them.
    pub(super) fn texels(self, mut pixels: Vec<u8>) -> Vec<u8> {
        if let Self::Glossiness(bits) = self {
            for texel in pixels.as_chunks_mut::<4>().0 {
                let rough = 255.0 - f32::from_bits(bits) * f32::from(texel[3]);
                *texel = [255, rough.round() as u8, 255, 255];
            }
        }
        pixels
    }

    pub(super) fn content(self) -> Content {
        match self {
            Self::Color => Content::Color,
            Self::Cutout(bits) => Content::Cutout {
                threshold: bits.map(f32::from_bits),
            },
            Self::Data | Self::Glossiness(_) => Content::Data,
            Self::Normal => Content::Normal,
        }
    }

    pub(super) fn color_space(self) -> ColorSpace {
        match self {
            Self::Data | Self::Normal | Self::Glossiness(_) => ColorSpace::Linear,
            _ => ColorSpace::Srgb,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Key {
    pub(super) image: Option<u32>,
    pub(super) sampler: Sampler,
    pub(super) role: Role,
}

/// The textures that the materials need, each once.
#[derive(Default)]
pub(crate) struct Wanted {
    pub(super) keys: Vec<Key>,
    /// Per key: nothing but emission reads it.
    pub(super) only_emissive: Vec<bool>,
    numbers: HashMap<Key, u32>,
}

impl Wanted {
    /// The material with its texture slots filled; they refer to the textures of
    /// [`decode`](super::textures::decode).
    pub(crate) fn material(&mut self, def: &MaterialDef, document: &Document) -> Material {
        let (sets, _) = def.uv_sets();
        let base_role = match def.material.alpha_mode {
            AlphaMode::Opaque => Role::Color,
            AlphaMode::Blend => Role::Cutout(None),
            AlphaMode::Mask { cutoff } => {
                // The factor scales alpha before the comparison.
                let threshold = cutoff / def.material.base_color.w.max(1e-6);
                Role::Cutout(Some(threshold.clamp(0.0, 1.0).to_bits()))
            }
        };
        let glossiness = |factor: f32| Role::Glossiness(factor.to_bits());
        let roughness_role = def.glossiness.map_or(Role::Data, glossiness);
        let mut slot = |slot: Option<SlotDef>, role, emissive| {
            let slot = slot?;
            let texture = self.number(slot, role, document);
            // Emission shares textures with colours but has a placeholder of its own.
            self.only_emissive[texture as usize] &= emissive;
            Some(TextureRef {
                texture,
                uv_set: u32::from(sets[1] == Some(slot.set)),
                uv_transform: slot.transform,
            })
        };
        let further = |found: Option<TextureRef>| {
            found.map(|found| SlotDef {
                texture: found.texture,
                set: found.uv_set,
                transform: found.uv_transform,
            })
        };
        let plain = &def.material;
        let mut of_lobe = |found: &mut Option<TextureRef>, role| {
            *found = slot(further(*found), role, false);
        };
        let (mut clearcoat, mut sheen) = (plain.clearcoat, plain.sheen);
        if let Some(coat) = &mut clearcoat {
            of_lobe(&mut coat.texture, Role::Data);
            of_lobe(&mut coat.roughness_texture, Role::Data);
            of_lobe(&mut coat.normal_texture, Role::Normal);
        }
        if let Some(sheen) = &mut sheen {
            of_lobe(&mut sheen.color_texture, Role::Color);
            of_lobe(&mut sheen.roughness_texture, Role::Data);
        }
        let mut anisotropy = plain.anisotropy;
        if let Some(anisotropy) = &mut anisotropy {
            of_lobe(&mut anisotropy.texture, Role::Data);
        }
        let mut transmission = plain.transmission;
        if let Some(transmission) = &mut transmission {
            of_lobe(&mut transmission.texture, Role::Data);
            of_lobe(&mut transmission.thickness_texture, Role::Data);
        }
        let mut iridescence = plain.iridescence;
        if let Some(film) = &mut iridescence {
            of_lobe(&mut film.texture, Role::Data);
            of_lobe(&mut film.thickness_texture, Role::Data);
        }
        Material {
            iridescence,
            transmission,
            clearcoat,
            sheen,
            anisotropy,
            specular_texture: slot(further(plain.specular_texture), Role::Data, false),
            specular_color_texture: slot(further(plain.specular_color_texture), Role::Color, false),
            base_color_texture: slot(def.base_color, base_role, false),
            metallic_roughness_texture: slot(def.metallic_roughness, roughness_role, false),
            normal_texture: slot(def.normal, Role::Normal, false),
            occlusion_texture: slot(def.occlusion, Role::Data, false),
            emissive_texture: slot(def.emissive, Role::Color, true),
            ..def.material.clone()
        }
    }

    /// The pictures that are decoded, some of them several times.
    pub(crate) fn images(&self) -> impl Iterator<Item = u32> {
        self.keys.iter().filter_map(|key| key.image)
    }

    /// The texture's number in the scene.
    fn number(&mut self, slot: SlotDef, role: Role, document: &Document) -> u32 {
        let texture = &document.textures[slot.texture as usize];
        let sampler = texture
            .sampler
            .map_or_else(Sampler::default, |s| document.samplers[s as usize]);
        // Without mip levels only the colour space is left to differ, and with a picture the
        // placeholder is not needed.
        let role = match (role, sampler.mip, texture.image) {
            (Role::Cutout(_), None, Some(_)) => Role::Color,
            (Role::Normal, None, Some(_)) => Role::Data,
            (role, ..) => role,
        };
        let key = Key {
            image: texture.image,
            sampler,
            role,
        };
        let (keys, only_emissive) = (&mut self.keys, &mut self.only_emissive);
        *self.numbers.entry(key).or_insert_with(|| {
            keys.push(key);
            only_emissive.push(true);
            keys.len() as u32 - 1
        })
    }
}
