//! Materials' lobes on the device: a uniform block and textures beside the material's own.

use bytemuck::{Pod, Zeroable};
use foveal_scene::{Material, Texture, TextureRef};
use glam::{Vec2, Vec3};

use super::material_uniform::{SLOTS, is_of_two, slots, uv_rows};

/// Places for textures in all lobes.
const PLACES: usize = 10;

/// Bindings for textures of lobes alone.
pub(super) const BOUND: usize = Material::MAX_LOBE_TEXTURES;

/// Where a texture of lobes is bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binding {
    /// At one for lobes alone.
    Own(usize),
    /// At a slot of the material's own textures.
    Slot(usize),
}

impl Binding {
    /// The bindings for a material's lobes. A pipeline of the reduced renderer binds 16 textures at
    /// most, and none of them for lobes alone: theirs go where the material has none of its own.
    fn all(material: &Material, reduced: bool) -> Vec<Self> {
        if !reduced {
            return (0..BOUND).map(Self::Own).collect();
        }
        let slots = slots(material).into_iter().enumerate().rev();
        let free = slots.filter(|(_, slot)| slot.is_none());
        free.map(|(number, _)| Self::Slot(number)).collect()
    }

    /// What `LOBE_TEXTURES` calls it.
    fn name(self) -> u32 {
        match self {
            Self::Own(number) => number as u32 + 1,
            Self::Slot(number) => (SLOTS - number) as u32,
        }
    }
}

/// Mirrors `Lobes` in `forward/lobes.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LobesUniform {
    pub(crate) sheen_color: [f32; 3],
    pub(crate) sheen_roughness: f32,
    pub(crate) clearcoat: f32,
    pub(crate) clearcoat_roughness: f32,
    pub(crate) clearcoat_normal_scale: f32,
    pub(crate) anisotropy: f32,
    pub(crate) anisotropy_turn: [f32; 2],
    pub(crate) transmission: f32,
    pub(crate) thickness: f32,
    pub(crate) absorption: [f32; 3],
    pub(crate) ior: f32,
    pub(crate) iridescence: f32,
    pub(crate) film_ior: f32,
    pub(crate) film_thickness: [f32; 2],
    pub(crate) uv: [[[f32; 4]; 2]; PLACES],
}

impl LobesUniform {
    pub(super) fn new(material: &Material) -> Self {
        let sheen = material.sheen.as_ref();
        let coat = material.clearcoat.as_ref();
        let anisotropy = material.anisotropy.as_ref();
        let transmission = material.transmission.as_ref();
        let film = material.iridescence.as_ref();
        Self {
            sheen_color: sheen.map_or([0.0; 3], |s| s.color.to_array()),
            sheen_roughness: sheen.map_or(0.0, |s| s.roughness),
            clearcoat: coat.map_or(0.0, |c| c.factor),
            clearcoat_roughness: coat.map_or(0.0, |c| c.roughness),
            clearcoat_normal_scale: coat.map_or(0.0, |c| c.normal_scale),
            anisotropy: anisotropy.map_or(0.0, |a| a.strength),
            anisotropy_turn: Vec2::from_angle(anisotropy.map_or(0.0, |a| a.rotation_rad))
                .to_array(),
            transmission: transmission.map_or(0.0, |t| t.factor),
            // Numbers whose product is finite, whatever a file says.
            thickness: transmission.map_or(0.0, |t| t.thickness_m.clamp(0.0, 1e6)),
            absorption: transmission.map_or([0.0; 3], |t| {
                // Per metre; what is black after the distance is as good as black at once.
                let passing = t.attenuation_color.max(Vec3::splat(1e-6));
                let absorption =
                    -passing.map(f32::ln) / t.attenuation_distance_m.max(f32::MIN_POSITIVE);
                absorption.clamp(Vec3::ZERO, Vec3::splat(1e9)).to_array()
            }),
            ior: material.ior.max(1.0),
            iridescence: film.map_or(0.0, |f| f.factor),
            // Numbers that have a cosine, whatever a file says.
            film_ior: film.map_or(1.0, |f| f.ior.clamp(1.0, 1e3)),
            film_thickness: film.map_or([0.0; 2], |f| {
                [f.thickness_min_nm, f.thickness_max_nm].map(|t| t.clamp(0.0, 1e5))
            }),
            uv: material
                .lobe_textures()
                .map(|slot| slot.map_or([[0.0; 4]; 2], uv_rows)),
        }
    }
}

