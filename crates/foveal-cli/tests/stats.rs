//! `--stats` and `adapters --json` write what their documentation says. They need a graphics
//! adapter.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod common;

use std::fs;

use common::{folder, schema::violations, stdout, succeed};
use serde_json::Value;

const SCHEMA: &str = include_str!("../../../docs/stats.schema.json");

fn stats(words: &[&str]) -> Value {
    let folder = folder();
    let words = [
        &["render", "cornell", "--size", "48x32", "--stats", "s.json"],
        words,
    ]
    .concat();
    succeed(folder.path(), &words);
    serde_json::from_str(&fs::read_to_string(folder.path().join("s.json")).unwrap()).unwrap()
}

#[test]
fn stats_keep_to_their_schema() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    for words in [
        &["-o", "a.png"][..],
        &["-o", "a_#.png", "--frames", "3", "--warmup", "1"],
    ] {
        let stats = stats(words);
        assert_eq!(violations(&schema, &stats), [""; 0]);
        assert_eq!(
            stats["frames"].as_array().unwrap().len(),
            if words.len() == 2 { 1 } else { 3 }
        );
    }
}

#[test]
fn the_schema_finds_what_is_wrong() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    let mut stats = stats(&["-o", "a.png"]);
    stats["schema_version"] = 2.into();
    stats["frames"][0]["draws"] = (-1).into();
    stats["scene"].as_object_mut().unwrap().remove("name");
    stats["adapter"]["price"] = 100.into();
    assert_eq!(violations(&schema, &stats).len(), 4);
}

#[test]
fn stats_say_what_was_drawn() {
    let stats = stats(&["-o", "a.png", "--point-lights", "7"]);
    let frame = &stats["frames"][0];
    assert_eq!(
        (&frame["width"], &frame["height"]),
        (&48.into(), &32.into())
    );
    assert_eq!(frame["shaded_samples"], 48 * 32);
    assert!(frame["draws"].as_u64() > Some(0) && frame["triangles"].as_u64() > Some(0));
    assert!(
        frame["frame_ms"].as_f64() > Some(0.0) && !frame["cpu_ms"].as_array().unwrap().is_empty()
    );
    assert_eq!(stats["settings"]["width"], 48);
    assert_eq!(stats["median"]["frame_ms"], frame["frame_ms"]);
    let scene = foveal_generate::by_name("cornell").unwrap();
    assert_eq!(stats["scene"]["lights"], scene.lights.len() + 7);
    assert_eq!(stats["scene"]["triangles"], scene.triangle_count());
}

#[test]
fn textures_in_blocks_take_a_part_and_look_nearly_the_same() {
    let folder = folder();
    let drawn = |name: &str, flag: Option<&str>| {
        let (picture, json) = (format!("{name}.png"), format!("{name}.json"));
        let mut words = vec!["render", "materials", "--size", "320x200", "-o", &picture];
        words.extend(["--stats", &json]);
        words.extend(flag);
        let output = succeed(folder.path(), &words);
        let stats = fs::read_to_string(folder.path().join(json)).unwrap();
        let stats: Value = serde_json::from_str(&stats).unwrap();
        let bytes = stats["scene"]["texture_bytes"].as_u64().unwrap();
        // A device that does not read blocks has texels, and a warning says so.
        let said = common::stderr(&output);
        (bytes, !said.contains("does not read textures in blocks"))
    };
    let (plain, _) = drawn("plain", None);
    for (name, flag, part, most, least) in [
        ("small", "--texture-compression", 0.18, "0.003", "0.00001"),
        (
            "fine",
            "--texture-compression=fine",
            0.26,
            "0.01",
            "0.000001",
        ),
    ] {
        let (bytes, reads) = drawn(name, Some(flag));
        let found = bytes as f64 / plain as f64;
        assert!(if reads { found < part } else { bytes == plain }, "{found}");
        let picture = format!("{name}.png");
        let compared = ["compare", "plain.png", &picture, "--max-flip"];
        succeed(folder.path(), &[&compared[..], &[most]].concat());
        let other = common::foveal_in(folder.path(), &[&compared[..], &[least]].concat());
        assert_eq!(other.status.code(), Some(1), "they differ");
    }
}

#[test]
fn adapters_are_listed_for_programs_and_for_people() {
    let folder = folder();
    let json: Value =
        serde_json::from_str(&stdout(&succeed(folder.path(), &["adapters", "--json"]))).unwrap();
    let text = stdout(&succeed(folder.path(), &["adapters"]));
    for (number, adapter) in json.as_array().unwrap().iter().enumerate() {
        assert_eq!(adapter["number"], number);
        assert!(text.contains(adapter["name"].as_str().unwrap()));
    }
}

#[test]
fn scene_info_lists_the_cameras() {
    let folder = folder();
    common::moving_triangle(folder.path());
    let text = stdout(&succeed(
        folder.path(),
        &["scene", "info", "triangle.gltf", "--json"],
    ));
    let info: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(info["animated"], true);
    assert_eq!(info["triangles"], 1);
    assert_eq!(info["cameras"][0]["name"], "front");
    assert_eq!(info["bounds"]["max"], serde_json::json!([0.0, 1.5, 0.0]));
}

#[test]
fn scene_info_gives_warnings_and_errors_with_their_codes() {
    let folder = folder();
    common::moving_triangle(folder.path());
    let path = folder.path().join("triangle.gltf");
    let text = fs::read_to_string(&path).unwrap();
    let used = text.replace("\"asset\"", "\"extensionsUsed\": [\"ACME_x\"], \"asset\"");
    fs::write(&path, used).unwrap();
    let words = ["scene", "info", "triangle.gltf", "--json"];
    let info: Value = serde_json::from_str(&stdout(&succeed(folder.path(), &words))).unwrap();
    assert_eq!(info["warnings"][0]["code"], "EXTENSION_IGNORED");
    let sentence = "extensionsUsed: ACME_x is not supported; the file is shown without it";
    assert_eq!(info["warnings"][0]["text"], sentence);

    fs::write(&path, "[]").unwrap();
    let output = common::foveal_in(folder.path(), &words);
    assert_eq!(output.status.code(), Some(1));
    let said: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(said["error"]["code"], "NOT_GLTF");
    let text = said["error"]["text"].as_str().unwrap();
    assert!(common::stderr(&output).contains(text), "{said}");

    let flags = [&words[..], &["--max-triangles", "0"]].concat();
    fs::remove_file(&path).unwrap();
    common::moving_triangle(folder.path());
    let output = common::foveal_in(folder.path(), &flags);
    let said: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(said["error"]["code"], "LIMIT_EXCEEDED", "{said}");
}
