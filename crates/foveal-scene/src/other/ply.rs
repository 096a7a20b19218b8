//! The Stanford polygon format, text or binary. The crate `ply-rs-bw` reads binary elements.

use std::io::Cursor;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess};
use serde_json::json;

use super::builder::{Builder, plain_surface};
use super::obj::{LINES, POINTS, TRIANGLES};
use super::ply_elements::{Corner, Edge, Face, Skipped, Strip, UVS};
use super::ply_faces::{give_own_uvs, triangles};
use super::{Converted, Refusal, check_memory, ply_header, ply_text};
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
    let has_own_uvs = has("face", "texcoord") && strips.is_empty() && !faces.is_empty();
    if has_own_uvs {
        let corners = faces.iter().map(|face: &Face| face.corners.len()).sum();
        let each = size_of::<Corner>() as u64 + 112;
        check_memory("corners of faces", corners, each, bytes.len(), options)?;
        give_own_uvs(&mut vertices, &mut faces);
    }
    let is_mapped = has_own_uvs || UVS.iter().any(|[u, _]| has("vertex", u));
    let files = if is_mapped {
        texture_files(header)
    } else {
        Vec::new()
    };
    // The indices of each texture, and of none.
    let (mode, parts) = if !faces.is_empty() || !strips.is_empty() {
        let mut parts = triangles(&faces, &vertices, files.len(), bytes.len(), &mut notes);
        add_strips(&strips, vertices.len(), &mut parts[0], &mut notes);
        (TRIANGLES, parts)
    } else if !edges.is_empty() {
        (LINES, vec![segments(&edges, vertices.len(), &mut notes)])
    } else {
        (POINTS, vec![(0..vertices.len() as u32).collect()])
    };
    let unread = [
        (
            has("face", "texcoord") && !strips.is_empty(),
            "texture coordinates",
        ),
        (has("face", "red"), "colours"),
    ];
    for (_, what) in unread.into_iter().filter(|(is_there, _)| *is_there) {
        let text = format!("has {what} of faces, which are not read; those of vertices are");
        notes.push(Warning::new(Code::MaterialIgnored, text));
    }
    let mut builder = Builder::default();
    if parts.iter().any(|indices| !indices.is_empty()) {
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
        if is_mapped {
            let uv: Vec<[f32; 2]> = vertices.iter().map(|v| v.uv).collect();
            attributes["TEXCOORD_0"] = json!(builder.vectors(&uv));
        }
        let mut primitives = Vec::new();
        let parts = (0..).zip(&parts);
        for (number, indices) in parts.filter(|(_, indices)| !indices.is_empty()) {
            let mut surface = plain_surface();
            if let Some(file) = files.get(number) {
                let texture = json!({ "index": builder.texture("", file) });
                surface["pbrMetallicRoughness"]["baseColorTexture"] = texture;
            }
            let mut primitive = json!({
                "attributes": attributes, "mode": mode, "material": builder.material(&surface)
            });
            if mode != POINTS {
                primitive["indices"] = json!(builder.indices(indices));
            }
            primitives.push(primitive);
        }
        builder.object("", primitives);
    }
    builder.finish(notes)
}

/// The pictures that comments name.
fn texture_files(header: &Header) -> Vec<String> {
    let named = |comment: &String| {
        let file = comment.trim().strip_prefix("TextureFile")?.trim();
        (!file.is_empty()).then(|| file.to_owned())
    };
    header.comments.iter().filter_map(named).collect()
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
