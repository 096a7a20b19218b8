//! KHR_animation_pointer: poses are what files with the same values are.

use foveal_seeds::pointers::{MOVES, Moved, animate, hold, movable, pointers};
use serde_json::{Value, json};

use super::{File, Loads, warnings};
use crate::{Clip, Code, Instance, Light, LightKind, LoadOptions, Material, Object, Scene};

/// A file in which these move, and the same file with their values at a time.
fn both(moves: &[Moved], time_s: f32) -> (Scene, Scene) {
    let (mut moving, mut still) = (movable(), movable());
    hold(&mut moving, moves, 0.0);
    animate(&mut moving, moves);
    hold(&mut still, moves, time_s);
    let mut moving = moving.load();
    assert_eq!(moving.warnings, [], "{moves:?}");
    moving.pose(time_s);
    (moving, still.load())
}

/// What is drawn of a material, whatever poses change of it: lobes that show nothing are none.
fn seen(material: &Material) -> Material {
    let mut m = material.clone();
    m.animated = Default::default();
    m.clearcoat = m.clearcoat.filter(|coat| coat.factor > 0.0);
    m.sheen = m.sheen.filter(|sheen| sheen.color != glam::Vec3::ZERO);
    m.anisotropy = m.anisotropy.filter(|a| a.strength > 0.0);
    m.iridescence = m.iridescence.filter(|f| f.factor > 0.0);
    m.transmission = m.transmission.filter(|t| t.factor > 0.0);
    m
}

/// The visible objects' nodes and what is drawn of them.
fn drawn(scene: &Scene) -> Vec<(u32, Vec<Instance>)> {
    let all = scene.objects.iter().filter(|object| object.visible);
    all.map(|object| {
        let range = object.instances.start as usize..object.instances.end as usize;
        // Meshes and objects are numbered in the order in which they are shown.
        let plain = |i: &Instance| Instance {
            mesh: 0,
            object: 0,
            ..*i
        };
        (
            object.node,
            scene.instances[range].iter().map(plain).collect(),
        )
    })
    .collect()
}

fn lit(scene: &Scene) -> Vec<Light> {
    let all = scene.lights.iter().filter(|light| light.intensity > 0.0);
    all.cloned().collect()
}

fn assert_same(pose: &Scene, still: &Scene, what: &str) {
    let materials = |scene: &Scene| scene.materials.iter().map(seen).collect::<Vec<_>>();
    assert_eq!(materials(pose), materials(still), "{what}");
    assert_eq!(drawn(pose), drawn(still), "{what}");
    assert_eq!(lit(pose), lit(still), "{what}");
    assert_eq!(pose.cameras, still.cameras, "{what}");
    let vertices = |scene: &Scene| {
        let of = |object: &Object| scene.instances[object.instances.start as usize].mesh as usize;
        let shown = scene.objects.iter().filter(|object| object.visible);
        shown
            .map(|object| scene.meshes[of(object)].vertices.clone())
            .collect::<Vec<_>>()
    };
    assert!(vertices(pose) == vertices(still), "{what}");
}

#[test]
fn each_pointer_gives_what_a_file_with_the_value_is() {
    for moved in MOVES {
        let at_start = both(&[*moved], 0.0).0;
        for time_s in [0.25, 1.0] {
            let (mut pose, still) = both(&[*moved], time_s);
            assert_same(&pose, &still, moved.pointer);
            assert_eq!(pose.animation_duration_s(), 1.0);
            pose.pose(0.0);
            assert_same(&pose, &at_start, moved.pointer);
        }
        let end = both(&[*moved], 1.0).0;
        let (a, b) = (at_start, end);
        let same = a.materials == b.materials
            && drawn(&a) == drawn(&b)
            && lit(&a) == lit(&b)
            && a.cameras == b.cameras
            && a.meshes == b.meshes;
        assert!(!same, "{} moves nothing", moved.pointer);
    }
}

#[test]
fn all_of_them_together_give_it_too() {
    for time_s in [0.25, 0.75, 1.0] {
        let (pose, still) = both(MOVES, time_s);
        assert_same(&pose, &still, "all");
    }
}

