//! KHR_animation_pointer: which property of the file a JSON pointer names (RFC 6901; glTF 2.0 Asset
//! Object Model).

use serde_json::Value;

use super::document::Counts;
use super::json::Obj;
use super::slots;
use crate::Code;
use crate::error::{Flaw, Parsed};
use crate::pose::{
    CameraPart, Factor, LightPart, MaterialPart, Target, TextureSlot, UvPart, UvTransform,
};

/// What a channel moves.
#[derive(Clone, Copy)]
pub(crate) struct Pointed {
    /// Number of the node, camera, light or material in the file.
    pub(crate) number: u32,
    pub(crate) target: Target,
    /// The whole transform at rest, where a part of one is moved.
    pub(crate) at_rest: Option<UvTransform>,
}

impl Pointed {
    pub(crate) fn new(number: u32, target: Target) -> Self {
        Self {
            number,
            target,
            at_rest: None,
        }
    }
}

/// Factors of materials by their pointers from the material on.
const FACTORS: [(&str, Factor); 26] = [
    ("pbrMetallicRoughness/baseColorFactor", Factor::BaseColor),
    ("pbrMetallicRoughness/metallicFactor", Factor::Metallic),
    ("pbrMetallicRoughness/roughnessFactor", Factor::Roughness),
    ("emissiveFactor", Factor::Emissive),
    (
        "extensions/KHR_materials_emissive_strength/emissiveStrength",
        Factor::EmissiveStrength,
    ),
    ("alphaCutoff", Factor::AlphaCutoff),
    ("normalTexture/scale", Factor::NormalScale),
    ("occlusionTexture/strength", Factor::OcclusionStrength),
    ("extensions/KHR_materials_ior/ior", Factor::Ior),
    (
        "extensions/KHR_materials_specular/specularFactor",
        Factor::Specular,
    ),
    (
        "extensions/KHR_materials_specular/specularColorFactor",
        Factor::SpecularColor,
    ),
    (
        "extensions/KHR_materials_clearcoat/clearcoatFactor",
        Factor::Clearcoat,
    ),
    (
        "extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor",
        Factor::ClearcoatRoughness,
    ),
    (
        "extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale",
        Factor::ClearcoatNormalScale,
    ),
    (
        "extensions/KHR_materials_sheen/sheenColorFactor",
        Factor::SheenColor,
    ),
    (
        "extensions/KHR_materials_sheen/sheenRoughnessFactor",
        Factor::SheenRoughness,
    ),
    (
        "extensions/KHR_materials_anisotropy/anisotropyStrength",
        Factor::Anisotropy,
    ),
    (
        "extensions/KHR_materials_anisotropy/anisotropyRotation",
        Factor::AnisotropyRotation,
    ),
    (
        "extensions/KHR_materials_iridescence/iridescenceFactor",
        Factor::Iridescence,
    ),
    (
        "extensions/KHR_materials_iridescence/iridescenceIor",
        Factor::IridescenceIor,
    ),
    (
        "extensions/KHR_materials_iridescence/iridescenceThicknessMinimum",
        Factor::IridescenceThicknessMin,
    ),
    (
        "extensions/KHR_materials_iridescence/iridescenceThicknessMaximum",
        Factor::IridescenceThicknessMax,
    ),
    (
        "extensions/KHR_materials_transmission/transmissionFactor",
        Factor::Transmission,
    ),
    (
        "extensions/KHR_materials_volume/thicknessFactor",
        Factor::Thickness,
    ),
    (
        "extensions/KHR_materials_volume/attenuationDistance",
        Factor::AttenuationDistance,
    ),
    (
        "extensions/KHR_materials_volume/attenuationColor",
        Factor::AttenuationColor,
    ),
];

/// Textures of materials by their pointers from the material on.
const TEXTURES: [(&str, TextureSlot); 17] = [
    (
        "pbrMetallicRoughness/baseColorTexture",
        TextureSlot::BaseColor,
    ),
    (
        "pbrMetallicRoughness/metallicRoughnessTexture",
        TextureSlot::MetallicRoughness,
    ),
    ("normalTexture", TextureSlot::Normal),
    ("occlusionTexture", TextureSlot::Occlusion),
    ("emissiveTexture", TextureSlot::Emissive),
    (
        "extensions/KHR_materials_specular/specularTexture",
        TextureSlot::Specular,
    ),
    (
        "extensions/KHR_materials_specular/specularColorTexture",
        TextureSlot::SpecularColor,
    ),
    (
        "extensions/KHR_materials_clearcoat/clearcoatTexture",
        TextureSlot::Clearcoat,
    ),
    (
        "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture",
        TextureSlot::ClearcoatRoughness,
    ),
    (
        "extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
        TextureSlot::ClearcoatNormal,
    ),
    (
        "extensions/KHR_materials_sheen/sheenColorTexture",
        TextureSlot::SheenColor,
    ),
    (
        "extensions/KHR_materials_sheen/sheenRoughnessTexture",
        TextureSlot::SheenRoughness,
    ),
    (
        "extensions/KHR_materials_anisotropy/anisotropyTexture",
        TextureSlot::Anisotropy,
    ),
    (
        "extensions/KHR_materials_iridescence/iridescenceTexture",
        TextureSlot::Iridescence,
    ),
    (
        "extensions/KHR_materials_iridescence/iridescenceThicknessTexture",
        TextureSlot::IridescenceThickness,
    ),
    (
        "extensions/KHR_materials_transmission/transmissionTexture",
        TextureSlot::Transmission,
    ),
    (
        "extensions/KHR_materials_volume/thicknessTexture",
        TextureSlot::Thickness,
    ),
];

