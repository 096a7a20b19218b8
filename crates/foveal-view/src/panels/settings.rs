//! The settings, stage by stage, made from their table.

use egui::{CollapsingHeader, DragValue, RichText, Slider, SliderClamping};
use foveal::{Kind, Setting, Settings};
use toml::{Table, Value};

use crate::app::{App, Display};
use crate::look;
use crate::needs::{Abilities, refused};

/// Width of the names, in points.
const NAMES: f32 = 108.0;

/// Above the settings: what they are, and what is wrong with them.
pub(super) fn head(app: &mut App, ui: &mut egui::Ui) {
    ui.horizontal(|ui| {
        ui.heading("Settings");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.button("Reset all").clicked() {
                app.use_settings(&Settings::default());
                app.display.fit = app.host.fit;
            }
        });
    });
    if let Some(wrong) = &app.wrong {
        ui.label(RichText::new(wrong).color(look::BAD));
    }
    ui.add_space(2.0);
}

pub(super) fn show(app: &mut App, ui: &mut egui::Ui) {
    let defaults = Table::try_from(Settings::default()).unwrap_or_default();
    let mut stages: Vec<&str> = Vec::new();
    for setting in Settings::ALL {
        if !stages.contains(&setting.stage) {
            stages.push(setting.stage);
        }
    }
    for stage in stages {
        let of_stage = || Settings::ALL.iter().filter(|s| s.stage == stage);
        let in_use = of_stage().any(|setting| app.missing(setting.key).is_none());
        let why = of_stage().find_map(|setting| app.missing(setting.key));
        let title = if in_use {
            RichText::new(stage).strong().color(look::ACCENT)
        } else {
            RichText::new(format!("{stage} (not in use)")).color(look::FAINT)
        };
        // Its identity changes with its use, so that it opens when it comes into use.
        let header = CollapsingHeader::new(title)
            .id_salt((stage, in_use))
            .default_open(in_use)
            .show_unindented(ui, |ui| {
                for setting in of_stage() {
                    let missing = app.missing(setting.key);
                    let abilities = app.abilities;
                    row(
                        ui,
                        setting,
                        (missing, abilities),
                        &mut app.draft,
                        &defaults,
                        &app.display,
                    );
                }
                match stage {
                    "Picture" => size(&mut app.display, ui),
                    "Eye" => {
                        let missing = app.missing("gaze");
                        let follows = &mut app.display.gaze_follows;
                        ui.add_enabled_ui(missing.is_none(), |ui| {
                            ui.checkbox(follows, "Gaze follows the pointer (G)")
                                .on_disabled_hover_text(missing.unwrap_or_default());
                        });
                    }
                    _ => {}
                }
                ui.add_space(4.0);
            });
        if let (false, Some(why)) = (in_use, why) {
            header.header_response.on_hover_text(why);
        }
    }
}

/// How the picture's size follows the window, and when it is drawn.
fn size(display: &mut Display, ui: &mut egui::Ui) {
    ui.checkbox(&mut display.fit, "Size follows the window");
    ui.add_enabled_ui(display.fit, |ui| {
        ui.horizontal(|ui| {
            name(ui, "Resolution", false);
            let mut percent = display.scale * 100.0;
            let slider = Slider::new(&mut percent, 10.0..=100.0)
                .suffix(" %")
                .integer();
            if ui.add(slider).changed() {
                display.scale = percent / 100.0;
            }
        });
    });
    ui.checkbox(&mut display.always, "Draw without pause");
    ui.checkbox(&mut display.vsync, "Vertical sync");
}

fn name(ui: &mut egui::Ui, text: &str, changed: bool) -> egui::Response {
    let color = if changed { look::TEXT } else { look::FAINT };
    let label = egui::Label::new(RichText::new(text).color(color))
        .truncate()
        .sense(egui::Sense::click());
    ui.allocate_ui_with_layout(
        egui::vec2(NAMES, ui.spacing().interact_size.y),
        egui::Layout::left_to_right(egui::Align::Center),
        |ui| {
            ui.set_min_width(NAMES);
            ui.add(label)
        },
    )
    .inner
}

