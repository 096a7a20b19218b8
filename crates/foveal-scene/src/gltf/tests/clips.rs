//! Clips and variants: what is there is listed, what is asked for is shown, what is missing is
//! named.

use serde_json::json;

use super::{File, Loads, warnings};
use crate::{Clip, LoadOptions};

/// A triangle that `Walk` (2 s) moves along x and `Run` (1 s) along y.
fn walker() -> File {
    let mut file = File::with_triangle();
    for (name, seconds, to) in [("Walk", 2.0, [1.0, 0.0]), ("Run", 1.0, [0.0, 1.0])] {
        let times = file.floats(&[0.0, seconds], "SCALAR");
        let places = file.floats(&[0.0, 0.0, 0.0, to[0], to[1], 0.0], "VEC3");
        file.push(
            "animations",
            json!({
                "name": name,
                "samplers": [{ "input": times, "output": places }],
                "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
            }),
        );
    }
    file
}

fn with(clip: &str) -> LoadOptions {
    LoadOptions {
        clip: clip.parse().unwrap(),
        time_s: 0.5,
        ..LoadOptions::default()
    }
}

/// Where the triangle's corner is half a second into a clip.
fn corner(clip: &str) -> [f32; 2] {
    let scene = walker().load_with(&with(clip)).unwrap();
    let place = scene.instances[0].world_from_object.w_axis;
    [place.x, place.y]
}

#[test]
fn a_clip_plays_alone_by_name_and_by_number() {
    for clip in ["0", "Walk"] {
        assert_eq!(corner(clip), [0.25, 0.0], "{clip}");
    }
    for clip in ["1", "Run"] {
        assert_eq!(corner(clip), [0.0, 0.5], "{clip}");
    }
    // Where clips move the same, the last one of the file wins.
    assert_eq!(corner("all"), [0.0, 0.5]);
    let scene = walker().load();
    let clips: Vec<(&str, f32)> = scene.clips().collect();
    assert_eq!(clips, [("Walk", 2.0), ("Run", 1.0)]);
    assert_eq!(scene.animation_duration_s(), 2.0);
}

#[test]
fn a_clip_whose_name_is_a_number_goes_before_the_clip_of_that_number() {
    let mut file = walker();
    file.json["animations"][0]["name"] = json!("001");
    let place = |file: &File, clip: &str| {
        let scene = file.load_with(&with(clip)).unwrap();
        scene.instances[0].world_from_object.w_axis.truncate()
    };
    for clip in ["001", "0"] {
        assert_eq!(place(&file, clip).to_array(), [0.25, 0.0, 0.0], "{clip}");
    }
    for clip in ["1", "01", "Run"] {
        assert_eq!(place(&file, clip).to_array(), [0.0, 0.5, 0.0], "{clip}");
    }
    file.json["animations"][1]["name"] = json!("0");
    assert_eq!(place(&file, "0").to_array(), [0.0, 0.5, 0.0]);
    let scene = file.load();
    assert_eq!(
        scene.find_clip(&"0".parse().unwrap()),
        Some(Clip::Number(1))
    );
    assert_eq!(scene.find_clip(&Clip::Number(0)), Some(Clip::Number(0)));
    assert_eq!(scene.find_clip(&Clip::Number(2)), None);
    // A number beyond all clips is a name that none has.
    let error = file.load_with(&with("7")).unwrap_err().to_string();
    assert_eq!(error, "test.glb has no clip '7'; there are: 0 '001', 1 '0'");
}

#[test]
fn a_clip_with_the_name_all_is_found_by_its_number() {
    let mut file = walker();
    file.json["animations"][0]["name"] = json!("all");
    let scene = file.load_with(&with("all")).unwrap();
    // Both play, and the second has the last word.
    assert_eq!(scene.instances[0].world_from_object.w_axis.y, 0.5);
    let named = Clip::Named("all".to_owned());
    assert_eq!(scene.find_clip(&named), Some(Clip::Number(0)));
}

#[test]
fn another_clip_may_be_played_later() {
    let mut scene = walker().load();
    assert!(scene.play(&Clip::Named("Run".to_owned())));
    assert_eq!(scene.animation_duration_s(), 1.0);
    scene.pose(0.5);
    assert_eq!(scene.instances[0].world_from_object.w_axis.y, 0.5);
    assert!(!scene.play(&Clip::Number(7)));
    assert_eq!(scene.animation_duration_s(), 1.0);
}

