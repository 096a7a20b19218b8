//! `foveal compare` on small pictures.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod common;

use std::path::Path;

use common::{fail, folder, foveal_in, names, png, stderr, stdout, succeed};
use serde_json::Value;

fn pattern(x: u32, y: u32) -> [u8; 3] {
    [(x * 8) as u8, (y * 8) as u8, ((x ^ y) * 4) as u8]
}

fn inverse(x: u32, y: u32) -> [u8; 3] {
    pattern(x, y).map(|c| 255 - c)
}

fn pictures(folder: &Path) {
    png(folder, "a.png", 32, 24, pattern);
    png(folder, "b.png", 32, 24, |x, y| {
        if (x, y) == (5, 6) {
            [255, 0, 0]
        } else {
            pattern(x, y)
        }
    });
    png(folder, "c.png", 32, 24, inverse);
    png(folder, "small.png", 8, 8, pattern);
}

fn json(folder: &Path, words: &[&str]) -> Value {
    serde_json::from_str(&stdout(&succeed(folder, words))).unwrap()
}

#[test]
fn equal_pictures_are_equal_by_every_measure() {
    let folder = folder();
    pictures(folder.path());
    let result = json(
        folder.path(),
        &[
            "compare",
            "a.png",
            "a.png",
            "--json",
            "--max-flip",
            "0",
            "--min-psnr",
            "inf",
        ],
    );
    let expected = serde_json::json!({
        "width": 32, "height": 24, "flip": 0.0, "psnr_db": null, "ssim": 1.0,
        "max_difference": 0, "differing_pixels": 0, "passed": true
    });
    assert_eq!(result, expected);
}

#[test]
fn one_pixel_differs_less_than_all_pixels() {
    let folder = folder();
    pictures(folder.path());
    let near = json(folder.path(), &["compare", "a.png", "b.png", "--json"]);
    let far = json(folder.path(), &["compare", "a.png", "c.png", "--json"]);
    assert_eq!(near["differing_pixels"], 1);
    let value = |result: &Value, name: &str| result[name].as_f64().unwrap();
    assert!(value(&near, "flip") > 0.0 && value(&near, "flip") < value(&far, "flip"));
    assert!(value(&near, "psnr_db") > value(&far, "psnr_db"));
    assert!(value(&near, "ssim") > value(&far, "ssim"));
}

#[test]
fn thresholds_decide_the_exit_code() {
    let folder = folder();
    pictures(folder.path());
    for threshold in [["--max-flip", "0.001"], ["--min-psnr", "40"]] {
        let [flag, value] = threshold;
        let output = foveal_in(
            folder.path(),
            &["compare", "a.png", "c.png", "--json", flag, value],
        );
        assert_eq!(output.status.code(), Some(1));
        assert!(
            stderr(&output).contains(flag) && stderr(&output).contains("c.png"),
            "{}",
            stderr(&output)
        );
        let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
        assert_eq!(result["passed"], false);
    }
    succeed(
        folder.path(),
        &[
            "compare",
            "a.png",
            "c.png",
            "--max-flip",
            "1",
            "--min-psnr",
            "1",
        ],
    );
}

#[test]
fn the_difference_picture_shows_where() {
    let folder = folder();
    pictures(folder.path());
    succeed(
        folder.path(),
        &["compare", "a.png", "b.png", "--diff", "d.png"],
    );
    let diff = image::open(folder.path().join("d.png"))
        .unwrap()
        .into_rgb8();
    assert_eq!(diff.dimensions(), (32, 24));
    let light = |x, y| {
        diff.get_pixel(x, y)
            .0
            .iter()
            .map(|&c| u32::from(c))
            .sum::<u32>()
    };
    assert!(light(5, 6) > light(28, 20) + 50);
}

#[test]
fn pictures_smaller_than_the_window_have_no_ssim() {
    let folder = folder();
    pictures(folder.path());
    assert!(
        json(
            folder.path(),
            &["compare", "small.png", "small.png", "--json"]
        )["ssim"]
            .is_null()
    );
    let text = stdout(&succeed(
        folder.path(),
        &["compare", "small.png", "small.png"],
    ));
    assert!(
        text.contains("PSNR        infinite") && text.contains("11x11"),
        "{text}"
    );
}

