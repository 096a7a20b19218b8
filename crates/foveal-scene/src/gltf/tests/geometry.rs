//! Vertices, indices, normals, tangents.

use glam::{Vec2, Vec3};
use serde_json::json;

use super::{File, Loads, near, warnings};
use crate::{Aabb, LoadOptions, MissingNormals};

#[test]
fn flat_normals_give_each_triangle_its_own_vertices() {
    let mut file = File::with_mesh();
    let corners = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.];
    file.attribute("POSITION", &corners, "VEC3");
    file.indices(&[0, 1, 2, 0, 2, 3]);
    let scene = file.load();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.indices, [0, 1, 2, 3, 4, 5]);
    assert!(mesh.vertices[..3].iter().all(|v| v.normal == [0., 0., 1.]));
    assert!(mesh.vertices[3..].iter().all(|v| v.normal == [1., 0., 0.]));
    assert!(
        mesh.vertices
            .iter()
            .all(|v| v.tangent == [0.; 4] && v.color == [u16::MAX; 4])
    );

    let options = LoadOptions {
        missing_normals: MissingNormals::Smooth,
        ..LoadOptions::default()
    };
    let mesh = &file.load_with(&options).unwrap().meshes[0];
    assert_eq!(mesh.vertices.len(), 4);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    assert!(near(&mesh.vertices[0].normal, &[half, 0., half]));
    assert!(near(&mesh.vertices[1].normal, &[0., 0., 1.]));
}

#[test]
fn strips_and_fans_become_lists() {
    for (mode, expected) in [(5, [0, 1, 2, 1, 3, 2]), (6, [1, 2, 0, 2, 3, 0])] {
        let mut file = File::with_mesh();
        let corners = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];
        file.attribute("POSITION", &corners, "VEC3");
        file.attribute("NORMAL", &[0., 0., 1.].repeat(4), "VEC3");
        file.primitive()["mode"] = json!(mode);
        assert_eq!(file.load().meshes[0].indices, expected);
    }
}

#[test]
fn points_and_lines_keep_the_attributes_of_their_vertices() {
    let expected: [&[[u32; 2]]; 4] = [
        &[],
        &[[0, 1], [2, 3]],
        &[[0, 1], [1, 2], [2, 3], [3, 0]],
        &[[0, 1], [1, 2], [2, 3]],
    ];
    for (mode, lines) in expected.iter().enumerate() {
        let mut file = File::with_mesh();
        let corners = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 2.];
        file.attribute("POSITION", &corners, "VEC3");
        file.attribute("COLOR_0", &[0., 1., 0., 1.].repeat(4), "VEC4");
        file.primitive()["mode"] = json!(mode);
        file.material(json!({ "normalTexture": { "index": 0 } }));
        file.texture(&image::RgbaImage::from_pixel(1, 1, [128; 4].into()));
        let scene = file.load();
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.lines, *lines);
        assert_eq!(mesh.points.len(), if mode == 0 { 4 } else { 0 });
        assert!(mesh.indices.is_empty() && !mesh.lights_strokes());
        assert!(
            mesh.vertices
                .iter()
                .all(|v| v.color == [0, u16::MAX, 0, u16::MAX])
        );
        assert!(mesh.vertices.iter().all(|v| v.tangent == [0.; 4]));
        let bounds = Aabb {
            min: Vec3::ZERO,
            max: Vec3::new(1., 1., 2.),
        };
        assert_eq!(scene.instances[0].bounds, bounds);
        assert!(!scene.can_occlude(&scene.instances[0]));
        file.attribute("NORMAL", &[0., 2., 0.].repeat(4), "VEC3");
        let scene = file.load();
        assert!(scene.meshes[0].lights_strokes());
        assert_eq!(scene.meshes[0].vertices[3].normal, [0., 1., 0.]);
    }
}