/// What a pipeline is specialized to besides the material's class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct LobeClass {
    /// Further bits of `MATERIAL_CLASS`; 0 without lobes.
    pub(crate) flags: u32,
    /// `LOBE_TEXTURES`.
    pub(crate) textures: u32,
}

const HAS_CLEARCOAT: u32 = 4096;
const HAS_TRANSMISSION: u32 = 32768;
const COAT_NORMAL_OF_TWO: u32 = 131_072;

impl LobeClass {
    /// The same for a surface that is blended.
    pub(crate) fn without_transmission(self) -> Self {
        let flags = self.flags & !HAS_TRANSMISSION;
        let textures = if flags == 0 { 0 } else { self.textures };
        Self { flags, textures }
    }

    /// Whether light passes.
    pub(crate) fn transmits(self) -> bool {
        self.flags & HAS_TRANSMISSION != 0
    }

    /// A material's, with the textures to bind and where; `textures`: the scene's, with or without
    /// texels.
    pub(super) fn of(
        material: &Material,
        textures: &[Texture],
        reduced: bool,
    ) -> (Self, Vec<(Binding, u32)>) {
        let coat_normal = (material.clearcoat.as_ref()).and_then(|coat| coat.normal_texture);
        let flags = [
            (material.clearcoat.is_some(), HAS_CLEARCOAT),
            (is_of_two(coat_normal, textures), COAT_NORMAL_OF_TWO),
            (material.sheen.is_some(), 8192),
            (material.anisotropy.is_some(), 16384),
            (material.transmission.is_some(), HAS_TRANSMISSION),
            (material.iridescence.is_some(), 262_144),
        ];
        let mut left = Binding::all(material, reduced).into_iter();
        let mut bound: Vec<(Binding, u32)> = Vec::new();
        let mut place = |slot: Option<TextureRef>| {
            let Some(slot) = slot else { return 0 };
            let known = bound.iter().find(|(_, texture)| *texture == slot.texture);
            if let Some((binding, _)) = known {
                return binding.name();
            }
            // One that is too many is left out.
            let Some(binding) = left.next() else { return 0 };
            bound.push((binding, slot.texture));
            binding.name()
        };
        let places = material.lobe_textures().map(&mut place);
        let textures = (0..).zip(places).map(|(i, at)| at << (3 * i)).sum();
        let flags = flags
            .iter()
            .map(|&(is, bit)| if is { bit } else { 0 })
            .sum();
        (Self { flags, textures }, bound)
    }
}

#[cfg(test)]
mod tests {
    use foveal_scene::{Clearcoat, Sheen};

    use super::*;
    use crate::testing::slot;

    #[test]
    fn places_share_what_is_bound_and_the_sixth_texture_is_left_out() {
        let material = Material {
            clearcoat: Some(Clearcoat {
                factor: 1.0,
                texture: slot(7),
                roughness: 0.0,
                roughness_texture: slot(7),
                normal_texture: slot(2),
                normal_scale: 1.0,
            }),
            sheen: Some(Sheen {
                color: Vec3::ONE,
                color_texture: slot(7),
                roughness: 0.5,
                roughness_texture: None,
            }),
            ..Material::default()
        };
        let (class, bound) = LobeClass::of(&material, &[], false);
        assert_eq!((class.flags, class.textures), (4096 | 8192, 0o1211));
        assert_eq!(bound, [(Binding::Own(0), 7), (Binding::Own(1), 2)]);
    }

    #[test]
    fn the_reduced_renderer_binds_them_where_the_material_has_none() {
        let mut material = Material {
            base_color_texture: slot(0),
            specular_color_texture: slot(1),
            emissive_texture: slot(2),
            clearcoat: Some(Clearcoat {
                factor: 1.0,
                texture: slot(7),
                roughness: 0.0,
                roughness_texture: slot(8),
                normal_texture: slot(9),
                normal_scale: 1.0,
            }),
            ..Material::default()
        };
        let (class, bound) = LobeClass::of(&material, &[], true);
        // Specular, occlusion, normals.
        assert_eq!(class.textures, 0o542);
        let expected = [(5, 7), (3, 8), (2, 9)];
        assert_eq!(bound, expected.map(|(at, of)| (Binding::Slot(at), of)));
        material.specular_texture = slot(3);
        material.occlusion_texture = slot(3);
        material.normal_texture = slot(3);
        let (class, bound) = LobeClass::of(&material, &[], true);
        assert_eq!(class.textures, 0o006);
        assert_eq!(bound, [(Binding::Slot(1), 7)]);
    }
}
