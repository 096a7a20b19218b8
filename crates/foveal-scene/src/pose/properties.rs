//! Properties of materials, lights and cameras that animations change (KHR_animation_pointer), and
//! what a value makes of them. Values are taken as the importer takes those of the file, so that a
//! pose is what a file with these values is.

use glam::{Mat2, Mat3, Vec2, Vec3, Vec4};

use crate::{AlphaMode, Light, LightKind, Material, Projection, TextureRef};

/// A number, or a few, of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CameraPart {
    FovY,
    PerspectiveNear,
    YMag,
    OrthographicNear,
    OrthographicFar,
}

/// A number, or a few, of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LightPart {
    Color,
    Intensity,
    Range,
    InnerCone,
    OuterCone,
}

/// A number, or a few, of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Factor {
    BaseColor,
    Metallic,
    Roughness,
    Emissive,
    EmissiveStrength,
    AlphaCutoff,
    NormalScale,
    OcclusionStrength,
    Ior,
    Specular,
    SpecularColor,
    Clearcoat,
    ClearcoatRoughness,
    ClearcoatNormalScale,
    SheenColor,
    SheenRoughness,
    Anisotropy,
    AnisotropyRotation,
    Iridescence,
    IridescenceIor,
    IridescenceThicknessMin,
    IridescenceThicknessMax,
    Transmission,
    Thickness,
    AttenuationDistance,
    AttenuationColor,
}

/// A place of a material for a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TextureSlot {
    BaseColor,
    MetallicRoughness,
    Normal,
    Occlusion,
    Emissive,
    Specular,
    SpecularColor,
    Clearcoat,
    ClearcoatRoughness,
    ClearcoatNormal,
    SheenColor,
    SheenRoughness,
    Anisotropy,
    Iridescence,
    IridescenceThickness,
    Transmission,
    Thickness,
}

/// A number, or two, of KHR_texture_transform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UvPart {
    Offset,
    Rotation,
    Scale,
}

/// What animations change of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MaterialPart {
    Factor(Factor),
    Uv(TextureSlot, UvPart),
}

/// KHR_texture_transform as the file has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct UvTransform {
    pub(crate) offset: Vec2,
    pub(crate) rotation_rad: f32,
    pub(crate) scale: Vec2,
}

impl UvTransform {
    /// Offset · rotation · scale.
    ///
    /// The rotation is counter-clockwise as seen with v upwards. glTF's v points down, so the angle
    /// is negated; so do the reference viewer and the other engines, against the letter of the
    /// extension's GLSL.
    pub(crate) fn matrix(&self) -> Mat3 {
        let (sin, cos) = self.rotation_rad.sin_cos();
        let scale = self.scale;
        Mat3::from_cols(
            Vec3::new(cos * scale.x, -sin * scale.x, 0.0),
            Vec3::new(sin * scale.y, cos * scale.y, 0.0),
            self.offset.extend(1.0),
        )
    }
}

/// What a transform of texture coordinates does to directions; nothing where it leaves none.
pub(crate) fn turn_of_uvs(transform: Mat3) -> Mat2 {
    let turn = Mat2::from_mat3(transform);
    if turn.is_finite() && turn.determinant() != 0.0 {
        turn
    } else {
        Mat2::IDENTITY
    }
}

impl TextureSlot {
    /// The texture that a material has there.
    fn of(self, material: &mut Material) -> Option<&mut TextureRef> {
        let slot = match self {
            Self::BaseColor => &mut material.base_color_texture,
            Self::MetallicRoughness => &mut material.metallic_roughness_texture,
            Self::Normal => &mut material.normal_texture,
            Self::Occlusion => &mut material.occlusion_texture,
            Self::Emissive => &mut material.emissive_texture,
            Self::Specular => &mut material.specular_texture,
            Self::SpecularColor => &mut material.specular_color_texture,
            Self::Clearcoat => &mut material.clearcoat.as_mut()?.texture,
            Self::ClearcoatRoughness => &mut material.clearcoat.as_mut()?.roughness_texture,
            Self::ClearcoatNormal => &mut material.clearcoat.as_mut()?.normal_texture,
            Self::SheenColor => &mut material.sheen.as_mut()?.color_texture,
            Self::SheenRoughness => &mut material.sheen.as_mut()?.roughness_texture,
            Self::Anisotropy => &mut material.anisotropy.as_mut()?.texture,
            Self::Iridescence => &mut material.iridescence.as_mut()?.texture,
            Self::IridescenceThickness => &mut material.iridescence.as_mut()?.thickness_texture,
            Self::Transmission => &mut material.transmission.as_mut()?.texture,
            Self::Thickness => &mut material.transmission.as_mut()?.thickness_texture,
        };
        slot.as_mut()
    }
}

