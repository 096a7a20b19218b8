//! Input that means harm, or might as well.

use foveal_seeds::{crc32, rich};
use proptest::prelude::*;
use serde_json::json;

use super::{File, Loads, warnings};
use crate::{Limit, LoadOptions, SceneError, load_bytes};

fn ask(bytes: &[u8]) -> Result<crate::Scene, SceneError> {
    let options = LoadOptions {
        max_vertices: 1 << 20,
        max_texture_bytes: 1 << 24,
        ..LoadOptions::default()
    };
    load_bytes(bytes, "x", &options, &|_| Err("no files".into()))
}

fn is_internal(error: &SceneError) -> bool {
    matches!(error, SceneError::Internal { .. })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), glb: bool) {
        let mut bytes = bytes;
        if glb {
            let mut header = b"glTF\x02\0\0\0".to_vec();
            header.extend((bytes.len() as u32 + 12).to_le_bytes());
            header.append(&mut bytes);
            bytes = header;
        }
        let internal = matches!(ask(&bytes), Err(SceneError::Internal { .. }));
        prop_assert!(!internal);
    }

    #[test]
    fn random_changes_to_a_good_file_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::weighted(0.1, any::<prop::sample::Index>()),
    ) {
        let mut bytes = rich().glb();
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        match ask(&bytes) {
            Ok(mut scene) => scene.pose(0.3),
            Err(error) => prop_assert!(!is_internal(&error), "{}", error),
        }
    }

    #[test]
    fn random_numbers_in_the_json_never_panic(
        change in any::<prop::sample::Index>(),
        number in prop::sample::select(vec![
            "-1", "0", "1", "3", "5", "255", "65536", "4294967295", "4294967296",
            "9223372036854775807", "18446744073709551615", "1e300", "0.5", "null", "[]", "{}",
        ]),
    ) {
        let json = serde_json::to_string(&rich().json).unwrap();
        let starts: Vec<usize> = json
            .char_indices()
            .zip(json.chars().skip(1))
            .filter(|((_, a), b)| ":[,".contains(*a) && (b.is_ascii_digit() || *b == '-'))
            .map(|((i, _), _)| i + 1)
            .collect();
        let start = starts[change.index(starts.len())];
        let len = json[start..].find([',', ']', '}']).unwrap();
        let changed = format!("{}{number}{}", &json[..start], &json[start + len..]);
        let mut file = rich();
        file.json = serde_json::from_str(&changed).unwrap();
        match ask(&file.glb()) {
            Ok(mut scene) => scene.pose(0.3),
            Err(error) => prop_assert!(!is_internal(&error), "{}", error),
        }
    }
}

#[test]
fn the_rich_file_is_good() {
    let scene = rich().load();
    assert!(scene.is_animated() && scene.cameras.len() == 1 && scene.objects.len() == 2);
}

#[test]
fn a_hundred_thousand_nodes_deep_is_no_stack_overflow() {
    let mut file = File::with_triangle();
    let depth = 100_000;
    let nodes: Vec<_> = (0..depth)
        .map(|i| {
            if i + 1 == depth {
                json!({ "mesh": 0 })
            } else {
                json!({ "children": [i + 1], "translation": [0, 0, 1] })
            }
        })
        .collect();
    file.json["nodes"] = json!(nodes);
    let scene = file.load();
    assert_eq!(scene.objects[0].bounds.min.z, (depth - 1) as f32);
}

#[test]
fn cycles_and_shared_children_are_refused() {
    let mut file = File::with_triangle();
    file.node()["children"] = json!([0]);
    assert!(file.refusal().contains("nodes[0]: is its own ancestor"));
    let mut file = File::with_triangle();
    file.push("nodes", json!({ "children": [0] }));
    file.push("nodes", json!({ "children": [0] }));
    let text = file.refusal();
    assert!(
        text.contains("nodes[2].children[0]: node 0 is already a child of node 1"),
        "{text}"
    );
}

