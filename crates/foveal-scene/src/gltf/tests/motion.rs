//! Animations, morph targets, skins.

use glam::{Mat4, Quat, Vec3};
use serde_json::{Value, json};

use super::{File, Loads, near, warnings};

/// Adds an animation with one channel.
fn animate(file: &mut File, target: Value, mode: &str, times: &[f32], values: &[f32], kind: &str) {
    let input = file.floats(times, "SCALAR");
    let output = file.floats(values, kind);
    file.push(
        "animations",
        json!({
            "samplers": [{ "input": input, "output": output, "interpolation": mode }],
            "channels": [{ "sampler": 0, "target": target }],
        }),
    );
}

#[test]
fn a_still_scene_has_no_rig() {
    let mut scene = File::with_triangle().load();
    assert!(!scene.is_animated() && scene.rig.data.is_none());
    let before = scene.instances.clone();
    scene.pose(1.0);
    assert_eq!(scene.instances, before);
}

#[test]
fn animated_nodes_carry_objects_cameras_and_lights() {
    let mut file = File::with_triangle();
    *file.node() = json!({ "children": [1, 2, 3] });
    file.push("nodes", json!({ "mesh": 0 }));
    file.push("nodes", json!({ "camera": 0 }));
    file.push(
        "nodes",
        json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }),
    );
    file.push("nodes", json!({ "mesh": 0, "name": "still" }));
    file.json["scenes"][0]["nodes"] = json!([0, 4]);
    file.json["cameras"] =
        json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }]);
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    let target = json!({ "node": 0, "path": "translation" });
    animate(
        &mut file,
        target,
        "LINEAR",
        &[0., 2.],
        &[0., 0., 0., 8., 0., 0.],
        "VEC3",
    );
    let mut scene = file.load();
    assert!(scene.is_animated());
    assert_eq!(scene.animation_duration_s(), 2.0);
    scene.pose(0.5);
    assert_eq!(scene.objects[0].bounds.min, Vec3::new(2., 0., 0.));
    assert_eq!(scene.instances[0].bounds.max, Vec3::new(3., 1., 0.));
    assert_eq!(scene.instances[0].world_from_object.w_axis.x, 2.);
    assert_eq!(scene.cameras[0].eye(), Vec3::new(2., 0., 0.));
    assert_eq!(scene.lights[0].position, Vec3::new(2., 0., 0.));
    assert_eq!(scene.objects[1].bounds.min, Vec3::ZERO);
    // It loops; poses do not build upon each other.
    scene.pose(2.25);
    assert_eq!(scene.objects[0].bounds.min, Vec3::new(1., 0., 0.));
    let options = crate::LoadOptions {
        time_s: 1.0,
        ..Default::default()
    };
    let posed = file.load_with(&options).unwrap();
    assert_eq!(posed.objects[0].bounds.min, Vec3::new(4., 0., 0.));
}

#[test]
fn rotations_and_scales_are_played_and_pointers_to_nothing_are_not() {
    let mut file = File::with_triangle();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turn = json!({ "node": 0, "path": "rotation" });
    animate(
        &mut file,
        turn,
        "LINEAR",
        &[0., 1.],
        &[0., 0., 0., 1., 0., 0., 1., 0.],
        "VEC4",
    );
    let scale = json!({ "node": 0, "path": "scale" });
    animate(
        &mut file,
        scale,
        "STEP",
        &[0., 1.],
        &[1., 1., 1., 2., 2., 2.],
        "VEC3",
    );
    let pointer = json!({ "path": "pointer" });
    animate(&mut file, pointer, "STEP", &[0.], &[1., 1., 1.], "VEC3");
    let options = crate::LoadOptions {
        clip: crate::Clip::All,
        ..Default::default()
    };
    let mut scene = file.load_with(&options).unwrap();
    scene.pose(0.5);
    let matrix = scene.instances[0].world_from_object;
    let expected = Mat4::from_quat(Quat::from_xyzw(0., 0., half, half));
    assert!(matrix.abs_diff_eq(expected, 1e-5), "{matrix}");
    scene.pose(1.0);
    assert!((scene.instances[0].world_from_object.x_axis.length() - 2.).abs() < 1e-5);
    let text = "animations[2].channels[0].target.path: is a pointer, but there is none";
    assert!(warnings(&scene).contains(text), "{}", warnings(&scene));
}