/// A material that animations change: at rest, or in the making of a pose.
#[derive(Clone, Debug)]
pub(crate) struct MaterialState {
    pub(crate) material: Material,
    /// The two factors of [`Material::emissive`].
    pub(crate) emissive: Vec3,
    pub(crate) emissive_strength: f32,
    /// Of the textures whose place moves.
    pub(crate) transforms: Vec<(TextureSlot, UvTransform)>,
    /// The texture that generated tangents follow, and where it was read when they were made.
    pub(crate) tangents: Option<(TextureSlot, UvTransform)>,
}

impl MaterialState {
    pub(crate) fn set(&mut self, part: MaterialPart, value: [f32; 4]) {
        match part {
            MaterialPart::Factor(factor) => self.set_factor(factor, value),
            MaterialPart::Uv(slot, part) => {
                let known = self.transforms.iter_mut().find(|(s, _)| *s == slot);
                let Some((_, transform)) = known else { return };
                let [x, y, ..] = value;
                match part {
                    UvPart::Offset => transform.offset = Vec2::new(x, y),
                    UvPart::Rotation => transform.rotation_rad = x,
                    UvPart::Scale => transform.scale = Vec2::new(x, y),
                }
            }
        }
    }

    fn set_factor(&mut self, factor: Factor, value: [f32; 4]) {
        let m = &mut self.material;
        let [x, ..] = value;
        let part = x.clamp(0.0, 1.0);
        let color = Vec4::from(value).truncate();
        let (coat, sheen) = (m.clearcoat.as_mut(), m.sheen.as_mut());
        let (anisotropy, transmission) = (m.anisotropy.as_mut(), m.transmission.as_mut());
        let film = m.iridescence.as_mut();
        match factor {
            Factor::BaseColor => m.base_color = Vec4::from(value).clamp(Vec4::ZERO, Vec4::ONE),
            Factor::Metallic => m.metallic = part,
            Factor::Roughness => m.roughness = part,
            Factor::Emissive => self.emissive = color.max(Vec3::ZERO),
            Factor::EmissiveStrength => self.emissive_strength = x.max(0.0),
            Factor::AlphaCutoff => {
                if let AlphaMode::Mask { cutoff } = &mut m.alpha_mode {
                    *cutoff = x;
                }
            }
            Factor::NormalScale => m.normal_scale = x,
            Factor::OcclusionStrength => m.occlusion_strength = part,
            Factor::Ior => m.ior = Material::usable_ior(x),
            Factor::Specular => m.specular = part,
            Factor::SpecularColor => m.specular_color = color.max(Vec3::ZERO),
            Factor::Clearcoat => coat.into_iter().for_each(|c| c.factor = part),
            Factor::ClearcoatRoughness => coat.into_iter().for_each(|c| c.roughness = part),
            Factor::ClearcoatNormalScale => coat.into_iter().for_each(|c| c.normal_scale = x),
            Factor::SheenColor => sheen
                .into_iter()
                .for_each(|s| s.color = color.clamp(Vec3::ZERO, Vec3::ONE)),
            Factor::SheenRoughness => sheen.into_iter().for_each(|s| s.roughness = part),
            Factor::Anisotropy => anisotropy.into_iter().for_each(|a| a.strength = part),
            Factor::AnisotropyRotation => anisotropy.into_iter().for_each(|a| a.rotation_rad = x),
            Factor::Iridescence => film.into_iter().for_each(|f| f.factor = part),
            Factor::IridescenceIor => film.into_iter().for_each(|f| f.ior = x.max(1.0)),
            Factor::IridescenceThicknessMin => film
                .into_iter()
                .for_each(|f| f.thickness_min_nm = x.max(0.0)),
            Factor::IridescenceThicknessMax => film
                .into_iter()
                .for_each(|f| f.thickness_max_nm = x.max(0.0)),
            Factor::Transmission => transmission.into_iter().for_each(|t| t.factor = part),
            Factor::Thickness => transmission
                .into_iter()
                .for_each(|t| t.thickness_m = x.max(0.0)),
            Factor::AttenuationDistance => transmission.into_iter().for_each(|t| {
                t.attenuation_distance_m = Some(x).filter(|&d| d > 0.0).unwrap_or(f32::INFINITY);
            }),
            Factor::AttenuationColor => transmission
                .into_iter()
                .for_each(|t| t.attenuation_color = color.clamp(Vec3::ZERO, Vec3::ONE)),
        }
    }

