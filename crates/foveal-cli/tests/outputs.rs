//! What `foveal render` writes besides PNG files: radiance, standard output, videos; and a scene
//! from standard input.
//!
//! These tests draw, and need a graphics adapter; Mesa's lavapipe will do.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod common;

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

use common::{command, fail, folder, moving_triangle, names, stderr, succeed};

const SIZE: [&str; 2] = ["--size", "48x32"];

fn render<'a>(words: &[&'a str]) -> Vec<&'a str> {
    [&["render", "cornell", "-q"], words, &SIZE].concat()
}

/// Display value of linear light, as `--tone-map linear` maps it.
fn displayed(linear: f32) -> f32 {
    let v = linear.clamp(0.0, 1.0);
    let encoded = if v <= 0.003_130_8 {
        12.92 * v
    } else {
        1.055 * v.powf(1.0 / 2.4) - 0.055
    };
    255.0 * encoded
}

#[test]
fn radiance_exposed_and_encoded_is_the_picture() {
    let folder = folder();
    let here = folder.path();
    let eyes = &["--stereo", "instanced"][..];
    let shown = &["--stereo", "instanced", "--show", "side-by-side"][..];
    // Radiance is side by side whether or not that is said.
    for (eyes, said) in [(&[][..], &[][..]), (shown, shown), (shown, eyes)] {
        for (file, flags) in [("a.png", eyes), ("a.exr", said), ("a.hdr", said)] {
            let words = ["-o", file, "--tone-map", "linear", "--exposure", "1"];
            succeed(here, &render(&[&words[..], flags].concat()));
        }
        let picture = image::open(here.join("a.png")).unwrap().into_rgb8();
        // Channels of a pixel in an .hdr file are multiples of up to 1/128 of its brightest one.
        for (file, step) in [("a.exr", 0.0), ("a.hdr", 1.0 / 128.0)] {
            let radiance = image::open(here.join(file)).unwrap().into_rgb32f();
            assert_eq!(radiance.dimensions(), picture.dimensions(), "{file}");
            let mut brightest = 0.0f32;
            for (linear, shown) in radiance.pixels().zip(picture.pixels()) {
                let step = step * linear.0.into_iter().fold(0.0, f32::max);
                for (linear, shown) in linear.0.iter().zip(shown.0) {
                    // Exposure 1 doubles.
                    let by = |off: f32| displayed(2.0 * (linear + off));
                    let fits = by(-step) - 0.6..=by(step) + 0.6;
                    let fits = fits.contains(&f32::from(shown));
                    assert!(fits, "{file}: {linear} is shown as {shown}");
                    brightest = brightest.max(*linear);
                }
            }
            assert!(
                brightest > 0.5,
                "{file}: the scene's light source is bright"
            );
        }
    }
}

#[cfg(unix)]
#[test]
fn settings_through_a_pipe_hold_for_radiance() {
    let folder = folder();
    let words = ["render", "cornell", "-q", "-o", "a.exr"];
    let words = [&words[..], &["--settings", "/dev/stdin"]].concat();
    let mut child = (command(folder.path(), &words).stdin(Stdio::piped()))
        .spawn()
        .unwrap();
    let settings = b"width = 10\nheight = 20\n";
    child.stdin.take().unwrap().write_all(settings).unwrap();
    assert!(child.wait().unwrap().success());
    let picture = image::open(folder.path().join("a.exr")).unwrap();
    assert_eq!((picture.width(), picture.height()), (10, 20));
}

#[test]
fn radiance_of_what_has_none_is_refused() {
    let folder = folder();
    for (flags, named) in [
        (&["--view", "depth"][..], "--view"),
        (&["--stereo", "instanced", "--show", "anaglyph"], "--show"),
        (&["--stereo", "instanced", "--show", "flat"], "--show"),
        (&["--stereo", "instanced", "-o", "flat"], "--show"),
        (&["--render-scale", "0.5"], "--render-scale"),
    ] {
        let output = command(folder.path(), &render(&[&["-o", "a.exr"], flags].concat()));
        let output = { output }.output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(named), "{}", stderr(&output));
    }
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn a_picture_of_an_environment_that_is_not_read_is_named() {
    let folder = folder();
    let words = ["-o", "a.png", "--environment-image", "a.hdr"];
    let said = |words: &[&str]| {
        let words = [&["render", "cornell"], words, &SIZE].concat();
        stderr(&succeed(folder.path(), &words))
    };
    let warning = "warning: --environment-image is not read: it is for --environment image";
    assert!(said(&words).contains(warning));
    assert!(!said(&words[..2]).contains(warning));
}

