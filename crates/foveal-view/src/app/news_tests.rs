//! What the window makes of the drawing thread's news, and what it asks for then.

use super::tests::{Pass, SIZES, loaded};
use super::*;

/// What the thread would draw for the window as it is.
fn drawn(app: &App, flip: Option<f32>) -> Box<Shown> {
    let request = app.request().unwrap();
    let shown = app.shown.clone().unwrap();
    Box::new(Shown {
        request,
        flip,
        ..*shown
    })
}

#[test]
fn the_flip_error_stays_while_both_sides_and_the_view_do() {
    let context = egui::Context::default();
    let changes: [fn(&mut App); 4] = [
        |app| app.settings.shading.mode = foveal::Shading::Coarse,
        |app| app.reference.antialiasing.mode = foveal::Antialiasing::Ssaa,
        |app| app.display.compare = false,
        |app| app.go_to_bookmark(0),
    ];
    for change in changes {
        let mut app = loaded();
        app.bookmarks[0] = Some(Camera {
            world_from_view: glam::Mat4::IDENTITY,
            ..app.scene.as_ref().unwrap().start.clone()
        });
        app.display.compare = true;
        let flip = Some(0.25);
        app.take_picture(&context, drawn(&app, flip));
        app.take_picture(&context, drawn(&app, None));
        assert_eq!(app.shown.as_ref().unwrap().flip, flip);
        change(&mut app);
        app.take_picture(&context, drawn(&app, None));
        assert_eq!(app.shown.as_ref().unwrap().flip, None);
    }
}

#[test]
fn messages_and_flights_go_on_by_the_clock_of_a_new_interface() {
    let mut app = loaded();
    let pass_at = |app: &mut App, context: &egui::Context, time_s| {
        let input = egui::RawInput {
            time: Some(time_s),
            ..egui::RawInput::default()
        };
        let mut output = context.run_ui(input, |ui| app.show(ui));
        output.textures_delta.clear();
    };
    let [old, new] = [(); 2].map(|()| egui::Context::default());
    pass_at(&mut app, &old, 100.0);
    app.capture.way = Way::Flight;
    app.capture.seconds = 2.0;
    app.start_capture(&old);
    app.say(&old, "for five seconds");
    pass_at(&mut app, &old, 101.0);
    app.move_to(&new, &old);
    pass_at(&mut app, &new, 0.5);
    assert!(matches!(app.capture.phase, Phase::Flying(..)));
    pass_at(&mut app, &new, 1.5);
    assert!(matches!(app.capture.phase, Phase::Drawing(0, 60)));
    assert_eq!(app.messages.len(), 1);
    pass_at(&mut app, &new, 5.0);
    assert!(app.messages.is_empty());
}

#[test]
fn nothing_is_asked_of_a_scene_that_goes() {
    let mut app = loaded();
    let context = egui::Context::default();
    let pass = Pass::new(&context, SIZES[0]);
    pass.show(&mut app, Vec::new());
    let ask_all = |app: &mut App| {
        app.select_at(glam::Vec2::splat(0.5));
        app.start_capture(&context);
        app.go_to_start();
        pass.show(app, Vec::new());
    };
    ask_all(&mut app);
    assert_eq!(app.worker.ordered(), ["pick", "capture", "draw"]);
    app.capture.phase = Phase::Idle;
    // Neither what waits nor what comes then.
    app.select_at(glam::Vec2::splat(0.5));
    app.open_scene("first".to_owned());
    app.open_scene("second".to_owned());
    ask_all(&mut app);
    assert_eq!(app.worker.ordered(), ["load"]);
    // A scene that was given up for another, and a picture that failed, end nothing.
    let source = "first".to_owned();
    app.worker.imagine(News::LoadFailed(source, String::new()));
    app.worker.imagine(News::Failed(String::new()));
    ask_all(&mut app);
    assert!(app.worker.ordered().is_empty());
    // Where the other cannot be opened either, the old one is drawn on.
    let source = "second".to_owned();
    app.worker.imagine(News::LoadFailed(source, String::new()));
    pass.show(&mut app, Vec::new());
    assert_eq!(app.worker.ordered(), ["draw"]);
}

#[test]
fn warnings_of_a_scene_are_counted_in_words_that_fit() {
    for (warnings, words) in [
        (1, "1 warning; 'foveal scene info' lists it"),
        (2, "2 warnings; 'foveal scene info' lists them"),
    ] {
        let mut app = loaded();
        let scene = LoadedScene {
            warnings,
            ..tests::scene()
        };
        app.take_scene(&egui::Context::default(), scene);
        assert_eq!(app.messages[0].text, format!("cornell: {words}"));
    }
}