#[test]
fn short_files_cannot_ask_for_much_memory() {
    let mut zeros = File::with_triangle();
    zeros.json["accessors"][0] =
        json!({ "componentType": 5126, "type": "VEC3", "count": 4_000_000_000_u32 });
    assert!(zeros.refusal().contains("too large"), "{}", zeros.refusal());

    let mut instances = File::with_triangle();
    let many = instances.push(
        "accessors",
        json!({ "componentType": 5126, "type": "VEC3", "count": 4_000_000 }),
    );
    let node = json!({ "mesh": 0, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": many } } } });
    instances.json["nodes"] = json!(vec![node; 30]);
    instances.json["scenes"][0]["nodes"] = json!((0..30).collect::<Vec<_>>());
    assert!(
        instances.refusal().contains("too large"),
        "{}",
        instances.refusal()
    );
}

#[test]
fn accessors_stay_within_their_views() {
    for (key, value) in [
        ("byteOffset", json!(u64::MAX)),
        ("byteOffset", json!(30)),
        ("count", json!(1000)),
        ("type", json!("MAT4")),
    ] {
        let mut file = File::with_triangle();
        file.json["accessors"][0][key] = value;
        let text = file.refusal();
        assert!(
            text.contains("meshes[0].primitives[0].attributes.POSITION"),
            "{text}"
        );
        assert!(text.contains("accessors[0]"), "{text}");
    }
}

#[test]
fn a_picture_that_promises_too_much_is_not_decoded() {
    let mut png = std::io::Cursor::new(Vec::new());
    image::GrayImage::new(1, 1)
        .write_to(&mut png, image::ImageFormat::Png)
        .unwrap();
    let mut bytes = png.into_inner();
    // Width and height in the header chunk; its checksum must be mended.
    bytes[16..20].copy_from_slice(&20_000u32.to_be_bytes());
    bytes[20..24].copy_from_slice(&20_000u32.to_be_bytes());
    let crc = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.to_be_bytes());
    let mut file = File::with_triangle();
    let view = file.view(&bytes);
    file.push("images", json!({ "bufferView": view }));
    file.push("textures", json!({ "source": 0 }));
    file.material(json!({ "emissiveTexture": { "index": 0 } }));
    let scene = file.load();
    assert!(
        warnings(&scene).contains("promises 20000 x 20000 texels"),
        "{}",
        warnings(&scene)
    );
}

#[test]
fn required_extensions_that_are_unknown_are_all_named_with_what_helps() {
    for name in ["EXT_primitive_voxels", "ACME_magic"] {
        let mut file = File::with_triangle();
        file.json["extensionsUsed"] = json!([name]);
        assert!(warnings(&file.load()).contains(name));
    }
    let mut file = File::with_triangle();
    let names = [
        "EXT_texture_avif",
        "KHR_mesh_quantization",
        "ACME_magic",
        "ACME_magic",
    ];
    file.json["extensionsUsed"] = json!(names);
    file.json["extensionsRequired"] = json!(names);
    let text = file.refusal();
    assert!(
        text.contains("extensionsRequired names ACME_magic, EXT_texture_avif, not supported here")
            && text.contains("gltf-transform png"),
        "{text}"
    );
}

#[test]
fn extensions_without_effect_on_the_picture_make_no_noise() {
    let mut file = File::with_triangle();
    file.json["extensionsUsed"] = json!([
        "KHR_xmp_json_ld",
        "KHR_texture_basisu",
        "EXT_structural_metadata",
        "FB_ngon_encoding",
        "GODOT_single_root",
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
    ]);
    assert_eq!(warnings(&file.load()), "");
}

/// A mesh of so many vertices, of which `drawn` are drawn, with sparse morph targets that have no
/// base: each moves vertex 7 by (1, 2, 3) and turns its normal.
fn with_sparse_targets(vertices: usize, drawn: u16, targets: usize) -> File {
    let mut file = File::with_mesh();
    let positions: Vec<f32> = (0..vertices * 3).map(|i| (i % 7) as f32).collect();
    file.attribute("POSITION", &positions, "VEC3");
    file.attribute("NORMAL", &[0., 0., 1.].repeat(vertices), "VEC3");
    file.indices(&(0..drawn).collect::<Vec<_>>());
    let at = file.view(&7u16.to_le_bytes());
    let value: Vec<u8> = [1f32, 2., 3.]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let value = file.view(&value);
    let mut differences = || {
        let sparse = json!({
            "count": 1,
            "indices": { "bufferView": at, "componentType": 5123 },
            "values": { "bufferView": value },
        });
        file.push(
            "accessors",
            json!({ "componentType": 5126, "type": "VEC3", "count": vertices, "sparse": sparse }),
        )
    };
    let targets: Vec<_> = (0..targets)
        .map(|_| json!({ "POSITION": differences(), "NORMAL": differences() }))
        .collect();
    file.primitive()["targets"] = json!(targets);
    file.json["meshes"][0]["weights"] = json!([2]);
    file
}

#[test]
fn sparse_morph_targets_without_a_base_are_cheap_to_declare() {
    // The first draws all its vertices; the second declares what a face with 400 shapes has.
    for (vertices, drawn, targets) in [(50_000, 49_998, 30), (24_000, 9, 400)] {
        let scene = with_sparse_targets(vertices, drawn, targets).load();
        let vertex = &scene.meshes[0].vertices[7];
        let rest = [21, 22, 23].map(|i| (i % 7) as f32);
        let [x, y, z] = vertex.position;
        assert_eq!([x - rest[0], y - rest[1], z - rest[2]], [2., 4., 6.]);
    }
}

#[test]
fn sets_of_texture_coordinates_take_time_in_proportion_to_their_number() {
    // Five thousand million comparisons where each set is searched for from the first one on.
    let mut file = File::with_triangle();
    let base = file.floats(&[0.25; 6], "VEC2");
    let delta = file.floats(&[0.5; 6], "VEC2");
    let sets = |accessor: usize| {
        let pairs = (0..100_000).map(|set| (format!("TEXCOORD_{set}"), json!(accessor)));
        serde_json::Value::Object(pairs.collect())
    };
    let mut attributes = sets(base);
    attributes["POSITION"] = file.primitive()["attributes"]["POSITION"].clone();
    file.primitive()["attributes"] = attributes;
    file.primitive()["targets"] = json!([sets(delta)]);
    file.json["meshes"][0]["weights"] = json!([1]);
    let scene = file.load();
    assert_eq!(scene.warnings, []);
    assert_eq!(scene.meshes[0].vertices[0].uv[0], [0.75, 0.75]);
}

#[test]
fn channels_of_weights_do_not_search_the_primitives_of_their_mesh() {
    let mut file = File::with_triangle();
    let many = 50_000;
    file.push(
        "meshes",
        json!({ "primitives": vec![json!({ "attributes": {} }); many] }),
    );
    file.push("nodes", json!({ "mesh": 1 }));
    let times = file.floats(&[0., 1.], "SCALAR");
    let channel = json!({ "sampler": 0, "target": { "node": 1, "path": "weights" } });
    file.push(
        "animations",
        json!({
            "samplers": [{ "input": times, "output": times }],
            "channels": vec![channel; many],
        }),
    );
    let text = warnings(&file.load());
    let note = "channels[0]: moves the weights of a node without such morph targets";
    assert!(text.contains(note), "{text}");
}

#[test]
fn the_flag_that_an_error_names_allows_what_no_file_stores() {
    // Beyond the limits of elements without stored values and of numbers.
    for targets in [20, 30] {
        let mut file = with_sparse_targets(100, 9, targets);
        for accessor in file.json["accessors"].as_array_mut().unwrap() {
            if accessor.get("sparse").is_some() {
                accessor["count"] = json!(450_000);
            }
        }
        let error = file.load_with(&LoadOptions::default()).unwrap_err();
        assert_eq!(error.limit(), Some(Limit::Expansion), "{error}");
        let options = LoadOptions {
            max_expansion: 1 << 14,
            ..LoadOptions::default()
        };
        assert!(file.load_with(&options).is_ok());
    }
}

#[test]
fn tangents_of_extreme_geometry_are_unit_vectors() {
    for (size, uv) in [(1e38, 1.), (1., 1e38), (1e-38, 1e-38), (1e38, 0.)] {
        let mut file = File::with_mesh();
        file.attribute(
            "POSITION",
            &[-size, 0., 0., size, 0., 0., 0., size, 0.],
            "VEC3",
        );
        file.attribute("NORMAL", &[0., 0., 1.].repeat(3), "VEC3");
        file.attribute("TEXCOORD_0", &[-uv, 0., uv, 0., 0., uv], "VEC2");
        let texture = file.texture(&image::RgbaImage::new(1, 1));
        file.material(json!({ "normalTexture": { "index": texture } }));
        for v in &file.load().meshes[0].vertices {
            let [x, y, z, w] = v.tangent;
            let length = (x * x + y * y + z * z).sqrt();
            assert!(
                (length - 1.).abs() < 1e-3 && w.abs() == 1.,
                "{size} {uv}: {:?}",
                v.tangent
            );
        }
    }
}

#[test]
fn key_frames_beyond_the_numbers_leave_things_where_they_are() {
    let mut file = File::with_triangle();
    file.push(
        "nodes",
        json!({ "children": [0], "scale": [1e30, 1e30, 1e30] }),
    );
    file.json["scenes"][0]["nodes"] = json!([1]);
    let times = file.floats(&[0., 1.], "SCALAR");
    let values = file.floats(&[1e-30, 1e-30, 1e-30, 1e30, 1e30, 1e30], "VEC3");
    file.push(
        "animations",
        json!({
            "samplers": [{ "input": times, "output": values, "interpolation": "STEP" }],
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "scale" } }],
        }),
    );
    let mut scene = file.load();
    scene.pose(1.0);
    assert!(scene.bounds().max.is_finite());
    assert!(scene.instances[0].world_from_object.is_finite());
}
