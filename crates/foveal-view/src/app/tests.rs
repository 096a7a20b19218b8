//! The window's state and its panels without a window: passes of the interface on no screen.

use std::sync::Arc;

use anyhow::bail;
use egui::{Event, Key, Modifiers, Pos2, RawInput, Rect, Vec2};
use foveal::{Settings, Shading, Stereo, Timing};
use foveal_generate as generate;

use super::*;
use crate::browser::tests::Imagined;
use crate::capture::Ended;
use crate::needs::{Switch, of_culling};

/// A program that lends nothing but folders that are not on any disk.
pub(crate) fn host() -> Host {
    Host {
        scene: "cornell".to_owned(),
        generated: generate::NAMES.map(str::to_owned).to_vec(),
        settings: Settings::default(),
        fit: true,
        adapter: None,
        window: (1, 1),
        load: Box::new(|_| bail!("no scenes here")),
        light: Box::new(|_| ()),
        files: Box::new(Imagined::default()),
        record: Box::new(|_, _, _| bail!("no recordings here")),
        no_video: Some("there is no ffmpeg".to_owned()),
        read_settings: |_| bail!("no settings here"),
        write_file: |_, _| bail!("no files here"),
        rate_image: |_| Ok(None),
        environment: |_| Ok(None),
        flags: |_| Vec::new(),
        exact_camera: |camera| format!("{:?}", camera.eye().to_array()),
        read_camera: |text| {
            let numbers = text.trim_matches(['[', ']']).split(',');
            let numbers: Vec<f32> = numbers.map(|n| n.trim().parse().unwrap()).collect();
            let eye = glam::Vec3::from_slice(&numbers);
            Some(Camera::look_at(eye, glam::Vec3::ZERO, glam::Vec3::Y, 1.0))
        },
        quoted: str::to_owned,
        scene_flags: Box::new(|_| Vec::new()),
    }
}

/// A window's state with a thread that does nothing.
pub(crate) fn app() -> App {
    App::with(Arc::new(host()), Worker::idle())
}

/// A scene as the thread would tell of it, with two clips.
pub(crate) fn scene() -> LoadedScene {
    let scene = generate::cornell();
    LoadedScene {
        name: "cornell".to_owned(),
        source: "cornell".to_owned(),
        counts: foveal::SceneStats {
            objects: 26_894,
            triangles: 1_891_747,
            lights: 200,
            ..Default::default()
        },
        start: scene.cameras[0].clone(),
        cameras: scene.cameras.clone(),
        bounds: scene.bounds(),
        clips: vec![("Walk".to_owned(), 1.5), (String::new(), 3.0)],
        clip: Clip::default(),
        warnings: 0,
    }
}

/// An app with a scene and a frame with large figures.
pub(crate) fn loaded() -> App {
    let mut app = app();
    let context = egui::Context::default();
    app.adapter = Some(AdapterStats {
        name: "llvmpipe (LLVM 15.0.6, 256 bits)".to_owned(),
        backend: "vulkan".to_owned(),
        kind: "cpu".to_owned(),
        driver: String::new(),
    });
    app.take_scene(&context, scene());
    app.display.playing = false;
    let timing = |name: &str, ms| Timing {
        name: name.to_owned(),
        ms,
    };
    let mut stats = foveal::FrameStats::default();
    stats.frame_ms = 1234.5;
    stats.cpu_ms = vec![timing("culling", 12.0), timing("encode and submit", 3.0)];
    stats.gpu_ms = vec![
        timing("reproject light history", 500.0),
        timing("shading", 700.0),
    ];
    stats.shaded_samples = 1_234_567_890;
    stats.draws = 26_894;
    stats.triangles = 1_891_747;
    app.shown = Some(Box::new(Shown {
        picture: Rgba {
            width: 4,
            height: 2,
            bytes: vec![0; 32],
        },
        stats,
        request: app.request().unwrap(),
        reference: None,
        compared: None,
        flip: None,
        culling: None,
        boxes: Vec::new(),
        depth: None,
    }));
    app
}

/// A window's size in points, its scale, and the keys that are pressed.
pub(crate) struct Pass<'a> {
    context: &'a egui::Context,
    size: Vec2,
}

impl<'a> Pass<'a> {
    pub(crate) fn new(context: &'a egui::Context, size: Vec2) -> Self {
        crate::look::apply(context);
        Self { context, size }
    }

