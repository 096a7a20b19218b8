//! Whole runs of `foveal cull`, as the command line starts them.

use std::path::PathBuf;

use clap::Parser;
use serde_json::Value;

use super::{Args, Report, cull, verdict};

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    args: Args,
}

fn culled(words: &[&str]) -> anyhow::Result<Report> {
    let line = ["cull", "--frames", "1", "--quiet"]
        .iter()
        .chain(words)
        .copied();
    let args = Line::try_parse_from(line)?.args;
    args.check()?;
    cull(&args)
}

/// A file that is not part of the repository.
fn shared(path: &str) -> Option<PathBuf> {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data")
        .join(path);
    if !file.exists() {
        eprintln!("skipped: there is no '{}'", file.display());
        return None;
    }
    Some(file)
}

#[test]
fn every_object_has_one_result_and_the_figures_add_up() {
    for scene in ["cornell", "demo:1000"] {
        let report = culled(&[scene]).unwrap();
        let json: Value = serde_json::from_str(&serde_json::to_string(&report).unwrap()).unwrap();
        assert_eq!(json["schema"], "foveal-cull");
        assert_eq!(json["schema_version"], 1);
        for camera in json["cameras"].as_array().unwrap() {
            let occludees = &camera["occludees"];
            let count = |key: &str| occludees[key].as_u64().unwrap();
            let objects = camera["objects"].as_array().unwrap();
            assert_eq!(objects.len() as u64, count("models"));
            assert_eq!(count("culled") + count("visible"), count("models"));
            assert_eq!(
                count("culled_triangles") + count("visible_triangles"),
                count("triangles")
            );
            for (word, key) in [
                ("visible", "visible"),
                ("frustum", "culled_by_frustum"),
                ("size", "culled_by_size"),
                ("occluded", "culled_by_occlusion"),
            ] {
                let with = objects.iter().filter(|o| o["result"] == word).count();
                assert_eq!(with as u64, count(key), "{word}");
            }
            assert!(camera["occluders"]["rasterize_ms"].as_f64().unwrap() >= 0.0);
            assert!(camera["far"].is_null() && camera["check"].is_null());
            let draws = &camera["draw_calls"];
            assert!(draws["occlusion"].as_u64() <= draws["frustum"].as_u64());
            assert!(draws["frustum"].as_u64() <= draws["off"].as_u64());
        }
    }
}

#[test]
fn nothing_visible_is_culled_from_small_scenes() {
    for scene in ["cornell", "demo:1000"] {
        let report = culled(&[scene, "--check", "--size", "160x90"]).unwrap();
        verdict(&report).unwrap();
        assert!(report.cameras.iter().all(|c| c.check.is_some()));
    }
}

#[test]
fn one_result_holds_for_two_eyes_and_for_all_places_within_a_radius() {
    let hidden = |words: &[&str]| {
        let mut line = vec!["demo:1000", "--size", "96x54", "--check"];
        line.extend(words);
        let report = culled(&line).unwrap();
        verdict(&report).unwrap();
        let figures = report.cameras.iter().map(|c| &c.figures.occludees);
        figures.map(|f| f.culled_by_occlusion).sum::<u64>()
    };
    let one = hidden(&[]);
    let two = hidden(&["--eyes-apart", "0.066"]);
    let around = hidden(&["--validity-radius", "0.05"]);
    assert!(0 < two && two <= one, "{one} {two}");
    assert!(around <= one, "{one} {around}");
}

#[test]
fn an_orthographic_camera_has_no_two_eyes() {
    let file = std::env::temp_dir().join(format!("foveal-two-eyes-{}.json", std::process::id()));
    let cameras = r#"[{"eye": [0, 5, 0], "target": [0, 0, 1], "ortho_height": 4, "far": 50}]"#;
    std::fs::write(&file, cameras).unwrap();
    let path = file.to_str().unwrap();
    let error = culled(&["cornell", "--cameras", path, "--eyes-apart", "0.06"]).unwrap_err();
    assert!(format!("{error:#}").contains("--eyes-apart"), "{error:#}");
    std::fs::remove_file(&file).unwrap();
}

#[test]
fn a_spent_budget_draws_nothing_and_culls_nothing_by_occlusion() {
    let report = culled(&["demo:1000", "--budget-ms", "0"]).unwrap();
    for camera in &report.cameras {
        let occluders = &camera.figures.occluders;
        assert_eq!(occluders.rasterized_models, 0);
        assert!(occluders.clusters_over_budget > 0);
        assert_eq!(camera.figures.occludees.culled_by_occlusion, 0);
    }
}

#[test]
fn threads_do_not_change_an_answer() {
    let results = |threads: &str| -> Vec<&str> {
        let report = culled(&["demo:1000", "--threads", threads]).unwrap();
        let objects = report.cameras.iter().flat_map(|c| &c.objects);
        objects.map(|o| o.result).collect()
    };
    assert_eq!(results("1"), results("3"));
}

