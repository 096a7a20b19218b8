//! The real window on a virtual screen, driven by real keys and a real pointer.
//!
//! Needs Xvfb and xdotool; without them it says so and passes, unless
//! `FOVEAL_WINDOW_TEST=required`, as `./run test` sets it. Screenshots come from Xvfb's frame
//! buffer; `FOVEAL_SCREENSHOTS=DIR` keeps them as PNG files.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]
#![allow(clippy::print_stdout, reason = "a test says what it skipped")]
#![cfg(target_os = "linux")]

#[path = "../common/mod.rs"]
mod common;
mod kept;
mod peer;
mod screen;

use std::process::Command;
use std::time::Duration;

use peer::Peer;
use screen::{BAD, PANEL, Screen, Shot, VISIBLE, colors, count, differing, is_possible};

#[test]
fn the_window_shows_a_scene_and_obeys_keys_and_pointer() {
    if !is_possible() {
        return;
    }
    let words = ["cornell", "--culling", "occlusion"];
    let mut screen = Screen::open((1280, 720), &words);
    let start = screen.settled();
    screen.keep("start", &start);
    assert_eq!(start.legibility(), Ok(()));

    // Keys that are held move the camera, a drag turns it, Home goes back.
    screen.xdotool(&["keydown", "w"]).unwrap();
    screen.until("the camera moves", |s| {
        (differing(&start.picture(), &s.shot().picture()) > 0.2).then_some(())
    });
    screen.xdotool(&["keyup", "w"]).unwrap();
    let nearer = screen.settled();
    screen.until("the camera turns", |s| {
        // On a busy machine the window may see press and release at once, which is no drag.
        s.drag((0.5, 0.6), (0.56, 0.6));
        std::thread::sleep(Duration::from_millis(500));
        (differing(&nearer.picture(), &s.shot().picture()) > 0.2).then_some(())
    });
    screen.keep("turned", &screen.shot());
    screen.key("Home");
    screen.until("the camera is back", |s| {
        (differing(&start.picture(), &s.shot().picture()) < 0.01).then_some(())
    });

    // Boxes, with the depth that hides them.
    let green = |shot: &Shot| count(&shot.picture(), VISIBLE, 24);
    screen.key("b");
    screen.key("z");
    screen.until("boxes are drawn", |s| {
        (green(&s.shot()) > green(&start) + 100).then_some(())
    });
    let boxes = screen.settled();
    screen.keep("boxes", &boxes);
    screen.key("b");
    screen.key("z");

    // The reference on the left, with a white line between.
    screen.key("x");
    screen.until("the split is drawn", |s| {
        let middle = s.shot().part(0.45, 0.3, 0.55, 0.4);
        (count(&middle, [255; 3], 2) > 100).then_some(())
    });
    let compare = screen.settled();
    screen.keep("compare", &compare);
    screen.key("x");

    // Without panels the picture has the whole width.
    screen.key("h");
    screen.until("the panels are gone", |s| {
        let left = s.shot().part(0.0, 0.1, 0.2, 0.9);
        (count(&left, PANEL, 0) < left.len() / 10).then_some(())
    });
    let wide = screen.settled();
    screen.keep("wide", &wide);
    screen.key("h");
    screen.until("the panels are back", |s| s.shot().legibility().ok());

    // A picture of the picture.
    screen.key("p");
    let file = screen.folder.path().join("foveal-001.png");
    screen.until("the screenshot is written", |_| {
        image::open(&file).is_ok().then_some(())
    });

    // A scene that is not there is an error in the window, which goes on.
    screen.click(150, 20);
    screen.key("ctrl+a");
    screen.xdotool(&["type", "missing.glb"]).unwrap();
    screen.key("Return");
    screen.until("the error is shown", |s| {
        let above = s.shot().part(0.22, 0.05, 0.78, 0.3);
        (count(&above, BAD, 24) > 100).then_some(())
    });
    let error = screen.settled();
    screen.keep("error", &error);
    assert!(colors(&error.picture()) > 12, "the old picture stays");
    screen.click(640, 400);
    screen.key("h");
    screen.until("the window still obeys", |s| {
        let left = s.shot().part(0.0, 0.1, 0.2, 0.9);
        (count(&left, PANEL, 0) < left.len() / 10).then_some(())
    });
}

#[test]
fn a_large_window_is_legible_too_and_shows_coarse_shading() {
    if !is_possible() {
        return;
    }
    let words = ["demo:1000", "--shading", "coarse", "--view", "rate"];
    let mut screen = Screen::open((1920, 1080), &words);
    let shot = screen.settled();
    screen.keep("coarse", &shot);
    assert_eq!(shot.legibility(), Ok(()));
}

#[test]
fn a_window_rests_once_its_view_is_drawn_and_after_it_was_moved() {
    if !is_possible() {
        return;
    }
    let mut screen = Screen::open((960, 540), &["cornell"]);
    screen.until_at_rest();
    let start = screen.settled();
    screen.key("alt+1");
    screen.until("the camera is in front", |s| {
        (differing(&start.picture(), &s.shot().picture()) > 0.2).then_some(())
    });
    screen.until_at_rest();
}

/// Middles of buttons in the bar of a window of 1280 pixels' width.
const SAVE: (usize, usize) = (993, 19);
const LOAD: (usize, usize) = (1044, 19);
const COPY_COMMAND: (usize, usize) = (1127, 19);

