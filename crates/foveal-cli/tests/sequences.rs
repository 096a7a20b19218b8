//! Image sequences: any part of one renders alone and the same, and finished frames can be left
//! out.
//!
//! These tests draw, and need a graphics adapter; Mesa's lavapipe will do.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod common;

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use common::{fail, folder, moving_triangle, names, spawn_in, stderr, succeed};

const SIZE: [&str; 2] = ["--size", "48x32"];

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap()
}

#[test]
fn the_folder_of_a_sequence_is_made_once_the_scene_is_there() {
    let folder = folder();
    let here = folder.path();
    let run = |scene: &'static str, output: &'static str| {
        let words = ["render", scene, "-o", output, "--frames", "2", "--quiet"];
        [&words[..], &SIZE].concat()
    };
    fail(here, &run("missing.gltf", "new/##.png"), &["missing.gltf"]);
    assert!(names(here).is_empty());
    moving_triangle(here);
    succeed(here, &run("triangle.gltf", "new/##.png"));
    assert_eq!(names(&here.join("new")), ["00.png", "01.png"]);
    fail(
        here,
        &run("triangle.gltf", "a/b/##.png"),
        &["'a' does not exist"],
    );
}

#[test]
fn a_part_of_a_sequence_is_the_same_as_in_the_whole() {
    let folder = folder();
    let here = folder.path();
    moving_triangle(here);
    fs::write(
        here.join("path.json"),
        r#"[{"eye": [0, 0.7, 4], "target": [0, 0.7, 0]}, {"eye": [2, 1, 3], "target": [0, 0.7, 0], "fov_y_deg": 40}]"#,
    )
    .unwrap();
    // Motion depends on the frame before: the hardest to get right in the middle.
    for view in ["final", "motion"] {
        let render = |output: &str, frames: &str| {
            let words = [
                "render",
                "triangle.gltf",
                "--path",
                "path.json",
                "--fps",
                "4",
                "--view",
                view,
            ];
            let more = ["-o", output, "--frames", frames];
            succeed(here, &[&words[..], &more, &SIZE].concat());
        };
        render("whole_##.png", "0..5");
        render("part_##.png", "2..4");
        for frame in [2, 3] {
            let (whole, part) = (
                format!("whole_{frame:02}.png"),
                format!("part_{frame:02}.png"),
            );
            assert!(bytes(here, &whole) == bytes(here, &part), "{view} {frame}");
        }
        assert!(
            bytes(here, "whole_01.png") != bytes(here, "whole_02.png"),
            "{view}"
        );
    }
}

/// A mesh of strips, narrower than a pixel, that lie in turn before and behind.
fn strips(folder: &Path) {
    let mut text = String::new();
    for i in 0..256u16 {
        let [left, right] = [i, i + 1].map(|i| f32::from(i) * 0.005);
        let z = f32::from(i % 2) * -0.5;
        for (x, y) in [(left, 0.0), (right, 0.0), (right, 5.2), (left, 5.2)] {
            text += &format!("v {x} {y} {z}\n");
        }
        let first = 4 * i + 1;
        let [second, third, last] = [1, 2, 3].map(|n| first + n);
        text += &format!("f {first} {second} {third} {last}\n");
    }
    fs::write(folder.join("strips.obj"), text).unwrap();
}

#[test]
fn a_picture_has_all_surfaces_of_its_edges_whether_or_not_others_were_drawn_before() {
    let folder = folder();
    let here = folder.path();
    strips(here);
    let render = |output: &str, more: &[&str]| {
        let words = "render strips.obj --size 128x520 --aa msaa --samples 16 \
                     --geometry visibility --stats stats.json -o";
        let words: Vec<&str> = words.split_whitespace().chain([output]).collect();
        succeed(here, &[&words[..], more].concat());
        let stats: serde_json::Value = serde_json::from_slice(&bytes(here, "stats.json")).unwrap();
        assert_eq!(stats["frames"][0]["surfaces_left_out"], 0, "{output}");
    };
    render("first.png", &[]);
    render("later.png", &["--warmup", "3"]);
    assert!(bytes(here, "first.png") == bytes(here, "later.png"));
}

#[test]
fn a_single_picture_is_the_frame_of_its_moment() {
    let folder = folder();
    let here = folder.path();
    moving_triangle(here);
    for view in ["final", "motion"] {
        let words = ["render", "triangle.gltf", "--fps", "10", "--view", view];
        succeed(
            here,
            &[
                &words[..],
                &["-o", "frame_#.png", "--frames", "6..8"],
                &SIZE,
            ]
            .concat(),
        );
        succeed(
            here,
            &[&words[..], &["-o", "still.png", "--time", "0.7"], &SIZE].concat(),
        );
        assert!(
            bytes(here, "frame_7.png") == bytes(here, "still.png"),
            "{view}"
        );
    }
}