#[test]
fn what_cannot_be_compared_is_named() {
    let folder = folder();
    pictures(folder.path());
    std::fs::write(folder.path().join("text.png"), "text").unwrap();
    let before = names(folder.path());
    let here = folder.path();
    fail(
        here,
        &["compare", "a.png", "small.png", "--diff", "d.png"],
        &["32x24", "8x8", "small.png"],
    );
    fail(
        here,
        &["compare", "a.png", "missing.png", "--diff", "d.png"],
        &["missing.png"],
    );
    fail(
        here,
        &["compare", "text.png", "a.png", "--diff", "d.png"],
        &["text.png"],
    );
    fail(
        here,
        &["compare", "a.png", "b.png", "--diff", "no/d.png"],
        &["no/d.png", "does not exist"],
    );
    assert_eq!(names(here), before);
}

#[test]
fn a_display_adds_the_quality_at_the_gaze() {
    let folder = folder();
    pictures(folder.path());
    let at = |test: &str, more: &[&str]| {
        let words = ["compare", "a.png", test, "--json"];
        json(folder.path(), &[&words, more].concat())
    };
    assert!(at("b.png", &[]).get("jod").is_none());
    let equal = at("a.png", &["--display", "h60"]);
    assert_eq!(
        (&equal["jod"], &equal["gaze"]),
        (&10.0.into(), &serde_json::json!([0.5, 0.5]))
    );
    let value = |result: Value, name: &str| result[name].as_f64().unwrap();
    let near = value(
        at("b.png", &["--display", "fhd", "--gaze", "0.17,0.27"]),
        "jod",
    );
    let far = value(
        at("b.png", &["--display", "fhd", "--gaze", "0.95,0.9"]),
        "jod",
    );
    assert!(near < far && far < 10.0, "{near} {far}");
    // A gaze is an eye at the default display.
    assert_eq!(
        at("b.png", &["--gaze", "0.17,0.27"]),
        at("b.png", &["--display", "h60", "--gaze", "0.17,0.27"])
    );
    // The eye may look beside the picture.
    assert_eq!(
        at("b.png", &["--gaze", "-0.25,0.5"])["gaze"],
        serde_json::json!([-0.25, 0.5])
    );
    let wide = value(at("b.png", &["--display", "1.2x0.5"]), "pixels_per_degree");
    let narrow = value(at("b.png", &["--display", "20"]), "pixels_per_degree");
    assert!(wide < narrow);
    let dark = value(at("c.png", &["--peak", "1", "--display", "h60"]), "jod");
    let bright = value(
        at("c.png", &["--ambient", "50000", "--display", "h60"]),
        "jod",
    );
    assert!(dark < 10.0 && bright < 10.0 && dark != bright);
    // What it was measured by is said, with what was changed of it.
    let seen = &at("b.png", &["--display", "fhd", "--peak", "150"])["display"];
    let number = |name: &str| seen[name].as_f64().unwrap();
    let light = ["peak_cd_m2", "ambient_lux", "contrast"].map(number);
    assert_eq!(light, [150.0, 250.0, 1000.0]);
    assert!((number("degrees_across") - 47.8).abs() < 1e-3);
}

#[test]
fn the_heat_map_shows_where_an_eye_sees_the_difference() {
    let folder = folder();
    pictures(folder.path());
    let text = stdout(&succeed(
        folder.path(),
        &["compare", "a.png", "b.png", "--heat-map", "h.png"],
    ));
    assert!(text.contains("JOD "), "{text}");
    let map = image::open(folder.path().join("h.png"))
        .unwrap()
        .into_rgb8();
    assert_eq!(map.dimensions(), (32, 24));
    let light = |x, y| {
        map.get_pixel(x, y)
            .0
            .iter()
            .map(|&c| u32::from(c))
            .sum::<u32>()
    };
    assert!(light(5, 6) > light(28, 20) + 50);
    let output = foveal_in(
        folder.path(),
        &["compare", "a.png", "c.png", "--min-jod", "9.5", "--json"],
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("--min-jod 9.5"),
        "{}",
        stderr(&output)
    );
}

/// A folder of frames in which `colour` depends on the frame's number.
fn frames(folder: &Path, name: &str, count: u32, colour: impl Fn(u32, u32, u32) -> [u8; 3]) {
    let frames = folder.join(name);
    std::fs::create_dir(&frames).unwrap();
    for frame in 0..count {
        png(&frames, &format!("{frame:02}.png"), 32, 24, |x, y| {
            colour(frame, x, y)
        });
    }
}

