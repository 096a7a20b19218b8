//! JOD beside the values of the published metric, for pictures and videos made here from integers
//! alone.
//!
//! `FOVEAL_VDP_PAIRS=DIR cargo test -p foveal-vdp --test published -- --ignored` writes all pairs,
//! as PPM files with the ending `png`, for measuring them with another program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod pairs;

use foveal_vdp::{Display, Gaze, Metric, Pixels};
use pairs::{Clip, DISTORTIONS, Frame, SCENES};

/// Greatest distance to the published metric; the aim is 0.1, the distance found when this was
/// written 0.01.
const TOLERANCE_JOD: f32 = 0.03;

struct Row {
    reference: Clip,
    test: Clip,
    display: &'static str,
    gaze: (f32, f32),
    frames_per_second: f32,
    jod: f32,
    /// For videos.
    flicker: Option<f32>,
}

include!("published/values.rs");

/// Pictures: for each scene, by turns one display and gaze and another; then videos.
fn rows() -> Vec<Row> {
    let mut values = JOD.iter();
    let mut rows = Vec::new();
    let views = [
        ("h60", (0.5, 0.5)),
        ("fhd", (0.25, 0.4)),
        ("hmd", (0.8, 0.65)),
        ("h60", (0.1, 0.9)),
        ("fhd", (0.5, 0.5)),
        ("hmd", (0.5, 0.5)),
    ];
    for scene in 0..SCENES {
        for distortion in 0..DISTORTIONS {
            let (display, gaze) = views[(scene + 3 * (distortion % 2)) % views.len()];
            rows.push(Row {
                reference: Clip::picture(scene, None, gaze),
                test: Clip::picture(scene, Some(distortion), gaze),
                display,
                gaze,
                frames_per_second: 30.0,
                jod: values.next().copied().unwrap(),
                flicker: None,
            });
        }
    }
    for (size, display, scene, distortion, jod) in SMALL {
        let gaze = (0.5, 0.5);
        rows.push(Row {
            reference: Clip::sized(size, scene, None, gaze),
            test: Clip::sized(size, scene, Some(distortion), gaze),
            display,
            gaze,
            frames_per_second: 30.0,
            jod,
            flicker: None,
        });
    }
    let mut flickers = FLICKER.iter();
    let views = [
        ("h60", (0.5, 0.5), 30.0),
        ("hmd", (0.3, 0.6), 60.0),
        ("fhd", (0.7, 0.4), 24.0),
    ];
    for (scene, &(display, gaze, frames_per_second)) in views.iter().enumerate() {
        for distortion in 0..pairs::VIDEO_DISTORTIONS {
            rows.push(Row {
                reference: Clip::video(scene, None, gaze),
                test: Clip::video(scene, Some(distortion), gaze),
                display,
                gaze,
                frames_per_second,
                jod: values.next().copied().unwrap(),
                flicker: flickers.next().copied(),
            });
        }
    }
    assert!(values.next().is_none() && flickers.next().is_none());
    rows
}

fn metric(row: &Row) -> Metric {
    let Frame { width, height, .. } = row.reference.frames[0];
    let gaze = Gaze {
        x: row.gaze.0,
        y: row.gaze.1,
    };
    Metric::new(&Display::parse(row.display).unwrap(), width, height, gaze).unwrap()
}

/// JOD and flicker.
fn measure(row: &Row) -> (f32, Option<f32>) {
    let metric = metric(row);
    let frames = row.reference.frames.iter().zip(&row.test.frames);
    if row.flicker.is_none() {
        let (reference, test) = (&row.reference.frames[0], &row.test.frames[0]);
        let comparison = metric.compare(Pixels::Rgb(&reference.pixels), Pixels::Rgb(&test.pixels));
        return (comparison.unwrap().jod, None);
    }
    let mut video = metric.video(row.frames_per_second).unwrap();
    for (reference, test) in frames {
        video
            .push(Pixels::Rgb(&reference.pixels), Pixels::Rgb(&test.pixels))
            .unwrap();
    }
    let result = video.finish().unwrap();
    (result.jod, result.flicker)
}

