//! A GLB file in the making.

use serde_json::{Value, json};

/// Component types of accessors (glTF 2.0 specification, section 3.6.2.2).
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Lists of a glTF document, and its binary part.
#[derive(Default)]
pub(super) struct Builder {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    images: Vec<Value>,
    textures: Vec<Value>,
    pub(super) materials: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

impl Builder {
    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()
        }));
        self.bin.extend_from_slice(bytes);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": component, "count": count,
            "type": kind
        }));
        self.accessors.len() - 1
    }

    /// Vectors of `N` numbers each.
    pub(super) fn vectors<const N: usize>(&mut self, values: &[f32]) -> usize {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        self.accessor(bytemuck::cast_slice(values), FLOAT, kind, values.len() / N)
    }

    pub(super) fn indices(&mut self, values: &[u32]) -> usize {
        let bytes = bytemuck::cast_slice(values);
        self.accessor(bytes, UNSIGNED_INT, "SCALAR", values.len())
    }

    /// The number of a texture that shows the picture in a file beside the scene.
    pub(super) fn texture(&mut self, file: &str) -> usize {
        // Exporters for Windows write its separators.
        let uri = file.replace('\\', "/");
        let uri = percent_encoding::utf8_percent_encode(&uri, ESCAPED).to_string();
        let known = self.images.iter().position(|image| image["uri"] == *uri);
        known.unwrap_or_else(|| {
            self.images.push(json!({ "uri": uri }));
            self.textures
                .push(json!({ "source": self.images.len() - 1 }));
            self.textures.len() - 1
        })
    }

    /// A mesh of one primitive at a node of its own.
    pub(super) fn object(&mut self, name: &str, primitive: Value) {
        self.meshes
            .push(json!({ "name": name, "primitives": [primitive] }));
        self.nodes
            .push(json!({ "name": name, "mesh": self.meshes.len() - 1 }));
    }

    /// The file's bytes; an error where they are more than a GLB may have.
    pub(super) fn glb(mut self) -> Result<Vec<u8>, String> {
        let mut root = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": (0..self.nodes.len()).collect::<Vec<_>>() }],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "textures": self.textures,
            "images": self.images,
            "accessors": self.accessors,
            "bufferViews": self.views,
        });
        if !self.bin.is_empty() {
            root["buffers"] = json!([{ "byteLength": self.bin.len() }]);
        }
        let mut json = root.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let of_bin = if self.bin.is_empty() {
            0
        } else {
            8 + self.bin.len()
        };
        let total = 12 + 8 + json.len() + of_bin;
        let total = u32::try_from(total).map_err(|_| "it is larger than 4 GB".to_owned())?;
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
