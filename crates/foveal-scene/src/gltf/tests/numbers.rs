//! Numbers of files: what stands in for those that are missing, ranges, and how integers are read.

use foveal_seeds::pointers::{Moved, animate};
use serde_json::json;

use super::{File, Loads, near, warnings};
use crate::{Material, Projection};

/// The material of a triangle that reads the first texture in each of these slots.
fn material(material: serde_json::Value) -> Material {
    let mut file = File::with_triangle();
    file.attribute("TEXCOORD_0", &[0., 0., 1., 0., 0., 1.], "VEC2");
    file.texture(&image::RgbaImage::new(1, 1));
    file.material(material);
    file.load().materials.remove(0)
}

#[test]
fn factors_that_a_file_leaves_out_are_those_of_the_specification() {
    let texture = json!({ "index": 0 });
    let coat = json!({ "clearcoatFactor": 1, "clearcoatNormalTexture": texture });
    let found = material(json!({
        "normalTexture": texture,
        "occlusionTexture": texture,
        "extensions": { "KHR_materials_clearcoat": coat },
    }));
    assert_eq!((found.metallic, found.roughness), (1.0, 1.0));
    assert_eq!((found.normal_scale, found.occlusion_strength), (1.0, 1.0));
    let coat = found.clearcoat.expect("it has a coat");
    assert_eq!((coat.roughness, coat.normal_scale), (0.0, 1.0));
    let plain = Material::default();
    assert_eq!((plain.normal_scale, plain.occlusion_strength), (1.0, 1.0));
    assert_eq!((plain.specular, plain.ior), (1.0, 1.5));
}

#[test]
fn factors_beyond_their_ranges_are_brought_into_them() {
    for (given, held) in [(2.0f32, 1.0f32), (-1.0, 0.0)] {
        let found = material(json!({
            "pbrMetallicRoughness": {
                "baseColorFactor": [given, given, given, given],
                "metallicFactor": given,
                "roughnessFactor": given,
            },
            "occlusionTexture": { "index": 0, "strength": given },
            "extensions": {
                "KHR_materials_clearcoat": {
                    "clearcoatFactor": given.max(0.5),
                    "clearcoatRoughnessFactor": given,
                },
            },
        }));
        assert_eq!(found.base_color, glam::Vec4::splat(held));
        let factors = [found.metallic, found.roughness, found.occlusion_strength];
        assert_eq!(factors, [held; 3]);
        let coat = found.clearcoat.expect("it has a coat");
        assert_eq!((coat.factor, coat.roughness), (held.max(0.5), held));
    }
}

#[test]
fn normalized_integers_are_fractions_of_their_largest_value() {
    let load = |bytes: &[u8], code| {
        let mut file = File::with_triangle();
        let uv = file.accessor(bytes, code, "VEC2", 3);
        file.json["accessors"][uv]["normalized"] = json!(true);
        file.primitive()["attributes"]["TEXCOORD_0"] = json!(uv);
        file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        let scene = file.load();
        assert_eq!(warnings(&scene), "", "{code}");
        let vertices = scene.meshes[0].vertices.iter();
        vertices.flat_map(|v| v.uv[0]).collect::<Vec<f32>>()
    };
    let wide = |values: [u16; 6]| values.map(u16::to_le_bytes).concat();
    // The smallest of those with a sign lies below -1.
    let signed = [0x8000, 0x8001, 0, 0x7fff, 0x4000, 0xc000];
    let found = load(&wide(signed), 5122);
    assert!(near(&found, &[-1., -1., 0., 1., 0.500_015, -0.500_015]));
    let found = load(&[0x80, 0x81, 0, 0x7f, 0x40, 0xc0], 5120);
    assert!(near(&found, &[-1., -1., 0., 1., 0.503_937, -0.503_937]));
    let found = load(&wide([0, 1, 0x8000, 0xffff, 2, 3]), 5123);
    assert!(near(
        &found,
        &[0., 0.000_015, 0.500_008, 1., 0.000_031, 0.000_046]
    ));
    let found = load(&[0, 1, 0x80, 0xff, 2, 3], 5121);
    assert!(near(
        &found,
        &[0., 0.003_922, 0.501_961, 1., 0.007_843, 0.011_765]
    ));
}

/// A triangle, and a camera that looks at it.
fn seen_by(camera: serde_json::Value) -> File {
    let mut file = File::with_triangle();
    file.push("cameras", camera);
    file.node()["camera"] = json!(0);
    file
}

#[test]
fn cameras_that_nothing_can_be_drawn_by_are_left_out() {
    let parallel = |ymag: f32, znear: f32, zfar: f32| {
        let numbers = json!({ "xmag": 1, "ymag": ymag, "znear": znear, "zfar": zfar });
        let scene = seen_by(json!({ "type": "orthographic", "orthographic": numbers })).load();
        (scene.cameras.len(), warnings(&scene))
    };
    assert_eq!(parallel(2.0, 0.0, 1.0), (1, String::new()));
    assert_eq!(parallel(-2.0, 0.0, 1.0), (1, String::new()));
    let (count, warning) = parallel(0.0, 0.0, 1.0);
    assert!(count == 0 && warning.contains("ymag: is 0"), "{warning}");
    for far in [1.0, 0.5] {
        let (count, warning) = parallel(2.0, 1.0, far);
        let cause = format!("zfar: is {far}, not beyond znear = 1");
        assert!(count == 0 && warning.contains(&cause), "{warning}");
    }
}

#[test]
fn pointers_change_all_of_a_parallel_projection() {
    let numbers = json!({ "xmag": 1, "ymag": 2, "znear": 0.5, "zfar": 10 });
    let mut file = seen_by(json!({ "type": "orthographic", "orthographic": numbers }));
    let to = |pointer, from, to| Moved {
        pointer,
        kind: "SCALAR",
        from,
        to,
    };
    let moves = [
        to("/cameras/0/orthographic/ymag", &[2.0], &[-4.0]),
        to("/cameras/0/orthographic/znear", &[0.5], &[1.5]),
        to("/cameras/0/orthographic/zfar", &[10.0], &[20.0]),
    ];
    animate(&mut file, &moves);
    let mut scene = file.load();
    assert_eq!(warnings(&scene), "");
    for (time_s, height_m, near_m, far_m) in [(0.0, 4.0, 0.5, 10.0), (1.0, 8.0, 1.5, 20.0)] {
        scene.pose(time_s);
        let expected = Projection::Orthographic {
            height_m,
            near_m,
            far_m,
        };
        assert_eq!(scene.cameras[0].projection, expected, "{time_s} s");
    }
}