#[test]
fn what_is_hidden_at_first_is_there_for_later() {
    let (mut pose, _) = both(MOVES, 0.0);
    let visible = |scene: &Scene| -> Vec<u32> {
        let shown = scene.objects.iter().filter(|o| o.visible);
        shown.map(|o| o.node).collect()
    };
    assert_eq!(visible(&pose), [1, 2, 3, 4, 6, 9]);
    assert_eq!(lit(&pose).len(), 2);
    pose.pose(1.0);
    assert_eq!(visible(&pose), [1, 2, 3, 6, 7, 8, 9]);
    assert_eq!(lit(&pose).len(), 1);
    // What no pose shows is not read.
    let mut file = movable();
    file.json["nodes"][8]["extensions"] = json!({ "KHR_node_visibility": { "visible": false } });
    animate(&mut file, MOVES);
    let scene = file.load();
    assert!(scene.objects.iter().all(|o| o.node != 8));
}

#[test]
fn another_clip_leaves_what_it_does_not_move_at_rest() {
    let mut file = movable();
    let (color, light): (Vec<Moved>, Vec<Moved>) = MOVES
        .iter()
        .filter(|m| m.pointer.starts_with("/materials/0") || m.pointer.contains("lights"))
        .partition(|m| m.pointer.starts_with("/materials"));
    animate(&mut file, &color);
    animate(&mut file, &light);
    let mut scene = file.load();
    let rest = movable().load();
    scene.pose(1.0);
    assert_ne!(seen(&scene.materials[0]), seen(&rest.materials[0]));
    assert_eq!(scene.lights, rest.lights);
    assert!(scene.play(&Clip::Number(1)));
    scene.pose(1.0);
    assert_eq!(seen(&scene.materials[0]), seen(&rest.materials[0]));
    assert_ne!(scene.lights, rest.lights);
    assert_eq!(scene.clips().len(), 2);
}

#[test]
fn what_poses_may_reach_is_prepared_in_every_pose() {
    let (pose, still) = both(MOVES, 0.0);
    assert!(still.materials[3].clearcoat.is_none() && pose.materials[3].clearcoat.is_some());
    assert!(pose.materials[3].sheen.is_some() && pose.materials[3].anisotropy.is_some());
    assert!(pose.materials[3].iridescence.is_some() && still.materials[3].iridescence.is_none());
    assert!(pose.materials[4].transmission.is_some());
    assert!(!still.materials[1].has_own_specular() && pose.materials[1].has_own_specular());
    assert!(pose.materials[0].animated.uv_transforms);
    assert_eq!(pose.materials[6].animated, Default::default());
}

fn target(pointer: &str) -> Value {
    let extension = json!({ "KHR_animation_pointer": { "pointer": pointer } });
    json!({ "path": "pointer", "extensions": extension })
}

/// Adds a clip with one pointer; the values are floats of a type.
fn point(file: &mut File, pointer: Value, mode: &str, values: &[f32], kind: &str) {
    let times = file.floats(&[0., 1.], "SCALAR");
    let output = file.floats(values, kind);
    file.push(
        "animations",
        json!({
            "samplers": [{ "input": times, "output": output, "interpolation": mode }],
            "channels": [{ "sampler": 0, "target": {
                "path": "pointer",
                "extensions": { "KHR_animation_pointer": { "pointer": pointer } },
            } }],
        }),
    );
}

