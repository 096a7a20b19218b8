//! The capture card: a sequence of pictures or a video.

use egui::{ComboBox, DragValue, ProgressBar, RichText, Ui};

use crate::app::{App, Ended, Phase, Way};
use crate::{Format, look};

const SIZES: [(u32, u32); 4] = [(1280, 720), (1920, 1080), (2560, 1440), (3840, 2160)];

pub(super) fn show(app: &mut App, context: &egui::Context) {
    let mut is_open = app.capture.is_open;
    egui::Window::new("Capture")
        .open(&mut is_open)
        .collapsible(false)
        .resizable(false)
        .default_width(300.0)
        .anchor(egui::Align2::CENTER_TOP, egui::vec2(0.0, 60.0))
        .show(context, |ui| contents(app, ui));
    app.capture.is_open = is_open;
}

fn contents(app: &mut App, ui: &mut Ui) {
    let is_idle = app.capture.is_idle();
    ui.add_enabled_ui(is_idle, |ui| choices(app, ui));
    ui.add_space(4.0);
    match &app.capture.phase {
        Phase::Idle => {
            let text = match app.capture.way {
                Way::Turntable => "Start (Enter)",
                Way::Flight => "Start flying (Enter)",
            };
            let has_scene = app.scene.is_some() && app.opening.is_none();
            if ui.add_enabled(has_scene, egui::Button::new(text)).clicked() {
                app.start_capture(&ui.ctx().clone());
            }
        }
        Phase::Flying(since_s, _) => {
            let left = f64::from(app.capture.seconds) - (ui.input(|i| i.time) - since_s);
            ui.label(format!("Fly now: {:.1} s left", left.max(0.0)));
            cancel(app, ui);
        }
        Phase::Drawing(written, of) => {
            let part = *written as f32 / (*of).max(1) as f32;
            ui.add(ProgressBar::new(part).text(format!("{written} of {of} frames")));
            cancel(app, ui);
        }
    }
    match &app.capture.ended {
        Some(Ended::Done(name)) => {
            ui.label(RichText::new(format!("Written: {name}")).color(look::GOOD));
        }
        Some(Ended::Cancelled(text)) => {
            ui.label(RichText::new(text).color(look::FAINT));
        }
        Some(Ended::Failed(cause)) => {
            ui.label(RichText::new(cause).color(look::BAD));
        }
        None => {}
    }
}

fn cancel(app: &mut App, ui: &mut Ui) {
    if ui.button("Cancel (Esc)").clicked() {
        app.cancel_capture();
    }
}

fn choices(app: &mut App, ui: &mut Ui) {
    let capture = &mut app.capture;
    egui::Grid::new("capture").num_columns(2).show(ui, |ui| {
        ui.label("Way");
        ui.horizontal(|ui| {
            ui.selectable_value(&mut capture.way, Way::Turntable, "Turntable")
                .on_hover_text("Once around what is selected, or else around the scene, from here");
            ui.selectable_value(&mut capture.way, Way::Flight, "Flight")
                .on_hover_text("The camera as you fly it in the next seconds; drawn afterwards");
        });
        ui.end_row();
        ui.label("As");
        ui.horizontal(|ui| {
            ui.selectable_value(&mut capture.format, Format::Pictures, "Pictures")
                .on_hover_text("PNG files in a new folder, capture-001 and so on");
            ui.add_enabled_ui(app.host.no_video.is_none(), |ui| {
                let video = ui
                    .selectable_value(&mut capture.format, Format::Video, "Video")
                    .on_hover_text("A new file, capture-001.mp4 and so on, written by ffmpeg");
                if let Some(why) = &app.host.no_video {
                    video.on_disabled_hover_text(why);
                }
            });
        });
        ui.end_row();
        ui.label("Length");
        ui.horizontal(|ui| {
            let seconds = DragValue::new(&mut capture.seconds);
            ui.add(seconds.range(0.1..=600.0).speed(0.1).suffix(" s"));
            ui.label("at");
            let rate = DragValue::new(&mut capture.per_second);
            ui.add(
                rate.range(1.0..=120.0)
                    .speed(0.2)
                    .max_decimals(2)
                    .suffix(" frames/s"),
            );
        });
        ui.end_row();
        ui.label("Size");
        let text = |(width, height): (u32, u32)| format!("{width} x {height}");
        let shown = "as shown";
        ComboBox::from_id_salt("capture size")
            .selected_text(capture.size.map_or(shown.to_owned(), text))
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut capture.size, None, shown);
                for size in SIZES {
                    ui.selectable_value(&mut capture.size, Some(size), text(size));
                }
            });
        ui.end_row();
    });
    let frames = format!("{} frames", app.capture.frames());
    ui.label(RichText::new(frames).small().color(look::FAINT));
}