#[test]
fn every_pair_agrees_with_the_published_metric() {
    let rows = rows();
    assert!(rows.len() >= 60);
    let mut wrong = Vec::new();
    for row in &rows {
        let (jod, flicker) = measure(row);
        println!(
            "{:14} {} {:?} {:.3} published {:.3}",
            row.test.name, row.display, row.gaze, jod, row.jod
        );
        if (jod - row.jod).abs() > TOLERANCE_JOD {
            wrong.push(format!("{}: {jod}, published {}", row.test.name, row.jod));
        }
        if let (Some(flicker), Some(published)) = (flicker, row.flicker)
            && (flicker - published).abs() > 2e-3 * published.max(1.0)
        {
            wrong.push(format!(
                "{}: flicker {flicker}, published {published}",
                row.test.name
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_single_frame_is_a_picture() {
    let row = &rows()[0];
    let metric = metric(row);
    let (reference, test) = (&row.reference.frames[0].pixels, &row.test.frames[0].pixels);
    let picture = metric
        .compare(Pixels::Rgb(reference), Pixels::Rgb(test))
        .unwrap();
    let mut video = metric.video(30.0).unwrap();
    video
        .push(Pixels::Rgb(reference), Pixels::Rgb(test))
        .unwrap();
    let video = video.finish().unwrap();
    assert_eq!(picture.jod, video.jod);
    assert!(picture.heat_map == video.heat_map);
    assert_eq!(video.flicker, None);
}

#[test]
fn beside_a_reference_that_rests_a_change_that_nobody_sees_is_no_flicker() {
    let (width, height) = (320, 180);
    let metric = Metric::new(&Display::DEGREES_60, width, height, Gaze::CENTRE).unwrap();
    let grey = vec![[110u8; 3]; width * height];
    let mut otherwise = grey.clone();
    let mut flicker = |changed: usize| {
        otherwise[..changed].fill([120; 3]);
        let mut video = metric.video(30.0).unwrap();
        for frame in [&grey, &otherwise, &grey] {
            let reference = Pixels::Rgb(&grey);
            video.push(reference, Pixels::Rgb(frame)).unwrap();
        }
        video.finish().unwrap().flicker.unwrap()
    };
    assert!(flicker(1) < 0.1);
    assert!(flicker(100 * width) > 100.0);
}

#[test]
fn equal_pictures_are_10_and_the_heat_map_is_cold() {
    let row = &rows()[0];
    let pixels = Pixels::Rgb(&row.reference.frames[0].pixels);
    let comparison = metric(row).compare(pixels, pixels).unwrap();
    assert_eq!(comparison.jod, 10.0);
    assert!(comparison.heat_map.jod_lost.iter().all(|&lost| lost == 0.0));
}

#[test]
fn the_heat_map_is_hot_where_the_difference_is_and_hotter_at_the_gaze() {
    let (width, height) = (320, 180);
    let grey = vec![[110u8; 3]; width * height];
    let mut dots = grey.clone();
    for (x, y) in [(40, 90), (280, 90)] {
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            dots[(y + dy) * width + x + dx] = [116; 3];
        }
    }
    let gaze = Gaze { x: 0.125, y: 0.5 };
    let metric = Metric::new(&Display::DEGREES_60, width, height, gaze).unwrap();
    let map = metric
        .compare(Pixels::Rgb(&grey), Pixels::Rgb(&dots))
        .unwrap()
        .heat_map;
    let at = |x: usize, y: usize| map.jod_lost[y * width + x];
    let (gaze, far, empty) = (at(40, 90), at(280, 90), at(160, 20));
    assert!(
        gaze > 1.5 * far && far > 5.0 * empty,
        "{gaze} {far} {empty}"
    );
}

#[test]
fn wrong_input_is_refused() {
    use foveal_vdp::VdpError;
    let new = |width, height| Metric::new(&Display::HEADSET, width, height, Gaze::CENTRE);
    assert_eq!(
        new(3, 100).unwrap_err(),
        VdpError::Size {
            width: 3,
            height: 100
        }
    );
    let metric = new(8, 8).unwrap();
    let (short, right) = (vec![[0; 3]; 63], vec![[0; 4]; 64]);
    let refused = metric.compare(Pixels::Rgb(&short), Pixels::Rgba(&right));
    assert_eq!(
        refused,
        Err(VdpError::PixelCount {
            expected: 64,
            found: 63
        })
    );
    assert!(matches!(
        metric.video(f32::NAN),
        Err(VdpError::FrameRate(_))
    ));
    assert_eq!(
        metric.video(30.0).unwrap().finish(),
        Err(VdpError::NoFrames)
    );
    let gaze = Gaze {
        x: f32::NAN,
        y: 0.0,
    };
    let refused = Metric::new(&Display::HEADSET, 8, 8, gaze);
    assert!(matches!(refused, Err(VdpError::Gaze { .. })));
}

/// Small and odd sizes come to an end without a panic.
#[test]
fn every_size_is_measured() {
    for (width, height) in [(4, 4), (4, 37), (37, 4), (5, 7), (16, 17), (65, 33)] {
        let dark = vec![[20; 3]; width * height];
        let mut light = dark.clone();
        light[width + 1] = [200; 3];
        let metric = Metric::new(&Display::MONITOR_24, width, height, Gaze::CENTRE).unwrap();
        let jod = metric
            .compare(Pixels::Rgb(&dark), Pixels::Rgb(&light))
            .unwrap()
            .jod;
        assert!(jod.is_finite() && jod < 10.0, "{width}x{height}: {jod}");
    }
}

#[test]
#[ignore = "writes the pairs for another program to measure"]
fn write_pairs() {
    let folder = std::env::var("FOVEAL_VDP_PAIRS").unwrap();
    let folder = std::path::Path::new(&folder);
    for row in rows() {
        for clip in [&row.reference, &row.test] {
            for (number, frame) in clip.frames.iter().enumerate() {
                let file = if row.flicker.is_some() {
                    folder.join(&clip.name).join(format!("{number:02}.png"))
                } else {
                    folder.join(format!("{}.png", clip.name))
                };
                std::fs::create_dir_all(file.parent().unwrap()).unwrap();
                std::fs::write(file, frame.ppm()).unwrap();
            }
        }
        let (test, (x, y)) = (&row.test.name, row.gaze);
        println!(
            "{} {test} {} {x},{y} {}",
            row.reference.name, row.display, row.frames_per_second
        );
    }
}
