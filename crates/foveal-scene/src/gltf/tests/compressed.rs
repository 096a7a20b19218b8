//! Compressed geometry and pictures, made here by the libraries' encoders.

use foveal_seeds::{draco_file, draco_stream, gradient, grid_file, meshopt_file, webp_file};
use serde_json::json;

use super::{File, Loads, warnings};

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

#[test]
fn views_compressed_by_meshopt_give_the_same_triangles() {
    let expected = triangles(&grid_file());
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

#[test]
fn primitives_compressed_by_draco_give_the_same_triangles() {
    let expected = triangles(&grid_file());
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
    let mut file = grid_file();
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
    let mut file = grid_file();
    let view = file.view(b"not Draco");
    file.primitive()["extensions"] = json!({ "KHR_draco_mesh_compression": {
        "bufferView": view, "attributes": { "POSITION": 0 },
    } });
    assert_eq!(triangles(&file), triangles(&grid_file()));
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
