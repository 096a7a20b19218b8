//! Which extensions are honoured, which are harmless, and what to say about the others.

use super::json::Obj;
use crate::error::{Flaw, FlawKind, Parsed};

/// Honoured in full as far as a picture can tell.
const HONOURED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Read, but turned into something near it.
const APPROXIMATED: &[(&str, &str)] = &[(
    "KHR_materials_pbrSpecularGlossiness",
    "its diffuse colour is shown as that of a dielectric, its specular colour is not",
)];

/// Without effect on a picture: metadata and interaction.
const INVISIBLE: &[&str] = &[
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_xmp",
    "KHR_xmp_json_ld",
];

/// Fails on an unsupported required extension, warns of an unsupported used one.
pub(crate) fn check(root: Obj<'_>, warn: &mut Vec<String>) -> Parsed<()> {
    let approximated = |name: &str| APPROXIMATED.iter().find(|(known, _)| *known == name);
    let honoured = |name: &str| {
        HONOURED.contains(&name) || INVISIBLE.contains(&name) || approximated(name).is_some()
    };
    for (i, name) in root.strings("extensionsRequired")?.into_iter().enumerate() {
        if !honoured(name) {
            let mut flaw = Flaw::new(name).under(format_args!("extensionsRequired[{i}]"));
            flaw.kind = FlawKind::Extension;
            return Err(flaw);
        }
    }
    let mut used = root.strings("extensionsUsed")?;
    used.sort_unstable();
    used.dedup();
    for name in used {
        if let Some((_, how)) = approximated(name) {
            warn.push(format!("extensionsUsed: {name} is approximated: {how}"));
        } else if !honoured(name) {
            warn.push(format!(
                "extensionsUsed: {name} is not supported; the file is shown without it"
            ));
        }
    }
    Ok(())
}
