//! Codes and places of warnings and errors.

use serde_json::json;

use super::{File, Loads, warnings};
use crate::{Code, LoadOptions, load_bytes};

type Change = fn(&mut File);

#[test]
fn errors_have_the_code_of_their_cause() {
    let cases: &[(Code, Change)] = &[
        (Code::NodeCycle, |file| {
            file.node()["children"] = json!([0]);
        }),
        (Code::IndexOutOfRange, |file| {
            file.node()["mesh"] = json!(7);
        }),
        (Code::ValueType, |file| {
            file.node()["translation"] = json!("left");
        }),
        (Code::ValueMissing, |file| {
            file.push("accessors", json!({ "componentType": 5126 }));
        }),
        (Code::ValueUnknown, |file| {
            file.push(
                "accessors",
                json!({ "componentType": 5126, "count": 1, "type": "VEC5" }),
            );
        }),
        (Code::ExtensionRequired, |file| {
            file.push("extensionsRequired", json!("ACME_surfaces"));
        }),
        (Code::VersionUnsupported, |file| {
            file.json["asset"]["version"] = json!("1.0");
        }),
        (Code::VersionUnsupported, |file| {
            file.json["asset"]["minVersion"] = json!("2.1");
        }),
        (Code::AccessorStride, |file| {
            file.json["bufferViews"][0]["byteStride"] = json!(8);
        }),
        (Code::BufferTooShort, |file| {
            file.push(
                "bufferViews",
                json!({ "buffer": 0, "byteLength": 1_000_000_000 }),
            );
        }),
    ];
    for (code, change) in cases {
        let mut file = File::with_triangle();
        change(&mut file);
        let error = file.load_with(&LoadOptions::default()).unwrap_err();
        assert_eq!(error.code(), *code, "{error}");
    }
    let options = LoadOptions {
        max_triangles: 0,
        ..LoadOptions::default()
    };
    let error = File::with_triangle().load_with(&options).unwrap_err();
    assert_eq!(error.code(), Code::LimitExceeded, "{error}");
    let none = |_: &str| Err("no files".into());
    let mut newer = File::with_triangle().glb();
    newer[4] = 3;
    for bytes in [&b"text"[..], &newer] {
        let error = load_bytes(bytes, "a.glb", &LoadOptions::default(), &none).unwrap_err();
        assert_eq!(error.code(), Code::NotGltf, "{error}");
    }
}

#[test]
fn errors_name_the_whole_place() {
    let cases: &[(&str, Change)] = &[
        ("materials[0].normalTexture.scale: is a string", |file| {
            file.material(json!({ "normalTexture": { "index": 0, "scale": "x" } }));
        }),
        (
            "materials[0].occlusionTexture.strength: is a string",
            |file| {
                file.material(json!({ "occlusionTexture": { "index": 0, "strength": "x" } }));
            },
        ),
        (
            "materials[0].extensions.KHR_materials_clearcoat.clearcoatNormalTexture.scale: is a string",
            |file| {
                let normal = json!({ "index": 0, "scale": "x" });
                let coat = json!({ "clearcoatFactor": 1, "clearcoatNormalTexture": normal });
                file.material(json!({ "extensions": { "KHR_materials_clearcoat": coat } }));
            },
        ),
        (
            "nodes[0].extensions.KHR_node_visibility.visible: is a string",
            |file| {
                file.node()["extensions"] = json!({ "KHR_node_visibility": { "visible": "x" } });
            },
        ),
        (
            "buffers[1].extensions.EXT_meshopt_compression.fallback: is a string",
            |file| {
                let extension = json!({ "EXT_meshopt_compression": { "fallback": "x" } });
                let buffer = json!({ "byteLength": 1, "extensions": extension });
                file.more_buffers.push(buffer);
            },
        ),
        (
            "bufferViews[0].byteStride: is 0, outside 1 to 252",
            |file| {
                file.json["bufferViews"][0]["byteStride"] = json!(0);
            },
        ),
        (
            "bufferViews[0].byteStride: is 253, outside 1 to 252",
            |file| {
                file.json["bufferViews"][0]["byteStride"] = json!(253);
            },
        ),
    ];
    for (place, change) in cases {
        let mut file = File::with_triangle();
        file.texture(&image::RgbaImage::new(1, 1));
        change(&mut file);
        let error = file.refusal();
        assert!(error.contains(&format!("broken at {place}")), "{error}");
    }
    let mut file = File::with_triangle();
    let spot = json!({ "type": "spot", "spot": { "innerConeAngle": "x" } });
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [spot] } });
    file.node()["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
    let text = warnings(&file.load());
    let place = "extensions.KHR_lights_punctual.lights[0].spot.innerConeAngle: is a string";
    assert!(text.contains(place), "{text}");
}

