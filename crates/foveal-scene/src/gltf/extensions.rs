//! Which extensions are honoured, which are harmless, and what to say about the others.

use super::json::Obj;
use crate::error::{Flaw, FlawKind, Parsed};
use crate::{Code, Warning};

/// Honoured in full as far as a picture can tell.
const HONOURED: &[&str] = &[
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Without effect on a picture: metadata, interaction, sound, physics, what triangles once were.
const INVISIBLE: &[&str] = &[
    "AGI_articulations",
    "AGI_stk_metadata",
    "EXT_instance_features",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "FB_ngon_encoding",
    "GODOT_single_root",
    "KHR_audio_emitter",
    "KHR_interactivity",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_physics_rigid_bodies",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "OMI_physics_body",
    "OMI_physics_shape",
];

/// Formats of textures that are not read. Where such a texture has another picture, that one is
/// shown and there is nothing to say; where it has none, the texture's own warning says so.
const TEXTURE_FORMATS: &[&str] = &["EXT_texture_avif", "MSFT_texture_dds"];

/// How a file that requires an extension becomes one that does not.
const CONVERSIONS: &[(&str, &str)] = &[(
    "EXT_texture_avif",
    "`gltf-transform png IN OUT` turns AVIF textures into PNG",
)];

/// Fails on unsupported required extensions, warns of unsupported used ones.
pub(crate) fn check(root: Obj<'_>, warn: &mut Vec<Warning>) -> Parsed<()> {
    let honoured = |name: &str| HONOURED.contains(&name) || INVISIBLE.contains(&name);
    let mut missing = root.strings("extensionsRequired")?;
    missing.retain(|name| !honoured(name));
    missing.sort_unstable();
    missing.dedup();
    if !missing.is_empty() {
        return Err(missing_extensions(&missing).under("extensionsRequired"));
    }
    let mut used = root.strings("extensionsUsed")?;
    used.sort_unstable();
    used.dedup();
    for name in used {
        if !honoured(name) && !TEXTURE_FORMATS.contains(&name) {
            warn.push(Warning::new(
                Code::ExtensionIgnored,
                format!("extensionsUsed: {name} is not supported; the file is shown without it"),
            ));
        }
    }
    Ok(())
}

/// All of them in one message, and what helps.
fn missing_extensions(missing: &[&str]) -> Flaw {
    let names = missing.join(", ");
    let helps = CONVERSIONS
        .iter()
        .filter(|(name, _)| missing.contains(name));
    let helps: Vec<&str> = helps.map(|(_, how)| *how).collect();
    let mut flaw = Flaw::new(
        Code::ExtensionRequired,
        if helps.is_empty() {
            format!("{names}, not supported here")
        } else {
            format!("{names}, not supported here; {}", helps.join("; "))
        },
    );
    flaw.kind = FlawKind::Extension;
    flaw
}