/// Whether a message about something that failed is shown over the picture.
fn complains(shot: &Shot) -> bool {
    count(&shot.part(0.22, 0.05, 0.78, 0.3), BAD, 24) > 100
}

#[test]
fn files_are_dropped_saved_and_loaded_and_the_command_is_copied() {
    if !is_possible() {
        return;
    }
    let mut screen = Screen::open((1280, 720), &["cornell"]);
    let peer = Peer::new(&screen.display);
    let folder = screen.folder.path().to_owned();
    let cornell = screen.settled();

    // The command in the clipboard draws the same scene.
    screen.click(COPY_COMMAND.0, COPY_COMMAND.1);
    let line = screen.until("the command is in the clipboard", |_| peer.clipboard());
    let words: Vec<&str> = line.split(' ').collect();
    assert_eq!(words[..3], ["foveal", "render", "cornell"], "{line}");
    common::succeed(&folder, &words[1..]);
    let output = words.iter().skip_while(|word| **word != "--output").nth(1);
    let drawn = image::open(folder.join(output.unwrap())).unwrap();
    assert!(drawn.width() > 300, "{line}");

    // Settings go to a file by the mouse, and come back from it.
    screen.click(SAVE.0, SAVE.1);
    let file = folder.join("foveal.toml");
    let saved = screen.until("the settings are saved", |_| {
        std::fs::read_to_string(&file)
            .ok()
            .filter(|text| !text.is_empty())
    });
    assert!(saved.contains("view = \"final\""), "{saved}");
    let depth = saved.replace("view = \"final\"", "view = \"depth\"");
    std::fs::write(&file, depth).unwrap();
    screen.click(LOAD.0, LOAD.1);
    screen.until("the loaded settings are shown", |s| {
        (differing(&cornell.picture(), &s.shot().picture()) > 0.5).then_some(())
    });
    std::fs::write(&file, "view = \"sideways\"").unwrap();
    screen.click(LOAD.0, LOAD.1);
    screen.until("the wrong file is complained about", |s| {
        complains(&s.shot()).then_some(())
    });
    screen.keep("wrong-settings", &screen.shot());
    std::fs::write(&file, &saved).unwrap();
    screen.click(LOAD.0, LOAD.1);
    screen.until("the first settings are back", |s| {
        (differing(&cornell.picture(), &s.shot().picture()) < 0.2).then_some(())
    });

    // A broken file that is dropped is complained about, and the old scene stays.
    let (name, middle) = ("it is broken.glb", (640, 360));
    std::fs::write(folder.join(name), b"glTF, but not really").unwrap();
    peer.drop_files(screen.id, middle, &[&folder.join(name)]);
    std::thread::sleep(Duration::from_millis(300));
    screen.until("the broken file is complained about", |s| {
        complains(&s.shot()).then_some(())
    });
    screen.keep("broken-file", &screen.shot());
    assert!(
        colors(&screen.shot().picture()) > 12,
        "the old picture stays"
    );

    // One that is not takes its place.
    let gltf = folder.join("triangle.gltf");
    std::fs::write(&gltf, triangle()).unwrap();
    let another = folder.join("another.glb");
    std::fs::write(&another, b"not opened").unwrap();
    peer.drop_files(screen.id, middle, &[&gltf, &another]);
    screen.until("the dropped scene is shown", |s| {
        let picture = s.shot().picture();
        (differing(&cornell.picture(), &picture) > 0.9 && colors(&picture) < 40).then_some(())
    });
    let dropped = screen.settled();
    screen.keep("dropped", &dropped);
    // The second one is remembered.
    let memory = std::fs::read_to_string(folder.join("config/foveal/window.toml")).unwrap();
    assert!(memory.contains("another.glb"), "{memory}");
}

/// A glTF file with a triangle.
fn triangle() -> String {
    // Three vertices of three floats each: (0, 0, 0), (1, 0, 0), (0, 1, 0).
    const BASE64: &str = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,{BASE64}"}}]}}"#
    )
}

#[test]
fn lost_devices_are_said_and_replaced() {
    if !is_possible() {
        return;
    }
    let mut screen = Screen::open((1280, 720), &["cornell"]);
    let before = screen.settled();
    screen.key("ctrl+shift+F12");
    screen.until("the loss is said", |s| complains(&s.shot()).then_some(()));
    let after = screen.settled();
    screen.keep("lost", &after);
    assert_eq!(after.legibility(), Ok(()));
    let below = |shot: &Shot| shot.part(0.3, 0.5, 0.7, 0.85);
    assert!(
        differing(&below(&before), &below(&after)) < 0.01,
        "the picture is there"
    );
    // New pictures come, too.
    screen.xdotool(&["keydown", "w"]).unwrap();
    screen.until("the camera moves", |s| {
        (differing(&below(&before), &below(&s.shot())) > 0.2).then_some(())
    });
    screen.xdotool(&["keyup", "w"]).unwrap();
}

#[test]
fn without_a_display_the_error_says_so() {
    let folder = common::folder();
    let output = Command::new(env!("CARGO_BIN_EXE_foveal"))
        .args(["view", "cornell"])
        .current_dir(folder.path())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        common::stderr(&output).contains("display"),
        "{}",
        common::stderr(&output)
    );
}
