//! Surfaces: glTF's metallic-roughness model.

use glam::{Vec3, Vec4};

use crate::{Anisotropy, Clearcoat, Iridescence, Sheen, TextureRef, Transmission};

/// What alpha means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// Pixels with alpha below `cutoff` are not there.
    Mask {
        /// The threshold, usually 0.5.
        cutoff: f32,
    },
    /// Blended over what is behind it.
    Blend,
}

/// One surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file.
    pub name: String,
    /// Linear RGBA factor.
    pub base_color: Vec4,
    /// sRGB colour and alpha.
    pub base_color_texture: Option<TextureRef>,
    /// 0 dielectric … 1 metal.
    pub metallic: f32,
    /// Perceptual roughness, 0 … 1.
    pub roughness: f32,
    /// Green = roughness, blue = metallic, linear.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// KHR_materials_ior: index of refraction of what is not metal; 0 reflects everything.
    pub ior: f32,
    /// KHR_materials_specular: part of the reflection of what is not metal, 0 … 1.
    pub specular: f32,
    /// Alpha times `specular`, linear.
    pub specular_texture: Option<TextureRef>,
    /// Linear colour of the reflection at right angles of what is not metal; may exceed 1.
    pub specular_color: Vec3,
    /// sRGB colour, times `specular_color`.
    pub specular_color_texture: Option<TextureRef>,
    /// Tangent-space normals, linear.
    pub normal_texture: Option<TextureRef>,
    /// Scale of the normal's x and y.
    pub normal_scale: f32,
    /// Red = ambient occlusion, linear.
    pub occlusion_texture: Option<TextureRef>,
    /// How much of the occlusion applies, 0 … 1.
    pub occlusion_strength: f32,
    /// Linear radiance, KHR_materials_emissive_strength multiplied in.
    pub emissive: Vec3,
    /// sRGB colour, times `emissive`.
    pub emissive_texture: Option<TextureRef>,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Back faces are drawn too, with the normal turned to the viewer.
    pub double_sided: bool,
    /// KHR_materials_unlit: base colour as radiance, without light. Exposure and tone map apply.
    pub unlit: bool,
    /// A clear coat over it.
    pub clearcoat: Option<Clearcoat>,
    /// Fibres that stand off it.
    pub sheen: Option<Sheen>,
    /// Highlights that are longer in one direction.
    pub anisotropy: Option<Anisotropy>,
    /// A thin film on it.
    pub iridescence: Option<Iridescence>,
    /// Light that passes.
    pub transmission: Option<Transmission>,
    /// Noise that is computed at each point instead of looked up in textures.
    pub procedural: Option<ProceduralLayers>,
    /// What poses change of it.
    pub animated: AnimatedParts,
    /// How far a pose has turned the texture coordinates that generated tangents follow since the
    /// tangents were made, in radians; 0 for a mesh with tangents of its own.
    pub tangent_turn_rad: f32,
    /// Whether a pose has mirrored these coordinates since: the bitangents point the other way.
    pub tangents_mirrored: bool,
}

/// What poses change of a material, where a renderer that prepares a shader for each kind of material
/// has to know. Lobes that poses change are there at rest too, if only with a factor of 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AnimatedParts {
    /// The index of refraction, or strength or colour of KHR_materials_specular.
    pub specular: bool,
    /// Where textures are read: [`TextureRef::uv_transform`].
    pub uv_transforms: bool,
}

/// A surface of eight layers of noise in world space, each over those before where its height is
/// great. Each has its own colour, which multiplies the base colour, its own roughness, which
/// replaces the material's, and raises the normal. Needs neither texture nor UVs. Layers whose
/// lumps are finer than two pixels fade into their mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProceduralLayers {
    /// What colours, roughnesses and noise follow from.
    pub seed: u32,
    /// Lumps per metre of the coarsest layer; each further one has 1.7 times as many.
    pub frequency: f32,
}

/// Places for textures in all lobes.
const TEXTURES: usize = 10;

/// The index of refraction of a material that names none.
const DEFAULT_IOR: f32 = 1.5;

impl Material {
    /// Most different textures that lobes read; renderers leave out what comes after.
    pub const MAX_LOBE_TEXTURES: usize = 5;

    /// Whether the material has a clear coat, sheen, anisotropy, iridescence or transmission.
    #[must_use]
    pub fn has_lobes(&self) -> bool {
        self.clearcoat.is_some()
            || self.sheen.is_some()
            || self.anisotropy.is_some()
            || self.transmission.is_some()
            || self.iridescence.is_some()
    }

    /// The textures of its lobes: clear coat, its roughness, its normals; sheen's colour, its
    /// roughness; anisotropy; transmission, thickness; iridescence, its film's thickness.
    #[must_use]
    pub fn lobe_textures(&self) -> [Option<TextureRef>; TEXTURES] {
        let (coat, sheen) = (self.clearcoat.as_ref(), self.sheen.as_ref());
        let film = self.iridescence.as_ref();
        [
            coat.and_then(|c| c.texture),
            coat.and_then(|c| c.roughness_texture),
            coat.and_then(|c| c.normal_texture),
            sheen.and_then(|s| s.color_texture),
            sheen.and_then(|s| s.roughness_texture),
            self.anisotropy.as_ref().and_then(|a| a.texture),
            self.transmission.as_ref().and_then(|t| t.texture),
            self.transmission.as_ref().and_then(|t| t.thickness_texture),
            film.and_then(|f| f.texture),
            film.and_then(|f| f.thickness_texture),
        ]
    }

    /// An index of refraction as near to this one as there are: 0 reflects everything, and nothing
    /// real lies between it and 1.
    pub(crate) fn usable_ior(ior: f32) -> f32 {
        if ior <= 0.0 { 0.0 } else { ior.max(1.0) }
    }

    /// Reflectance at right angles that the index of refraction gives what is not metal.
    #[must_use]
    pub fn ior_reflectance(&self) -> f32 {
        if self.ior == DEFAULT_IOR {
            return 0.04;
        }
        ((self.ior - 1.0) / (self.ior + 1.0)).powi(2)
    }

    /// Whether what is not metal reflects otherwise than by default: by the index of refraction, or
    /// by KHR_materials_specular, now or in another pose.
    #[must_use]
    pub fn has_own_specular(&self) -> bool {
        let default = (DEFAULT_IOR, 1.0, Vec3::ONE);
        let textures = [self.specular_texture, self.specular_color_texture];
        (self.ior, self.specular, self.specular_color) != default
            || textures.iter().any(Option::is_some)
            || self.animated.specular
    }
}

impl Default for Material {
    /// glTF's default material, white, with roughness and metallic 1 (as the specification says).
    fn default() -> Self {
        Self {
            name: "default".to_owned(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            ior: DEFAULT_IOR,
            specular: 1.0,
            specular_texture: None,
            specular_color: Vec3::ONE,
            specular_color_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            occlusion_texture: None,
            occlusion_strength: 1.0,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            clearcoat: None,
            sheen: None,
            anisotropy: None,
            iridescence: None,
            transmission: None,
            procedural: None,
            animated: AnimatedParts::default(),
            tangent_turn_rad: 0.0,
            tangents_mirrored: false,
        }
    }
}
