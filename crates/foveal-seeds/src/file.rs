//! A glTF file in the making.

use serde_json::{Value, json};

/// A glTF file in the making: JSON and one binary chunk.
#[derive(Clone, Debug)]
pub struct File {
    /// The document, without its buffers.
    pub json: Value,
    bin: Vec<u8>,
    /// Buffers after the binary chunk's own.
    pub more_buffers: Vec<Value>,
}

impl File {
    /// One node 0 with mesh 0, whose single primitive 0 has no attributes yet.
    #[must_use]
    pub fn with_mesh() -> Self {
        Self {
            json: json!({
                "asset": { "version": "2.0" },
                "scene": 0,
                "scenes": [{ "nodes": [0] }],
                "nodes": [{ "mesh": 0 }],
                "meshes": [{ "primitives": [{ "attributes": {} }] }],
                "accessors": [],
                "bufferViews": [],
            }),
            bin: Vec::new(),
            more_buffers: Vec::new(),
        }
    }

    /// The same with the triangle (0,0,0) (1,0,0) (0,1,0).
    #[must_use]
    pub fn with_triangle() -> Self {
        let mut file = Self::with_mesh();
        file.attribute("POSITION", &[0., 0., 0., 1., 0., 0., 0., 1., 0.], "VEC3");
        file
    }

    /// Appends a buffer view over raw bytes.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        self.bin.extend(bytes);
        self.push("bufferViews", view)
    }

    /// Appends an accessor over raw bytes.
    pub fn accessor(&mut self, bytes: &[u8], code: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        let accessor =
            json!({ "bufferView": view, "componentType": code, "type": kind, "count": count });
        self.push("accessors", accessor)
    }

    /// Appends an accessor over 32-bit floats of this glTF type.
    pub fn floats(&mut self, values: &[f32], kind: &str) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, 5126, kind, values.len() / width)
    }

    /// Gives the primitive indices of 16 bits.
    pub fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let accessor = self.accessor(&bytes, 5123, "SCALAR", values.len());
        self.primitive()["indices"] = json!(accessor);
        accessor
    }

    /// Gives the primitive an attribute of 32-bit floats.
    pub fn attribute(&mut self, name: &str, values: &[f32], kind: &str) -> usize {
        let accessor = self.floats(values, kind);
        self.primitive()["attributes"][name] = json!(accessor);
        accessor
    }

    /// Primitive 0 of mesh 0.
    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// Node 0.
    pub fn node(&mut self) -> &mut Value {
        &mut self.json["nodes"][0]
    }

    /// Appends to a list of the document; returns the new element's number.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    /// Adds a PNG picture with a texture of its own; returns the texture's number.
    pub fn texture(&mut self, picture: &image::RgbaImage) -> usize {
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        let view = self.view(bytes.get_ref());
        let image = self.push(
            "images",
            json!({ "bufferView": view, "mimeType": "image/png" }),
        );
        self.push("textures", json!({ "source": image }))
    }

    /// Adds a material, used by the primitive.
    pub fn material(&mut self, material: Value) {
        let number = self.push("materials", material);
        self.primitive()["material"] = json!(number);
    }

    /// The file's bytes.
    #[must_use]
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let own = json!({ "byteLength": self.bin.len() });
        json["buffers"] = std::iter::once(own)
            .chain(self.more_buffers.iter().cloned())
            .collect();
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut out = b"glTF".to_vec();
        out.extend(2u32.to_le_bytes());
        out.extend((28 + text.len() as u32 + bin.len() as u32).to_le_bytes());
        for (kind, chunk) in [(0x4E4F_534A_u32, text), (0x004E_4942, bin)] {
            out.extend((chunk.len() as u32).to_le_bytes());
            out.extend(kind.to_le_bytes());
            out.extend(chunk);
        }
        out
    }
}
