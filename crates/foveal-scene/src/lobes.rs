//! What surfaces reflect beside glTF's metallic-roughness model: coats, cloth, brushed metal.

use glam::Vec3;

use crate::TextureRef;

/// KHR_materials_clearcoat: a clear coat over everything else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// How much of it there is, 0 … 1.
    pub factor: f32,
    /// Red times `factor`, linear.
    pub texture: Option<TextureRef>,
    /// Perceptual roughness, 0 … 1.
    pub roughness: f32,
    /// Green times `roughness`, linear.
    pub roughness_texture: Option<TextureRef>,
    /// Tangent-space normals of the coat, linear; without, the geometry's.
    pub normal_texture: Option<TextureRef>,
    /// Scale of the normal's x and y.
    pub normal_scale: f32,
}

/// KHR_materials_sheen: fibres that stand off the surface, as of velvet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Linear colour, 0 … 1.
    pub color: Vec3,
    /// sRGB colour, times `color`.
    pub color_texture: Option<TextureRef>,
    /// Perceptual roughness, 0 … 1.
    pub roughness: f32,
    /// Alpha times `roughness`, linear.
    pub roughness_texture: Option<TextureRef>,
}

/// KHR_materials_anisotropy: highlights that are longer in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// 0 … 1.
    pub strength: f32,
    /// Direction of the longer side, counter-clockwise from the tangent.
    pub rotation_rad: f32,
    /// Red and green: direction in tangent space, turned by the rotation; blue times `strength`.
    /// Linear.
    pub texture: Option<TextureRef>,
}

/// KHR_materials_iridescence: a thin film, as of soap or oil, in which light interferes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iridescence {
    /// How much of it there is, 0 … 1.
    pub factor: f32,
    /// Red times `factor`, linear.
    pub texture: Option<TextureRef>,
    /// The film's index of refraction, at least 1.
    pub ior: f32,
    /// Nanometres of the film where the thickness' texture is black; may be more than
    /// `thickness_max_nm`.
    pub thickness_min_nm: f32,
    /// Nanometres of the film where the texture is white, or without one everywhere.
    pub thickness_max_nm: f32,
    /// Green: from `thickness_min_nm` to `thickness_max_nm`, linear.
    pub thickness_texture: Option<TextureRef>,
}

/// KHR_materials_transmission with KHR_materials_volume: light that passes instead of being
/// scattered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission {
    /// Part of the light, 0 … 1.
    pub factor: f32,
    /// Red times `factor`, linear.
    pub texture: Option<TextureRef>,
    /// Metres of the volume behind the surface, in the mesh's own scale; 0 is a thin wall, which
    /// does not refract.
    pub thickness_m: f32,
    /// Green times `thickness_m`, linear.
    pub thickness_texture: Option<TextureRef>,
    /// Metres after which light has the attenuation's colour; infinite by default.
    pub attenuation_distance_m: f32,
    /// What white light is then, linear.
    pub attenuation_color: Vec3,
}
