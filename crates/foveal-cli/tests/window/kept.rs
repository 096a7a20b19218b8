//! What the window opens by its dialog, keeps from run to run, and captures.

use std::fs;
use std::path::Path;

use super::screen::{Screen, colors, differing, is_possible};
use super::triangle;

/// The text in which the window remembers.
fn memory(folder: &Path) -> String {
    fs::read_to_string(folder.join("config/foveal/window.toml")).unwrap_or_default()
}

#[test]
fn a_scene_is_opened_by_the_dialog_and_is_recent_in_the_next_run() {
    if !is_possible() {
        return;
    }
    let mut screen = Screen::open((960, 540), &["cornell"]);
    let folder = screen.folder.path().to_owned();
    fs::write(folder.join("a triangle.gltf"), triangle()).unwrap();
    let cornell = screen.settled();
    screen.keep("small", &cornell);
    assert_eq!(cornell.legibility(), Ok(()));
    screen.key("ctrl+o");
    screen.until("the dialog is shown", |s| {
        (differing(&cornell.picture(), &s.shot().picture()) > 0.9).then_some(())
    });
    screen
        .xdotool(&["type", "--delay", "60", "TRIANGLE"])
        .unwrap();
    let dialog = screen.settled();
    screen.keep("dialog", &dialog);
    screen.key("Return");
    let shows_triangle = |screen: &Screen| {
        let picture = screen.shot().picture();
        (differing(&cornell.picture(), &picture) > 0.9 && colors(&picture) < 40).then_some(())
    };
    screen.until("the scene of the dialog is shown", shows_triangle);
    screen.until("the scene is remembered", |_| {
        memory(&folder).contains("a triangle.gltf").then_some(())
    });

    screen.restart(&["cornell"]);
    screen.settled();
    screen.click(SCENES.0, SCENES.1);
    let menu = screen.settled();
    screen.keep("recent", &menu);
    // Of this run's scene and the last one's, the second.
    screen.click(SCENES.0, SECOND_RECENT);
    screen.until("the recent scene is shown", shows_triangle);
}

/// Middle of the scenes' menu in the bar, and the height of the second recent scene below it.
const SCENES: (usize, usize) = (292, 19);
const SECOND_RECENT: usize = 92;

#[test]
fn a_bookmark_survives_a_restart() {
    if !is_possible() {
        return;
    }
    let mut screen = Screen::open((1280, 720), &["cornell"]);
    let folder = screen.folder.path().to_owned();
    let start = screen.settled();
    // From the side there is another picture, wherever the machine's pace would have led a flight.
    screen.key("alt+1");
    screen.until("the camera is in front", |s| {
        (differing(&start.picture(), &s.shot().picture()) > 0.2).then_some(())
    });
    let front = screen.settled();
    screen.keep("front", &front);
    screen.key("ctrl+3");
    screen.until("the bookmark is kept", |_| {
        memory(&folder).contains("perspective,").then_some(())
    });
    screen.restart(&["cornell"]);
    let again = screen.settled();
    assert!(
        differing(&start.picture(), &again.picture()) < 0.01,
        "it starts anew"
    );
    screen.key("3");
    screen.until("the bookmark is seen", |s| {
        (differing(&front.picture(), &s.shot().picture()) < 0.01).then_some(())
    });
}

#[test]
fn a_turntable_is_captured_and_cancelled() {
    if !is_possible() {
        return;
    }
    let mut screen = Screen::open((960, 540), &["cornell"]);
    let capture = screen.folder.path().join("capture-001");
    let start = screen.settled();
    screen.key("v");
    screen.until("the card is shown", |s| {
        (differing(&start.picture(), &s.shot().picture()) > 0.2).then_some(())
    });
    let card = screen.settled();
    screen.keep("capture", &card);
    screen.key("Return");
    let frame = |number: usize| capture.join(format!("frame-{number:04}.png"));
    let fifth = screen.until("five frames are written", |_| image::open(frame(4)).ok());
    screen.keep("capturing", &screen.shot());
    screen.key("Escape");
    // The window draws views again, and no further frame comes.
    let settled = screen.settled();
    screen.keep("captured", &settled);
    let written = fs::read_dir(&capture).unwrap().count();
    assert!((5..120).contains(&written), "{written}");
    let first = image::open(frame(0)).unwrap().to_rgb8();
    let fifth = fifth.to_rgb8();
    assert_eq!(first.dimensions(), fifth.dimensions());
    assert_ne!(first.as_raw(), fifth.as_raw(), "the camera turns");
    assert_eq!(fs::read_dir(&capture).unwrap().count(), written);
}
