//! What is broken and nothing shown needs: the rest of the file is shown.

use glam::Vec3;
use serde_json::{Value, json};

use super::{File, Loads, warnings};
use crate::{Clip, LoadOptions};

/// A triangle whose vertices follow joint 0 of a skin, if its node has one.
fn with_joints() -> File {
    let mut file = File::with_triangle();
    let joints = file.accessor(&[0; 12], 5121, "VEC4", 3);
    file.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    file.attribute("WEIGHTS_0", &[1., 0., 0., 0.].repeat(3), "VEC4");
    file
}

#[test]
fn a_broken_skin_is_an_error_only_where_a_shown_node_has_it() {
    let mut file = with_joints();
    let one = file.floats(&[1.; 16], "MAT4");
    let three = file.floats(&[0.; 9], "VEC3");
    let whole = file.accessor(&[0; 32], 5123, "MAT4", 1);
    let cases: [(Value, &str); 6] = [
        (json!({ "joints": [] }), "skins[1].joints: is empty"),
        (
            json!({ "joints": [9] }),
            "skins[1].joints[0]: names number 9, there are 2",
        ),
        (
            json!({ "joints": "all" }),
            "skins[1].joints: is a string instead of an array",
        ),
        (
            json!({ "joints": [0, 1], "inverseBindMatrices": one }),
            "skins[1].inverseBindMatrices: has 1 matrices for 2 joints",
        ),
        (
            json!({ "joints": [0], "inverseBindMatrices": whole }),
            "skins[1].inverseBindMatrices: is not of 32-bit floats",
        ),
        // Not looked into without need: the type shows where it is read.
        (json!({ "joints": [0], "inverseBindMatrices": three }), ""),
    ];
    file.node()["skin"] = json!(0);
    file.push("nodes", json!({ "mesh": 0, "skin": 1 }));
    for (skin, fault) in cases {
        file.json["skins"] = json!([{ "joints": [0] }, skin]);
        file.json["scenes"][0]["nodes"] = json!([0]);
        let text = warnings(&file.load());
        if fault.is_empty() {
            assert_eq!(text, "");
        } else {
            assert_eq!(text, format!("{fault}; nothing shown uses it"));
        }
        file.json["scenes"][0]["nodes"] = json!([0, 1]);
        let refusal = file.refusal();
        assert!(refusal.contains("broken at skins[1]."), "{refusal}");
        assert!(
            refusal.contains(&fault.replace("skins[1].", "")),
            "{refusal}"
        );
    }
}

#[test]
fn channels_that_are_broken_are_left_out_and_the_others_play() {
    let mut file = File::with_triangle();
    let times = file.floats(&[0., 1.], "SCALAR");
    let places = file.floats(&[0., 0., 0., 0., 4., 0.], "VEC3");
    let target = json!({ "node": 0, "path": "translation" });
    let samplers = json!([
        { "input": times, "output": places, "interpolation": "SMOOTH" },
        { "input": times, "output": 99 },
        { "output": places },
        7,
        { "input": times, "output": places },
    ]);
    let channels = json!([
        { "sampler": 0, "target": target },
        { "sampler": 1, "target": target },
        { "sampler": 2, "target": target },
        { "sampler": 3, "target": target },
        { "sampler": 4, "target": { "node": 99, "path": "translation" } },
        { "sampler": 5, "target": target },
        { "target": target },
        { "sampler": 4 },
        { "sampler": 4, "target": { "node": 0 } },
        [],
        { "sampler": 4, "target": target },
    ]);
    for broken in [
        json!(5),
        json!({ "channels": 5 }),
        json!({ "samplers": {}, "channels": channels }),
    ] {
        file.push("animations", broken);
    }
    let last = json!({ "name": "Jump", "samplers": samplers, "channels": channels });
    file.push("animations", last);
    let options = LoadOptions {
        clip: Clip::Named("Jump".to_owned()),
        time_s: 0.5,
        ..LoadOptions::default()
    };
    let scene = file.load_with(&options).unwrap();
    assert_eq!(scene.objects[0].bounds.min, Vec3::new(0., 2., 0.));
    // Numbers are the file's.
    assert_eq!(scene.find_clip(&options.clip), Some(Clip::Number(3)));
    let text = warnings(&scene);
    for (place, fault) in [
        (
            "sampler 0 interpolation",
            "\"SMOOTH\" is not an interpolation",
        ),
        ("sampler 1 output", "names number 99, there are 3"),
        ("sampler 2 input", "is missing"),
        ("sampler 3", "is a number instead of an object"),
        ("target.node", "names number 99, there are 1"),
        ("sampler", "names number 5, there are 5"),
        ("sampler", "is missing"),
        ("target", "is missing"),
        ("target.path", "is missing"),
        ("", "is an array instead of an object"),
    ]
    .iter()
    .enumerate()
    .map(|(i, (place, fault))| {
        let dot = if place.is_empty() { "" } else { "." };
        (format!("animations[3].channels[{i}]{dot}{place}"), fault)
    }) {
        let note = format!("{place}: {fault}; this channel is not played");
        assert!(text.contains(&note), "{note} in {text}");
    }
    for note in [
        "animations[0]: is a number instead of an object; this animation is not played",
        "animations[1].channels: is a number instead of an array; this animation is not played",
        "animations[2].samplers: is an object instead of an array; this animation is not played",
    ] {
        assert!(text.contains(note), "{note} in {text}");
    }
    assert_eq!(scene.warnings.len(), 13, "{text}");
}
