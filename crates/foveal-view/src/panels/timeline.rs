//! Times made visible: a graph of frames, and a frame's stages as one stacked bar.

use egui::{CornerRadius, Pos2, Rect, RichText, Sense, Stroke, Vec2};
use foveal::Timing;

use crate::history::History;
use crate::look;

/// The last frames, one bar each, with a line at the median.
pub(super) fn graph(ui: &mut egui::Ui, history: &History) {
    let size = Vec2::new(ui.available_width(), 56.0);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, CornerRadius::same(3), look::BACKGROUND);
    let Some((median, slowest)) = history.median_and_slowest() else {
        return;
    };
    let top = 1.25 * slowest.max(median).max(1e-3);
    let step = rect.width() / 120.0;
    let frames = history.frames();
    let first = 120 - frames.len();
    for (i, ms) in frames.enumerate() {
        let height = (ms / top).min(1.0) as f32 * rect.height();
        let left = rect.left() + (first + i) as f32 * step;
        let bar = Rect::from_min_max(
            Pos2::new(left, rect.bottom() - height),
            Pos2::new(left + (step - 0.5).max(0.5), rect.bottom()),
        );
        painter.rect_filled(bar, CornerRadius::ZERO, look::ACCENT);
    }
    let y = rect.bottom() - (median / top) as f32 * rect.height();
    painter.hline(rect.x_range(), y, Stroke::new(1.0, look::TEXT));
    let text = format!("median {}", look::ms(median));
    let at = rect.left_top() + Vec2::new(5.0, 3.0);
    let galley = painter.layout_no_wrap(text, look::small_font(), look::TEXT);
    let back = Rect::from_min_size(at, galley.size()).expand(2.0);
    painter.rect_filled(back, CornerRadius::same(2), look::BACKGROUND);
    painter.galley(at, galley, look::TEXT);
}

/// A frame's stages side by side, as wide as they are long, with their names and times below.
pub(super) fn stacked(ui: &mut egui::Ui, title: &str, stages: &[Timing], first_color: usize) {
    let total: f64 = stages.iter().map(|stage| stage.ms).sum();
    ui.horizontal(|ui| {
        ui.label(RichText::new(title).color(look::FAINT));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let text = if stages.is_empty() {
                "no timestamps".to_owned()
            } else {
                look::ms(total)
            };
            ui.label(text);
        });
    });
    if total <= 0.0 {
        return;
    }
    let (rect, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), 14.0), Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, CornerRadius::same(3), look::BACKGROUND);
    let mut left = rect.left();
    for (i, stage) in stages.iter().enumerate() {
        let width = (stage.ms / total) as f32 * rect.width();
        let part =
            Rect::from_min_size(Pos2::new(left, rect.top()), Vec2::new(width, rect.height()));
        let color = look::stage_color(first_color + i);
        painter.rect_filled(
            part.shrink2(Vec2::new(0.25, 0.0)),
            CornerRadius::ZERO,
            color,
        );
        ui.interact(part, ui.scope_id().with((title, i)), Sense::hover())
            .on_hover_text(format!("{}: {}", stage.name, look::ms(stage.ms)));
        left += width;
    }
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        for (i, stage) in stages.iter().enumerate() {
            ui.horizontal(|ui| {
                let (square, _) = ui.allocate_exact_size(Vec2::splat(8.0), Sense::hover());
                let color = look::stage_color(first_color + i);
                ui.painter()
                    .rect_filled(square, CornerRadius::same(2), color);
                ui.label(RichText::new(&stage.name).small().color(look::FAINT));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    ui.label(RichText::new(look::ms(stage.ms)).small());
                });
            });
        }
    });
}