#[test]
fn a_wrong_camera_file_is_named_with_entry_and_key() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("eyes.json");
    let name = file.to_str().unwrap();
    for (text, cause) in [
        (
            r#"[{"eye":[0,1,"x"],"target":[0,0,0],"fov_y_deg":60}]"#,
            "'eye'",
        ),
        (
            r#"[{"eye":[0,1e999,0],"target":[0,0,0],"fov_y_deg":60}]"#,
            "number",
        ),
        (
            r#"[{"eye":[0,1,0],"target":[0,0,0],"fov_y_deg":-3}]"#,
            "'fov_y_deg'",
        ),
    ] {
        std::fs::write(&file, text).unwrap();
        let error = format!("{:#}", culled(&["cornell", "--cameras", name]).unwrap_err());
        assert!(
            error.contains("eyes.json") && error.contains(cause),
            "{error}"
        );
    }
}

#[test]
fn pictures_are_written_one_per_camera() {
    let folder = tempfile::tempdir().unwrap();
    let cameras = folder.path().join("eyes.json");
    let eye = r#"{"eye":[0,1,3],"target":[0,1,0],"fov_y_deg":60}"#;
    std::fs::write(&cameras, format!("[{eye},{eye}]")).unwrap();
    let depth = folder.path().join("depth.png");
    let overlay = folder.path().join("overlay.png");
    let text = |path: &PathBuf| path.to_str().unwrap().to_owned();
    culled(&[
        "cornell",
        "--cameras",
        &text(&cameras),
        "--depth",
        &text(&depth),
        "--overlay",
        &text(&overlay),
    ])
    .unwrap();
    for name in [
        "depth-0.png",
        "depth-1.png",
        "overlay-0.png",
        "overlay-1.png",
    ] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
}

#[test]
fn recorded_draws_are_replayed() {
    for number in 0..3 {
        let Some(file) = shared(&format!("mocrec/OcclusionCulling_{number}.mocrec")) else {
            return;
        };
        let report = culled(&[file.to_str().unwrap()]).unwrap();
        let occluders = &report.cameras[0].figures.occluders;
        assert!(occluders.models >= 9 && occluders.rasterized_triangles > 1000);
    }
}

#[test]
fn a_broken_recording_is_refused_with_the_record() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.mocrec");
    let mut bytes = 0xA701_B600_u32.to_le_bytes().to_vec();
    bytes.extend(0.1_f32.to_le_bytes());
    bytes.extend([0; 8]);
    for (body, cause) in [
        (&[][..], "record 0"),
        (&[9][..], "0x9"),
        (&[0, 0, 0, 0, 0, 255, 255, 255, 255][..], "-1 vertices"),
        (
            &[0, 0, 0, 0, 0, 255, 255, 255, 127, 12, 0, 0, 0][..],
            "ends",
        ),
    ] {
        std::fs::write(&file, [&bytes, body].concat()).unwrap();
        let error = format!("{:#}", culled(&[file.to_str().unwrap()]).unwrap_err());
        assert!(
            error.contains("a.mocrec") && error.contains(cause),
            "{error}"
        );
    }
}

/// Six views of 90° from every position in the list of nodes that rays hit from there.
fn never_culls_what_rays_hit(scene: &str) {
    let (Some(file), Some(list)) = (
        shared(&format!("scenes/{scene}.glb")),
        shared(&format!("scenes/{scene}.rayvis.json")),
    ) else {
        return;
    };
    let list: Value = serde_json::from_slice(&std::fs::read(list).unwrap()).unwrap();
    let positions = list["cameras"].as_array().unwrap();
    let mut cameras = Vec::new();
    for camera in positions {
        let p: Vec<f64> = camera["pos"]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect();
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let mut target = p.clone();
                target[axis] += sign;
                let up = if axis == 1 { [0, 0, 1] } else { [0, 1, 0] };
                cameras.push(serde_json::json!({
                    "eye": p, "target": target, "up": up, "fov_y_deg": 90, "aspect": 1, "near": 0.01
                }));
            }
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("eyes.json");
    std::fs::write(&path, serde_json::to_string(&cameras).unwrap()).unwrap();
    let report = culled(&[
        file.to_str().unwrap(),
        "--cameras",
        path.to_str().unwrap(),
        "--size",
        "256x256",
    ])
    .unwrap();
    let mut lost = Vec::new();
    for (number, (position, views)) in positions.iter().zip(report.cameras.chunks(6)).enumerate() {
        for node in position["ray_visible"].as_object().unwrap().keys() {
            let node: u32 = node.parse().unwrap();
            let seen = views
                .iter()
                .flat_map(|view| &view.objects)
                .any(|o| o.node == node && o.result == "visible");
            if !seen {
                lost.push((number, node));
            }
        }
    }
    assert!(lost.is_empty(), "(position, node): {lost:?}");
}

#[test]
fn no_node_of_the_castle_that_a_ray_hits_is_culled() {
    never_culls_what_rays_hit("IntelCastle");
}

#[test]
fn no_node_of_sponza_that_a_ray_hits_is_culled() {
    never_culls_what_rays_hit("Sponza");
}
