//! The open dialog: recent and generated scenes on the left, a folder on the right.

use egui::{Align, Key, Layout, Modifiers, RichText, ScrollArea, TextEdit, Ui};

use crate::app::App;
use crate::browser::{Browser, Choice, Entry};
use crate::look;

/// Width of the recent and generated scenes' names, in points.
const SHORTCUTS: f32 = 210.0;

pub(super) fn show(app: &mut App, context: &egui::Context) {
    let Some(mut browser) = app.browser.take() else {
        return;
    };
    let screen = context.content_rect().size();
    let size = egui::vec2((screen.x - 80.0).min(760.0), (screen.y - 120.0).min(460.0));
    let mut opens = None;
    let mut is_closed = false;
    let modal = egui::Modal::new(egui::Id::unique("open")).show(context, |ui| {
        ui.set_width(size.x);
        ui.horizontal(|ui| {
            ui.heading("Open a scene");
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                is_closed = ui.button("Cancel (Esc)").clicked();
            });
        });
        ui.separator();
        let height = size.y - 60.0;
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(SHORTCUTS);
                ScrollArea::vertical()
                    .id_salt("shortcuts")
                    .max_height(height)
                    .auto_shrink([false, false])
                    .show(ui, |ui| opens = shortcuts(app, ui));
            });
            ui.separator();
            ui.vertical(|ui| {
                if let Choice::Opens(scene) = folder(app, &mut browser, ui, height) {
                    opens = Some(scene);
                }
            });
        });
    });
    if let Some(scene) = opens {
        app.open_scene(scene);
    } else if !is_closed && !modal.should_close() {
        app.browser = Some(browser);
    }
}

/// Recent and generated scenes.
fn shortcuts(app: &App, ui: &mut Ui) -> Option<String> {
    let mut opens = None;
    let files = app.host.files.as_ref();
    if !app.memory.recent.is_empty() {
        ui.label(RichText::new("Recent").color(look::ACCENT).strong());
        for scene in &app.memory.recent {
            if recent(ui, scene, files.is_there(scene)) {
                opens = Some(scene.clone());
            }
        }
        ui.add_space(8.0);
    }
    ui.label(RichText::new("Generated").color(look::ACCENT).strong());
    for name in &app.host.generated {
        if ui.selectable_label(false, name).clicked() {
            opens = Some(name.clone());
        }
    }
    opens
}

/// A line with a scene that was opened before; whether it is clicked.
pub(super) fn recent(ui: &mut Ui, scene: &str, is_there: bool) -> bool {
    let name = std::path::Path::new(scene).file_name();
    let name = name.map_or(scene.into(), |name| name.to_string_lossy());
    ui.add_enabled_ui(is_there, |ui| {
        let line = egui::Button::selectable(false, name.as_ref()).truncate();
        ui.add(line)
            .on_hover_text(scene)
            .on_disabled_hover_text(format!("{scene}\nis not there any more"))
            .clicked()
    })
    .inner
}

fn folder(app: &App, browser: &mut Browser, ui: &mut Ui, height: f32) -> Choice {
    let files = app.host.files.as_ref();
    let mut choice = Choice::Stays;
    ui.horizontal(|ui| {
        if ui.button("Up").on_hover_text("The folder above").clicked() {
            browser.enter_parent(files);
        }
        let folder = browser.folder().display().to_string();
        ui.add(egui::Label::new(RichText::new(&folder).color(look::FAINT)).truncate())
            .on_hover_text(folder);
    });
    // Kept from the field. They come after what was typed in the same pass, which can be long.
    let pressed = |key| ui.input_mut(|i| i.consume_key(Modifiers::NONE, key));
    let steps = [
        (Key::ArrowDown, 1),
        (Key::ArrowUp, -1),
        (Key::PageDown, 8),
        (Key::PageUp, -8),
    ]
    .map(|(key, by)| if pressed(key) { by } else { 0 });
    let is_entered = pressed(Key::Enter);
    let before = browser.typed.clone();
    let field = TextEdit::singleline(&mut browser.typed)
        .desired_width(f32::INFINITY)
        .hint_text("part of a name, or a path; Enter opens");
    // It has the keys from the first moment on.
    ui.add(field).request_focus();
    if browser.typed != before {
        browser.chosen = 0;
        browser.fault = None;
    }
    for by in steps {
        browser.step(by);
    }
    if is_entered {
        choice = browser.accept(files);
    }
    if let Some(fault) = &browser.fault {
        ui.label(RichText::new(fault).color(look::BAD));
    }
    let entries = browser.entries();
    if entries.is_empty() {
        let text = if browser.typed.is_empty() {
            "No folders and no scenes"
        } else {
            "Nothing here has such a name"
        };
        ui.label(RichText::new(text).color(look::FAINT));
    }
    ScrollArea::vertical()
        .id_salt("folder")
        .max_height((height - 70.0).max(80.0))
        .auto_shrink([false, false])
        .show(ui, |ui| {
            for (index, entry) in entries.iter().enumerate() {
                let text = match entry {
                    Entry::Folder(name) => RichText::new(format!("{name}/")).color(look::ACCENT),
                    Entry::Scene(name) => RichText::new(name).color(look::TEXT),
                };
                let is_chosen = index == browser.chosen;
                let line = ui.add(egui::Button::selectable(is_chosen, text).truncate());
                if is_chosen && ui.input(|i| !i.events.is_empty()) {
                    line.scroll_to_me(None);
                }
                if line.clicked() {
                    choice = browser.choose(files, entry);
                }
            }
        });
    choice
}

#[cfg(test)]
mod tests {
    use egui::Event;

    use super::*;
    use crate::app::tests::{Pass, SIZES, loaded};

    #[test]
    fn enter_is_for_what_was_typed_before_it_in_the_same_pass() {
        let mut app = loaded();
        let context = egui::Context::default();
        let pass = Pass::new(&context, SIZES[0]);
        app.open_dialog();
        for _ in 0..2 {
            pass.show(&mut app, Vec::new());
        }
        let enter = Event::Key {
            key: Key::Enter,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        pass.show(&mut app, vec![Event::Text("Cas".to_owned()), enter]);
        assert_eq!(app.opening.as_deref(), Some("/home/eva/Castle.glb"));
    }
}
