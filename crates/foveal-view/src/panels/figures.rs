//! What the last frame cost.

use egui::RichText;

use super::{card, compare, figure, timeline};
use crate::app::App;
use crate::look::{self, grouped};

pub(super) fn show(app: &mut App, ui: &mut egui::Ui) {
    compare::show(app, ui);
    let Some(shown) = &app.shown else {
        ui.label(RichText::new("No frame yet").color(look::FAINT));
        return;
    };
    let stats = &shown.stats;
    card(ui, "Frame", |ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new(look::ms(stats.frame_ms)).size(20.0).strong());
            let fps = 1000.0 / stats.frame_ms.max(1e-3);
            ui.label(RichText::new(format!("{fps:.1} fps")).color(look::FAINT));
        });
        timeline::graph(ui, &app.history);
        if let Some((_, slowest)) = app.history.median_and_slowest() {
            figure(ui, "Slowest 1 %", look::ms(slowest));
        }
        timeline::stacked(ui, "CPU", &stats.cpu_ms, 0);
        timeline::stacked(ui, "GPU", &stats.gpu_ms, 0);
    });
    ui.add_space(6.0);
    card(ui, "Work", |ui| {
        figure(ui, "Picture", format!("{} x {}", stats.width, stats.height));
        figure(ui, "Draws", grouped(stats.draws));
        figure(ui, "Triangles", grouped(stats.triangles));
        figure(ui, "Shaded samples", grouped(stats.shaded_samples));
        let pixels = shown.request.settings.drawn_pixels();
        let fraction = 100.0 * stats.shaded_samples as f64 / pixels.max(1) as f64;
        figure(ui, "Per pixel", format!("{fraction:.2} %"));
        if stats.edge_fraction > 0.0 {
            let edges = 100.0 * stats.edge_fraction;
            figure(ui, "Edge pixels", format!("{edges:.2} %"));
        }
        if stats.surfaces_left_out > 0 {
            let left_out = grouped(stats.surfaces_left_out);
            figure(ui, "Surfaces left out", left_out);
        }
        let bytes = stats.target_bytes as f64 / f64::from(1 << 20);
        figure(ui, "Targets", format!("{bytes:.1} MiB"));
        if let Some(coarse) = &stats.coarse {
            figure(ui, "Backend", coarse.backend.as_str());
            ui.label(
                RichText::new(&coarse.backend_reason)
                    .small()
                    .color(look::FAINT),
            );
            notice(ui, &coarse.notice);
            for (level, samples) in coarse.samples_per_level.iter().enumerate() {
                figure(ui, &format!("Level {level}"), grouped(*samples));
            }
            if coarse.unlit_pixels > 0 {
                figure(ui, "Pixels without a sample", grouped(coarse.unlit_pixels));
            }
        }
        if let Some(variable) = &stats.variable {
            notice(ui, &variable.notice);
        }
    });
    ui.add_space(6.0);
    card(ui, "Machine", |ui| {
        if let Some(adapter) = &app.adapter {
            ui.label(&adapter.name);
            let text = format!("{}, {}", adapter.backend, adapter.kind);
            ui.label(RichText::new(text).small().color(look::FAINT));
        }
        if let Some(scene) = &app.scene {
            figure(ui, "Scene", scene.name.as_str());
            figure(ui, "Objects", grouped(scene.counts.objects));
            figure(ui, "Triangles", grouped(scene.counts.triangles));
            figure(ui, "Lights", grouped(scene.counts.lights));
        }
    });
    ui.add_space(6.0);
}

/// What has turned itself off, if anything has.
fn notice(ui: &mut egui::Ui, sentence: &str) {
    if !sentence.is_empty() {
        ui.label(RichText::new(sentence).small().color(look::FAINT));
    }
}
