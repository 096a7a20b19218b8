//! What keys do, and where the camera goes by them.

use std::path::Path;

use egui::{Event, Key, Modifiers};
use foveal::ShownEyes;
use foveal_scene::Camera;
use glam::{Vec2, Vec3};

use super::App;
use crate::browser::Browser;
use crate::navigator::{Hands, Mode, Side};
use crate::pick::Ray;

/// Whether a key goes down; it does not again while it is held.
fn consume_press(input: &mut egui::InputState, modifiers: Modifiers, key: Key) -> bool {
    let is_repeated =
        |event: &Event| matches!(event, Event::Key { key: held, repeat: true, .. } if *held == key);
    input.events.retain(|event| !is_repeated(event));
    input.consume_key(modifiers, key)
}

impl App {
    /// Keys, unless a text field takes them.
    pub(super) fn take_keys(&mut self, context: &egui::Context) {
        let with = |modifiers, key| context.input_mut(|i| consume_press(i, modifiers, key));
        if with(Modifiers::COMMAND, Key::O) {
            self.open_dialog();
        }
        if self.browser.is_some() || context.text_edit_focused() {
            return;
        }
        let pressed = |key| with(Modifiers::NONE, key);
        if with(Modifiers::CTRL | Modifiers::SHIFT, Key::F12) {
            self.worker.lose_device();
            self.loses_devices = true;
        }
        // An open menu takes it for itself.
        if !egui::Popup::is_any_open(context) && pressed(Key::Escape) {
            self.escape();
        }
        for (key, side) in [
            (Key::Num1, Side::Front),
            (Key::Num3, Side::Right),
            (Key::Num7, Side::Top),
        ] {
            if with(Modifiers::ALT, key) {
                self.look_from(side);
            }
        }
        let display = &mut self.display;
        for (key, switch) in [
            (Key::C, &mut display.frozen),
            (Key::B, &mut display.boxes),
            (Key::Z, &mut display.depth),
            (Key::X, &mut display.compare),
            (Key::G, &mut display.gaze_follows),
            (Key::H, &mut display.panels),
            (Key::F1, &mut display.keys),
            (Key::Space, &mut display.playing),
            (Key::V, &mut self.capture.is_open),
        ] {
            if pressed(key) {
                *switch = !*switch;
            }
        }
        if pressed(Key::F)
            && let Some(navigator) = &mut self.navigator
        {
            navigator.mode = match navigator.mode {
                Mode::Fly => Mode::Orbit,
                Mode::Orbit => Mode::Fly,
            };
        }
        if pressed(Key::Home) {
            self.go_to_start();
        }
        if pressed(Key::Period) {
            self.frame_selected();
        }
        if pressed(Key::P) || pressed(Key::F12) {
            self.take_screenshot(context);
        }
        if self.capture.is_open && pressed(Key::Enter) {
            self.start_capture(context);
        }
        const DIGITS: [Key; 9] = [
            Key::Num1,
            Key::Num2,
            Key::Num3,
            Key::Num4,
            Key::Num5,
            Key::Num6,
            Key::Num7,
            Key::Num8,
            Key::Num9,
        ];
        for (index, key) in DIGITS.into_iter().enumerate() {
            if with(Modifiers::CTRL, key) {
                self.set_bookmark(index);
            } else if pressed(key) {
                self.go_to_bookmark(index);
            }
        }
    }

    /// Opens the dialog on the folder of the last file, or on the one that the host starts with.
    pub(crate) fn open_dialog(&mut self) {
        let files = self.host.files.as_ref();
        let last = self.scene.as_ref().map(|scene| &scene.source);
        let last = last.filter(|source| !self.host.generated.contains(source));
        let folder = last.map(|source| files.full_name(source));
        let folder = folder.as_ref().and_then(|name| Path::new(name).parent());
        let folder = folder.filter(|folder| files.is_folder(folder));
        let folder = folder.map_or_else(|| files.start(), Path::to_owned);
        self.browser = Some(Browser::new(files, folder));
    }

    /// Closes or ends what is on top.
    fn escape(&mut self) {
        if self.display.keys {
            self.display.keys = false;
        } else if !self.capture.is_idle() {
            self.cancel_capture();
        } else if self.capture.is_open {
            self.capture.is_open = false;
        } else {
            self.selected = None;
        }
    }