#[test]
fn strokes_whose_normals_have_no_direction_are_not_lit() {
    for mode in 0..4 {
        let mut file = File::with_mesh();
        let corners = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 2.];
        file.attribute("POSITION", &corners, "VEC3");
        file.attribute("NORMAL", &[0.; 12], "VEC3");
        file.primitive()["mode"] = json!(mode);
        let scene = file.load();
        assert!(!scene.meshes[0].lights_strokes());
        let text = "4 of 4 normals have no direction: the points and lines there are not lit";
        assert!(warnings(&scene).contains(text), "{}", warnings(&scene));
        let normals = [0., 0., 0., 0., 0., 3., 0., f32::NAN, 0., 0., 1., 0.];
        file.attribute("NORMAL", &normals, "VEC3");
        let scene = file.load();
        let mesh = &scene.meshes[0];
        let found: Vec<_> = mesh.vertices.iter().map(|v| v.normal).collect();
        assert_eq!(found, [[0.; 3], [0., 0., 1.], [0.; 3], [0., 1., 0.]]);
        // A line is lit where both of its ends are.
        assert_eq!(mesh.lights_strokes(), mode == 0);
    }
}

#[test]
fn lines_to_vertices_that_do_not_exist_are_left_out() {
    let mut file = File::with_triangle();
    file.indices(&[0, 1, 1, 7, 2, 1]);
    file.primitive()["mode"] = json!(1);
    let scene = file.load();
    assert_eq!(scene.meshes[0].lines, [[0, 1], [2, 1]]);
    assert!(warnings(&scene).contains("1 of 3 lines name vertices that do not exist"));
}

#[test]
fn points_morph_and_follow_joints() {
    let mut file = foveal_seeds::rich();
    file.primitive()["mode"] = json!(0);
    let mut scene = file.load();
    assert!(scene.meshes.iter().all(|mesh| mesh.points.len() == 3));
    let skinned = scene
        .instances
        .iter()
        .map(|i| &scene.meshes[i.mesh as usize]);
    let before: Vec<_> = skinned.map(|mesh| mesh.vertices[0].position).collect();
    scene.pose(0.5);
    let after = scene
        .instances
        .iter()
        .map(|i| &scene.meshes[i.mesh as usize]);
    let after: Vec<_> = after.map(|mesh| mesh.vertices[0].position).collect();
    assert_ne!(before, after);
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh as usize];
        let place = instance
            .world_from_object
            .transform_point3(mesh.vertices[1].position.into());
        assert!(instance.bounds.min.cmple(place).all() && instance.bounds.max.cmpge(place).all());
    }
}

#[test]
fn sparse_accessors_replace_single_elements() {
    let mut file = File::with_triangle();
    let at = file.view(&[2]);
    let values: Vec<u8> = [5f32, 6., 7.]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let values = file.view(&values);
    file.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": at, "componentType": 5121 },
        "values": { "bufferView": values },
    });
    assert_eq!(file.load().meshes[0].vertices[2].position, [5., 6., 7.]);

    // Without a base everything else is zero.
    file.json["accessors"][0]
        .as_object_mut()
        .unwrap()
        .remove("bufferView");
    assert_eq!(file.load().meshes[0].vertices[1].position, [0., 0., 0.]);

    file.json["accessors"][0]["count"] = json!(2);
    let error = file.refusal();
    assert!(
        error.contains("attributes.POSITION") && error.contains("element 2"),
        "{error}"
    );
}

#[test]
fn sparse_indices_are_unsigned_integers() {
    for code in [5120, 5122, 5126, 7] {
        let mut file = File::with_triangle();
        let at = file.view(&[2, 0, 0, 0]);
        let values = file.view(&[0; 12]);
        file.json["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": at, "componentType": code },
            "values": { "bufferView": values },
        });
        let error = file.refusal();
        let place = "broken at accessors[0].sparse.indices.componentType: is ";
        assert!(error.contains(place), "{code}: {error}");
    }
}