    pub(crate) fn show(&self, app: &mut App, events: Vec<Event>) -> egui::FullOutput {
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, self.size)),
            events,
            ..RawInput::default()
        };
        let mut output = self.context.run_ui(input, |ui| app.show(ui));
        // Nobody draws here.
        output.textures_delta.clear();
        output
    }

    fn press(&self, app: &mut App, modifiers: Modifiers, key: Key) {
        let event = |pressed| Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers,
        };
        self.show(app, vec![event(true), event(false)]);
        self.show(app, Vec::new());
    }
}

/// A text on the screen: what it says, where it is, what of it can be seen, whether it is cut.
#[derive(Debug)]
pub(crate) struct Text {
    pub(crate) says: String,
    pub(crate) rect: Rect,
    clip: Rect,
    is_elided: bool,
}

pub(crate) fn texts(output: &egui::FullOutput) -> Vec<Text> {
    fn collect(shape: &egui::Shape, clip: Rect, found: &mut Vec<Text>) {
        match shape {
            egui::Shape::Text(text) => found.push(Text {
                says: text.galley.text().to_owned(),
                rect: text.visual_bounding_rect(),
                clip,
                is_elided: text.galley.elided,
            }),
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|s| collect(s, clip, found)),
            _ => {}
        }
    }
    let mut found = Vec::new();
    for clipped in &output.shapes {
        collect(&clipped.shape, clipped.clip_rect, &mut found);
    }
    found.retain(|text| !text.says.trim().is_empty());
    found
}

/// Texts that are cut off at a side, cut short, or over one another.
fn faults(output: &egui::FullOutput, size: Vec2) -> Vec<String> {
    let screen = Rect::from_min_size(Pos2::ZERO, size);
    let texts = texts(output);
    // What is scrolled out of sight is no fault.
    let seen: Vec<&Text> = (texts.iter())
        .filter(|t| t.clip.intersect(screen).intersects(t.rect))
        .collect();
    let mut faults = Vec::new();
    for text in &seen {
        let within = text.clip.intersect(screen).expand(0.6).x_range();
        if !within.contains(text.rect.left()) || !within.contains(text.rect.right()) {
            faults.push(format!("cut off: {text:?}"));
        }
        if text.is_elided {
            faults.push(format!("cut short: {text:?}"));
        }
    }
    for (i, a) in seen.iter().enumerate() {
        for b in &seen[..i] {
            // A dialog lies over what is below it.
            let both = a.rect.shrink(1.5).intersect(b.rect.shrink(1.5));
            if a.clip == b.clip && both.is_positive() {
                faults.push(format!("over one another: {a:?}, {b:?}"));
            }
        }
    }
    faults
}

/// Sizes in points: the smallest window, as wide with all that its panels scroll to, the usual one,
/// a large screen at twice the size.
pub(crate) const SIZES: [Vec2; 4] = [
    Vec2::new(960.0, 540.0),
    Vec2::new(960.0, 4000.0),
    Vec2::new(1280.0, 800.0),
    Vec2::new(1280.0, 720.0),
];