#[test]
fn a_frame_after_a_gap_follows_on_nothing() {
    let folder = folder();
    let here = folder.path();
    moving_triangle(here);
    let finished = b"finished elsewhere, with the end of a PNG file\0\0\0\0IEND\xaeB`\x82";
    for shading in ["coarse", "variable"] {
        let words = [
            "render",
            "triangle.gltf",
            "--fps",
            "10",
            "--shading",
            shading,
        ];
        for frame in [3, 4] {
            fs::write(here.join(format!("{shading}_{frame}.png")), finished).unwrap();
        }
        let frames = format!("{shading}_#.png");
        let sequence = ["--frames", "0..6", "--skip-existing", "-o", &frames];
        succeed(here, &[&words[..], &sequence, &SIZE].concat());
        succeed(
            here,
            &[&words[..], &["-o", "still.png", "--time", "0.5"], &SIZE].concat(),
        );
        let after_gap = bytes(here, &format!("{shading}_5.png"));
        assert!(after_gap == bytes(here, "still.png"), "{shading}");
    }
}

#[test]
fn finished_frames_are_left_out_and_the_rest_is_whole() {
    let folder = folder();
    let here = folder.path();
    let words = [
        "render",
        "cornell",
        "-o",
        "f{frame}.png",
        "--frames",
        "3",
        "--skip-existing",
    ];
    let elsewhere = b"finished elsewhere, with the end of a PNG file\0\0\0\0IEND\xaeB`\x82";
    fs::write(here.join("f1.png"), elsewhere).unwrap();
    // As a crash or a full disk might leave it behind; it is not finished.
    fs::write(here.join("f2.png"), b"\x89PNG\r\n").unwrap();
    let output = succeed(here, &[&words[..], &SIZE].concat());
    assert!(
        stderr(&output).contains("1 were there already"),
        "{}",
        stderr(&output)
    );
    // Not a terminal, hence no progress bar.
    assert!(
        !stderr(&output).contains(['\r', '\x1b']),
        "{}",
        stderr(&output)
    );
    assert_eq!(names(here), ["f0.png", "f1.png", "f2.png"]);
    assert_eq!(bytes(here, "f1.png"), elsewhere);
    // A still camera before a still scene.
    assert!(bytes(here, "f0.png") == bytes(here, "f2.png"));
    // One frame alone is missing.
    fs::remove_file(here.join("f2.png")).unwrap();
    let share = [&words[..6], &SIZE, &["--share"]].concat();
    let said = stderr(&succeed(here, &share));
    assert!(
        said.contains("wrote f2.png; 2 were there already"),
        "{said}"
    );
    let output = succeed(here, &[&words[..], &SIZE, &["--stats", "s.json"]].concat());
    let said = stderr(&output);
    assert!(said.contains("all 3 frames"), "{said}");
    // There are no figures: a file of the run before stays.
    assert!(said.contains("'s.json' is not written"), "{said}");
    assert_eq!(names(here), ["f0.png", "f1.png", "f2.png"]);
}

#[test]
fn a_killed_run_leaves_whole_files_only() {
    let folder = folder();
    let here = folder.path();
    let words = [
        "render",
        "cornell",
        "-o",
        "f####.png",
        "--frames",
        "5000",
        "-q",
    ];
    let mut child = spawn_in(here, &[&words[..], &SIZE].concat());
    let started = Instant::now();
    while !here.join("f0002.png").exists() {
        assert!(started.elapsed().as_secs() < 60 && child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(1));
    }
    // Harder than Ctrl-C: the program has no chance to tidy up.
    child.kill().unwrap();
    child.wait().unwrap();
    let frames: Vec<String> = names(here)
        .into_iter()
        .filter(|name| !name.starts_with('.'))
        .collect();
    assert!((3..5000).contains(&frames.len()));
    for name in frames {
        assert_eq!(image::open(here.join(&name)).unwrap().width(), 48, "{name}");
    }
}

#[test]
fn a_quiet_run_says_nothing() {
    let folder = folder();
    let output = succeed(
        folder.path(),
        &[&["render", "cornell", "-o", "a.png", "-q"][..], &SIZE].concat(),
    );
    assert!(
        output.stderr.is_empty() && output.stdout.is_empty(),
        "{}",
        stderr(&output)
    );
}

#[test]
fn flags_change_the_picture() {
    let folder = folder();
    let here = folder.path();
    let render = |name: &str, flags: &[&str]| {
        succeed(
            here,
            &[&["render", "cornell", "-q", "-o", name], &SIZE[..], flags].concat(),
        );
        bytes(here, name)
    };
    let plain = render("plain.png", &[]);
    for flags in [
        &["--view", "normals"][..],
        &["--exposure", "1"],
        &["--tone-map", "linear"],
        &["--lighting", "blinn-phong"],
        &["--fov", "90"],
        &["--eye", "-1,1,3", "--target", "0,1,0"],
        &["--camera", "overview"],
        &["--point-lights", "8"],
    ] {
        assert!(render("other.png", flags) != plain, "{flags:?}");
    }
    assert!(render("same.png", &["--camera", "0", "--warmup", "2"]) == plain);
    assert!(
        render("a.png", &["--point-lights", "8"])
            != render("b.png", &["--point-lights", "8", "--light-seed", "1"])
    );
}

