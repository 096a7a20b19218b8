//! The Stanford polygon format, text or binary. The crate `ply-rs-bw` reads binary elements.

use std::io::Cursor;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult,
};
use serde_json::json;

use super::builder::{Builder, plain_surface};
use super::obj::{LINES, POINTS, TRIANGLES};
use super::polygons::Polygons;
use super::{Converted, Refusal, check_memory, linear, ply_header, ply_text};
use crate::error::Limit;
use crate::gltf::BYTE_ORDER_MARK;
use crate::{Code, LoadOptions, Warning};

/// The mesh as one object; polygons are cut into triangles. Without faces and strips its edges become
/// lines, and without these its vertices points.
pub(super) fn convert(bytes: &[u8], options: &LoadOptions) -> Result<Converted, Refusal> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let found = ply_header::read(bytes)?;
    let header = &found.header;
    check_counts(header, bytes.len(), options)?;
    let mut rest = Cursor::new(bytes);
    rest.set_position(found.length as u64);
    let mut reader = Reader::new(rest);
    let (mut vertices, mut faces, mut edges) = (Vec::new(), Vec::new(), Vec::new());
    let mut strips = Vec::new();
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => vertices = elements(&mut reader, element, &found)?,
            "face" => faces = elements(&mut reader, element, &found)?,
            "edge" => edges = elements(&mut reader, element, &found)?,
            "tristrips" => strips = elements(&mut reader, element, &found)?,
            _ => {
                elements::<Skipped>(&mut reader, element, &found)?;
            }
        }
    }
    let has = |element: &str, key: &str| {
        let element = header.elements.get(element);
        element.is_some_and(|element| element.properties.contains_key(key))
    };
    let mut notes = Vec::new();
    let (mode, indices) = if !faces.is_empty() || !strips.is_empty() {
        let mut indices = triangles(&faces, &vertices, bytes.len(), &mut notes);
        add_strips(&strips, vertices.len(), &mut indices, &mut notes);
        (TRIANGLES, indices)
    } else if !edges.is_empty() {
        (LINES, segments(&edges, vertices.len(), &mut notes))
    } else {
        (POINTS, (0..vertices.len() as u32).collect())
    };
    for (key, what) in [("texcoord", "texture coordinates"), ("red", "colours")] {
        if has("face", key) {
            let text = format!("has {what} of faces, which are not read; those of vertices are");
            notes.push(Warning::new(Code::MaterialIgnored, text));
        }
    }
    let mut builder = Builder::default();
    if !indices.is_empty() {
        let list = |pick: fn(&Corner) -> [f32; 3]| -> Vec<[f32; 3]> {
            vertices.iter().map(pick).collect()
        };
        let mut attributes = json!({ "POSITION": builder.vectors(&list(|v| v.position)) });
        if has("vertex", "nx") {
            attributes["NORMAL"] = json!(builder.vectors(&list(|v| v.normal)));
        }
        if has("vertex", "red") || has("vertex", "diffuse_red") {
            attributes["COLOR_0"] = json!(builder.vectors(&list(|v| v.color)));
        } else if ["r", "g", "b"].iter().all(|key| has("vertex", key)) {
            attributes["COLOR_0"] = json!(builder.vectors(&list(|v| v.rgb)));
        }
        let is_mapped = UVS.iter().any(|[u, _]| has("vertex", u));
        if is_mapped {
            let uv: Vec<[f32; 2]> = vertices.iter().map(|v| v.uv).collect();
            attributes["TEXCOORD_0"] = json!(builder.vectors(&uv));
        }
        let mut surface = plain_surface();
        let named = |comment: &String| {
            let file = comment.trim().strip_prefix("TextureFile")?.trim();
            (!file.is_empty()).then(|| file.to_owned())
        };
        let file = header.comments.iter().find_map(named);
        if let Some(file) = file.filter(|_| is_mapped) {
            let texture = json!({ "index": builder.texture("", &file) });
            surface["pbrMetallicRoughness"]["baseColorTexture"] = texture;
        }
        let mut primitive = json!({
            "attributes": attributes, "mode": mode, "material": builder.material(&surface)
        });
        if mode != POINTS {
            primitive["indices"] = json!(builder.indices(&indices));
        }
        builder.object("", vec![primitive]);
    }
    builder.finish(notes)
}