#[test]
fn a_picture_of_rates_that_is_not_read_is_named() {
    let folder = folder();
    let here = folder.path();
    succeed(here, &render(&["-o", "rates.png"]));
    let said = |words: &[&str]| {
        let named = [
            "render",
            "cornell",
            "-o",
            "a.png",
            "--rate-image",
            "rates.png",
        ];
        let said = stderr(&succeed(here, &[&named, words, &SIZE].concat()));
        said.contains("warning: --rate-image is not read")
    };
    assert!(said(&["--shading", "coarse"]));
    assert!(said(&["--shading", "full", "--rate", "image"]));
    assert!(!said(&["--shading", "coarse", "--rate", "image"]));
}

#[test]
fn flags_of_eyes_and_sub_samples_that_have_no_effect_are_named() {
    let folder = folder();
    let said = |words: &[&str]| {
        let words = [&["render", "cornell", "-o", "a.png"], words, &SIZE].concat();
        stderr(&succeed(folder.path(), &words))
    };
    for (words, warning) in [
        (
            &["--show", "anaglyph"][..],
            "--show has no effect: there is one eye",
        ),
        (&["-o", "headset"], "--output headset has no effect"),
        (
            &["--ipd", "0.1", "--lens", "dk1"],
            "--lens has no effect: there is one eye",
        ),
        (
            &["--stereo", "two-pass", "--lens", "dk1"],
            "--lens has no effect: it is for --show headset",
        ),
        (
            &[
                "--stereo=two-pass",
                "--convergence=1",
                "--eye-tangents=-1,1,-1,1,-1,1,-1,1",
            ],
            "--convergence has no effect",
        ),
        (
            &["--samples", "9"],
            "--samples has no effect: it is for --aa ssaa or msaa",
        ),
        (
            &["--aa", "ssaa", "--edge-test", "paper"],
            "--edge-test has no effect",
        ),
    ] {
        let said = said(words);
        assert!(said.contains(&format!("warning: {warning}")), "{said}");
    }
    for words in [
        &["--show", "flat"][..],
        &["--stereo", "two-pass", "-o", "anaglyph"],
        &["--stereo=two-pass", "--show=headset", "--lens=dk1"],
        &["--aa", "msaa", "--samples", "9", "--edge-test", "paper"],
    ] {
        let said = said(words);
        assert!(!said.contains("has no effect"), "{said}");
    }
}

#[test]
fn standard_output_takes_the_file_s_bytes() {
    let folder = folder();
    let here = folder.path();
    succeed(here, &render(&["-o", "a.png"]));
    let piped = succeed(here, &render(&["-o", "-"]));
    assert!(piped.stdout == fs::read(here.join("a.png")).unwrap());
    assert_eq!(names(here), ["a.png"]);
}