/// Four jobs on one sequence, of which two are killed while they draw.
#[test]
fn jobs_that_share_a_sequence_draw_each_frame_once_and_lose_none() {
    const FRAMES: usize = 24;
    let folder = folder();
    let here = folder.path();
    moving_triangle(here);
    let words = |output: &'static str| {
        let words = [
            "render",
            "triangle.gltf",
            "--fps",
            "8",
            "--frames",
            "24",
            "-o",
            output,
        ];
        [&words[..], &SIZE].concat()
    };
    succeed(here, &words("alone_##.png"));
    let share = || {
        // Long enough for a living job on a busy machine to give a sign.
        let more = ["--share", "--share-expiry", "8"];
        let words = [&words("shared_##.png")[..], &more].concat();
        let mut command = common::command(here, &words);
        command.stderr(Stdio::piped()).spawn().unwrap()
    };
    let drawn = || {
        let is_drawn = |name: &String| name.starts_with("shared_");
        names(here).into_iter().filter(is_drawn).count()
    };
    let mut killed = [share(), share()];
    let start = Instant::now();
    while drawn() < 2 {
        assert!(
            start.elapsed() < Duration::from_secs(300),
            "no frame is drawn"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    for job in &mut killed {
        job.kill().unwrap();
        job.wait().unwrap();
    }
    // What a job that is killed at the worst moment leaves: a claim, and a picture without its end.
    fs::write(here.join(".shared_23.png.claim-0"), "..").unwrap();
    fs::write(here.join("shared_22.png"), b"\x89PNG").unwrap();
    let before = drawn() - 1;
    let mut frames = 0;
    for job in [share(), share()] {
        let output = job.wait_with_output().unwrap();
        let said = stderr(&output);
        assert!(output.status.success(), "{said}");
        let wrote = said.lines().find_map(|line| line.strip_prefix("wrote "));
        frames += match wrote.and_then(|rest| rest.split_once(" frames")) {
            Some((count, _)) => count.parse().unwrap(),
            None => usize::from(wrote.is_some()),
        };
    }
    // All frames are there, as is seen below: none was drawn twice.
    assert_eq!(frames, FRAMES - before);
    for frame in 0..FRAMES {
        let of = |name: &str| bytes(here, &format!("{name}_{frame:02}.png"));
        assert!(of("alone") == of("shared"), "{frame}");
    }
    let claims = names(here)
        .into_iter()
        .filter(|name| name.contains("claim"));
    assert_eq!(claims.collect::<Vec<_>>(), Vec::<String>::new());
}

#[test]
fn parts_of_a_sequence_are_drawn_by_number() {
    let folder = folder();
    let here = folder.path();
    moving_triangle(here);
    for part in ["0/2", "1/2"] {
        let words = [
            "render",
            "triangle.gltf",
            "-o",
            "f_#.png",
            "--frames",
            "3..6",
            "--part",
            part,
        ];
        succeed(here, &[&words[..], &SIZE].concat());
        let drawn = names(here)
            .into_iter()
            .filter(|name| name.starts_with("f_"));
        let expected: &[&str] = if part == "0/2" {
            &["f_3.png"]
        } else {
            &["f_3.png", "f_4.png", "f_5.png"]
        };
        assert_eq!(drawn.collect::<Vec<_>>(), expected);
    }
}

/// Light that is kept from frame to frame makes pictures depend on those before.
#[test]
fn a_part_that_warms_up_over_the_frames_before_it_is_the_same_as_in_the_whole() {
    let folder = folder();
    let here = folder.path();
    let words = "render cornell --path sway --point-lights 4 --fps 8 --shading coarse \
                 --display 60 --rate radii --composite light";
    let words: Vec<&str> = words.split_whitespace().chain(SIZE).collect();
    let render = |output: &str, more: &[&str]| {
        succeed(here, &[&words[..], &["-o", output], more].concat());
    };
    render("whole_#.png", &["--frames", "6"]);
    render("part_#.png", &["--frames", "4..6", "--warmup", "4"]);
    render("cold_#.png", &["--frames", "4..6"]);
    for frame in [4, 5] {
        let of = |name: &str| bytes(here, &format!("{name}_{frame}.png"));
        assert!(of("whole") == of("part"), "{frame}");
        assert!(of("whole") != of("cold"), "{frame}: nothing is kept");
    }
}
