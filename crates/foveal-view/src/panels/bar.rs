//! The bar on top: scene, camera, files. The line below: what the keys do.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Align, Layout, PopupCloseBehavior, RichText};

use crate::app::App;
use crate::navigator::{Mode, Side};
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
        "A scene file's path or a generated scene's name; Enter loads it. Or drop a file onto the window.",
    );
    if response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter)) {
        let name = app.scene_name.trim().to_owned();
        app.open_scene(name);
    }
    if ui
        .button("Open")
        .on_hover_text("Lists folders with scene files (Ctrl+O)")
        .clicked()
    {
        app.open_dialog();
    }
    ui.menu_button("Scenes", |ui| {
        let mut opens = None;
        let files = app.host.files.as_ref();
        ui.set_max_width(260.0);
        if !app.memory.recent.is_empty() {
            ui.label(RichText::new("Recent").color(look::FAINT));
            for scene in &app.memory.recent {
                if super::open::recent(ui, scene, files.is_there(scene)) {
                    opens = Some(scene.clone());
                }
            }
            ui.separator();
        }
        ui.label(RichText::new("Generated").color(look::FAINT));
        for name in &app.host.generated {
            if ui.button(name).clicked() {
                opens = Some(name.clone());
            }
        }
        if let Some(scene) = opens {
            app.open_scene(scene);
            ui.close();
        }
    });
    if app.opening.is_some() {
        ui.spinner();
    }
}

fn camera(app: &mut App, ui: &mut egui::Ui) {
    ui.separator();
    let (Some(navigator), Some(scene)) = (&mut app.navigator, &app.scene) else {
        return;
    };
    ui.selectable_value(&mut navigator.mode, Mode::Fly, "Fly")
        .on_hover_text("W A S D, Q E, drag to look, middle drag to orbit, scroll for speed (F)");
    ui.selectable_value(&mut navigator.mode, Mode::Orbit, "Orbit")
        .on_hover_text("drag to turn, right drag to shift, scroll for distance (F)");
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
    views(app, ui);
    bookmarks(app, ui);
}

fn views(app: &mut App, ui: &mut egui::Ui) {
    ui.menu_button("View", |ui| {
        let mut item = |text: &str, keys: &str| {
            let button = egui::Button::new(text).shortcut_text(keys);
            let is_clicked = ui.add(button).clicked();
            if is_clicked {
                ui.close();
            }
            is_clicked
        };
        if item("Start", "Home") {
            app.go_to_start();
        }
        let selected = app.selected.as_ref().map(|picked| picked.name.clone());
        let frame = selected.map_or("All".to_owned(), |name| format!("Selected: {name}"));
        if item(&frame, ".") {
            app.frame_selected();
        }
        for (text, keys, side) in [
            ("Front", "Alt+1", Side::Front),
            ("Right side", "Alt+3", Side::Right),
            ("Top", "Alt+7", Side::Top),
        ] {
            if item(text, keys) {
                app.look_from(side);
            }
        }
    })
    .response
    .on_hover_text("Of what is selected (click an object), or else of everything; a side again: from the opposite one");
}

fn bookmarks(app: &mut App, ui: &mut egui::Ui) {
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
                if ui.add_enabled(there, egui::Button::new("Clear")).clicked() {
                    app.keep_bookmark(index, None);
                }
            });
        }
    })
    .response
    .on_hover_text("Views of this scene, kept from run to run (1 to 9; with Ctrl set)");
}

/// In windows narrower than this the files' buttons are a menu.
const WIDE: f32 = 1240.0;

/// From right to left.
fn files(app: &mut App, ui: &mut egui::Ui) {
    if ui.ctx().content_rect().width() >= WIDE {
        file_buttons(app, ui);
    } else {
        // A click into the field for the file's name leaves it open.
        let closes = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        MenuButton::new("Files").config(closes).ui(ui, |ui| {
            if file_buttons(app, ui) {
                ui.close();
            }
        });
    }
}