#[test]
fn texture_coordinates_that_are_read_in_vain_are_missed() {
    let load = |material: Option<serde_json::Value>| {
        let mut file = File::with_triangle();
        file.texture(&image::RgbaImage::new(1, 1));
        let plain = file.primitive().clone();
        if let Some(material) = material {
            file.material(material);
        }
        // Without a material it is the same mesh.
        let primitives = file.json["meshes"][0]["primitives"].as_array_mut().unwrap();
        primitives.insert(0, plain);
        warnings(&file.load())
    };
    let slot = json!({ "index": 0 });
    let missing =
        "meshes[0].primitives[1]: has no TEXCOORD_0 although its material reads it; (0, 0) is used";
    for material in [
        json!({ "pbrMetallicRoughness": { "baseColorTexture": slot } }),
        json!({ "emissiveTexture": slot }),
        json!({ "normalTexture": slot }),
        json!({ "extensions": { "KHR_materials_sheen": { "sheenColorFactor": [1, 1, 1], "sheenColorTexture": slot } } }),
    ] {
        assert_eq!(load(Some(material)), missing);
    }
    let anisotropic = json!({ "KHR_materials_anisotropy": { "anisotropyStrength": 1 } });
    for material in [
        None,
        Some(json!({})),
        Some(json!({ "extensions": anisotropic })),
    ] {
        assert_eq!(load(material), "");
    }
}

#[test]
fn quantized_attributes_are_understood() {
    let mut file = File::with_mesh();
    let positions: [i16; 12] = [0, 0, 0, 0, 100, 0, 0, 0, 0, -100, 0, 0];
    let bytes: Vec<u8> = positions.iter().flat_map(|v| v.to_le_bytes()).collect();
    let position = file.accessor(&bytes, 5122, "VEC3", 3);
    file.json["bufferViews"][0]["byteStride"] = json!(8);
    let normal = file.accessor(&[0, 0, 127, 0, 0, 129, 129, 0, 0, 0, 0, 0], 5120, "VEC3", 3);
    file.json["accessors"][normal]["normalized"] = json!(true);
    file.json["bufferViews"][1]["byteStride"] = json!(4);
    let uv: Vec<u8> = [0u16, 0, 65535, 0, 0, 32768]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let uv = file.accessor(&uv, 5123, "VEC2", 3);
    file.json["accessors"][uv]["normalized"] = json!(true);
    file.primitive()["attributes"] =
        json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv });
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let scene = file.load();
    let v = &scene.meshes[0].vertices;
    assert_eq!(v[1].position, [100., 0., 0.]);
    assert_eq!(v[2].position, [0., -100., 0.]);
    assert_eq!(v[0].normal, [0., 0., 1.]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    assert!(near(&v[1].normal, &[0., -half, -half]), "{:?}", v[1].normal);
    assert_eq!(v[1].uv[0], [1., 0.]);
    assert!(near(&v[2].uv[0], &[0., 0.500_007_6]));
}

#[test]
fn vertex_colours_come_in_every_format() {
    let cases: [(&[u8], u32, &str, bool); 4] = [
        (&[255, 0, 51, 0].repeat(3), 5121, "VEC4", true),
        (
            &[0xFF, 0xFF, 0, 0, 0x33, 0x33, 0, 0].repeat(3),
            5123,
            "VEC4",
            true,
        ),
        (
            &[1f32, 0., 0.2].map(f32::to_le_bytes).concat().repeat(3),
            5126,
            "VEC3",
            false,
        ),
        (
            &[1f32, 0., 0.2, 0.].map(f32::to_le_bytes).concat().repeat(3),
            5126,
            "VEC4",
            false,
        ),
    ];
    for (bytes, code, kind, normalized) in cases {
        let mut file = File::with_triangle();
        let accessor = file.accessor(bytes, code, kind, 3);
        file.json["accessors"][accessor]["normalized"] = json!(normalized);
        file.primitive()["attributes"]["COLOR_0"] = json!(accessor);
        let alpha = if kind == "VEC3" { u16::MAX } else { 0 };
        let color = file.load().meshes[0].vertices[1].color;
        assert_eq!(color, [u16::MAX, 0, 13107, alpha], "{code} {kind}");
    }
}