#[test]
fn morph_targets_move_vertices_and_flat_normals_follow() {
    let mut file = File::with_triangle();
    let up = file.floats(&[0., 0., 0., 0., 0., 0., 0., 0., 1.], "VEC3");
    let right = file.floats(&[2., 0., 0.].repeat(3), "VEC3");
    file.primitive()["targets"] = json!([{ "POSITION": up }, { "POSITION": right }]);
    file.json["meshes"][0]["weights"] = json!([0, 0.5]);
    let target = json!({ "node": 0, "path": "weights" });
    animate(
        &mut file,
        target,
        "LINEAR",
        &[0., 1.],
        &[0., 0., 1., 0.],
        "SCALAR",
    );
    // A second node shows the same mesh with its own weights, and does not move.
    file.push("nodes", json!({ "mesh": 0, "weights": [0, 1] }));
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    let mut scene = file.load();
    assert_eq!(scene.meshes.len(), 2);
    scene.pose(1.0);
    let [moved, other] = &scene.meshes[..] else {
        panic!()
    };
    assert!(moved.deforms && other.deforms);
    assert_eq!(moved.vertices[2].position, [0., 1., 1.]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    assert!(near(&moved.vertices[0].normal, &[0., -half, half]));
    assert_eq!(scene.objects[0].bounds.max, Vec3::new(1., 1., 1.));
    assert_eq!(other.vertices[0].position, [2., 0., 0.]);
    assert_eq!(scene.objects[1].bounds.min, Vec3::new(2., 0., 0.));
}

#[test]
fn joints_that_do_not_exist_take_no_part_of_a_vertex() {
    let mut file = File::with_triangle();
    // Vertex 0 follows joint 0 and none, vertex 1 joint 0, vertex 2 none that exists.
    let joints = file.accessor(&[0, 9, 0, 0, 0, 0, 0, 0, 9, 8, 0, 0], 5121, "VEC4", 3);
    file.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    let weights = [0.5, 0.5, 0., 0., 1., 0., 0., 0., 0.5, 0.5, 0., 0.];
    file.attribute("WEIGHTS_0", &weights, "VEC4");
    file.push("nodes", json!({ "translation": [10, 0, 0] }));
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    file.push("skins", json!({ "joints": [1] }));
    file.node()["skin"] = json!(0);
    let scene = file.load();
    let places = scene.meshes[0].vertices.iter().map(|v| v.position[0]);
    let rest = File::with_triangle().load();
    let at_rest = rest.meshes[0].vertices.iter().map(|v| v.position[0]);
    for (place, rest) in places.zip(at_rest) {
        assert_eq!(place, rest + 10.0);
    }
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.to_string().contains("ignored"))
    );
}

#[test]
fn a_skin_follows_its_joints_and_ignores_its_own_node() {
    let mut file = File::with_triangle();
    file.attribute("NORMAL", &[0., 0., 1.].repeat(3), "VEC3");
    let joints = file.accessor(&[0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0], 5121, "VEC4", 3);
    file.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    // Vertex 0 follows joint 0, vertex 1 joint 1, vertex 2 both in equal parts (not normalized in
    // the file).
    file.attribute(
        "WEIGHTS_0",
        &[1., 0., 0., 0., 1., 0., 0., 0., 2., 2., 0., 0.],
        "VEC4",
    );
    let back = Mat4::from_translation(Vec3::new(-1., 0., 0.));
    let bind: Vec<f32> = [Mat4::IDENTITY.to_cols_array(), back.to_cols_array()].concat();
    let bind = file.floats(&bind, "MAT4");
    file.push("nodes", json!({ "children": [2] }));
    file.push("nodes", json!({ "translation": [1, 0, 0] }));
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    file.push(
        "skins",
        json!({ "joints": [1, 2], "inverseBindMatrices": bind }),
    );
    file.node()["skin"] = json!(0);
    file.node()["translation"] = json!([100, 100, 100]);
    let target = json!({ "node": 2, "path": "translation" });
    animate(
        &mut file,
        target,
        "LINEAR",
        &[0., 1.],
        &[1., 0., 0., 1., 0., 4.],
        "VEC3",
    );
    // A rigid node shows the same mesh.
    file.push("nodes", json!({ "mesh": 0, "name": "rigid" }));
    file.json["scenes"][0]["nodes"] = json!([0, 1, 3]);
    let mut scene = file.load();
    scene.pose(1.0);
    let at = |i: usize| scene.meshes[scene.instances[0].mesh as usize].vertices[i].position;
    assert_eq!(at(0), [0., 0., 0.]);
    assert_eq!(at(1), [1., 0., 4.]);
    assert_eq!(at(2), [0., 1., 2.]);
    assert_eq!(scene.instances[0].world_from_object, Mat4::IDENTITY);
    assert_eq!(scene.objects[0].bounds.max, Vec3::new(1., 1., 4.));
    let rigid = &scene.meshes[scene.instances[1].mesh as usize];
    assert_eq!(rigid.vertices[1].position, [1., 0., 0.]);
    assert!(!rigid.deforms);
    assert!(warnings(&scene).contains("no skin; it stays rigid"));
}

