//! What the culler found: every figure and switch of Intel's occlusion culling sample.

use egui::RichText;

use super::{card, figure, noted};
use crate::app::App;
use crate::look::{self, grouped};
use crate::needs::{Switch, of_culling};

pub(super) fn show(app: &mut App, ui: &mut egui::Ui) {
    card(ui, "Culling", |ui| {
        for (switch, on, text) in [
            (Switch::Boxes, &mut app.display.boxes, "Boxes (B)"),
            (
                Switch::Depth,
                &mut app.display.depth,
                "Occluders' depth (Z)",
            ),
            (Switch::Freeze, &mut app.display.frozen, "Freeze (C)"),
        ] {
            noted(ui, of_culling(switch, &app.settings), |ui| {
                ui.checkbox(on, text)
            });
        }
        let Some(shown) = &app.shown else { return };
        let Some(found) = &shown.culling else {
            ui.label(RichText::new("Culling is off: all is drawn").color(look::FAINT));
            return;
        };
        let s = &found.stats;
        let part = |ui: &mut egui::Ui, title: &str| {
            ui.add_space(4.0);
            ui.label(RichText::new(title).strong());
        };
        part(ui, "Occluders");
        figure(ui, "Models", grouped(s.occluder_models));
        figure(ui, "Rasterized", grouped(s.occluder_models_rasterized));
        figure(ui, "Triangles", grouped(s.occluder_triangles));
        figure(ui, "Rasterized", grouped(s.occluder_triangles_rasterized));
        figure(ui, "Over budget", grouped(s.clusters_over_budget));
        figure(ui, "Rasterizer", look::ms(found.rasterize_ms));
        part(ui, "Occludees");
        figure(ui, "Models", grouped(s.occludees));
        figure(ui, "Visible", grouped(s.occludees_visible));
        figure(ui, "Culled", grouped(s.occludees_culled()));
        figure(ui, "  outside", grouped(s.occludees_outside));
        figure(ui, "  too small", grouped(s.occludees_small));
        figure(ui, "  occluded", grouped(s.occludees_occluded));
        figure(ui, "Triangles", grouped(s.occludee_triangles));
        figure(ui, "Visible", grouped(s.occludee_triangles_visible));
        figure(ui, "Culled", grouped(s.occludee_triangles_culled()));
        figure(ui, "Test", look::ms(found.test_ms));
        figure(ui, "Test for shadows", look::ms(found.receivers_ms));
        part(ui, "Buffer");
        figure(
            ui,
            "Size",
            format!("{} x {}", found.buffer.0, found.buffer.1),
        );
        figure(ui, "Raster threads", grouped(found.threads as u64));
        // Boxes are tested on the thread that asks.
        figure(ui, "Test tasks", grouped(1));
        figure(ui, "Draws", grouped(shown.stats.draws));
    });
}
