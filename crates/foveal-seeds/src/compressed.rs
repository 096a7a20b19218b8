//! Compressed geometry and pictures, by the libraries' own encoders.

use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, Mesh, MeshEncoder,
    PointAttribute, PointIndex,
};
use serde_json::json;

use crate::file::File;

/// A bumpy grid of 8 x 8 quads.
#[must_use]
pub fn bumpy_grid() -> (Vec<[f32; 3]>, Vec<u32>) {
    let point = |i: u32| {
        let (x, y) = ((i % 9) as f32, (i / 9) as f32);
        [x, y, (x * 1.7).sin() + (y * 0.9).cos()]
    };
    let mut indices = Vec::new();
    for y in 0..8 {
        for x in 0..8 {
            let a = y * 9 + x;
            indices.extend([a, a + 1, a + 9, a + 9, a + 1, a + 10]);
        }
    }
    ((0..81).map(point).collect(), indices)
}

/// The grid without compression.
#[must_use]
pub fn grid_file() -> File {
    let (points, indices) = bumpy_grid();
    let mut file = File::with_mesh();
    file.attribute("POSITION", points.as_flattened(), "VEC3");
    let narrow: Vec<u16> = indices.iter().map(|&i| i as u16).collect();
    file.indices(&narrow);
    file
}

/// Puts compressed bytes behind a view of a buffer that exists only for readers without the
/// extension.
fn compress(file: &mut File, view: usize, name: &str, bytes: &[u8], stride: usize, mode: &str) {
    let at = file.view(bytes);
    let stored = file.json["bufferViews"][at].clone();
    let plain = file.json["bufferViews"][view]["byteLength"]
        .as_u64()
        .unwrap() as usize;
    file.json["bufferViews"][view] = json!({
        "buffer": 1, "byteOffset": 0, "byteLength": plain,
        "extensions": { name: {
            "buffer": 0, "byteOffset": stored["byteOffset"], "byteLength": bytes.len(),
            "byteStride": stride, "count": plain / stride, "mode": mode,
        } },
    });
}

/// The grid compressed by this extension, in this version of meshopt's format.
#[must_use]
pub fn meshopt_file(name: &str, version: i32) -> File {
    let (points, indices) = bumpy_grid();
    let mut file = grid_file();
    let packed = meshopt::encode_vertex_buffer_level(&points, 2, Some(version)).unwrap();
    compress(&mut file, 0, name, &packed, 12, "ATTRIBUTES");
    let packed = meshopt::encode_index_buffer(&indices, points.len()).unwrap();
    compress(&mut file, 1, name, &packed, 2, "TRIANGLES");
    file.more_buffers =
        vec![json!({ "byteLength": 4096, "extensions": { name: { "fallback": true } } })];
    file.json["extensionsRequired"] = json!([name]);
    file.json["extensionsUsed"] = json!([name]);
    file
}

/// The grid's Draco stream, by the method that follows edges (speed 5) or without prediction (speed
/// 10).
#[must_use]
pub fn draco_stream(speed: i32) -> Vec<u8> {
    let (points, indices) = bumpy_grid();
    let mut position = PointAttribute::new();
    let count = points.len();
    position.init(
        GeometryAttributeType::Position,
        3,
        DataType::Float32,
        false,
        count,
    );
    for (i, point) in points.iter().enumerate() {
        let bytes: Vec<u8> = point.iter().flat_map(|v| v.to_le_bytes()).collect();
        position.buffer_mut().write(i * 12, &bytes);
    }
    let mut mesh = Mesh::new();
    mesh.add_attribute(position);
    mesh.set_num_faces(indices.len() / 3);
    for (i, t) in indices.chunks_exact(3).enumerate() {
        let face = [PointIndex(t[0]), PointIndex(t[1]), PointIndex(t[2])];
        mesh.set_face(FaceIndex(i as u32), face);
    }
    let mut options = EncoderOptions::new();
    options.set_compression_level(10 - speed);
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut out = EncoderBuffer::new();
    encoder.encode(&options, &mut out).unwrap();
    out.data().to_vec()
}

/// A file around a Draco stream of the grid.
#[must_use]
pub fn draco_file(stream: &[u8]) -> File {
    let (points, indices) = bumpy_grid();
    let mut file = File::with_mesh();
    let view = file.view(stream);
    let position = file.push(
        "accessors",
        json!({ "componentType": 5126, "type": "VEC3", "count": points.len() }),
    );
    let index = file.push(
        "accessors",
        json!({ "componentType": 5123, "type": "SCALAR", "count": indices.len() }),
    );
    *file.primitive() = json!({
        "attributes": { "POSITION": position },
        "indices": index,
        "extensions": { "KHR_draco_mesh_compression": {
            "bufferView": view, "attributes": { "POSITION": 0 },
        } },
    });
    file.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    file
}

/// A picture of 8 x 4 texels, all different.
#[must_use]
pub fn gradient() -> image::RgbaImage {
    image::RgbaImage::from_fn(8, 4, |x, y| {
        image::Rgba([x as u8 * 30, y as u8 * 60, 9, 255])
    })
}

/// A triangle with a WebP picture and a PNG in its place for readers that know no WebP.
#[must_use]
pub fn webp_file() -> File {
    let mut bytes = std::io::Cursor::new(Vec::new());
    gradient()
        .write_to(&mut bytes, image::ImageFormat::WebP)
        .unwrap();
    let mut file = File::with_triangle();
    let texture = file.texture(&image::RgbaImage::new(1, 1));
    let view = file.view(bytes.get_ref());
    let webp = file.push(
        "images",
        json!({ "bufferView": view, "mimeType": "image/webp" }),
    );
    file.json["textures"][texture]["extensions"] =
        json!({ "EXT_texture_webp": { "source": webp } });
    file.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
    file.attribute("TEXCOORD_0", &[0., 0., 1., 0., 0., 1.], "VEC2");
    file.material(json!({ "emissiveTexture": { "index": texture } }));
    file
}