    pub(crate) fn go_to_start(&mut self) {
        if let (Some(navigator), Some(scene)) = (&mut self.navigator, &self.scene) {
            navigator.go_to(scene.start.clone());
        }
    }

    /// Width by height of an eye's picture.
    pub(crate) fn aspect(&self) -> f32 {
        self.settings.picture.width as f32 / self.settings.picture.height.max(1) as f32
    }

    /// Brings what is selected, or else everything, into view.
    pub(crate) fn frame_selected(&mut self) {
        let (bounds, aspect) = (self.framed(), self.aspect());
        if let Some(navigator) = &mut self.navigator {
            navigator.frame(bounds, aspect);
        }
    }

    /// Looks at what is selected, or else at everything, from a side.
    pub(crate) fn look_from(&mut self, side: Side) {
        let (bounds, aspect) = (self.framed(), self.aspect());
        if let Some(navigator) = &mut self.navigator {
            navigator.look_from(side, bounds, aspect);
        }
    }

    /// The eyes that the picture on the screen shows, from where the camera is.
    pub(crate) fn shown_eyes(&self) -> Option<ShownEyes> {
        let (shown, navigator) = (self.shown.as_ref()?, self.navigator.as_ref()?);
        ShownEyes::new(&shown.request.settings, navigator.camera()).ok()
    }

    /// Selects what is at a place of the picture, given as fractions of it from the top left.
    pub(crate) fn select_at(&mut self, place: Vec2) {
        if let (Some(ray), None) = (self.ray_at(place), &self.opening) {
            self.worker.pick(ray);
        }
    }

    /// The ray of the eye whose picture has this place; `None` where no eye sees anything.
    fn ray_at(&self, place: Vec2) -> Option<Ray> {
        let eyes = self.shown_eyes()?;
        let (eye, place) = eyes.seen(place.to_array());
        let is_seen = place.iter().all(|part| (0.0..=1.0).contains(part));
        is_seen.then(|| Ray::through(&eyes.clip_from_world(eye), place))
    }

    /// Has the eye look at a place of the picture, given as fractions of it from the top left.
    pub(crate) fn look_at(&mut self, place: Vec2) {
        let Some(eyes) = self.shown_eyes() else {
            return;
        };
        let (eye, place) = eyes.seen(place.to_array());
        let shift = self
            .settings
            .stereo
            .gaze_shift
            .map(|part| part * eye as f32);
        let gaze = (Vec2::from(place) - Vec2::from(shift)).to_array();
        let gaze = gaze.map(|part| f64::from((part * 1000.0).round() / 1000.0));
        self.draft.insert("gaze".to_owned(), gaze.to_vec().into());
    }

    pub(crate) fn set_bookmark(&mut self, index: usize) {
        if let Some(navigator) = &self.navigator {
            let camera = Some(navigator.camera().clone());
            self.keep_bookmark(index, camera);
        }
    }

    /// Sets or removes a bookmark, now and for the next time that the scene is opened.
    pub(crate) fn keep_bookmark(&mut self, index: usize, camera: Option<Camera>) {
        let text = camera
            .as_ref()
            .map(|camera| (self.host.exact_camera)(camera));
        self.bookmarks[index] = camera;
        if let Some(scene) = &self.scene {
            let name = self.host.files.full_name(&scene.source);
            self.remember(|memory| memory.set_bookmark(&name, index as u8 + 1, text));
        }
    }

    pub(crate) fn go_to_bookmark(&mut self, index: usize) {
        if let (Some(navigator), Some(camera)) = (&mut self.navigator, &self.bookmarks[index]) {
            navigator.go_to(camera.clone());
        }
    }