    /// The material with all that has been set.
    pub(crate) fn finish(mut self) -> Material {
        self.material.emissive = emission(self.emissive, self.emissive_strength);
        for (slot, transform) in &self.transforms {
            if let Some(texture) = slot.of(&mut self.material) {
                texture.uv_transform = transform.matrix();
            }
            if let Some((_, made_for)) = self.tangents.filter(|(of, _)| of == slot) {
                turn_tangents(&mut self.material, &made_for, transform);
            }
        }
        self.material
    }
}

/// Turns generated tangents from where u grew on the surface to where it grows.
fn turn_tangents(material: &mut Material, before: &UvTransform, now: &UvTransform) {
    let [before, now] = [before, now].map(|transform| turn_of_uvs(transform.matrix()));
    let signs = [before, now].map(|turn| turn.determinant().signum());
    // By the inverse: u grows and v does not.
    let angles = [(before, signs[0]), (now, signs[1])]
        .map(|(turn, sign)| (sign * Vec2::new(turn.y_axis.y, -turn.x_axis.y)).to_angle());
    material.tangent_turn_rad = signs[0] * (angles[1] - angles[0]);
    material.tangents_mirrored = signs[0] != signs[1];
}

/// Emission of its two factors. An infinite one would be NaN where its texture is black.
pub(crate) fn emission(factor: Vec3, strength: f32) -> Vec3 {
    (factor * strength).min(Vec3::MAX)
}

/// Sets a number of a light, or its colour. [`finish_light`] follows the last one.
pub(crate) fn set_light(light: &mut Light, part: LightPart, value: [f32; 4]) {
    let [x, ..] = value;
    match part {
        LightPart::Color => light.color = Vec4::from(value).truncate().max(Vec3::ZERO),
        LightPart::Intensity => light.intensity = x.max(0.0),
        LightPart::Range => light.range_m = Some(x).filter(|&range| range > 0.0),
        LightPart::InnerCone | LightPart::OuterCone => {
            if let LightKind::Spot {
                inner_rad,
                outer_rad,
            } = &mut light.kind
            {
                match part {
                    LightPart::InnerCone => *inner_rad = x,
                    _ => *outer_rad = x,
                }
            }
        }
    }
}

/// Brings a spot light's angles into their ranges.
pub(crate) fn finish_light(light: &mut Light) {
    if let LightKind::Spot {
        inner_rad,
        outer_rad,
    } = light.kind
    {
        light.kind = LightKind::spot(inner_rad, outer_rad);
    }
}

/// Sets a number of a camera's projection; numbers of the other kind of projection change nothing.
pub(crate) fn set_projection(projection: &mut Projection, part: CameraPart, x: f32) {
    match (projection, part) {
        (Projection::Perspective { fov_y_rad, .. }, CameraPart::FovY) => *fov_y_rad = x,
        (Projection::Perspective { near_m, .. }, CameraPart::PerspectiveNear)
        | (Projection::Orthographic { near_m, .. }, CameraPart::OrthographicNear) => *near_m = x,
        (Projection::Orthographic { height_m, .. }, CameraPart::YMag) => *height_m = 2.0 * x.abs(),
        (Projection::Orthographic { far_m, .. }, CameraPart::OrthographicFar) => *far_m = x,
        _ => {}
    }
}

/// Whether a picture can be drawn by a projection.
pub(crate) fn is_usable(projection: &Projection) -> bool {
    match *projection {
        Projection::Perspective { fov_y_rad, near_m } => {
            fov_y_rad > 0.0 && fov_y_rad < std::f32::consts::PI && near_m > 0.0
        }
        Projection::Orthographic {
            height_m,
            near_m,
            far_m,
        } => height_m > 0.0 && far_m > near_m,
    }
}