/// A name, and what brings the window there.
type State = (&'static str, fn(&mut App));

#[test]
fn no_text_is_cut_off_or_over_another_whatever_is_switched_on() {
    let all_on: [State; 7] = [
        ("defaults", |_| ()),
        ("coarse", |app| {
            let settings = Settings::default().with(|s| {
                s.shading.mode = Shading::Coarse;
                s.stereo.mode = Stereo::Instanced;
                s.antialiasing.mode = foveal::Antialiasing::Msaa;
            });
            app.use_settings(&settings);
        }),
        ("variable, compared", |app| {
            let settings = Settings::default().with(|s| {
                s.geometry.path = foveal::Geometry::Visibility;
                s.shading.mode = Shading::Variable;
            });
            app.use_settings(&settings);
            app.display.compare = true;
        }),
        ("culling off", |app| {
            let settings = Settings::default().with(|s| s.culling.mode = foveal::Culling::Off);
            app.use_settings(&settings);
            app.selected = Some(Picked {
                name: "a thing with a rather long name, longer than the place".to_owned(),
                object: 7,
                bounds: app.scene.as_ref().unwrap().bounds,
                triangles: 1_055_674,
            });
        }),
        ("keys", |app| app.display.keys = true),
        ("open", |app| app.open_dialog()),
        ("capture", |app| {
            app.capture.is_open = true;
            app.capture.ended = Some(Ended::Done("capture-001".to_owned()));
        }),
    ];
    for (name, switch_on) in all_on {
        for size in SIZES {
            let mut app = loaded();
            switch_on(&mut app);
            let context = egui::Context::default();
            let pass = Pass::new(&context, size);
            // Panels and dialogs find their sizes in the first passes.
            for _ in 0..3 {
                pass.show(&mut app, Vec::new());
            }
            let output = pass.show(&mut app, Vec::new());
            let faults = faults(&output, size);
            assert!(
                faults.is_empty(),
                "{name} at {size}:\n{}",
                faults.join("\n")
            );
            assert!(texts(&output).len() > 40, "{name}");
        }
    }
}

#[test]
fn a_scene_is_opened_from_the_dialog_by_keys() {
    let mut app = loaded();
    let context = egui::Context::default();
    let pass = Pass::new(&context, SIZES[0]);
    pass.show(&mut app, Vec::new());
    pass.press(&mut app, Modifiers::COMMAND, Key::O);
    assert!(app.browser.is_some());
    // Letters go to the field, not to the camera or the switches.
    pass.show(&mut app, vec![Event::Text("room".to_owned())]);
    assert_eq!(app.browser.as_ref().unwrap().typed, "room");
    pass.press(&mut app, Modifiers::NONE, Key::B);
    assert!(!app.display.boxes);
    pass.press(&mut app, Modifiers::NONE, Key::Enter);
    assert_eq!(app.scene_name, "/home/eva/room.gltf");
    assert!(app.opening.is_some() && app.browser.is_none());
    pass.press(&mut app, Modifiers::COMMAND, Key::O);
    pass.press(&mut app, Modifiers::NONE, Key::Escape);
    assert!(app.browser.is_none());
}

#[test]
fn what_failed_to_open_stays_typed_and_the_old_scene_stays() {
    let mut app = loaded();
    let context = egui::Context::default();
    app.open_scene("/no/such.glb".to_owned());
    let cause = "there is none".to_owned();
    app.worker
        .imagine(News::LoadFailed("/no/such.glb".to_owned(), cause));
    app.take_news(&context);
    assert_eq!(app.scene_name, "/no/such.glb");
    assert_eq!(app.scene.as_ref().unwrap().source, "cornell");
    assert!(app.opening.is_none() && app.messages[0].is_error);
    assert_eq!(app.memory.recent, ["cornell"]);
}

#[test]
fn bookmarks_belong_to_their_scene_and_are_kept() {
    let mut app = loaded();
    let context = egui::Context::default();
    app.set_bookmark(2);
    let set = app.bookmarks[2].clone().unwrap();
    let mut other = scene();
    other.source = "demo".to_owned();
    app.take_scene(&context, other);
    assert_eq!(app.bookmarks[2], None);
    app.take_scene(&context, scene());
    let kept = app.bookmarks[2].clone().unwrap();
    assert_eq!((kept.name.as_str(), kept.eye()), ("bookmark 3", set.eye()));
    assert_eq!(app.memory.recent, ["cornell", "demo"]);
    app.keep_bookmark(2, None);
    app.take_scene(&context, scene());
    assert_eq!(app.bookmarks[2], None);
}

#[test]
fn keys_frame_what_is_selected_and_look_from_sides() {
    let mut app = loaded();
    let context = egui::Context::default();
    let pass = Pass::new(&context, SIZES[0]);
    pass.show(&mut app, Vec::new());
    let eye = |app: &App| app.navigator.as_ref().unwrap().camera().eye();
    let center = app.scene.as_ref().unwrap().bounds.center();
    pass.press(&mut app, Modifiers::ALT, Key::Num1);
    let front = eye(&app) - center;
    assert!(
        front.z > 1.0 && front.x.abs() < 1e-3 && front.y.abs() < 1e-3,
        "{front}"
    );
    app.selected = Some(Picked {
        name: "one".to_owned(),
        object: 0,
        bounds: foveal_scene::Aabb {
            min: glam::Vec3::ZERO,
            max: glam::Vec3::splat(0.1),
        },
        triangles: 1,
    });
    pass.press(&mut app, Modifiers::NONE, Key::Period);
    let near = eye(&app) - glam::Vec3::splat(0.05);
    assert!(near.length() < 0.5 && near.z > 0.1, "{near}");
    pass.press(&mut app, Modifiers::NONE, Key::Escape);
    assert_eq!(app.selected, None);
    pass.press(&mut app, Modifiers::NONE, Key::Home);
    assert_eq!(eye(&app), app.scene.as_ref().unwrap().start.eye());
}

#[test]
fn a_flight_ends_by_itself_and_is_drawn() {
    let mut app = loaded();
    app.capture.way = Way::Flight;
    app.capture.seconds = 0.05;
    app.capture.per_second = 100.0;
    let context = egui::Context::default();
    let pass = Pass::new(&context, SIZES[0]);
    pass.show(&mut app, Vec::new());
    app.start_capture(&context);
    assert!(matches!(app.capture.phase, Phase::Flying(..)));
    for _ in 0..20 {
        pass.show(&mut app, Vec::new());
    }
    assert!(
        matches!(app.capture.phase, Phase::Drawing(0, 5)),
        "{:?}",
        app.capture.phase
    );
    // The bar's progress and the end are the thread's news.
    app.worker.imagine(News::Captured(2, 5));
    app.take_news(&context);
    assert!(matches!(app.capture.phase, Phase::Drawing(2, 5)));
    let end = Ended::Done("capture-001".to_owned());
    app.worker.imagine(News::CaptureEnded(end.clone()));
    app.take_news(&context);
    assert!(app.capture.is_idle());
    assert_eq!(app.capture.ended, Some(end));
}

#[test]
fn the_clip_and_its_moment_are_asked_for_and_copied() {
    let mut app = loaded();
    let context = egui::Context::default();
    let pass = Pass::new(&context, SIZES[0]);
    app.display.clip = Clip::Number(1);
    app.display.time_s = 2.5;
    pass.show(&mut app, Vec::new());
    let asked = app.asked.as_ref().unwrap();
    assert_eq!((&asked.clip, asked.time_s), (&Clip::Number(1), 2.5));
    let line = app.command_line().unwrap();
    assert!(line.contains("--clip 1 --time 2.5"), "{line}");
}

#[test]
fn switches_that_need_culling_say_so() {
    let mut app = loaded();
    let context = egui::Context::default();
    let size = Vec2::new(1280.0, 3000.0);
    let pass = Pass::new(&context, size);
    for _ in 0..3 {
        pass.show(&mut app, Vec::new());
    }
    let says = |output: &egui::FullOutput, what: &str| {
        texts(output)
            .iter()
            .filter(|text| text.says == what)
            .count()
    };
    let why = of_culling(Switch::Depth, &app.settings).unwrap();
    let output = pass.show(&mut app, Vec::new());
    assert_eq!(says(&output, why), 1);
    let settings = Settings::default().with(|s| s.culling.mode = foveal::Culling::Occlusion);
    app.use_settings(&settings);
    pass.show(&mut app, Vec::new());
    let output = pass.show(&mut app, Vec::new());
    assert_eq!(says(&output, why), 0);
}

#[test]
fn a_file_s_name_counts_once_it_is_typed() {
    let mut app = loaded();
    let settings = Settings::default().with(|s| {
        s.lighting.environment = foveal::EnvironmentSource::Image;
        s.lighting.environment_image = "sky.hdr".to_owned();
    });
    app.use_settings(&settings);
    let context = egui::Context::default();
    let pass = Pass::new(&context, Vec2::new(1280.0, 3000.0));
    for _ in 0..2 {
        pass.show(&mut app, Vec::new());
    }
    let output = pass.show(&mut app, Vec::new());
    let field = texts(&output).into_iter().find(|t| t.says == "sky.hdr");
    let at = field.unwrap().rect.right_center();
    let press = |pressed| Event::PointerButton {
        pos: at,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    pass.show(&mut app, vec![Event::PointerMoved(at), press(true)]);
    pass.show(&mut app, vec![press(false)]);
    for letter in ["2", "3"] {
        pass.show(&mut app, vec![Event::Text(letter.to_owned())]);
    }
    let named = |app: &App| app.settings.lighting.environment_image.clone();
    assert_eq!(named(&app), "sky.hdr");
    pass.press(&mut app, Modifiers::NONE, Key::Enter);
    assert_ne!(named(&app), "sky.hdr");
    assert!(named(&app).contains("23"));
}

#[test]
fn a_gaze_that_wanders_leaves_the_graph_and_without_effect_asks_for_nothing() {
    let mut app = loaded();
    let context = egui::Context::default();
    let pass = Pass::new(&context, SIZES[0]);
    app.load_textures(&context);
    app.opening = None;
    app.display.gaze_follows = true;
    pass.show(&mut app, Vec::new());
    let wander = |app: &mut App, shading: &str| {
        app.draft.insert("shading".to_owned(), shading.into());
        pass.show(app, Vec::new());
        app.worker.ordered();
        app.history.push(1.0);
        let middle = Pos2::ZERO + SIZES[0] * 0.5;
        for place in [middle, middle + Vec2::splat(20.0)] {
            pass.show(app, vec![Event::PointerMoved(place)]);
            pass.show(app, Vec::new());
        }
        (app.worker.ordered().len(), app.history.frames().len())
    };
    assert_eq!(wander(&mut app, "full"), (0, 1));
    let (orders, frames) = wander(&mut app, "coarse");
    assert!(orders > 0 && frames == 1, "{orders}, {frames}");
}