/// Reads all elements of a kind.
fn elements<E: PropertyAccess>(
    reader: &mut Reader<Cursor<&[u8]>>,
    kind: &ElementDef,
    found: &ply_header::Found,
) -> Result<Vec<E>, String> {
    if found.header.encoding == Encoding::Ascii {
        return ply_text::elements(reader.get_mut(), kind, found.line_end);
    }
    let read = Parser::new().read_payload_for_element(reader, kind, &found.header);
    read.map_err(|error| short(&error))
}

/// The parser's message without the file's own text, and without a line, which binary elements have
/// none of.
fn short(error: &ply_rs_bw::parser::ParseError) -> String {
    let text = error.to_string();
    let text = text.lines().next().unwrap_or_default().trim();
    let behind_line = error.line().and_then(|_| text.split_once(": "));
    behind_line.map_or(text, |(_, said)| said).to_owned()
}

/// An element takes a byte of the file at least: a short file cannot promise many.
fn check_counts(header: &Header, len: usize, options: &LoadOptions) -> Result<(), Refusal> {
    for (name, element) in &header.elements {
        let count = element.count;
        if element.properties.is_empty() && count > 0 {
            return Err(format!("element {name} has no properties").into());
        }
        if count > len {
            return Err(format!("element {name} promises {count} of them in {len} bytes").into());
        }
        let (limit, most) = match name.as_str() {
            "vertex" => (Limit::Vertices, options.max_vertices),
            "face" | "edge" => (Limit::Triangles, options.max_triangles),
            _ => continue,
        };
        if count as u64 > most {
            let cause = format!("wants {count} elements {name}; the limit is {most}");
            return Err(Refusal::TooLarge(Some(limit), cause));
        }
    }
    let vertices = header.elements.get("vertex").map_or(0, |e| e.count);
    let faces = header.elements.get("face").map_or(0, |e| e.count);
    let edges = header.elements.get("edge").map_or(0, |e| e.count);
    let (corner, face) = (size_of::<Corner>() as u64 + 80, 64);
    check_memory("vertices", vertices, corner, len, options)?;
    check_memory("edges", edges, face, len, options)?;
    check_memory("faces", faces, face, len, options)
}

/// Lines of all edges that name vertices that exist.
fn segments(edges: &[Edge], vertices: usize, notes: &mut Vec<Warning>) -> Vec<u32> {
    let is_there = |edge: &&Edge| edge.ends.iter().all(|&end| (end as usize) < vertices);
    let indices: Vec<u32> = (edges.iter().filter(is_there))
        .flat_map(|edge| edge.ends)
        .collect();
    let dropped = edges.len() - indices.len() / 2;
    if dropped > 0 {
        let text = format!(
            "{dropped} of {} edges name vertices that do not exist, and are left out",
            edges.len()
        );
        notes.push(Warning::new(Code::TrianglesUnusable, text));
    }
    indices
}

