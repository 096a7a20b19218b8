//! Compressed geometry and pictures, made here by the libraries' encoders.

use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, Mesh, MeshEncoder,
    PointAttribute, PointIndex,
};
use serde_json::json;

use super::{File, warnings};

/// A bumpy grid of 8 x 8 quads.
fn grid() -> (Vec<[f32; 3]>, Vec<u32>) {
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
fn plain() -> File {
    let (points, indices) = grid();
    let mut file = File::with_mesh();
    file.attribute("POSITION", points.as_flattened(), "VEC3");
    let narrow: Vec<u16> = indices.iter().map(|&i| i as u16).collect();
    file.indices(&narrow);
    file
}

/// All triangles as sorted corners, whatever order they are stored in.
fn triangles(file: &File) -> Vec<[[i32; 3]; 3]> {
    let scene = file.load();
    assert_eq!(warnings(&scene), "");
    let mesh = &scene.meshes[0];
    let corner = |&i: &u32| {
        mesh.vertices[i as usize]
            .position
            .map(|v| (v * 100.0).round() as i32)
    };
    let mut all: Vec<[[i32; 3]; 3]> = mesh
        .indices
        .chunks_exact(3)
        .map(|t| {
            let mut corners = [corner(&t[0]), corner(&t[1]), corner(&t[2])];
            corners.sort_unstable();
            corners
        })
        .collect();
    all.sort_unstable();
    all
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

pub(super) fn meshopt_file(name: &str, version: i32) -> File {
    let (points, indices) = grid();
    let mut file = plain();
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

#[test]
fn views_compressed_by_meshopt_give_the_same_triangles() {
    let expected = triangles(&plain());
    for (name, version) in [
        ("EXT_meshopt_compression", 0),
        ("KHR_meshopt_compression", 0),
        ("KHR_meshopt_compression", 1),
    ] {
        assert_eq!(triangles(&meshopt_file(name, version)), expected, "{name}");
    }
}

#[test]
fn broken_meshopt_data_are_named_with_their_view() {
    for (key, value, cause) in [
        ("byteLength", json!(40), "its meshopt data are broken"),
        ("byteOffset", json!(1_u64 << 40), "end beyond their buffer"),
        ("mode", json!("MAGIC"), "\"MAGIC\" is not a mode"),
        ("byteStride", json!(7), "7 bytes"),
        ("filter", json!("OCTAHEDRAL"), "does not allow"),
        (
            "count",
            json!(u32::MAX),
            "wants 51.5 GB for decompressed data",
        ),
    ] {
        let mut file = meshopt_file("EXT_meshopt_compression", 0);
        file.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
        let text = file.refusal();
        assert!(
            text.contains("bufferViews[0]") && text.contains(cause),
            "{text}"
        );
    }
}

/// The grid's Draco stream, by the method that follows edges (speed 5) or without prediction (speed
/// 10).
pub(super) fn draco_stream(speed: i32) -> Vec<u8> {
    let (points, indices) = grid();
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

pub(super) fn draco_file(stream: &[u8]) -> File {
    let (points, indices) = grid();
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

#[test]
fn primitives_compressed_by_draco_give_the_same_triangles() {
    let expected = triangles(&plain());
    for speed in [0, 5, 10] {
        assert_eq!(
            triangles(&draco_file(&draco_stream(speed))),
            expected,
            "speed {speed}"
        );
    }
}

#[test]
fn streams_of_indices_alone_are_read() {
    let mut file = plain();
    // A header, 2 triangles, 0 points, indices of a byte each, no attributes.
    let stream = b"DRACO\x02\x02\x01\0\0\0\x02\0\x01\x00\x01\x09\x09\x01\x0a\0";
    let view = file.view(stream);
    let index = file.push(
        "accessors",
        json!({ "componentType": 5123, "type": "SCALAR", "count": 6 }),
    );
    file.primitive()["indices"] = json!(index);
    file.primitive()["extensions"] = json!({ "KHR_draco_mesh_compression": {
        "bufferView": view, "attributes": {},
    } });
    assert_eq!(triangles(&file).len(), 2);
}

#[test]
fn broken_draco_data_are_named_with_their_primitive() {
    let stream = draco_stream(5);
    for end in (0..stream.len()).step_by(7) {
        let text = draco_file(&stream[..end]).refusal();
        assert!(
            text.contains("meshes[0].primitives[0]") && text.contains("Draco data"),
            "{text}"
        );
    }
    let mut file = draco_file(&stream);
    file.json["accessors"][0]["count"] = json!(4_000_000_000_u32);
    let text = file.refusal();
    assert!(text.contains("for Draco meshes"), "{text}");
    // Fewer points than the accessor promises.
    let mut file = draco_file(&stream);
    file.json["accessors"][0]["count"] = json!(500);
    assert!(file.refusal().contains("accessors[0] 500 of 3"));
    // An attribute that the stream does not have.
    let mut file = draco_file(&stream);
    let extension = &mut file.primitive()["extensions"]["KHR_draco_mesh_compression"];
    extension["attributes"]["POSITION"] = json!(9);
    assert!(file.refusal().contains("has no attribute 9"));
}

#[test]
fn changed_draco_data_never_fail_the_importer() {
    let stream = draco_stream(5);
    for i in 0..stream.len() {
        for value in [0, 0xFF, stream[i] ^ 1] {
            let mut changed = stream.clone();
            changed[i] = value;
            let outcome = draco_file(&changed).load_with(&crate::LoadOptions::default());
            if let Err(error) = outcome {
                let text = error.to_string();
                assert!(!text.contains("the importer failed"), "{text}");
            }
        }
    }
}

#[test]
fn a_plain_copy_is_preferred_to_a_stream() {
    let mut file = plain();
    let view = file.view(b"not Draco");
    file.primitive()["extensions"] = json!({ "KHR_draco_mesh_compression": {
        "bufferView": view, "attributes": { "POSITION": 0 },
    } });
    assert_eq!(triangles(&file), triangles(&plain()));
}

fn gradient() -> image::RgbaImage {
    image::RgbaImage::from_fn(8, 4, |x, y| {
        image::Rgba([x as u8 * 30, y as u8 * 60, 9, 255])
    })
}

/// A triangle with a WebP picture and a PNG in its place for readers that know no WebP.
pub(super) fn webp_file() -> File {
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
    file.material(json!({ "emissiveTexture": { "index": texture } }));
    file
}

#[test]
fn webp_pictures_are_read_and_preferred_to_their_stand_in() {
    let scene = webp_file().load();
    assert_eq!(warnings(&scene), "");
    assert_eq!(scene.textures[0].levels[0], gradient().into_raw());
}

#[test]
fn formats_that_are_not_read_say_how_to_convert_them() {
    for (bytes, cause) in [
        (&b"\0\0\0\x1cftypavif"[..], "AVIF"),
        (&b"GIF89a"[..], "neither PNG nor JPEG nor WebP nor KTX2"),
    ] {
        let mut file = File::with_triangle();
        let view = file.view(bytes);
        file.push("images", json!({ "bufferView": view }));
        file.push("textures", json!({ "source": 0 }));
        file.material(json!({ "emissiveTexture": { "index": 0 } }));
        let said = warnings(&file.load());
        assert!(said.contains(cause), "{said}");
    }
}