    /// Moves the camera by the keys that are held and by what the pointer did over the picture.
    pub(crate) fn steer(&mut self, context: &egui::Context, mut hands: Hands) {
        if !context.text_edit_focused() && self.browser.is_none() {
            context.input(|i| {
                if i.modifiers.ctrl || i.modifiers.command {
                    return;
                }
                let axis = |more: &[Key], less: &[Key]| {
                    let down = |keys: &[Key]| keys.iter().any(|&key| i.key_down(key));
                    f32::from(u8::from(down(more))) - f32::from(u8::from(down(less)))
                };
                hands.push = Vec3::new(
                    axis(&[Key::D], &[Key::A]),
                    axis(&[Key::E, Key::PageUp], &[Key::Q, Key::PageDown]),
                    axis(&[Key::W], &[Key::S]),
                );
                hands.keys_turn = Vec2::new(
                    axis(&[Key::ArrowRight], &[Key::ArrowLeft]),
                    axis(&[Key::ArrowUp], &[Key::ArrowDown]),
                );
                hands.hurry = i.modifiers.shift;
            });
        }
        let dt = context.input(|i| i.stable_dt);
        // A step after a pause is as long as one frame, not as the pause.
        hands.elapsed_s = dt.min(0.1);
        if let Some(navigator) = &mut self.navigator
            && navigator.step(&hands)
            && (hands.push != Vec3::ZERO || hands.keys_turn != Vec2::ZERO)
        {
            context.request_repaint();
        }
        let scene = self.scene.as_ref();
        let duration_s = scene.map_or(0.0, |scene| scene.duration_s(&self.display.clip));
        if duration_s > 0.0 && self.display.playing {
            self.display.time_s = (self.display.time_s + hands.elapsed_s) % duration_s;
            context.request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use foveal::{Output, Stereo};
    use foveal_generate as generate;

    use super::super::tests::{Pass, SIZES, loaded};
    use super::*;
    use crate::pick::pick;

    /// An app that shows both eyes.
    fn with_eyes(output: Output) -> App {
        let mut app = loaded();
        app.settings.stereo.mode = Stereo::Instanced;
        app.settings.stereo.output = output;
        if let Some(shown) = &mut app.shown {
            shown.request.settings = app.settings.clone();
        }
        app
    }

    #[test]
    fn a_click_meets_what_the_eye_sees_whose_picture_is_there() {
        let scene = generate::cornell();
        let block = scene.objects.iter().find(|o| o.name == "tall block");
        let middle = block.unwrap().bounds.center();
        for output in [
            Output::Flat,
            Output::SideBySide,
            Output::SideBySideHalf,
            Output::Anaglyph,
            Output::Headset,
        ] {
            let app = with_eyes(output);
            let eyes = app.shown_eyes().unwrap();
            for eye in 0..eyes.count() {
                let at = eyes.clip_from_world(eye).project_point3(middle);
                let at = eyes.shown(eye, [0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y]);
                let ray = app.ray_at(at.unwrap().into()).unwrap();
                let found = pick(&scene, ray).unwrap();
                assert_eq!(found.name, "tall block", "{output:?}, eye {eye}");
            }
        }
        let corner = with_eyes(Output::Headset).ray_at(Vec2::splat(0.001));
        assert_eq!(corner, None);
    }

    #[test]
    fn the_gaze_is_a_place_of_the_left_eye_s_picture() {
        let gaze = |output, at: [f32; 2]| {
            let mut app = with_eyes(output);
            app.settings.stereo.gaze_shift = [0.25, 0.0];
            app.look_at(at.into());
            app.draft["gaze"].to_string()
        };
        assert_eq!(gaze(Output::Flat, [0.75, 0.25]), "[0.75, 0.25]");
        assert_eq!(gaze(Output::Anaglyph, [0.75, 0.25]), "[0.75, 0.25]");
        assert_eq!(gaze(Output::SideBySide, [0.25, 0.25]), "[0.5, 0.25]");
        assert_eq!(gaze(Output::SideBySide, [0.75, 0.25]), "[0.25, 0.25]");
    }

    #[test]
    fn a_held_key_switches_once() {
        let mut app = loaded();
        let context = egui::Context::default();
        let pass = Pass::new(&context, SIZES[0]);
        let down = Event::Key {
            key: Key::C,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        for _ in 0..4 {
            pass.show(&mut app, vec![down.clone()]);
            assert!(app.display.frozen);
        }
    }

    #[test]
    fn escape_closes_an_open_menu_before_all_else() {
        let mut app = loaded();
        app.capture.is_open = true;
        let context = egui::Context::default();
        let pass = Pass::new(&context, SIZES[0]);
        pass.show(&mut app, Vec::new());
        egui::Popup::open_id(&context, egui::Id::unique("menu"));
        app.take_keys(&context);
        let escape = Event::Key {
            key: Key::Escape,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        context.input_mut(|i| i.events.push(escape));
        app.take_keys(&context);
        assert!(app.capture.is_open);
        egui::Popup::close_all(&context);
        app.take_keys(&context);
        assert!(!app.capture.is_open);
    }
}