#[test]
fn a_scene_comes_from_standard_input() {
    let folder = folder();
    let here = folder.path();
    moving_triangle(here);
    let shown = [
        "--eye", "0,0.7,4", "--target", "0,0.7,0", "-q", "--size", "48x32",
    ];
    let from = |scene: &str, bytes: &[u8], file: &str| {
        let words = [&["render", scene, "-o", file], &shown[..]].concat();
        let mut child = command(here, &words)
            .stdin(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // A program that ends early reads no more.
        let _ = child.stdin.take().unwrap().write_all(bytes);
        child.wait_with_output().unwrap()
    };
    let scene = fs::read(here.join("triangle.gltf")).unwrap();
    let named = from("triangle.gltf", b"", "named.png");
    assert_eq!(named.status.code(), Some(0), "{}", stderr(&named));
    let piped = from("-", &scene, "piped.png");
    let text = String::from_utf8_lossy(&scene);
    if text.contains("data:") {
        assert_eq!(piped.status.code(), Some(0), "{}", stderr(&piped));
        assert!(
            fs::read(here.join("named.png")).unwrap() == fs::read(here.join("piped.png")).unwrap()
        );
    } else {
        assert_eq!(piped.status.code(), Some(1));
        assert!(
            stderr(&piped).contains("pipe in a .glb"),
            "{}",
            stderr(&piped)
        );
    }
    let broken = from("-", b"no scene", "broken.png");
    assert_eq!(broken.status.code(), Some(1));
    assert!(
        stderr(&broken).contains("standard input"),
        "{}",
        stderr(&broken)
    );
}

/// A .glb of the moving triangle.
fn triangle_glb(folder: &Path) -> Vec<u8> {
    let file = fs::read_to_string(moving_triangle(folder)).unwrap();
    let mut json = file.replace(r#""uri":"triangle.bin""#, r#""name":"inside""#);
    json += &" ".repeat(json.len().next_multiple_of(4) - json.len());
    let bytes = fs::read(folder.join("triangle.bin")).unwrap();
    let length = |bytes: usize| (bytes as u32).to_le_bytes();
    let mut glb = [*b"glTF", length(2), length(28 + json.len() + bytes.len())].concat();
    for (kind, chunk) in [(b"JSON", json.as_bytes()), (b"BIN\0", &bytes[..])] {
        glb.extend([length(chunk.len()), *kind].concat());
        glb.extend(chunk);
    }
    glb
}

#[test]
fn a_bench_reads_standard_input_once() {
    let folder = folder();
    let glb = triangle_glb(folder.path());
    let line = "bench variable - --size 16x16 --rounds 1 --point-lights 1";
    let words: Vec<&str> = line.split(' ').collect();
    let mut child = (command(folder.path(), &words).stdin(Stdio::piped()))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(&glb).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// A program named ffmpeg that notes its words and keeps the frames as they come.
#[cfg(unix)]
fn stand_in(folder: &Path, script: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    let bin = folder.join("bin");
    fs::create_dir_all(&bin).unwrap();
    let listed = "[ \"$2\" != -encoders ] || { echo libx264; exit 0; }\n\
                  [ \"$1\" != -version ] || exit 0";
    fs::write(
        bin.join("ffmpeg"),
        format!("#!/bin/sh\n{listed}\n{script}\n"),
    )
    .unwrap();
    fs::set_permissions(bin.join("ffmpeg"), fs::Permissions::from_mode(0o755)).unwrap();
    format!("{}:{}", bin.display(), std::env::var("PATH").unwrap())
}

#[cfg(unix)]
#[test]
fn a_video_gets_every_frame() {
    let folder = folder();
    let here = folder.path();
    let path = stand_in(
        here,
        "echo \"$@\" > words; for last; do :; done; cat > \"$last\"",
    );
    // Of runs that were killed two days ago.
    let old = std::time::SystemTime::now() - std::time::Duration::from_secs(2 * 86_400);
    for left in [".film.mp4.a1B2c3.mp4", ".s.json.a1B2c3.tmp"] {
        let left = fs::File::create(here.join(left)).unwrap();
        left.set_modified(old).unwrap();
    }
    let words = render(&[
        "--path",
        "turntable",
        "--stats",
        "s.json",
        "--fps",
        "1",
        "--frames",
        "0..3",
        "--video",
        "film.mp4",
        "-o",
        "f_#.png",
    ]);
    let output = command(here, &words).env("PATH", &path).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let film = fs::read(here.join("film.mp4")).unwrap();
    let mut frames = Vec::new();
    for frame in 0..3 {
        let picture = image::open(here.join(format!("f_{frame}.png"))).unwrap();
        frames.extend(picture.into_rgb8().into_raw());
    }
    assert!(
        film == frames,
        "the video holds the frames that the files show"
    );
    let said = fs::read_to_string(here.join("words")).unwrap();
    assert!(said.contains("-video_size 48x32 -framerate 1 "), "{said}");
    use std::os::unix::fs::PermissionsExt;
    let mode = |name: &str| fs::metadata(here.join(name)).unwrap().permissions().mode();
    assert_eq!(mode("film.mp4"), mode("f_0.png"), "both are ordinary files");
    // Nothing else is left.
    assert_eq!(
        names(here),
        [
            "bin", "f_0.png", "f_1.png", "f_2.png", "film.mp4", "s.json", "words"
        ]
    );
}

#[cfg(unix)]
#[test]
fn a_video_that_fails_leaves_nothing_and_says_why() {
    let folder = folder();
    let here = folder.path();
    let words = render(&["--frames", "0..2", "--video", "film.mp4"]);
    let path = stand_in(here, "echo 'no such codec: h264' >&2; exit 3");
    let output = command(here, &words).env("PATH", &path).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("no such codec: h264"),
        "{}",
        stderr(&output)
    );
    assert_eq!(names(here), ["bin"]);
    fail(
        here,
        &render(&["--frames", "0..2", "--video", "none/film.mp4"]),
        &["none"],
    );
}

#[test]
fn what_keeps_a_video_from_being_written_is_said_before_a_scene_is_loaded() {
    let folder = folder();
    let here = folder.path();
    let said = |more: &[&str]| {
        let words = [&["render", "none.glb", "--frames", "0..9"], more].concat();
        let output = command(here, &words).env("PATH", here).output().unwrap();
        assert!([Some(1), Some(2)].contains(&output.status.code()));
        stderr(&output)
    };
    let missing = said(&["--video", "film.mp4"]);
    assert!(missing.contains("not installed"), "{missing}");
    let nameless = said(&["--video", "film"]);
    assert!(nameless.contains(".mp4"), "{nameless}");
    // The film of one part would take the place of another's.
    let part = said(&["--part", "0/3", "--video", "film.mp4"]);
    assert!(part.contains("--part"), "{part}");
    assert_eq!(names(here), [""; 0]);
}