#[test]
fn unused_vertices_do_not_count_and_large_shared_buffers_are_cut() {
    let mut file = File::with_mesh();
    let mut corners = [0., 0., 0., 1., 0., 0., 0., 1., 0.].to_vec();
    corners.extend([9e9; 30]);
    file.attribute("POSITION", &corners, "VEC3");
    file.attribute("NORMAL", &[0., 0., 1.].repeat(13), "VEC3");
    file.indices(&[2, 0, 1]);
    let scene = file.load();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.vertices.len(), 3);
    assert_eq!(
        mesh.vertices[mesh.indices[0] as usize].position,
        [0., 1., 0.]
    );
    let unit = Aabb {
        min: Vec3::ZERO,
        max: Vec3::new(1., 1., 0.),
    };
    assert_eq!(mesh.bounds, unit);
    assert_eq!(scene.objects[0].bounds, unit);
}

#[test]
fn triangles_beyond_the_vertices_or_at_no_place_are_left_out() {
    let mut file = File::with_mesh();
    let corners = [0., 0., 0., 1., 0., 0., 0., 1., 0., f32::NAN, 0., 0.];
    file.attribute("POSITION", &corners, "VEC3");
    file.indices(&[0, 1, 2, 0, 1, 3, 0, 1, 9]);
    let scene = file.load();
    assert_eq!(scene.triangle_count(), 1);
    assert!(warnings(&scene).contains("2 of 3 triangles"));
    assert!(scene.bounds().max.is_finite());
}

#[test]
fn normals_without_direction_are_made_anew() {
    let mut file = File::with_triangle();
    file.attribute(
        "NORMAL",
        &[0., 0., 2., 0., 0., 0., f32::NAN, 0., 0.],
        "VEC3",
    );
    let scene = file.load();
    assert!(
        scene.meshes[0]
            .vertices
            .iter()
            .all(|v| v.normal == [0., 0., 1.])
    );
    assert!(warnings(&scene).contains("2 of 3 normals"));
}

#[test]
fn tangents_point_along_u_and_bitangents_against_v() {
    for mirrored in [false, true] {
        let mut file = File::with_mesh();
        let corners = [0., 0., 0., 1., 0., 0., 0., 1., 0.];
        file.attribute("POSITION", &corners, "VEC3");
        file.attribute("NORMAL", &[0., 0., 1.].repeat(3), "VEC3");
        // The picture upright on the surface: v falls where y rises.
        let u = |x: f32| if mirrored { 1. - x } else { x };
        file.attribute("TEXCOORD_0", &[u(0.), 1., u(1.), 1., u(0.), 0.], "VEC2");
        let texture = file.texture(&image::RgbaImage::from_pixel(
            1,
            1,
            [128, 128, 255, 255].into(),
        ));
        file.material(json!({ "normalTexture": { "index": texture } }));
        let scene = file.load();
        let sign = if mirrored { -1. } else { 1. };
        for v in &scene.meshes[0].vertices {
            assert!(near(&v.tangent, &[sign, 0., 0., sign]), "{:?}", v.tangent);
            let bitangent =
                Vec3::from(v.normal).cross(Vec3::new(v.tangent[0], 0., 0.)) * v.tangent[3];
            assert!(bitangent.abs_diff_eq(Vec3::Y, 1e-5));
        }
    }
}

/// A triangle with a normal map, whose texture coordinates are these, read where the file's
/// transform says.
fn with_normal_map(uv: &[f32], transform: &serde_json::Value) -> crate::Scene {
    let mut file = File::with_mesh();
    let corners = [0., 0., 0., 1., 0., 0., 0.3, 1., 0.];
    file.attribute("POSITION", &corners, "VEC3");
    file.attribute("NORMAL", &[0., 0., 1.].repeat(3), "VEC3");
    file.attribute("TEXCOORD_0", uv, "VEC2");
    let texel = [128, 128, 255, 255].into();
    let texture = file.texture(&image::RgbaImage::from_pixel(1, 1, texel));
    let mut info = json!({ "index": texture });
    if !transform.is_null() {
        info["extensions"] = json!({ "KHR_texture_transform": transform });
    }
    file.material(json!({ "normalTexture": info }));
    file.load()
}