#[test]
fn a_primitive_without_joints_stays_rigid_at_a_node_with_a_skin() {
    let mut file = File::with_triangle();
    let bare = file.primitive().clone();
    let joints = file.accessor(&[0; 12], 5121, "VEC4", 3);
    file.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    file.attribute("WEIGHTS_0", &[1., 0., 0., 0.].repeat(3), "VEC4");
    let primitives = file.json["meshes"][0]["primitives"].as_array_mut().unwrap();
    primitives.push(bare.clone());
    let two = json!({ "mesh": 0, "skin": 0, "translation": [5, 0, 0] });
    file.json["nodes"] = json!([two, { "translation": [0, 0, 7] }]);
    file.push("skins", json!({ "joints": [1] }));
    // No primitive of another node's mesh has joints.
    file.push("meshes", json!({ "primitives": [bare] }));
    file.push(
        "nodes",
        json!({ "mesh": 1, "skin": 0, "translation": [0, 9, 0] }),
    );
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let still = file.load();
    let text = warnings(&still);
    for (node, primitive) in [(0, 1), (2, 0)] {
        let note = format!(
            "nodes[{node}]: has a skin, but primitive {primitive} of its mesh has no joints; it stays rigid"
        );
        assert!(text.contains(&note), "{text}");
    }
    let places = |scene: &crate::Scene| {
        let corner = |i: &crate::Instance| {
            let vertex = scene.meshes[i.mesh as usize].vertices[0].position;
            i.world_from_object
                .transform_point3(vertex.into())
                .to_array()
        };
        let places: Vec<_> = scene.instances.iter().map(corner).collect();
        for (instance, place) in scene.instances.iter().zip(&places) {
            assert_eq!(instance.bounds.min.to_array(), *place);
        }
        places
    };
    assert_eq!(places(&still), [[0., 0., 7.], [5., 0., 0.], [0., 9., 0.]]);
    assert_eq!(still.objects[0].bounds.max, Vec3::new(6., 1., 7.));
    let target = json!({ "node": 0, "path": "translation" });
    let there = [5., 0., 0., 6., 0., 0.];
    animate(&mut file, target, "LINEAR", &[0., 1.], &there, "VEC3");
    let mut moving = file.load();
    moving.pose(1.0);
    assert_eq!(places(&moving), [[0., 0., 7.], [6., 0., 0.], [0., 9., 0.]]);
}

#[test]
fn morph_targets_move_colours_and_texture_coordinates() {
    let mut file = File::with_triangle();
    file.attribute("COLOR_0", &[0.2, 0.4, 0.6].repeat(3), "VEC3");
    file.attribute("TEXCOORD_0", &[0., 0., 1., 0., 0., 1.], "VEC2");
    file.attribute("TEXCOORD_1", &[0.5; 6], "VEC2");
    let picture = image::RgbaImage::from_pixel(1, 1, [9; 4].into());
    let texture = file.texture(&picture);
    file.material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": texture, "texCoord": 1 } },
        "emissiveTexture": { "index": texture },
    }));
    let colors = file.floats(&[0.4, 0., -1.6, 0., 0., 0., 0., 0., 0.], "VEC3");
    let first = file.floats(&[0., 0., 4., 0., 0., 0.], "VEC2");
    let second = file.floats(&[0., 0., 0., 2., 0., f32::NAN], "VEC2");
    file.primitive()["targets"] = json!([
        { "COLOR_0": colors, "TEXCOORD_0": first, "TEXCOORD_1": second },
        { "COLOR_0": colors },
    ]);
    file.json["meshes"][0]["weights"] = json!([0.5, 0.5]);
    let scene = file.load();
    assert_eq!(scene.warnings, []);
    let vertices = &scene.meshes[scene.instances[0].mesh as usize].vertices;
    // 0.2 + 0.4, and 0.6 - 1.6, which is clamped.
    assert_eq!(vertices[0].color, [39321, 26214, 0, 65535]);
    assert_eq!(vertices[1].color, [13107, 26214, 39321, 65535]);
    let material = &scene.materials[scene.instances[0].material as usize];
    let set = |slot: Option<crate::TextureRef>| slot.unwrap().uv_set as usize;
    let (base, emissive) = (
        set(material.base_color_texture),
        set(material.emissive_texture),
    );
    assert_ne!(base, emissive);
    assert_eq!(vertices[1].uv[emissive], [3., 0.]);
    assert_eq!(vertices[1].uv[base], [0.5, 1.5]);
    assert_eq!(vertices[2].uv[base], [0.5, 0.5]);

    file.primitive()["attributes"]
        .as_object_mut()
        .unwrap()
        .remove("COLOR_0");
    let text = "targets[0] morphs texture coordinates or colours that the primitive does not have";
    assert!(warnings(&file.load()).contains(text));
}