/// Whether one of the buttons is clicked.
fn file_buttons(app: &mut App, ui: &mut egui::Ui) -> bool {
    let mut is_clicked = false;
    if ui
        .button("Screenshot")
        .on_hover_text("Writes the picture as foveal-001.png and so on (P)")
        .clicked()
    {
        app.take_screenshot(ui.ctx());
        is_clicked = true;
    }
    if ui
        .button("Copy command")
        .on_hover_text("Copies the command that draws this picture to a file, byte by byte")
        .clicked()
    {
        if let Some(line) = app.command_line() {
            ui.ctx().copy_text(line);
            app.say(ui.ctx(), "The command is in the clipboard");
        }
        is_clicked = true;
    }
    if ui
        .button("Load")
        .on_hover_text("Reads the settings file")
        .clicked()
    {
        app.load_settings(ui.ctx(), app.settings_file.clone());
        is_clicked = true;
    }
    if ui
        .button("Save")
        .on_hover_text("Writes the settings file")
        .clicked()
    {
        app.save_settings(ui.ctx());
        is_clicked = true;
    }
    let file = egui::TextEdit::singleline(&mut app.settings_file).desired_width(96.0);
    ui.add(file).on_hover_text("The settings file, TOML");
    if ui
        .button("Capture")
        .on_hover_text("A turntable or a flight as pictures or a video (V)")
        .clicked()
    {
        app.capture.is_open = !app.capture.is_open;
        is_clicked = true;
    }
    is_clicked
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
            if let Some(picked) = &app.selected {
                let name: String = picked.name.chars().take(24).collect();
                let many = if picked.triangles == 1 { "" } else { "s" };
                let triangles = look::grouped(picked.triangles);
                let text = format!("{name}: {triangles} triangle{many}");
                ui.label(RichText::new(text).small().color(look::ACCENT))
                    .on_hover_text(format!(
                        "Selected: {}, object {}",
                        picked.name, picked.object
                    ));
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
            // In a small window the list is longer than the screen.
            let most = ui.ctx().content_rect().height() - 120.0;
            let list = egui::ScrollArea::vertical().max_height(most);
            list.show(ui, |ui| {
                let grid = egui::Grid::new("keys")
                    .num_columns(2)
                    .spacing([14.0, 2.0])
                    .min_row_height(16.0);
                grid.show(ui, |ui| {
                    for (key, does, _) in keys::ALL {
                        ui.label(RichText::new(key).strong().color(look::TEXT));
                        ui.label(RichText::new(does).color(look::FAINT));
                        ui.end_row();
                    }
                });
            });
        });
    app.display.keys = is_open;
}

#[cfg(test)]
mod tests {
    use egui::{Event, Modifiers, PointerButton, Pos2};

    use crate::app::App;
    use crate::app::tests::{Pass, SIZES, loaded, texts};

    #[test]
    fn a_file_s_name_can_be_typed_in_the_menu_of_a_narrow_window() {
        let mut app = loaded();
        let context = egui::Context::default();
        let pass = Pass::new(&context, SIZES[0]);
        let place = |app: &mut App, says: &str| -> Option<Pos2> {
            for _ in 0..2 {
                pass.show(app, Vec::new());
            }
            let seen = texts(&pass.show(app, Vec::new()));
            let text = seen.into_iter().find(|text| text.says == says);
            text.map(|text| text.rect.right_center())
        };
        let click = |app: &mut App, pos: Pos2| {
            let press = |pressed| Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            };
            pass.show(app, vec![Event::PointerMoved(pos), press(true)]);
            pass.show(app, vec![press(false)]);
        };
        for says in ["Files", "foveal.toml"] {
            let at = place(&mut app, says).unwrap();
            click(&mut app, at);
        }
        pass.show(&mut app, vec![Event::Text("2".to_owned())]);
        assert_eq!(app.settings_file, "foveal.toml2");
        // What is chosen closes the menu.
        let save = place(&mut app, "Save").unwrap();
        click(&mut app, save);
        assert!(app.messages[0].is_error, "{:?}", app.messages);
        assert_eq!(place(&mut app, "Save"), None);
    }
}
