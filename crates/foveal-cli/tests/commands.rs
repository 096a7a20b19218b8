//! What the benches and the report say they did can be done again: each command that stands beside
//! figures is run, and gives them. Needs a graphics adapter.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod common;

use std::fs;
use std::path::Path;

use common::{folder, stdout, succeed};
use serde_json::Value;

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// Runs a line that begins with `foveal`; no word of it has blanks.
fn run(folder: &Path, line: &str, more: &[&str]) -> String {
    let mut words: Vec<&str> = line.split(' ').collect();
    assert_eq!(words.remove(0), "foveal", "{line}");
    words.extend(more);
    stdout(&succeed(folder, &words))
}

/// Draws and compares as these commands say: what `foveal compare`, the last one, found.
fn compared(folder: &Path, made_by: &Value) -> Value {
    let lines: Vec<&str> = (made_by.as_array().unwrap().iter())
        .map(|line| line.as_str().unwrap())
        .collect();
    let (compare, before) = lines.split_last().unwrap();
    for line in before {
        match line.strip_prefix("mkdir -p ") {
            Some(folders) => folders
                .split(' ')
                .for_each(|name| fs::create_dir_all(folder.join(name)).unwrap()),
            None => {
                run(folder, line, &["--quiet"]);
            }
        }
    }
    serde_json::from_str(&run(folder, compare, &["--json"])).unwrap()
}

fn assert_near(found: &Value, said: &Value, what: &str) {
    let (a, b) = (found.as_f64().unwrap(), said.as_f64().unwrap());
    assert!((a - b).abs() < 1e-5, "{what}: {a}, not {b}");
}

#[test]
fn what_the_eye_sees_is_drawn_and_compared_again() {
    let folder = folder();
    let at = folder.path();
    let words =
        "bench eye cornell --display fhd-24 --size 160x90 --rounds 0 --frames 3 --json e.json";
    succeed(at, &words.split(' ').collect::<Vec<_>>());
    let report = json(&at.join("e.json"));
    let rows = report["rows"].as_array().unwrap();
    let row = |way: &str| rows.iter().find(|row| row["way"] == way).unwrap();
    assert_eq!(row("full")["jod"], 10.0);
    assert_eq!(row("full")["lit_fraction"], 1.0);
    for way in ["coarse, light, quality 9", "variable and foveated"] {
        let row = row(way);
        assert!(row["lit_fraction"].as_f64().unwrap() < 1.0, "{row}");
        assert!(row["frame_ms"].is_null(), "no times were asked for");
        for (made_by, jod, flip) in [
            ("picture", "jod", "flip_mean"),
            ("off", "off_jod", "off_flip_mean"),
            ("video", "video_jod", "video_flip_mean"),
        ] {
            let found = compared(at, &row["made_by"][made_by]);
            assert_near(&found["jod"], &row[jod], &format!("{way}, {jod}"));
            assert_near(&found["flip"], &row[flip], &format!("{way}, {flip}"));
            if made_by == "video" {
                assert_near(&found["flicker"], &row["flicker"], way);
            }
        }
    }
}

/// Whether a figure is a time, or follows from times.
fn is_timed(key: &str) -> bool {
    let exact = [
        "ms",
        "ratio",
        "low",
        "high",
        "finding",
        "gain",
        "why",
        "decision",
        "work_gain",
        "spread",
        "pairs",
    ];
    exact.contains(&key) || key.ends_with("_ms") || key.contains("ratio") || key.contains("_ns_")
}

/// The rows that the bench's command writes, as they are in its own file.
fn rows_again(folder: &Path, line: &str) -> Vec<Value> {
    let is_render = line.starts_with("foveal render");
    let file = if is_render { "--stats" } else { "--json" };
    run(folder, line, &[file, "again.json"]);
    let found = json(&folder.join("again.json"));
    match found.get("rows").unwrap_or(&found) {
        Value::Array(rows) => rows.clone(),
        _ => vec![found["median"].clone()],
    }
}

#[test]
fn each_command_of_the_report_gives_its_figures_again() {
    let folder = folder();
    let at = folder.path();
    let words = "bench all cornell --quick --size 96x64 --report r --quiet \
                 --only verdict,baseline,culling,culling-frames,coarse,eye,antialiasing";
    succeed(at, &words.split_whitespace().collect::<Vec<_>>());
    let report = json(&at.join("r/report.json"));
    for bench in report["benches"].as_array().unwrap() {
        let name = bench["name"].as_str().unwrap();
        if bench["status"] != "measured" {
            continue;
        }
        let rows = bench["rows"].as_array().unwrap();
        let commands = bench["commands"].as_array().unwrap();
        assert!(!rows.is_empty() && !commands.is_empty(), "{name}");
        let mut again = Vec::new();
        for command in commands {
            again.extend(rows_again(at, command.as_str().unwrap()));
        }
        if name == "baseline" {
            // Its rows are stages, which are times.
            assert!(again[0]["frame_ms"].as_f64().unwrap() > 0.0);
            continue;
        }
        // Which settings are put together depends on what was faster.
        let is_fixed = |row: &&Value| row["name"] != "These together";
        let said: Vec<&Value> = rows.iter().filter(is_fixed).collect();
        let found: Vec<&Value> = again.iter().filter(is_fixed).collect();
        assert_eq!(said.len(), found.len(), "{name}");
        for (said, found) in said.iter().zip(found) {
            // A technique that turned itself off, as it does by its times, has no error.
            let by_time = said["flip_mean"].is_null() || found["flip_mean"].is_null();
            for (key, value) in said.as_object().unwrap() {
                let Some(now) = found.get(key) else { continue };
                if is_timed(key) {
                    assert_eq!(now.is_number(), value.is_number(), "{name}, {key}");
                } else if !(by_time && matches!(key.as_str(), "flip_mean" | "jod")) {
                    assert_eq!(now, value, "{name}, {}: {key}", said["label"]);
                }
            }
        }
        for picture in bench["pictures"].as_array().unwrap() {
            let made_by =
                ["before_flags", "after_flags", "compare"].map(|key| picture[key].clone());
            let found = compared(at, &Value::from(made_by.to_vec()));
            assert_near(&found["flip"], &picture["flip_mean"], name);
            assert_near(&found["jod"], &picture["jod"], name);
        }
        if name == "verdict" {
            for row in &said {
                // What cannot be drawn here, or turned itself off, has none.
                if row["flip_mean"].is_null() {
                    continue;
                }
                let found = compared(at, &row["made_by"]);
                assert_near(&found["flip"], &row["flip_mean"], &row["name"].to_string());
                assert_near(&found["jod"], &row["jod"], &row["name"].to_string());
            }
        }
    }
}