#[test]
fn a_pointer_that_cannot_be_followed_gives_one_warning() {
    let cases = [
        (json!("/nodes/99/translation"), Code::AnimationPointer),
        (json!("/nodes/01/translation"), Code::AnimationPointer),
        (json!("/nodes/+1/translation"), Code::AnimationPointer),
        (
            json!("/materials/0/extensions/KHR_materials_ior/ior"),
            Code::AnimationPointer,
        ),
        (
            json!("/materials/5/normalTexture/scale"),
            Code::AnimationPointer,
        ),
        (
            json!("/extensions/KHR_lights_punctual/lights/1/range"),
            Code::AnimationPointer,
        ),
        (json!("/nodes/1/name"), Code::AnimationUnsupported),
        (
            json!("/cameras/0/perspective/zfar"),
            Code::AnimationUnsupported,
        ),
        (json!("/materials/0/extras/x"), Code::AnimationUnsupported),
        (
            json!("/materials/0/extensions/KHR_materials_dispersion/dispersion"),
            Code::AnimationUnsupported,
        ),
        (json!(""), Code::AnimationUnsupported),
        (json!("nodes/1/translation"), Code::AnimationUnsupported),
        (json!("/nodes"), Code::AnimationUnsupported),
        (json!("/nodes/1"), Code::AnimationUnsupported),
        (json!(7), Code::ValueType),
        (Value::Null, Code::ValueType),
        // The values do not fit.
        (json!("/nodes/1/rotation"), Code::AccessorType),
        (json!("/materials/0/alphaCutoff"), Code::AccessorType),
        (
            json!("/nodes/4/extensions/KHR_node_visibility/visible"),
            Code::Animation,
        ),
        (json!("/nodes/1/weights"), Code::Animation),
        (json!("/nodes/3/weights/2"), Code::Animation),
    ];
    for (pointer, code) in cases {
        let mut file = movable();
        let is_list = pointer.as_str().is_some_and(|p| p.contains("weights"));
        let kind = if is_list { "SCALAR" } else { "VEC3" };
        point(&mut file, pointer.clone(), "LINEAR", &[1.0; 6], kind);
        let mut scene = file.load();
        let codes: Vec<Code> = scene.warnings.iter().map(|w| w.code).collect();
        assert_eq!(codes, [code], "{pointer}: {}", warnings(&scene));
        scene.pose(0.5);
        assert_same(&scene, &movable().load(), "nothing moves");
    }
}

#[test]
fn a_hidden_light_stays_dark_where_the_channel_that_would_show_it_cannot_be_read() {
    let mut file = movable();
    let nodes = file.json["nodes"].as_array().expect("a list").clone();
    let light = |node: &Value| node["extensions"]["KHR_lights_punctual"]["light"].as_u64();
    let (node, light) = (nodes.iter().enumerate())
        .find_map(|(i, node)| Some((i, light(node)?)))
        .expect("a light");
    let lit_before = lit(&file.load()).len();
    let hidden = json!({ "visible": false });
    file.json["nodes"][node]["extensions"]["KHR_node_visibility"] = hidden;
    // A switch that is interpolated.
    let pointer = json!(format!(
        "/nodes/{node}/extensions/KHR_node_visibility/visible"
    ));
    point(&mut file, pointer, "LINEAR", &[0.0, 1.0], "SCALAR");
    let pointer = json!(format!(
        "/extensions/KHR_lights_punctual/lights/{light}/intensity"
    ));
    point(&mut file, pointer, "LINEAR", &[3.0, 7.0], "SCALAR");
    let mut scene = file.load();
    assert_eq!(scene.warnings.len(), 1, "{}", warnings(&scene));
    assert!(lit(&scene).len() < lit_before);
    for clip in [0, 1] {
        scene.play(&Clip::Number(clip));
        scene.pose(0.5);
        assert!(lit(&scene).len() < lit_before, "clip {clip}");
    }
}

#[test]
fn values_are_brought_into_range_as_those_of_the_file_are() {
    let cases = [
        ("/materials/0/pbrMetallicRoughness/roughnessFactor", 7.0),
        ("/materials/1/extensions/KHR_materials_ior/ior", 0.5),
        ("/materials/1/extensions/KHR_materials_ior/ior", -1.0),
        ("/materials/0/occlusionTexture/strength", -3.0),
        (
            "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength",
            -1.0,
        ),
        (
            "/materials/4/extensions/KHR_materials_volume/attenuationDistance",
            -1.0,
        ),
        ("/extensions/KHR_lights_punctual/lights/0/intensity", -1.0),
        (
            "/extensions/KHR_lights_punctual/lights/1/spot/outerConeAngle",
            9.0,
        ),
    ];
    for (pointer, value) in cases {
        let mut file = movable();
        point(&mut file, json!(pointer), "STEP", &[value; 2], "SCALAR");
        let mut still = movable();
        let (holder, key) = pointer.rsplit_once('/').unwrap();
        still.json.pointer_mut(holder).unwrap()[key] = json!(value);
        let still = still.load();
        assert_same(&file.load(), &still, pointer);
    }
    // A camera that cannot be looked through stays as it is.
    for value in [0.0, -1.0, 4.0] {
        let mut file = movable();
        let pointer = json!("/cameras/0/perspective/yfov");
        point(&mut file, pointer, "STEP", &[value; 2], "SCALAR");
        assert_eq!(file.load().cameras, movable().load().cameras);
    }
}