fn row(
    ui: &mut egui::Ui,
    setting: &Setting,
    (missing, abilities): (Option<&str>, Abilities),
    draft: &mut Table,
    defaults: &Table,
    display: &Display,
) {
    let key = setting.key;
    // What a choice would make of the other settings.
    let others = draft.clone();
    let (Some(value), Some(default)) = (draft.get_mut(key), defaults.get(key)) else {
        return;
    };
    let follows = display.fit && matches!(key, "width" | "height");
    ui.push_id(key, |ui| {
        ui.horizontal(|ui| {
            let changed = value != default && !follows;
            let help = format!(
                "{}\n\nFlag: --{key}\nClick: back to {default}",
                setting.help
            );
            let reset = ui
                .add_enabled_ui(missing.is_none(), |ui| {
                    name(ui, setting.label, changed)
                        .on_hover_text(&help)
                        .on_disabled_hover_text(match missing {
                            Some(why) => format!("{why}\n\n{help}"),
                            None => help.clone(),
                        })
                })
                .inner;
            ui.add_enabled_ui(!follows && missing.is_none(), |ui| {
                let refused = |choice: &str| refused((setting, choice), &others, abilities);
                edit(ui, setting.kind, value, refused);
            });
            if changed && reset.clicked() {
                *value = default.clone();
            }
        });
    });
}

/// A text that counts once it is typed: half a file's name is none.
fn text(ui: &mut egui::Ui, value: &mut String) {
    let id = ui.scope_id().with("typed");
    let typed = ui.data(|data| data.get_temp(id));
    let mut typed = typed.unwrap_or_else(|| value.clone());
    let field = ui.add(egui::TextEdit::singleline(&mut typed).desired_width(136.0));
    if field.lost_focus() {
        value.clone_from(&typed);
    }
    let is_typing = field.has_focus();
    ui.data_mut(|data| {
        if is_typing {
            data.insert_temp(id, typed);
        } else {
            data.remove::<String>(id);
        }
    });
}

/// `refused`: why a choice is impossible beside the other settings.
fn edit(
    ui: &mut egui::Ui,
    kind: Kind,
    value: &mut Value,
    refused: impl Fn(&str) -> Option<String>,
) {
    match (kind, value) {
        (Kind::Switch, Value::Boolean(on)) => {
            ui.checkbox(on, "");
        }
        (Kind::Choice(names), Value::String(chosen)) => {
            egui::ComboBox::from_id_salt("choice")
                .width(136.0)
                .selected_text(chosen.as_str())
                .show_ui(ui, |ui| {
                    for name in names() {
                        let why = refused(name);
                        ui.add_enabled_ui(why.is_none(), |ui| {
                            ui.selectable_value(chosen, (*name).to_owned(), *name)
                                .on_disabled_hover_text(why.unwrap_or_default());
                        });
                    }
                });
        }
        (Kind::Integer { least, most }, Value::Integer(number)) => {
            if most - least <= 32 {
                ui.add(Slider::new(number, least..=most));
            } else {
                ui.add(DragValue::new(number).range(least..=most));
            }
        }
        (Kind::Number { least, most }, Value::Float(number)) => {
            let slider = Slider::new(number, least..=most)
                .clamping(SliderClamping::Never)
                .max_decimals(3);
            if ui.add(slider).changed() {
                // As a settings file's reader would round it.
                *number = f64::from(*number as f32);
            }
        }
        (Kind::Place, Value::Array(place)) => {
            for part in place {
                if let Value::Float(part) = part {
                    ui.add(DragValue::new(part).speed(0.005).max_decimals(3));
                }
            }
        }
        (Kind::File | Kind::Text, Value::String(path)) => {
            text(ui, path);
        }
        (_, other) => {
            ui.label(other.to_string());
        }
    }
}
