//! The Stanford polygon format, text or binary, read by the crate `ply-rs-bw`.

use std::io::Cursor;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Header, Property, PropertyAccess, PropertyAccessResult};
use serde_json::json;

use super::builder::Builder;
use crate::{Code, Warning};

/// The mesh as one object; polygons are cut into fans.
pub(super) fn convert(bytes: &[u8]) -> Result<(Vec<u8>, Vec<Warning>), String> {
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = Parser::<Skipped>::new()
        .read_header(&mut reader)
        .map_err(|error| short(&error))?;
    check_counts(&header, bytes.len())?;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => {
                vertices = Parser::<Corner>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(|error| short(&error))?;
            }
            "face" => {
                faces = Parser::<Face>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(|error| short(&error))?;
            }
            _ => {
                Parser::<Skipped>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(|error| short(&error))?;
            }
        }
    }
    let mut notes = Vec::new();
    let indices = fans(&faces, vertices.len(), &mut notes);
    if faces.is_empty() {
        let text = "has no faces: points are not drawn";
        notes.push(Warning::new(Code::PrimitiveMode, text));
    }
    let has = |key: &str| {
        let vertex = header.elements.get("vertex");
        vertex.is_some_and(|vertex| vertex.properties.contains_key(key))
    };
    let mut builder = Builder::default();
    if !indices.is_empty() {
        let list = |pick: fn(&Corner) -> [f32; 3]| -> Vec<f32> {
            vertices.iter().flat_map(pick).collect()
        };
        let mut attributes = json!({ "POSITION": builder.vectors::<3>(&list(|v| v.position)) });
        if has("nx") {
            attributes["NORMAL"] = json!(builder.vectors::<3>(&list(|v| v.normal)));
        }
        if has("red") {
            attributes["COLOR_0"] = json!(builder.vectors::<3>(&list(|v| v.color)));
        }
        let is_mapped = UVS.iter().any(|[u, _]| has(u));
        if is_mapped {
            let uv: Vec<f32> = vertices.iter().flat_map(|v| v.uv).collect();
            attributes["TEXCOORD_0"] = json!(builder.vectors::<2>(&uv));
        }
        let mut primitive =
            json!({ "attributes": attributes, "indices": builder.indices(&indices) });
        let mut surface =
            json!({ "pbrMetallicRoughness": { "metallicFactor": 0 }, "doubleSided": true });
        let named = |comment: &String| {
            let file = comment.trim().strip_prefix("TextureFile")?.trim();
            (!file.is_empty()).then(|| file.to_owned())
        };
        if let Some(file) = header.comments.iter().find_map(named).filter(|_| is_mapped) {
            let texture = json!({ "index": builder.texture(&file) });
            surface["pbrMetallicRoughness"]["baseColorTexture"] = texture;
        }
        builder.materials.push(surface);
        primitive["material"] = json!(0);
        builder.object("", primitive);
    }
    Ok((builder.glb()?, notes))
}

/// The parser's message without the file's own text.
fn short(error: &ply_rs_bw::parser::ParseError) -> String {
    let text = error.to_string();
    text.lines().next().unwrap_or_default().trim().to_owned()
}

/// An element takes a byte of the file at least: a short file cannot promise many.
fn check_counts(header: &Header, len: usize) -> Result<(), String> {
    for (name, element) in &header.elements {
        if element.properties.is_empty() && element.count > 0 {
            return Err(format!("element {name} has no properties"));
        }
        if element.count > len {
            return Err(format!(
                "element {name} promises {} of them in {len} bytes",
                element.count
            ));
        }
    }
    Ok(())
}

/// Triangles of all faces that name vertices that exist.
fn fans(faces: &[Face], vertices: usize, notes: &mut Vec<Warning>) -> Vec<u32> {
    let mut indices = Vec::with_capacity(3 * faces.len());
    let mut dropped = 0usize;
    for face in faces {
        let corners = &face.corners;
        if corners.len() < 3 || corners.iter().any(|&i| i as usize >= vertices) {
            dropped += 1;
            continue;
        }
        for pair in corners[1..].windows(2) {
            indices.extend([corners[0], pair[0], pair[1]]);
        }
    }
    if dropped > 0 {
        let text = format!(
            "{dropped} of {} faces have fewer than three corners or name vertices that do not exist, and are left out",
            faces.len()
        );
        notes.push(Warning::new(Code::TrianglesUnusable, text));
    }
    indices
}

/// Names of texture coordinates.
const UVS: [[&str; 2]; 4] = [
    ["u", "v"],
    ["s", "t"],
    ["texture_u", "texture_v"],
    ["texture_s", "texture_t"],
];

#[derive(Default)]
struct Corner {
    position: [f32; 3],
    normal: [f32; 3],
    /// Linear.
    color: [f32; 3],
    uv: [f32; 2],
}

impl PropertyAccess for Corner {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(value) = property.to_f32_lossy() else {
            return PropertyAccessResult::Ignored;
        };
        let slot = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            "red" | "green" | "blue" => {
                let channel = ["red", "green", "blue"].iter().position(|c| *c == name);
                self.color[channel.unwrap_or(0)] = linear(&property, value);
                return PropertyAccessResult::Set;
            }
            _ => {
                let at = UVS
                    .iter()
                    .find_map(|pair| pair.iter().position(|n| *n == name));
                // Rows are counted from below.
                match at {
                    Some(0) => self.uv[0] = value,
                    Some(_) => self.uv[1] = 1.0 - value,
                    None => return PropertyAccessResult::Ignored,
                }
                return PropertyAccessResult::Set;
            }
        };
        *slot = value;
        PropertyAccessResult::Set
    }
}

/// A colour's channel, which PLY files hold as displays show it (IEC 61966-2-1).
fn linear(property: &Property, value: f32) -> f32 {
    let most = match property {
        Property::Float(_) | Property::Double(_) => 1.0,
        Property::UShort(_) | Property::Short(_) => 65535.0,
        _ => 255.0,
    };
    let x = (value / most).clamp(0.0, 1.0);
    if x <= 0.04045 {
        x / 12.92
    } else {
        ((x + 0.055) / 1.055).powf(2.4)
    }
}

#[derive(Default)]
struct Face {
    corners: Vec<u32>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        // Negative numbers name no vertex.
        self.corners = property.to_u32_list().unwrap_or_default();
        PropertyAccessResult::Set
    }
}

/// An element that is read and forgotten.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
