//! Wavefront OBJ and MTL, read by the crate `tobj`.

use std::borrow::Cow;
use std::cell::RefCell;
use std::io::BufReader;

use serde_json::{Value, json};
use tobj::{LoadError, LoadOptions, Material, Mesh};

use super::builder::Builder;
use crate::gltf::Resolver;
use crate::{Code, Warning};

/// One object per group and material; polygons are cut into fans.
pub(super) fn convert(
    bytes: &[u8],
    resolver: &Resolver<'_>,
) -> Result<(Vec<u8>, Vec<Warning>), String> {
    let options = LoadOptions {
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let bytes = &*without_nameless_materials(bytes);
    let missing = RefCell::new(Vec::new());
    let (models, materials) = tobj::load_obj_buf(&mut BufReader::new(bytes), &options, |path| {
        let name = path.to_string_lossy().replace('\\', "/");
        match resolver(&name) {
            Ok(bytes) => tobj::load_mtl_buf(&mut BufReader::new(&bytes[..])),
            Err(cause) => {
                missing.borrow_mut().push(format!("mtllib: {cause}"));
                Err(LoadError::OpenFileFailed)
            }
        }
    })
    .map_err(|error| error.to_string())?;
    let mut notes: Vec<Warning> = missing
        .into_inner()
        .into_iter()
        .map(|text| Warning::new(Code::MaterialUnreadable, text))
        .collect();
    let materials = materials.unwrap_or_else(|error| {
        if notes.is_empty() {
            let text = format!("mtllib: {error}; the materials are left out");
            notes.push(Warning::new(Code::MaterialUnreadable, text));
        }
        Vec::new()
    });
    let mut builder = Builder::default();
    for material in &materials {
        let material = surface(material, &mut builder, &mut notes);
        builder.materials.push(material);
    }
    if models.iter().all(|model| model.mesh.indices.is_empty()) {
        let text = "has no faces: points and lines are not drawn";
        notes.push(Warning::new(Code::PrimitiveMode, text));
    }
    for model in models {
        let place = |what: &str| format!("object {}: {what}", model.name);
        let mesh = model.mesh;
        if mesh.indices.is_empty() {
            continue;
        }
        let count = mesh.positions.len() / 3;
        if !fits(&mesh, count) {
            let text = place("its lists have different lengths; it is left out");
            notes.push(Warning::new(Code::AccessorCount, text));
            continue;
        }
        let mut attributes = json!({ "POSITION": builder.vectors::<3>(&mesh.positions) });
        if !mesh.normals.is_empty() {
            attributes["NORMAL"] = json!(builder.vectors::<3>(&mesh.normals));
        }
        if !mesh.texcoords.is_empty() {
            // OBJ counts rows from below.
            let turned: Vec<f32> = mesh
                .texcoords
                .chunks_exact(2)
                .flat_map(|uv| [uv[0], 1.0 - uv[1]])
                .collect();
            attributes["TEXCOORD_0"] = json!(builder.vectors::<2>(&turned));
        }
        if !mesh.vertex_color.is_empty() {
            attributes["COLOR_0"] = json!(builder.vectors::<3>(&mesh.vertex_color));
        }
        let mut primitive = json!({
            "attributes": attributes, "indices": builder.indices(&mesh.indices)
        });
        if let Some(material) = mesh.material_id {
            primitive["material"] = json!(material);
        }
        builder.object(&model.name, primitive);
    }
    Ok((builder.glb()?, notes))
}

/// The file without `usemtl` lines that name nothing, which Rhino writes and the parser refuses.
fn without_nameless_materials(bytes: &[u8]) -> Cow<'_, [u8]> {
    let is_nameless = |line: &[u8]| line.trim_ascii() == b"usemtl";
    if !bytes.split(|&b| b == b'\n').any(is_nameless) {
        return Cow::Borrowed(bytes);
    }
    let lines = bytes.split_inclusive(|&b| b == b'\n');
    Cow::Owned(
        lines
            .filter(|line| !is_nameless(line))
            .flatten()
            .copied()
            .collect(),
    )
}