#[test]
fn tangents_follow_the_turned_and_mirrored_coordinates_that_the_normal_map_is_read_at() {
    let uv = [0.1, 0.9, 1.0, 0.7, 0.2, 0.0];
    let tangents = |scene: &crate::Scene| -> Vec<_> {
        let vertices = scene.meshes[0].vertices.iter();
        vertices.map(|v| v.tangent).collect()
    };
    let own = tangents(&with_normal_map(&uv, &json!(null)));
    for (transform, turns) in [
        (json!({ "rotation": 1.1 }), true),
        (json!({ "scale": [-1, 1] }), true),
        (json!({ "scale": [2, -3], "offset": [0.5, 4] }), true),
        (json!({ "rotation": -0.4, "scale": [1, 2] }), true),
        (json!({ "scale": [2, 3], "offset": [0.5, 4] }), false),
        (json!({ "scale": [0, 0] }), false),
    ] {
        let scene = with_normal_map(&uv, &transform);
        let slot = scene.materials[0].normal_texture.unwrap();
        let moved: Vec<f32> = uv
            .chunks(2)
            .flat_map(|uv| {
                let at = slot.uv_transform.transform_point2(Vec2::new(uv[0], uv[1]));
                at.to_array()
            })
            .collect();
        let found = tangents(&scene);
        if turns {
            let expected = tangents(&with_normal_map(&moved, &json!(null)));
            for (a, b) in found.iter().zip(&expected) {
                assert!(near(a, b), "{transform}: {a:?} not {b:?}");
            }
            assert!(!near(&found[0], &own[0]), "{transform}: {found:?}");
        } else {
            assert_eq!(found, own, "{transform}");
        }
    }
}

#[test]
fn a_huge_fan_and_many_triangles_without_area_do_not_stall_tangents() {
    let mut file = File::with_mesh();
    let count = 60_000u16;
    let mut corners = vec![0.; 3];
    let mut uv = vec![0.5; 2];
    for i in 0..count {
        let (sin, cos) = (f32::from(i) * 1e-4).sin_cos();
        corners.extend([cos, sin, 0.]);
        uv.extend([0.5 + 0.5 * cos, 0.5 - 0.5 * sin]);
    }
    file.attribute("POSITION", &corners, "VEC3");
    file.attribute(
        "NORMAL",
        &[0., 0., 1.].repeat(usize::from(count) + 1),
        "VEC3",
    );
    file.attribute("TEXCOORD_0", &uv, "VEC2");
    let fan = (1..count).flat_map(|i| [0, i, i + 1]);
    let nothing = (1..count).flat_map(|i| [i, i, 0]);
    let indices: Vec<u16> = fan.chain(nothing).collect();
    file.indices(&indices);
    let texture = file.texture(&image::RgbaImage::from_pixel(
        1,
        1,
        [128, 128, 255, 255].into(),
    ));
    file.material(json!({ "normalTexture": { "index": texture } }));
    let scene = file.load();
    let v = &scene.meshes[0].vertices[0];
    assert!(near(&v.tangent, &[1., 0., 0., 1.]), "{:?}", v.tangent);
}

#[test]
fn equal_primitives_share_a_mesh() {
    let mut file = File::with_triangle();
    let twin = file.json["meshes"][0].clone();
    file.push("meshes", twin);
    file.push("nodes", json!({ "mesh": 1, "translation": [5, 0, 0] }));
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = file.load();
    assert_eq!((scene.meshes.len(), scene.objects.len()), (1, 2));
}
