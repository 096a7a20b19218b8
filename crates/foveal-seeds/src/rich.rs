//! Files with a little of everything.

use serde_json::json;

use crate::file::File;

/// A small file with a little of everything.
#[must_use]
pub fn rich() -> File {
    let mut file = File::with_triangle();
    file.attribute("NORMAL", &[0., 0., 1.].repeat(3), "VEC3");
    file.attribute("TEXCOORD_0", &[0., 0., 1., 0., 0., 1.], "VEC2");
    file.indices(&[0, 1, 2]);
    let texture = file.texture(&image::RgbaImage::from_pixel(5, 3, [9, 8, 7, 6].into()));
    let joints = file.accessor(&[0; 12], 5121, "VEC4", 3);
    file.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    file.attribute("WEIGHTS_0", &[1., 0., 0., 0.].repeat(3), "VEC4");
    let delta = file.floats(&[0.5; 9], "VEC3");
    file.primitive()["targets"] = json!([{ "POSITION": delta }]);
    file.material(json!({
        "alphaMode": "MASK",
        "pbrMetallicRoughness": { "baseColorTexture": { "index": texture } },
        "normalTexture": { "index": texture },
    }));
    let times = file.floats(&[0., 1.], "SCALAR");
    let moves = file.floats(&[0., 0., 0., 1., 1., 1.], "VEC3");
    file.push(
        "animations",
        json!({
            "samplers": [{ "input": times, "output": moves }],
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
        }),
    );
    file.push("nodes", json!({ "camera": 0, "children": [2] }));
    file.push("nodes", json!({ "mesh": 0, "skin": 0 }));
    file.push("skins", json!({ "joints": [1] }));
    file.json["cameras"] =
        json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }]);
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    file
}

/// A file with every extension that is honoured without compression, sparse and quantized
/// accessors, a JPEG picture, a triangle strip, and curves of three kinds.
#[must_use]
pub fn extended() -> File {
    let mut file = File::with_mesh();
    let corners: Vec<u8> = [
        [-9i16, 0, 5, 0],
        [90, 3, 5, 0],
        [0, 80, -4, 0],
        [70, 60, 9, 0],
    ]
    .iter()
    .flatten()
    .flat_map(|v| v.to_le_bytes())
    .collect();
    let position = file.accessor(&corners, 5122, "VEC3", 4);
    let view = file.json["accessors"][position]["bufferView"].clone();
    file.json["bufferViews"][view.as_u64().unwrap_or(0) as usize]["byteStride"] = json!(8);
    file.primitive()["attributes"]["POSITION"] = json!(position);
    file.primitive()["mode"] = json!(5);
    let at = file.view(&[0, 2]);
    let value: Vec<u8> = [0.5f32, 1.0, 0.25, 0.75]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let value = file.view(&value);
    let uv = file.push(
        "accessors",
        json!({ "componentType": 5126, "type": "VEC2", "count": 4, "sparse": {
            "count": 2,
            "indices": { "bufferView": at, "componentType": 5121 },
            "values": { "bufferView": value },
        } }),
    );
    file.primitive()["attributes"]["TEXCOORD_0"] = json!(uv);
    let colors = file.accessor(&[200; 16], 5121, "VEC4", 4);
    file.json["accessors"][colors]["normalized"] = json!(true);
    file.primitive()["attributes"]["COLOR_0"] = json!(colors);
    let delta = file.floats(&[0.25; 12], "VEC3");
    file.primitive()["targets"] = json!([{ "POSITION": delta }]);
    file.json["meshes"][0]["weights"] = json!([0.5]);

    let mut jpeg = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_fn(9, 7, |x, y| image::Rgb([x as u8 * 20, y as u8 * 30, 40]))
        .write_to(&mut jpeg, image::ImageFormat::Jpeg)
        .unwrap();
    let view = file.view(jpeg.get_ref());
    let image = file.push(
        "images",
        json!({ "bufferView": view, "mimeType": "image/jpeg" }),
    );
    let sampler = file.push(
        "samplers",
        json!({ "magFilter": 9728, "minFilter": 9987, "wrapS": 33071 }),
    );
    let texture = file.push("textures", json!({ "source": image, "sampler": sampler }));
    let transform = json!({ "KHR_texture_transform": { "offset": [0.5, 0.25], "rotation": 0.3, "scale": [2, 3] } });
    file.material(json!({
        "doubleSided": true,
        "alphaMode": "BLEND",
        "emissiveFactor": [0.5, 0.5, 0.5],
        "emissiveTexture": { "index": texture, "extensions": transform },
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 4 },
            "KHR_materials_pbrSpecularGlossiness": { "diffuseTexture": { "index": texture } },
        },
    }));
    file.push(
        "materials",
        json!({ "extensions": { "KHR_materials_unlit": {} } }),
    );
    file.primitive()["extensions"] = json!({ "KHR_materials_variants": {
        "mappings": [{ "material": 1, "variants": [0] }],
    } });

    let places = file.floats(&[0., 0., 0., 4., 0., 0., 0., 4., 0.], "VEC3");
    let turns = file.accessor(&[127, 0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0], 5120, "VEC4", 3);
    file.json["accessors"][turns]["normalized"] = json!(true);
    file.node()["extensions"] = json!({
        "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places, "ROTATION": turns } },
        "KHR_node_visibility": { "visible": true },
    });
    file.push(
        "nodes",
        json!({ "camera": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } } }),
    );
    file.push(
        "nodes",
        json!({
            "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 2, 1, 1],
            "extensions": { "KHR_lights_punctual": { "light": 1 } },
        }),
    );
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    file.json["cameras"] = json!([{ "type": "orthographic", "orthographic": {
        "xmag": 2, "ymag": 1, "znear": 0.1, "zfar": 50,
    } }]);
    file.json["extensions"] = json!({
        "KHR_lights_punctual": { "lights": [
            { "type": "point", "range": 8, "color": [1, 0.5, 0] },
            { "type": "spot", "intensity": 20, "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.6 } },
        ] },
        "KHR_materials_variants": { "variants": [{ "name": "plain" }] },
    });
    let times = file.floats(&[0., 0.5, 2.], "SCALAR");
    let spline = file.floats(&[0.1; 36], "VEC4");
    let weights = file.floats(&[0., 1., 0.], "SCALAR");
    let scales = file.floats(&[1., 1., 1., 2., 1., 1., 1., 3., 1.], "VEC3");
    file.push(
        "animations",
        json!({
            "name": "all",
            "samplers": [
                { "input": times, "output": spline, "interpolation": "CUBICSPLINE" },
                { "input": times, "output": weights, "interpolation": "STEP" },
                { "input": times, "output": scales },
            ],
            "channels": [
                { "sampler": 0, "target": { "node": 1, "path": "rotation" } },
                { "sampler": 1, "target": { "node": 0, "path": "weights" } },
                { "sampler": 2, "target": { "node": 0, "path": "scale" } },
            ],
        }),
    );
    file.json["extensionsUsed"] = json!([
        "EXT_mesh_gpu_instancing",
        "KHR_lights_punctual",
        "KHR_materials_variants",
        "KHR_mesh_quantization",
        "KHR_texture_transform",
        "KHR_node_visibility",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_unlit",
    ]);
    file
}