/// Whether each list is empty or has an element for each vertex.
fn fits(mesh: &Mesh, count: usize) -> bool {
    let is = |len: usize, width: usize| len == 0 || len == width * count;
    is(mesh.normals.len(), 3) && is(mesh.texcoords.len(), 2) && is(mesh.vertex_color.len(), 3)
}

/// A material of MTL as metallic-roughness: Kd and map_Kd are the base colour, Ke and map_Ke emission,
/// d opacity, Ns the exponent of a Blinn-Phong lobe; Pm, Pr and norm, the format's extension for
/// physically based materials, are taken as they are. A lobe of exponent n has the roughness
/// `sqrt(2 / (n + 2))` squared in glTF's terms (Walter et al. 2007, section 5.2).
fn surface(material: &Material, builder: &mut Builder, notes: &mut Vec<Warning>) -> Value {
    let extra = |key: &str| material.unknown_param.get(key).map(String::as_str);
    let number = |key: &str| extra(key).and_then(|text| text.trim().parse::<f32>().ok());
    let unit = |x: f32| {
        if x.is_finite() {
            x.clamp(0.0, 1.0)
        } else {
            1.0
        }
    };
    let opacity = unit(material.dissolve.unwrap_or(1.0));
    let color = material.diffuse.unwrap_or([1.0; 3]).map(unit);
    let from_exponent = |n: f32| (2.0 / (n.max(0.0) + 2.0)).sqrt().sqrt();
    let roughness = number("Pr").or_else(|| material.shininess.map(from_exponent));
    let mut surface = json!({
        "name": material.name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [color[0], color[1], color[2], opacity],
            "metallicFactor": unit(number("Pm").unwrap_or(0.0)),
            "roughnessFactor": unit(roughness.unwrap_or(1.0)),
        },
        "alphaMode": if opacity < 1.0 { "BLEND" } else { "OPAQUE" },
        "doubleSided": true,
    });
    if let Some(file) = material.diffuse_texture.as_deref().map(picture) {
        let texture = json!({ "index": builder.texture(file) });
        surface["pbrMetallicRoughness"]["baseColorTexture"] = texture;
        if material.diffuse.is_some_and(|kd| kd == [0.0; 3]) {
            // Exporters write black where the picture says it all.
            surface["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, opacity]);
        }
    }
    if let Some(file) = extra("norm").map(picture) {
        surface["normalTexture"] = json!({ "index": builder.texture(file) });
    }
    if let Some(emission) = material.emissive {
        surface["emissiveFactor"] = json!(emission.map(unit));
    }
    if let Some(file) = extra("map_Ke").map(picture) {
        surface["emissiveTexture"] = json!({ "index": builder.texture(file) });
        if material.emissive.is_none() {
            surface["emissiveFactor"] = json!([1, 1, 1]);
        }
    }
    let ignored = [
        ("map_d", material.dissolve_texture.is_some()),
        ("map_Bump", material.normal_texture.is_some()),
        ("map_Ks", material.specular_texture.is_some()),
        ("map_Ns", material.shininess_texture.is_some()),
        ("map_Pr", extra("map_Pr").is_some()),
        ("map_Pm", extra("map_Pm").is_some()),
    ];
    let ignored: Vec<&str> = ignored.iter().filter(|i| i.1).map(|i| i.0).collect();
    if !ignored.is_empty() {
        let text = format!(
            "material {}: {} not read; the surface is shown without",
            material.name,
            if ignored.len() == 1 {
                format!("{} is", ignored[0])
            } else {
                format!("{} are", ignored.join(", "))
            }
        );
        notes.push(Warning::new(Code::MaterialIgnored, text));
    }
    surface
}

/// The picture's file, without the options that may stand before it (`-s 2 2 1 wood.png`).
fn picture(text: &str) -> &str {
    if text.starts_with('-') {
        text.rsplit(char::is_whitespace).next().unwrap_or(text)
    } else {
        text
    }
}