const TEXTURE_TRANSFORM: &str = "/extensions/KHR_texture_transform/";

/// What a channel's target object, whose path is `pointer`, points at. `root` is the whole file.
pub(super) fn pointed(target: Obj<'_>, root: &Value, counts: &Counts) -> Parsed<Pointed> {
    let within = |e: Flaw| e.under("extensions.KHR_animation_pointer");
    let Some(extension) = target.extension("KHR_animation_pointer")? else {
        let flaw = Flaw::new(Code::AnimationPointer, "is a pointer, but there is none");
        return Err(flaw.under("path"));
    };
    let pointer = extension.name("pointer").map_err(within)?;
    let pointer = extension.need("pointer", pointer).map_err(within)?;
    resolve(&pointer, root, counts).map_err(|e| within(e.under("pointer")))
}

fn resolve(pointer: &str, root: &Value, counts: &Counts) -> Parsed<Pointed> {
    let unknown = || {
        let cause = format!("\"{pointer}\" is not animated here");
        Flaw::new(Code::AnimationUnsupported, cause)
    };
    let lights = "/extensions/KHR_lights_punctual/lights/";
    let lists = [
        ("/nodes/", counts.nodes),
        ("/cameras/", counts.cameras),
        ("/materials/", counts.materials),
        (lights, counts.lights),
    ];
    let found = lists
        .iter()
        .find_map(|&(list, len)| Some((list, len, pointer.strip_prefix(list)?)));
    let (list, len, rest) = found.ok_or_else(unknown)?;
    let (number, property) = rest.split_once('/').ok_or_else(unknown)?;
    let number = index(number).filter(|&n| (n as usize) < len);
    let number = number.ok_or_else(|| {
        let cause = format!("\"{pointer}\" names nothing in the file: there are {len}");
        Flaw::new(Code::AnimationPointer, cause)
    })?;
    let (target, needs_value) = match list {
        "/nodes/" => (node_property(property), false),
        "/cameras/" => (camera_property(property), false),
        "/materials/" => (material_property(property), false),
        _ => (light_property(property), property == "range"),
    };
    let target = target.ok_or_else(unknown)?;
    // A property is there if the file gives it, or if it has a default value and its object is there.
    let object = pointer.rsplit_once('/').map_or("", |(object, _)| object);
    let holder = match target {
        Target::Weight(_) => object.rsplit_once('/').map_or("", |(node, _)| node),
        _ => object,
    };
    let holder = root.pointer(holder).filter(|holder| holder.is_object());
    if holder.is_none() || (needs_value && root.pointer(pointer).is_none()) {
        let cause = format!("\"{pointer}\" names nothing in the file");
        return Err(Flaw::new(Code::AnimationPointer, cause));
    }
    let at_rest = match (target, holder) {
        (Target::Material(MaterialPart::Uv(..)), Some(holder)) => {
            Some(slots::parse_transform(Obj::of(holder)?)?)
        }
        _ => None,
    };
    Ok(Pointed {
        number,
        target,
        at_rest,
    })
}

/// A place in a list as JSON pointers write it: decimal, without leading zeros.
fn index(text: &str) -> Option<u32> {
    let is_plain = text.bytes().all(|b| b.is_ascii_digit());
    let has_zeros = text.len() > 1 && text.starts_with('0');
    text.parse().ok().filter(|_| is_plain && !has_zeros)
}

fn node_property(property: &str) -> Option<Target> {
    Some(match property {
        "translation" => Target::Translation,
        "rotation" => Target::Rotation,
        "scale" => Target::Scale,
        "weights" => Target::Weights,
        "extensions/KHR_node_visibility/visible" => Target::Visible,
        other => Target::Weight(index(other.strip_prefix("weights/")?)?),
    })
}

/// The far plane of a perspective, the aspect ratio and the horizontal magnification are not used:
/// depth is infinite there, and the picture gives the aspect.
fn camera_property(property: &str) -> Option<Target> {
    Some(Target::Camera(match property {
        "perspective/yfov" => CameraPart::FovY,
        "perspective/znear" => CameraPart::PerspectiveNear,
        "orthographic/ymag" => CameraPart::YMag,
        "orthographic/znear" => CameraPart::OrthographicNear,
        "orthographic/zfar" => CameraPart::OrthographicFar,
        _ => return None,
    }))
}

fn light_property(property: &str) -> Option<Target> {
    Some(Target::Light(match property {
        "color" => LightPart::Color,
        "intensity" => LightPart::Intensity,
        "range" => LightPart::Range,
        "spot/innerConeAngle" => LightPart::InnerCone,
        "spot/outerConeAngle" => LightPart::OuterCone,
        _ => return None,
    }))
}

fn material_property(property: &str) -> Option<Target> {
    let part = match property.split_once(TEXTURE_TRANSFORM) {
        None => {
            let factor = FACTORS.iter().find(|(path, _)| *path == property);
            MaterialPart::Factor(factor?.1)
        }
        Some((texture, part)) => {
            let slot = TEXTURES.iter().find(|(path, _)| *path == texture);
            let part = match part {
                "offset" => UvPart::Offset,
                "rotation" => UvPart::Rotation,
                "scale" => UvPart::Scale,
                _ => return None,
            };
            MaterialPart::Uv(slot?.1, part)
        }
    };
    Some(Target::Material(part))
}