#[test]
fn a_missing_clip_is_named_beside_those_that_there_are() {
    let error = walker().load_with(&with("Jump")).unwrap_err().to_string();
    assert_eq!(
        error,
        "test.glb has no clip 'Jump'; there are: 0 'Walk', 1 'Run'"
    );
    let still = File::with_triangle();
    assert!(still.load_with(&with("0")).is_ok() && still.load_with(&with("all")).is_ok());
    let error = still.load_with(&with("1")).unwrap_err().to_string();
    assert_eq!(error, "test.glb has no clip '1'; there are: none");
}

/// A triangle in material 0, or in 1 for the variant `red`.
fn dressed() -> File {
    let mut file = File::with_triangle();
    file.material(json!({ "name": "plain" }));
    file.push("materials", json!({ "name": "red" }));
    file.json["extensionsUsed"] = json!(["KHR_materials_variants"]);
    file.json["extensions"] = json!({ "KHR_materials_variants": {
        "variants": [{ "name": "blue" }, { "name": "red" }],
    } });
    file.primitive()["extensions"] = json!({ "KHR_materials_variants": {
        "mappings": [{ "material": 1, "variants": [1] }],
    } });
    file
}

#[test]
fn a_variant_changes_the_materials_that_it_names() {
    let shown = |variant: Option<&str>| {
        let options = LoadOptions {
            variant: variant.map(str::to_owned),
            ..LoadOptions::default()
        };
        let scene = dressed().load_with(&options).unwrap();
        assert_eq!(warnings(&scene), "");
        assert_eq!(scene.variants, ["blue", "red"]);
        scene.instances[0].material
    };
    assert_eq!(shown(None), 0);
    assert_eq!(shown(Some("red")), 1);
    assert_eq!(shown(Some("1")), 1);
    assert_eq!(shown(Some("blue")), 0);
    let options = LoadOptions {
        variant: Some("green".to_owned()),
        ..LoadOptions::default()
    };
    let error = dressed().load_with(&options).unwrap_err().to_string();
    assert_eq!(
        error,
        "test.glb has no variant 'green'; there are: 0 'blue', 1 'red'"
    );
}

#[test]
fn variants_that_point_nowhere_are_errors() {
    for (key, value) in [("material", json!(9)), ("variants", json!([2]))] {
        let mut file = dressed();
        let mapping = &mut file.primitive()["extensions"]["KHR_materials_variants"]["mappings"][0];
        mapping[key] = value;
        assert!(
            file.refusal()
                .contains("KHR_materials_variants.mappings[0]")
        );
    }
}

#[test]
fn an_overview_shows_what_a_clip_makes_grow_out_of_nothing() {
    for first in [0.0, 1e-3, 0.5] {
        let mut file = File::with_triangle();
        let times = file.floats(&[0.0, 1.0], "SCALAR");
        let scales = file.floats(&[first, first, first, 1.0, 1.0, 1.0], "VEC3");
        file.push(
            "animations",
            json!({
                "samplers": [{ "input": times, "output": scales }],
                "channels": [{ "sampler": 0, "target": { "node": 0, "path": "scale" } }],
            }),
        );
        let scene = file.load();
        assert_eq!(scene.bounds().max.x, first);
        let distance = |scene: &crate::Scene| scene.overview_camera().eye().length();
        let whole = distance(&File::with_triangle().load());
        let part = distance(&scene) / whole;
        // What is there at the beginning fills the picture.
        let expected = if first == 0.5 { 0.5 } else { 1.0 };
        assert!((part - expected).abs() < 0.01, "{first}: {part}");
    }
}

#[test]
fn the_scene_that_is_asked_for_is_shown() {
    let mut file = File::with_triangle();
    file.json["nodes"] = json!([
        { "name": "near", "mesh": 0 },
        { "name": "far", "mesh": 0, "translation": [0, 0, -9] },
    ]);
    file.json["scenes"] = json!([{ "name": "one", "nodes": [0] }, { "nodes": [0, 1] }]);
    file.json["scene"] = json!(1);
    let of = |scene: Option<&str>| LoadOptions {
        file_scene: scene.map(str::to_owned),
        ..LoadOptions::default()
    };
    for (asked, instances) in [(None, 2), (Some("one"), 1), (Some("0"), 1), (Some("1"), 2)] {
        let scene = file.load_with(&of(asked)).expect("it is well formed");
        assert_eq!(scene.instances.len(), instances, "{asked:?}");
        assert_eq!(scene.file_scenes, ["one", ""]);
    }
    let error = file.load_with(&of(Some("two"))).unwrap_err().to_string();
    assert!(
        error.ends_with("has no scene 'two'; there are: 0 'one', 1 ''"),
        "{error}"
    );
}
