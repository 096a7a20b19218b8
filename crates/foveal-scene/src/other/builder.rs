//! A GLB file in the making.

use std::collections::HashMap;
use std::fmt::{Display, Write as _};
use std::path::Path;

use serde_json::json;

use super::lines::unquoted;
use super::{Converted, Refusal};
use crate::Warning;

/// Component types of accessors (glTF 2.0 specification, section 3.6.2.2).
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// A list of JSON, as text: trees of it would take many times the memory.
#[derive(Default)]
struct List {
    text: String,
    len: usize,
}

impl List {
    /// Adds an entry and returns its number.
    fn push(&mut self, entry: impl Display) -> usize {
        let comma = if self.len == 0 { "" } else { "," };
        let _ = write!(self.text, "{comma}{entry}");
        self.len += 1;
        self.len - 1
    }
}

/// Lists of a glTF document, and its binary part.
#[derive(Default)]
pub(super) struct Builder {
    bin: Vec<u8>,
    views: List,
    accessors: List,
    images: List,
    textures: List,
    materials: List,
    meshes: List,
    nodes: List,
    texture_of: HashMap<String, usize>,
    /// Of paths of pictures: where a picture may lie instead, in order.
    elsewhere: HashMap<String, Vec<String>>,
}

/// What has no material of its own: no metal, and seen from both sides.
pub(super) fn plain_surface() -> serde_json::Value {
    json!({ "pbrMetallicRoughness": { "metallicFactor": 0 }, "doubleSided": true })
}

impl Builder {
    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let (start, len) = (self.bin.len(), bytes.len());
        let view = self.views.push(format_args!(
            "{{\"buffer\":0,\"byteOffset\":{start},\"byteLength\":{len}}}"
        ));
        self.bin.extend_from_slice(bytes);
        self.accessors.push(format_args!(
            "{{\"bufferView\":{view},\"componentType\":{component},\"count\":{count},\"type\":\"{kind}\"}}"
        ))
    }

    /// Vectors of `N` numbers each.
    pub(super) fn vectors<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let numbers: &[f32] = values.as_flattened();
        self.accessor(bytemuck::cast_slice(numbers), FLOAT, kind, values.len())
    }

    pub(super) fn indices(&mut self, values: &[u32]) -> usize {
        let bytes = bytemuck::cast_slice(values);
        self.accessor(bytes, UNSIGNED_INT, "SCALAR", values.len())
    }

    /// The number of a texture that shows the picture in a file: in `folder`, else beside the scene. A
    /// picture whose own folders are not there, as those of another machine, is looked for without them.
    pub(super) fn texture(&mut self, folder: &str, file: &str) -> usize {
        // Exporters for Windows write its separators.
        let file = unquoted(file).replace('\\', "/");
        let name = file.rsplit('/').next().unwrap_or_default();
        let within = |file: &str| match folder {
            "" => file.to_owned(),
            _ => format!("{folder}/{file}"),
        };
        let path = match Path::new(&file).has_root() {
            true => file.clone(),
            false => within(&file),
        };
        let mut others = vec![file.clone(), within(name), name.to_owned()];
        others.retain(|other| *other != path);
        others.dedup();
        if let Some(number) = self.texture_of.get(&path) {
            return *number;
        }
        let uri = percent_encoding::utf8_percent_encode(&path, ESCAPED).to_string();
        let image = self.images.push(json!({ "uri": uri }));
        let number = self.textures.push(json!({ "source": image }));
        self.elsewhere.insert(path.clone(), others);
        self.texture_of.insert(path, number);
        number
    }

    pub(super) fn material(&mut self, material: &serde_json::Value) -> usize {
        self.materials.push(material)
    }

    /// A mesh of these primitives, of at least one, at a node of its own.
    pub(super) fn object(&mut self, name: &str, primitives: Vec<serde_json::Value>) {
        let name = json!(name);
        let primitives = serde_json::Value::from(primitives);
        let mesh = self.meshes.push(format_args!(
            "{{\"name\":{name},\"primitives\":{primitives}}}"
        ));
        self.nodes
            .push(format_args!("{{\"name\":{name},\"mesh\":{mesh}}}"));
    }

    /// The file, and what it leaves out; an error where it has more bytes than a GLB may have.
    pub(super) fn finish(mut self, notes: Vec<Warning>) -> Result<Converted, Refusal> {
        let elsewhere = std::mem::take(&mut self.elsewhere);
        let too_large = |cause| Refusal::TooLarge(None, cause);
        Ok(Converted {
            glb: self.glb().map_err(too_large)?,
            notes,
            elsewhere,
        })
    }

    fn glb(mut self) -> Result<Vec<u8>, String> {
        let mut roots = List::default();
        for node in 0..self.nodes.len {
            roots.push(node);
        }
        let mut json = String::from("{\"asset\":{\"version\":\"2.0\"},\"scene\":0");
        let _ = write!(json, ",\"scenes\":[{{\"nodes\":[{}]}}]", roots.text);
        for (name, list) in [
            ("nodes", &self.nodes),
            ("meshes", &self.meshes),
            ("materials", &self.materials),
            ("textures", &self.textures),
            ("images", &self.images),
            ("accessors", &self.accessors),
            ("bufferViews", &self.views),
        ] {
            let _ = write!(json, ",\"{name}\":[{}]", list.text);
        }
        if !self.bin.is_empty() {
            let len = self.bin.len();
            let _ = write!(json, ",\"buffers\":[{{\"byteLength\":{len}}}]");
        }
        json.push('}');
        let mut json = json.into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let of_bin = if self.bin.is_empty() {
            0
        } else {
            8 + self.bin.len()
        };
        let total = 12 + 8 + json.len() + of_bin;
        let total = u32::try_from(total).map_err(|_| "takes more than 4 GB as glTF".to_owned())?;
        let mut out = Vec::with_capacity(total as usize);
        let words = |out: &mut Vec<u8>, words: &[u32]| {
            for word in words {
                out.extend_from_slice(&word.to_le_bytes());
            }
        };
        words(&mut out, &[0x4654_6C67, 2, total]);
        words(&mut out, &[json.len() as u32, 0x4E4F_534A]);
        out.append(&mut json);
        if !self.bin.is_empty() {
            words(&mut out, &[self.bin.len() as u32, 0x004E_4942]);
            out.append(&mut self.bin);
        }
        Ok(out)
    }
}

/// What a URI's path may not hold as it is.
const ESCAPED: &percent_encoding::AsciiSet = &percent_encoding::CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b':')
    .add(b'<')
    .add(b'>')
    .add(b'?');