/// Adds a clip that moves the node by so many numbers.
fn clip(file: &mut File, times: &[f32], numbers: usize) {
    let input = file.floats(times, "SCALAR");
    let output = file.floats(&vec![0.0; numbers], "VEC3");
    let target = json!({ "node": 0, "path": "translation" });
    file.push(
        "animations",
        json!({
            "samplers": [{ "input": input, "output": output }],
            "channels": [{ "sampler": 0, "target": target }],
        }),
    );
}

#[test]
fn warnings_have_the_code_of_their_cause() {
    let cases: &[(Code, Change)] = &[
        (Code::ExtensionIgnored, |file| {
            file.push("extensionsUsed", json!("ACME_surfaces"));
        }),
        (Code::NodeRoot, |file| {
            let child = file.push("nodes", json!({}));
            file.node()["children"] = json!([child]);
            file.json["scenes"][0]["nodes"] = json!([0, child]);
        }),
        (Code::Animation, |file| clip(file, &[0.0, 2.0, 1.0], 9)),
        (Code::Animation, |file| clip(file, &[0.0, 1.0, 2.0], 6)),
        (Code::MorphWeights, |file| {
            let moved = file.floats(&[0.0; 9], "VEC3");
            file.primitive()["targets"] = json!([{ "POSITION": moved }]);
            file.json["meshes"][0]["weights"] = json!([0.5, 0.5]);
        }),
        (Code::Skin, |file| {
            file.attribute("WEIGHTS_0", &[0.0; 12], "VEC4");
        }),
        (Code::NodeTransform, |file| {
            let one = glam::Mat4::IDENTITY.to_cols_array();
            file.node()["matrix"] = json!(one);
            file.node()["scale"] = json!([1, 1, 1]);
        }),
        (Code::ImageUnreadable, |file| {
            file.push("images", json!({ "uri": "missing.png" }));
            file.push("textures", json!({ "source": 0 }));
            file.push(
                "materials",
                json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }),
            );
            file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        }),
        (Code::TextureWithoutImage, |file| {
            file.push("textures", json!({ "extensions": {} }));
            file.push(
                "materials",
                json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }),
            );
            file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        }),
        (Code::SceneEmpty, |file| {
            file.json["scenes"][0]["nodes"] = json!([]);
        }),
        // The fault of a part that is left out keeps its own code.
        (Code::ValueOutOfRange, |file| {
            file.push(
                "cameras",
                json!({ "type": "perspective", "perspective": { "yfov": -1, "znear": 1 } }),
            );
            file.node()["camera"] = json!(0);
        }),
    ];
    for (code, change) in cases {
        let mut file = File::with_triangle();
        change(&mut file);
        let scene = file.load();
        let found: Vec<Code> = scene.warnings.iter().map(|w| w.code).collect();
        assert!(found.contains(code), "{code}: {:?}", scene.warnings);
    }
}

#[test]
fn what_nothing_uses_is_checked_on_request_and_changes_nothing() {
    let mut file = File::with_triangle();
    let positions = file.floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.], "VEC3");
    let indices = file.accessor(&[0, 0, 1, 0, 9, 0], 5123, "SCALAR", 3);
    let primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices });
    file.push("meshes", json!({ "primitives": [primitive] }));
    file.push("images", json!({ "uri": "missing.png" }));
    let plain = file.load();
    assert!(plain.warnings.is_empty(), "{:?}", plain.warnings);
    let options = LoadOptions {
        check_unused: true,
        ..LoadOptions::default()
    };
    let scene = file.load_with(&options).unwrap();
    let found: Vec<(Code, &str)> = scene
        .warnings
        .iter()
        .map(|w| (w.code, w.text.as_str()))
        .collect();
    let expected = [
        (
            Code::TrianglesUnusable,
            "meshes[1].primitives[0]: 1 of 1 triangles name vertices that do not exist or lie at no \
             finite place, and are left out; nothing shown uses it",
        ),
        (
            Code::ImageUnreadable,
            "images[0] (missing.png): no files; nothing shown uses it",
        ),
    ];
    assert_eq!(found, expected);
    assert_eq!(scene.meshes.len(), plain.meshes.len());
    assert!(scene.textures.is_empty());
}
