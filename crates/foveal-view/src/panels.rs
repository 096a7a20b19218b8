//! Everything around the picture: the bar on top, settings on the left, figures on the right, keys
//! below.

mod bar;
mod capture;
mod compare;
mod culling;
mod figures;
mod open;
mod playback;
mod settings;
mod timeline;

use egui::{Panel, ScrollArea};

use crate::app::App;
use crate::look;

/// Widths of the side panels, in points.
const SETTINGS_WIDTH: f32 = 284.0;
const FIGURES_WIDTH: f32 = 268.0;

pub(crate) fn show(app: &mut App, ui: &mut egui::Ui) {
    Panel::top("bar")
        .frame(look::panel_frame())
        .show(ui, |ui| bar::show(app, ui));
    Panel::bottom("keys")
        .frame(look::panel_frame())
        .show(ui, |ui| bar::keys(app, ui));
    open::show(app, &ui.ctx().clone());
    capture::show(app, &ui.ctx().clone());
    if !app.display.panels {
        return;
    }
    if playback::is_shown(app) {
        Panel::bottom("playback")
            .frame(look::panel_frame())
            .show(ui, |ui| playback::show(app, ui));
    }
    Panel::left("settings")
        .exact_size(SETTINGS_WIDTH)
        .resizable(false)
        .frame(look::panel_frame())
        .show(ui, |ui| {
            settings::head(app, ui);
            ScrollArea::vertical()
                .auto_shrink([false, false])
                .show(ui, |ui| settings::show(app, ui));
        });
    Panel::right("figures")
        .exact_size(FIGURES_WIDTH)
        .resizable(false)
        .frame(look::panel_frame())
        .show(ui, |ui| {
            ScrollArea::vertical()
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    figures::show(app, ui);
                    culling::show(app, ui);
                });
        });
}

/// A card with a title.
fn card<R>(ui: &mut egui::Ui, title: &str, contents: impl FnOnce(&mut egui::Ui) -> R) -> R {
    let frame = egui::Frame::new()
        .fill(look::CARD)
        .corner_radius(egui::CornerRadius::same(6))
        .inner_margin(egui::Margin::symmetric(10, 8));
    frame
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.label(egui::RichText::new(title).color(look::ACCENT).strong());
            contents(ui)
        })
        .inner
}

/// A switch that needs something else: greyed where that is missing, with the reason below and when
/// it is pointed at.
fn noted(
    ui: &mut egui::Ui,
    missing: Option<&str>,
    switch: impl FnOnce(&mut egui::Ui) -> egui::Response,
) {
    let Some(why) = missing else {
        switch(ui);
        return;
    };
    ui.add_enabled_ui(false, |ui| switch(ui).on_disabled_hover_text(why));
    ui.label(egui::RichText::new(why).small().color(look::FAINT));
}

/// A line of a name and a figure at the right edge.
fn figure(ui: &mut egui::Ui, name: &str, value: impl Into<String>) {
    ui.horizontal(|ui| {
        ui.label(egui::RichText::new(name).color(look::FAINT));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(egui::RichText::new(value.into()).color(look::TEXT));
        });
    });
}
