//! The bar on top: scene, camera, files. The line below: what the keys do.

use egui::{Align, Layout, RichText};

use crate::app::App;
use crate::look;
use crate::navigator::Mode;

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

/// From right to left.
fn files(app: &mut App, ui: &mut egui::Ui) {
    if ui
        .button("Screenshot")
        .on_hover_text("Writes the picture as foveal-001.png and so on (P)")
        .clicked()
    {
        app.take_screenshot(ui.ctx());
    }
    if ui
        .button("Copy command")
        .on_hover_text("Copies the command that draws this picture to a file")
        .clicked()
    {
        let line = app.command_line();
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

/// What the keys do, and where one is.
pub(super) fn keys(app: &App, ui: &mut egui::Ui) {
    ui.horizontal(|ui| {
        let keys = [
            ("WASD QE", "move"),
            ("Drag", "look"),
            ("F", "fly/orbit"),
            ("Home", "start"),
            ("1-9", "bookmark, Ctrl sets"),
            ("X", "compare"),
            ("G", "gaze"),
            ("B", "boxes"),
            ("Z", "depth"),
            ("C", "freeze"),
            ("H", "panels"),
            ("P", "screenshot"),
        ];
        ui.spacing_mut().item_spacing.x = 4.0;
        for (key, does) in keys {
            ui.label(RichText::new(key).small().strong().color(look::TEXT));
            ui.label(RichText::new(does).small().color(look::FAINT));
            ui.add_space(5.0);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(navigator) = &app.navigator {
                let eye = navigator.camera().eye();
                let text = format!(
                    "{:.2} {:.2} {:.2}   {:.2} m/s",
                    eye.x, eye.y, eye.z, navigator.speed_m_s
                );
                ui.add(egui::Label::new(RichText::new(text).small().color(look::FAINT)).truncate());
            }
        });
    });
}
