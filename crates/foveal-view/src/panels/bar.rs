//! The bar on top: scene, camera, files. The line below: what the keys do.

use egui::{Align, Layout, RichText};

use crate::app::App;
use crate::navigator::Mode;
use crate::{keys, look};

pub(super) fn show(app: &mut App, ui: &mut egui::Ui) {
    ui.horizontal(|ui| {
        ui.label(
            RichText::new("Foveal")
                .strong()
                .color(look::ACCENT)
                .size(16.0),
        );
        ui.add_space(4.0);
        scene(app, ui);
        camera(app, ui);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| files(app, ui));
    });
}

fn scene(app: &mut App, ui: &mut egui::Ui) {
    let name = egui::TextEdit::singleline(&mut app.scene_name)
        .desired_width(130.0)
        .hint_text("path or generated scene");
    let response = ui.add(name).on_hover_text(
        "A glTF file's path or a generated scene's name; Enter loads it. Or drop a file onto the window.",
    );
    let mut open = response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    open |= ui.button("Open").clicked();
    if open {
        let name = app.scene_name.trim().to_owned();
        app.open_scene(name);
    }
    ui.menu_button("Generated", |ui| {
        for name in app.host.generated.clone() {
            if ui.button(&name).clicked() {
                app.open_scene(name);
                ui.close();
            }
        }
    });
    if app.loading {
        ui.spinner();
    }
}

fn camera(app: &mut App, ui: &mut egui::Ui) {
    ui.separator();
    let (Some(navigator), Some(scene)) = (&mut app.navigator, &app.scene) else {
        return;
    };
    ui.selectable_value(&mut navigator.mode, Mode::Fly, "Fly")
        .on_hover_text("W A S D, Q E, drag to look, scroll for speed");
    ui.selectable_value(&mut navigator.mode, Mode::Orbit, "Orbit")
        .on_hover_text("drag to turn, right drag to shift, scroll for distance");
    let mut chosen = None;
    egui::ComboBox::from_id_salt("camera")
        .width(96.0)
        .truncate()
        .selected_text(navigator.camera().name.as_str())
        .show_ui(ui, |ui| {
            for camera in std::iter::once(&scene.start).chain(&scene.cameras) {
                if ui.selectable_label(false, camera.name.as_str()).clicked() {
                    chosen = Some(camera.clone());
                }
            }
        });
    if let Some(camera) = chosen {
        navigator.go_to(camera);
    }
    ui.menu_button("Bookmarks", |ui| {
        for index in 0..app.bookmarks.len() {
            ui.horizontal(|ui| {
                let there = app.bookmarks[index].is_some();
                let go = egui::Button::new(format!("Go to {}", index + 1));
                if ui.add_enabled(there, go).clicked() {
                    app.go_to_bookmark(index);
                    ui.close();
                }
                if ui.button("Set").clicked() {
                    app.set_bookmark(index);
                    ui.close();
                }
            });
        }
    });
}

/// In windows narrower than this the files' buttons are a menu.
const WIDE: f32 = 1150.0;

/// From right to left.
fn files(app: &mut App, ui: &mut egui::Ui) {
    if ui.ctx().content_rect().width() >= WIDE {
        file_buttons(app, ui);
    } else {
        ui.menu_button("Files", |ui| file_buttons(app, ui));
    }
}

fn file_buttons(app: &mut App, ui: &mut egui::Ui) {
    if ui
        .button("Screenshot")
        .on_hover_text("Writes the picture as foveal-001.png and so on (P)")
        .clicked()
    {
        app.take_screenshot(ui.ctx());
    }
    if ui
        .button("Copy command")
        .on_hover_text("Copies the command that draws this picture to a file, byte by byte")
        .clicked()
        && let Some(line) = app.command_line()
    {
        ui.ctx().copy_text(line);
        app.say(ui.ctx(), "The command is in the clipboard");
    }
    if ui
        .button("Load")
        .on_hover_text("Reads the settings file")
        .clicked()
    {
        app.load_settings(ui.ctx());
    }
    if ui
        .button("Save")
        .on_hover_text("Writes the settings file")
        .clicked()
    {
        app.save_settings(ui.ctx());
    }
    let file = egui::TextEdit::singleline(&mut app.settings_file).desired_width(96.0);
    ui.add(file).on_hover_text("The settings file, TOML");
}

/// What the keys do, as many as fit, and where one is.
pub(super) fn keys(app: &mut App, ui: &mut egui::Ui) {
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(navigator) = &app.navigator {
                let eye = navigator.camera().eye();
                let text = format!(
                    "{:.2} {:.2} {:.2}   {:.2} m/s",
                    eye.x, eye.y, eye.z, navigator.speed_m_s
                );
                ui.label(RichText::new(text).small().color(look::FAINT));
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.spacing_mut().item_spacing.x = 4.0;
                for (key, _, word) in keys::ALL.iter().filter(|(.., word)| !word.is_empty()) {
                    let width = 7.0 * (key.len() + word.len()) as f32;
                    if ui.available_width() < width {
                        break;
                    }
                    ui.label(RichText::new(*key).small().strong().color(look::TEXT));
                    ui.label(RichText::new(*word).small().color(look::FAINT));
                    ui.add_space(5.0);
                }
            });
        });
    });
    let mut is_open = app.display.keys;
    egui::Window::new("Keys")
        .open(&mut is_open)
        .collapsible(false)
        .resizable(false)
        .anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .show(ui.ctx(), |ui| {
            egui::Grid::new("keys").num_columns(2).show(ui, |ui| {
                for (key, does, _) in keys::ALL {
                    ui.label(RichText::new(key).strong().color(look::TEXT));
                    ui.label(RichText::new(does).color(look::FAINT));
                    ui.end_row();
                }
            });
        });
    app.display.keys = is_open;
}