/// Triangles of all faces that name vertices that exist, in a file of so many bytes.
fn triangles(
    faces: &[Face],
    vertices: &[Corner],
    file_bytes: usize,
    notes: &mut Vec<Warning>,
) -> Vec<u32> {
    let mut indices = Vec::with_capacity(3 * faces.len());
    let mut polygons = Polygons::of_file(file_bytes);
    let mut places = Vec::new();
    let mut dropped = 0usize;
    for face in faces {
        let corners = &face.corners;
        let found = corners.iter().map_while(|&i| vertices.get(i as usize));
        places.clear();
        places.extend(found.map(|vertex| vertex.position));
        if corners.len() < 3 || places.len() < corners.len() {
            dropped += 1;
            continue;
        }
        polygons.cut(&places, |triangle| {
            indices.extend(triangle.map(|i| corners[i]));
        });
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

/// Adds the triangles of strips, every second of which turns the other way.
fn add_strips(strips: &[Strip], vertices: usize, indices: &mut Vec<u32>, notes: &mut Vec<Warning>) {
    let (mut count, mut dropped) = (0usize, 0usize);
    let runs = strips
        .iter()
        .flat_map(|s| s.corners.split(|&i| i == Strip::END));
    for run in runs {
        for (number, corners) in run.windows(3).enumerate() {
            let &[a, b, c] = corners else { continue };
            // Strips turn and go on by triangles without area.
            if a == b || b == c || c == a {
                continue;
            }
            count += 1;
            if [a, b, c].iter().any(|&i| i as usize >= vertices) {
                dropped += 1;
                continue;
            }
            indices.extend(if number % 2 == 0 {
                [a, b, c]
            } else {
                [b, a, c]
            });
        }
    }
    if dropped > 0 {
        let text = format!(
            "{dropped} of {count} triangles of strips name vertices that do not exist, and are left out"
        );
        notes.push(Warning::new(Code::TrianglesUnusable, text));
    }
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
    /// The same by short names, which may mean something else: a radius.
    rgb: [f32; 3],
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
            "red" | "diffuse_red" => return set_color(&mut self.color[0], &property, value),
            "green" | "diffuse_green" => return set_color(&mut self.color[1], &property, value),
            "blue" | "diffuse_blue" => return set_color(&mut self.color[2], &property, value),
            "r" => return set_color(&mut self.rgb[0], &property, value),
            "g" => return set_color(&mut self.rgb[1], &property, value),
            "b" => return set_color(&mut self.rgb[2], &property, value),
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

/// Sets a colour's channel.
fn set_color(slot: &mut f32, property: &Property, value: f32) -> PropertyAccessResult {
    *slot = linear(channel(property, value));
    PropertyAccessResult::Set
}

/// A colour's channel from 0 to 1.
fn channel(property: &Property, value: f32) -> f32 {
    match property {
        Property::Float(_) | Property::Double(_) => value,
        Property::UShort(_) | Property::Short(_) => value / 65535.0,
        _ => value / 255.0,
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

/// Vertices of triangle strips.
#[derive(Default)]
struct Strip {
    corners: Vec<u32>,
}

impl Strip {
    /// The end of a strip: -1 in the file.
    const END: u32 = u32::MAX;
}

impl PropertyAccess for Strip {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        self.corners = match property {
            Property::ListInt(list) => list.into_iter().map(|i| i as u32).collect(),
            Property::ListShort(list) => list.into_iter().map(|i| i32::from(i) as u32).collect(),
            Property::ListChar(list) => list.into_iter().map(|i| i32::from(i) as u32).collect(),
            other => other.to_u32_list().unwrap_or_default(),
        };
        PropertyAccessResult::Set
    }
}

struct Edge {
    ends: [u32; 2],
}

impl PropertyAccess for Edge {
    fn new() -> Self {
        Self {
            ends: [u32::MAX; 2],
        }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let end = match name {
            "vertex1" => 0,
            "vertex2" => 1,
            _ => return PropertyAccessResult::Ignored,
        };
        // Negative numbers, and what is none, name no vertex.
        let number = match property {
            Property::Char(n) => u32::try_from(n).ok(),
            Property::Short(n) => u32::try_from(n).ok(),
            Property::Int(n) => u32::try_from(n).ok(),
            Property::UChar(n) => Some(n.into()),
            Property::UShort(n) => Some(n.into()),
            Property::UInt(n) => Some(n),
            _ => None,
        };
        self.ends[end] = number.unwrap_or(u32::MAX);
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