#[test]
fn folders_are_compared_as_videos() {
    let folder = folder();
    let moving = |frame: u32, x: u32, y: u32| pattern(x + frame, y);
    frames(folder.path(), "a", 6, moving);
    frames(folder.path(), "b", 6, |frame, x, y| {
        moving(frame, x, y).map(|c| c.saturating_add(if frame % 2 == 0 { 40 } else { 0 }))
    });
    let result = json(
        folder.path(),
        &["compare", "a", "b", "--fps", "60", "--json"],
    );
    assert_eq!(
        (&result["frames"], &result["fps"]),
        (&6.into(), &60.0.into())
    );
    let value = |name: &str| result[name].as_f64().unwrap();
    assert!(value("jod") < 9.5 && value("flicker") > 2.0 && value("flip") > 0.0);

    let words = [
        "compare",
        "a",
        "a",
        "--json",
        "--min-jod",
        "10",
        "--max-flip",
        "0",
    ];
    let equal = json(folder.path(), &words);
    assert_eq!(
        (&equal["jod"], &equal["flicker"]),
        (&10.0.into(), &1.0.into())
    );
    assert_eq!(equal["passed"], true);

    let output = foveal_in(folder.path(), &["compare", "a", "b", "--min-jod", "9.9"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stdout(&output).contains("flicker"), "{}", stdout(&output));
}

#[test]
fn folders_need_the_same_frames() {
    let folder = folder();
    frames(folder.path(), "a", 3, |_, x, y| pattern(x, y));
    frames(folder.path(), "b", 2, |_, x, y| pattern(x, y));
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    fail(
        folder.path(),
        &["compare", "a", "b"],
        &["02.png", "one of them alone"],
    );
    fail(
        folder.path(),
        &["compare", "empty", "empty"],
        &["no PNG files"],
    );
    png(&folder.path().join("b"), "02.png", 8, 8, pattern);
    fail(folder.path(), &["compare", "a", "b"], &["02.png", "8x8"]);
    let output = foveal_in(folder.path(), &["compare", "a", "a", "--diff", "d.png"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_map_replaces_no_frame() {
    let folder = folder();
    frames(folder.path(), "a", 2, |_, x, y| pattern(x, y));
    frames(folder.path(), "b", 2, |_, x, y| inverse(x, y));
    for map in ["b/01.png", "./a/00.png", "a/../b/new.png"] {
        let before = std::fs::read(folder.path().join("b/01.png")).unwrap();
        let output = foveal_in(folder.path(), &["compare", "a", "b", "--heat-map", map]);
        assert_eq!(output.status.code(), Some(2), "{map}: {}", stderr(&output));
        assert!(
            stderr(&output).contains("--heat-map"),
            "{}",
            stderr(&output)
        );
        assert_eq!(
            std::fs::read(folder.path().join("b/01.png")).unwrap(),
            before
        );
    }
    succeed(
        folder.path(),
        &["compare", "a", "b", "--heat-map", "map.png"],
    );
    // A single picture's map may lie beside it.
    let words = ["compare", "a/00.png", "b/00.png", "--diff", "a/diff.png"];
    succeed(folder.path(), &words);
}

#[cfg(unix)]
#[test]
fn a_map_replaces_no_picture_that_is_compared() {
    let folder = folder();
    pictures(folder.path());
    std::fs::create_dir(folder.path().join("inner")).unwrap();
    std::os::unix::fs::symlink("a.png", folder.path().join("link.png")).unwrap();
    let before = std::fs::read(folder.path().join("a.png")).unwrap();
    for map in ["./a.png", "inner/../a.png", "link.png"] {
        let output = foveal_in(folder.path(), &["compare", "a.png", "b.png", "--diff", map]);
        assert_eq!(output.status.code(), Some(2), "{map}: {}", stderr(&output));
        let after = std::fs::read(folder.path().join("a.png")).unwrap();
        assert_eq!(after, before, "{map}");
    }
}

#[test]
fn a_rate_that_the_metric_does_not_take_is_refused_at_once() {
    let folder = folder();
    for words in [["compare", "a", "b"], ["bench", "eye", "cornell"]] {
        let output = foveal_in(folder.path(), &[&words[..], &["--fps", "2"]].concat());
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains("5 to 1000"), "{}", stderr(&output));
    }
}

#[test]
fn pictures_that_are_too_small_for_the_eye_are_named() {
    let folder = folder();
    let here = folder.path();
    png(here, "dot.png", 1, 1, pattern);
    std::fs::create_dir(here.join("film")).unwrap();
    png(&here.join("film"), "0.png", 1, 1, pattern);
    succeed(here, &["compare", "dot.png", "dot.png"]);
    let words = ["compare", "dot.png", "dot.png", "--display", "h60"];
    fail(here, &words, &["'dot.png'", "1x1 pixels"]);
    fail(
        here,
        &["compare", "film", "film"],
        &["'film'", "1x1 pixels"],
    );
}
