//! What keys do, and where the camera goes by them.

use egui::{Key, Modifiers};
use glam::Vec3;

use super::App;
use crate::navigator::{Hands, Mode};

impl App {
    /// Keys, unless a text field takes them.
    pub(super) fn take_keys(&mut self, context: &egui::Context) {
        if context.text_edit_focused() {
            return;
        }
        let pressed = |key| context.input_mut(|i| i.consume_key(Modifiers::NONE, key));
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
        if pressed(Key::Home)
            && let (Some(navigator), Some(scene)) = (&mut self.navigator, &self.scene)
        {
            navigator.go_to(scene.start.clone());
        }
        if context.input_mut(|i| i.consume_key(Modifiers::CTRL | Modifiers::SHIFT, Key::F12)) {
            self.worker.lose_device();
            self.loses_devices = true;
        }
        if pressed(Key::P) || pressed(Key::F12) {
            self.take_screenshot(context);
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
            if context.input_mut(|i| i.consume_key(Modifiers::CTRL, key)) {
                self.set_bookmark(index);
            } else if pressed(key) {
                self.go_to_bookmark(index);
            }
        }
    }

    pub(crate) fn set_bookmark(&mut self, index: usize) {
        if let Some(navigator) = &self.navigator {
            self.bookmarks[index] = Some(navigator.camera().clone());
        }
    }

    pub(crate) fn go_to_bookmark(&mut self, index: usize) {
        if let (Some(navigator), Some(camera)) = (&mut self.navigator, &self.bookmarks[index]) {
            navigator.go_to(camera.clone());
        }
    }

    /// Moves the camera by the keys that are held and by what the pointer did over the picture.
    pub(crate) fn steer(&mut self, context: &egui::Context, mut hands: Hands) {
        if !context.text_edit_focused() {
            context.input(|i| {
                if i.modifiers.ctrl || i.modifiers.command {
                    return;
                }
                let axis = |more: &[Key], less: &[Key]| {
                    let down = |keys: &[Key]| keys.iter().any(|&key| i.key_down(key));
                    f32::from(u8::from(down(more))) - f32::from(u8::from(down(less)))
                };
                hands.push = Vec3::new(
                    axis(&[Key::D, Key::ArrowRight], &[Key::A, Key::ArrowLeft]),
                    axis(&[Key::E, Key::PageUp], &[Key::Q, Key::PageDown]),
                    axis(&[Key::W, Key::ArrowUp], &[Key::S, Key::ArrowDown]),
                );
                hands.hurry = i.modifiers.shift;
            });
        }
        let dt = context.input(|i| i.stable_dt);
        // A step after a pause is as long as one frame, not as the pause.
        hands.elapsed_s = dt.min(0.1);
        if let Some(navigator) = &mut self.navigator
            && navigator.step(&hands)
            && hands.push != Vec3::ZERO
        {
            context.request_repaint();
        }
        let animated = self.scene.as_ref().is_some_and(|scene| scene.is_animated);
        if animated && self.display.playing {
            self.display.time_s += hands.elapsed_s;
            context.request_repaint();
        }
    }
}
