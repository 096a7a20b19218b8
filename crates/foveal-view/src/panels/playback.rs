//! The animation: which clip plays, where in it one is.

use egui::{Slider, SliderClamping, Ui};
use foveal_scene::{Clip, printable};

use crate::app::App;

/// A clip's name for people.
fn name(number: usize, name: &str) -> String {
    if name.is_empty() {
        format!("clip {number}")
    } else {
        printable(name)
    }
}

pub(super) fn is_shown(app: &App) -> bool {
    let scene = app.scene.as_ref();
    scene.is_some_and(|scene| scene.duration_s(&Clip::All) > 0.0)
}

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    let Some(scene) = &app.scene else { return };
    let duration_s = scene.duration_s(&app.display.clip);
    ui.horizontal(|ui| {
        let text = if app.display.playing { "Pause" } else { "Play" };
        if ui
            .add_sized([52.0, 22.0], egui::Button::new(text))
            .on_hover_text("Lets the animation run or rest (Space)")
            .clicked()
        {
            app.display.playing = !app.display.playing;
        }
        if scene.clips.len() > 1 {
            let chosen = match &app.display.clip {
                Clip::Number(number) => {
                    let clip = scene.clips.get(*number as usize);
                    clip.map_or(String::new(), |c| name(*number as usize, &c.0))
                }
                Clip::Named(name) => printable(name),
                Clip::All => "all".to_owned(),
            };
            let before = app.display.clip.clone();
            egui::ComboBox::from_id_salt("clip")
                .width(120.0)
                .truncate()
                .selected_text(chosen)
                .show_ui(ui, |ui| {
                    for (number, (clip, _)) in scene.clips.iter().enumerate() {
                        let value = Clip::Number(number as u32);
                        ui.selectable_value(&mut app.display.clip, value, name(number, clip));
                    }
                    ui.selectable_value(&mut app.display.clip, Clip::All, "all")
                        .on_hover_text("All at once: each is looped over its own length, and all begin anew after the longest");
                })
                .response
                .on_hover_text("The animation that plays");
            if app.display.clip != before {
                app.display.time_s = 0.0;
            }
        }
        // Its number stands to the right of a slider.
        ui.spacing_mut().slider_width = (ui.available_width() - 130.0).max(60.0);
        let slider = Slider::new(&mut app.display.time_s, 0.0..=duration_s.max(1e-3))
            .fixed_decimals(2)
            // Else it would round the moment in each pass, and with it the animation's speed.
            .clamping(SliderClamping::Edits)
            .suffix(format!(" of {duration_s:.2} s"));
        if ui.add(slider).changed() {
            app.display.playing = false;
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::{Pass, SIZES, loaded};

    #[test]
    fn an_animation_runs_as_fast_as_time_does() {
        let mut app = loaded();
        let context = egui::Context::default();
        let pass = Pass::new(&context, SIZES[0]);
        app.display.playing = true;
        // Sixty passes are a second, of a clip of 1.5.
        for _ in 0..60 {
            pass.show(&mut app, Vec::new());
        }
        let time_s = app.display.time_s;
        assert!(
            app.display.playing && (time_s - 1.0).abs() < 0.02,
            "{time_s}"
        );
    }

    #[test]
    fn a_clip_is_shown_without_control_characters_and_by_its_number_where_it_has_no_name() {
        assert_eq!(name(3, "Walk\u{1b}[2J"), r"Walk\u001b[2J");
        assert_eq!(name(3, ""), "clip 3");
    }
}