#[test]
fn integers_are_numbers_and_one_weight_moves_alone() {
    let mut file = movable();
    let times = file.floats(&[0., 1.], "SCALAR");
    let bytes = file.accessor(&[0, 255], 5121, "SCALAR", 2);
    file.json["accessors"][bytes]["normalized"] = json!(true);
    let whole = file.accessor(&[2, 4], 5121, "SCALAR", 2);
    file.push(
        "animations",
        json!({
            "samplers": [{ "input": times, "output": bytes }, { "input": times, "output": whole }],
            "channels": [
                { "sampler": 0, "target": target("/nodes/3/weights/1") },
                { "sampler": 1, "target": target("/extensions/KHR_lights_punctual/lights/0/intensity") },
            ],
        }),
    );
    let mut still = movable();
    still.json["nodes"][3]["weights"] = json!([0, 0.5]);
    still.json["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = json!(3);
    let mut scene = file.load();
    scene.pose(0.5);
    assert_same(&scene, &still.load(), "integers");
}

#[test]
fn two_channels_of_one_property_are_noticed() {
    let mut file = movable();
    let times = file.floats(&[0., 1.], "SCALAR");
    let vectors = file.floats(&[0.; 6], "VEC3");
    let numbers = file.floats(&[0.; 2], "SCALAR");
    let lists = file.floats(&[0.; 4], "SCALAR");
    file.push(
        "animations",
        json!({
            "samplers": [
                { "input": times, "output": vectors },
                { "input": times, "output": numbers },
                { "input": times, "output": lists },
            ],
            "channels": [
                { "sampler": 0, "target": { "node": 1, "path": "translation" } },
                { "sampler": 0, "target": target("/nodes/1/translation") },
                { "sampler": 0, "target": target("/nodes/1/scale") },
                { "sampler": 1, "target": target("/nodes/3/weights/0") },
                { "sampler": 1, "target": target("/nodes/3/weights/1") },
                { "sampler": 2, "target": target("/nodes/3/weights") },
            ],
        }),
    );
    let scene = file.load();
    let places: Vec<&str> = scene.warnings.iter().map(|w| w.text.as_str()).collect();
    assert_eq!(places.len(), 2, "{places:?}");
    assert!(places[0].contains("channels[1]") && places[1].contains("channels[5]"));
    assert!(
        scene
            .warnings
            .iter()
            .all(|w| w.code == Code::AnimationTwice)
    );
}

#[test]
fn a_node_with_a_matrix_is_moved_by_its_translation_alone() {
    let matrix = [2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, 5, 6, 7, 1];
    let still = |node: &mut Value| {
        *node = json!({ "mesh": 1, "matrix": matrix });
    };
    let mut file = movable();
    still(&mut file.json["nodes"][1]);
    let pointer = json!("/nodes/1/translation");
    point(
        &mut file,
        pointer,
        "LINEAR",
        &[0., 0., 0., 2., 4., 6.],
        "VEC3",
    );
    let mut scene = file.load();
    assert_eq!(scene.warnings, []);
    scene.pose(0.5);
    let mut expected = movable();
    still(&mut expected.json["nodes"][1]);
    for (at, value) in [(12, 1), (13, 2), (14, 3)] {
        expected.json["nodes"][1]["matrix"][at] = json!(value);
    }
    assert_same(&scene, &expected.load(), "translation");
    let pointer = json!("/nodes/1/scale");
    point(&mut file, pointer, "LINEAR", &[2.; 6], "VEC3");
    assert!(warnings(&file.load()).contains("rotation and scale are not animated"));
}

#[test]
fn a_required_extension_is_no_obstacle_and_curves_may_leave_the_range_of_numbers() {
    let mut file = pointers();
    file.json["extensionsRequired"] = json!(["KHR_animation_pointer", "KHR_node_visibility"]);
    let options = LoadOptions {
        clip: Clip::All,
        ..LoadOptions::default()
    };
    let scene = file.load_with(&options).unwrap();
    assert_eq!(scene.warnings, []);
    assert!(matches!(scene.lights[1].kind, LightKind::Spot { .. }));

    let mut file = movable();
    let times = file.floats(&[0., 1.], "SCALAR");
    let wild = file.floats(&[f32::MAX; 6], "SCALAR");
    file.push(
        "animations",
        json!({
            "samplers": [{ "input": times, "output": wild, "interpolation": "CUBICSPLINE" }],
            "channels": [{ "sampler": 0, "target": {
                "path": "pointer",
                "extensions": { "KHR_animation_pointer": {
                    "pointer": "/extensions/KHR_lights_punctual/lights/1/spot/outerConeAngle",
                } },
            } }],
        }),
    );
    let mut scene = file.load();
    for i in 0..20 {
        scene.pose(i as f32 * 0.05);
        assert!(scene.lights.iter().all(|l| match l.kind {
            LightKind::Spot {
                inner_rad,
                outer_rad,
            } => inner_rad < outer_rad,
            _ => true,
        }));
    }
}

/// Draws the first primitive twice, once without its tangents.
fn repeat_without_tangents(file: &mut File) {
    let mut again = file.json["meshes"][0]["primitives"][0].clone();
    let attributes = again["attributes"].as_object_mut().unwrap();
    attributes.remove("TANGENT");
    let primitives = file.json["meshes"][0]["primitives"].as_array_mut();
    primitives.unwrap().push(again);
}

#[test]
fn a_normal_map_that_slides_needs_no_second_material() {
    let materials = |part: &str| {
        let pointer = format!("/materials/0/normalTexture/extensions/KHR_texture_transform/{part}");
        let moves = MOVES.iter().copied().filter(|m| m.pointer == pointer);
        let mut file = movable();
        repeat_without_tangents(&mut file);
        animate(&mut file, &moves.collect::<Vec<_>>());
        file.load().materials.len()
    };
    assert_eq!(materials("offset") + 1, materials("rotation"));
}

/// Tangents of the file are taken as they are, and make no others of their material stay.
#[test]
fn generated_tangents_turn_beside_those_of_the_file() {
    let pointer = "/materials/0/normalTexture/extensions/KHR_texture_transform/rotation";
    let moves: Vec<Moved> = (MOVES.iter().copied())
        .filter(|m| m.pointer == pointer)
        .collect();
    let turns = |edit: &dyn Fn(&mut File)| -> Vec<f32> {
        let mut file = movable();
        edit(&mut file);
        hold(&mut file, &moves, 0.0);
        animate(&mut file, &moves);
        let mut scene = file.load();
        scene.pose(1.0);
        let of_first = scene.instances.iter().filter(|i| i.bounds.min.x < -1.0);
        let materials = of_first.map(|i| &scene.materials[i.material as usize]);
        let mapped = materials.filter(|m| m.normal_texture.is_some());
        mapped.map(|m| m.tangent_turn_rad).collect()
    };
    let without = |file: &mut File, mesh: usize| {
        let attributes = &mut file.json["meshes"][mesh]["primitives"][0]["attributes"];
        attributes.as_object_mut().unwrap().remove("TANGENT");
    };
    assert_eq!(turns(&|_| {}), [0.0]);
    let near = |turns: &[f32]| turns.len() == 1 && (turns[0] - 1.5).abs() < 1e-6;
    assert!(near(&turns(&|file| without(file, 0))));
    // A mesh with tangents that no node shows.
    let found = turns(&|file| {
        let other = file.json["meshes"][0].clone();
        file.push("meshes", other);
        without(file, 0);
    });
    assert!(near(&found), "{found:?}");
    // One that a node shows.
    let found = turns(&repeat_without_tangents);
    assert!(found[0] == 0.0 && near(&found[1..]), "{found:?}");
}