#[test]
fn generated_tangents_follow_morph_targets_that_give_none() {
    let mut file = File::with_triangle();
    file.attribute("TEXCOORD_0", &[0., 0., 1., 0., 0., 1.], "VEC2");
    let picture = image::RgbaImage::from_pixel(1, 1, [128, 128, 255, 255].into());
    let texture = file.texture(&picture);
    file.material(json!({ "normalTexture": { "index": texture } }));
    // A quarter turn; u where v was; a fold out of the plane; a quarter turn with tangents of its own.
    let turned = file.floats(&[0., 0., 0., -1., 1., 0., -1., -1., 0.], "VEC3");
    let mapped = file.floats(&[0., 0., -1., 1., 1., -1.], "VEC2");
    let folded = file.floats(&[0., 0., 0., -1., 0., 2., 0., 0., 0.], "VEC3");
    let none = file.floats(&[0.; 9], "VEC3");
    file.primitive()["targets"] = json!([
        { "POSITION": turned },
        { "TEXCOORD_0": mapped },
        { "POSITION": folded },
        { "POSITION": turned, "TANGENT": none },
    ]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    for (weights, tangent) in [
        ([0., 0., 0., 0.], [1., 0., 0.]),
        ([1., 0., 0., 0.], [0., 1., 0.]),
        ([0.5, 0., 0., 0.], [half, half, 0.]),
        ([0., 1., 0., 0.], [0., 1., 0.]),
        ([0., 0., 1., 0.], [0., 0., 1.]),
        ([0., 0., 0., 1.], [1., 0., 0.]),
    ] {
        file.json["meshes"][0]["weights"] = json!(weights);
        let scene = file.load();
        for vertex in &scene.meshes[scene.instances[0].mesh as usize].vertices {
            assert!(near(&vertex.tangent[..3], &tangent), "{:?}", vertex.tangent);
            assert_eq!(vertex.tangent[3].abs(), 1.0);
        }
    }
}

/// A cube under a node 1 with this transform, by joint 2 or rigid; with its own normals and
/// tangents, or with flat normals that are made for it.
fn cube(root: &Value, skinned: bool, own_normals: bool) -> File {
    let mut file = File::with_mesh();
    let (mut positions, mut normals, mut tangents) = (Vec::new(), Vec::new(), Vec::new());
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for normal in [axis, -axis] {
            let along = normal.any_orthonormal_vector();
            let across = normal.cross(along);
            let corner = |a: f32, b: f32| 0.5 * (normal + a * along + b * across);
            let corners = [
                corner(-1., -1.),
                corner(1., -1.),
                corner(1., 1.),
                corner(-1., 1.),
            ];
            for i in [0, 1, 2, 0, 2, 3] {
                positions.extend(corners[i].to_array());
                normals.extend(normal.to_array());
                tangents.extend(along.extend(1.).to_array());
            }
        }
    }
    file.attribute("POSITION", &positions, "VEC3");
    if own_normals {
        file.attribute("NORMAL", &normals, "VEC3");
        file.attribute("TANGENT", &tangents, "VEC4");
    }
    *file.node() = json!({});
    file.push("nodes", root.clone());
    if skinned {
        let corners = positions.len() / 3;
        let joints = file.accessor(&vec![0; 4 * corners], 5121, "VEC4", corners);
        file.primitive()["attributes"]["JOINTS_0"] = json!(joints);
        file.attribute("WEIGHTS_0", &[1., 0., 0., 0.].repeat(corners), "VEC4");
        file.push("nodes", json!({ "translation": [0.5, 2, 0] }));
        file.push("skins", json!({ "joints": [2] }));
        // The node with the mesh has a transform of its own, which a skin ignores.
        *file.node() = json!({ "mesh": 0, "skin": 0, "scale": [3, 3, 3] });
    } else {
        file.push("nodes", json!({ "mesh": 0, "translation": [0.5, 2, 0] }));
    }
    file.json["nodes"][1]["children"] = json!([2]);
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    file
}

/// Position, normal and tangent of each vertex as renderers place them: normals by the inverse
/// transpose, the bitangent's sign by the determinant. Each triangle's front, by its winding in a
/// mirrored or plain instance, must face as its normals do.
fn in_world(scene: &crate::Scene) -> Vec<[f32; 10]> {
    let [instance] = &scene.instances[..] else {
        panic!("{} instances", scene.instances.len())
    };
    let mesh = &scene.meshes[instance.mesh as usize];
    let matrix = instance.world_from_object;
    let normal_matrix = matrix.inverse().transpose();
    let handedness = matrix.determinant().signum();
    let placed = mesh.indices.iter().map(|&i| {
        let v = &mesh.vertices[i as usize];
        let [x, y, z, w] = v.tangent;
        let position = matrix.transform_point3(v.position.into()).to_array();
        let normal = normal_matrix.transform_vector3(v.normal.into());
        let tangent = matrix.transform_vector3(Vec3::new(x, y, z));
        let (normal, tangent) = (normal.normalize(), tangent.normalize_or_zero());
        let mut all = [0.; 10];
        all[..3].copy_from_slice(&position);
        all[3..6].copy_from_slice(&normal.to_array());
        all[6..].copy_from_slice(&tangent.extend(w * handedness).to_array());
        all
    });
    let placed: Vec<[f32; 10]> = placed.collect();
    for triangle in placed.chunks(3) {
        let [a, b, c] = [0, 1, 2].map(|i| Vec3::from_slice(&triangle[i]));
        let front = handedness * (b - a).cross(c - a);
        let normal = Vec3::from_slice(&triangle[0][3..6]);
        assert!(front.dot(normal) > 0., "{front} and {normal}");
    }
    placed
}

#[test]
fn a_skin_under_a_mirrored_node_looks_as_the_rigid_mesh_does() {
    let turn = Quat::from_rotation_z(0.7) * Quat::from_rotation_x(-0.4);
    for root in [
        json!({ "scale": [-1, 1, 1] }),
        json!({ "scale": [-1, -1, -1] }),
        json!({ "scale": [2, -1, 0.5], "rotation": turn.to_array(), "translation": [1, 2, 3] }),
        json!({ "scale": [-1, -2, 1] }),
    ] {
        for own_normals in [true, false] {
            let [skinned, rigid] =
                [true, false].map(|skinned| cube(&root, skinned, own_normals).load());
            let (found, expected) = (in_world(&skinned), in_world(&rigid));
            assert_eq!(found.len(), 36);
            for (a, b) in found.iter().zip(&expected) {
                assert!(near(a, b), "{root}: {a:?} not {b:?}");
            }
            assert!(skinned.bounds().min.abs_diff_eq(rigid.bounds().min, 1e-5));
            assert!(skinned.bounds().max.abs_diff_eq(rigid.bounds().max, 1e-5));
        }
    }
}

#[test]
fn a_skin_that_an_animation_mirrors_turns_its_winding_around() {
    let [mut skinned, mut rigid] = [true, false].map(|skinned| {
        let mut file = cube(&json!({}), skinned, true);
        let target = json!({ "node": 1, "path": "scale" });
        let scales = [1., 1., 1., -1., 1., 1.];
        animate(&mut file, target, "STEP", &[0., 1.], &scales, "VEC3");
        file.load()
    });
    for time_s in [0., 1., 0.5] {
        skinned.pose(time_s);
        rigid.pose(time_s);
        let mirrored = skinned.instances[0].world_from_object.determinant() < 0.;
        assert_eq!(mirrored, time_s == 1.);
        for (a, b) in in_world(&skinned).iter().zip(&in_world(&rigid)) {
            assert!(near(a, b), "at {time_s}: {a:?} not {b:?}");
        }
    }
}
