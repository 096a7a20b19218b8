//! What the colours of a view mean.

use egui::{Color32, CornerRadius, RichText, Sense, Vec2};
use foveal::{DebugView, Settings, Shading};

use crate::look;

/// The colour that `overlay.wgsl` gives a level.
fn level_color(level: u8) -> Color32 {
    if level == 0 {
        return Color32::WHITE;
    }
    let hue = 0.36 + f32::from(level) * 0.1;
    let channel = |shift: f32| {
        let wheel = (((hue + shift / 3.0).fract() * 6.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0);
        (wheel * 255.0) as u8
    };
    Color32::from_rgb(channel(0.0), channel(2.0), channel(1.0))
}

/// The colours that `variable/view.wgsl` mixes into the picture, and pixels across and down of a
/// sample.
const RATES: [(Color32, &str); 5] = [
    (Color32::BLACK, "1 x 1"),
    (Color32::from_rgb(0, 255, 0), "2 x 1"),
    (Color32::from_rgb(255, 0, 0), "1 x 2"),
    (Color32::from_rgb(0, 0, 255), "2 x 2"),
    (Color32::WHITE, "4 x 4"),
];

/// Squares of colour with their meaning.
type Entries = Vec<(Color32, String)>;

fn entries(settings: &Settings) -> Entries {
    let gray = Color32::from_gray;
    let named = |list: &[(Color32, &str)]| {
        let own = |&(color, text): &(Color32, &str)| (color, text.to_owned());
        list.iter().map(own).collect()
    };
    let variable = settings.shading.mode == Shading::Variable;
    match settings.picture.view {
        DebugView::Rate if variable => {
            let blocks = usize::from(settings.variable.blocks_4x4);
            named(&RATES[..4 + blocks])
        }
        DebugView::Unknown => named(&[
            (Color32::from_rgb(255, 0, 0), "nothing known"),
            (Color32::from_rgb(0, 255, 0), "measured again"),
        ]),
        DebugView::Rate | DebugView::Blocks => (0..=settings.coarse.coarsest_level)
            .map(|level| {
                let side = 1u32 << level;
                (level_color(level), format!("{side} x {side}"))
            })
            .collect(),
        DebugView::Shaded => named(&[(gray(200), "shaded"), (gray(20), "filled in")]),
        DebugView::Edges => named(&[
            (Color32::WHITE, "shaded more than once"),
            (Color32::BLACK, "once"),
        ]),
        DebugView::Samples => named(&[
            (Color32::BLACK, "once"),
            (Color32::BLUE, "few"),
            (Color32::RED, "many"),
            (Color32::WHITE, "all sub-samples"),
        ]),
        DebugView::Depth => named(&[
            (Color32::WHITE, "near"),
            (gray(128), "x 256"),
            (Color32::BLACK, "x 65 536"),
        ]),
        DebugView::Normals => named(&[
            (Color32::from_rgb(255, 128, 128), "+x"),
            (Color32::from_rgb(128, 255, 128), "+y"),
            (Color32::from_rgb(128, 128, 255), "+z"),
        ]),
        DebugView::Motion => named(&[
            (Color32::from_rgb(255, 128, 128), "right, 16 px"),
            (Color32::from_rgb(128, 255, 128), "down, 16 px"),
            (gray(128), "still"),
        ]),
        _ => Vec::new(),
    }
}

/// Of the picture's view.
pub(crate) fn of_view(ui: &mut egui::Ui, settings: &Settings) {
    show(ui, &entries(settings));
}

/// Of the boxes.
pub(crate) fn of_boxes(ui: &mut egui::Ui) {
    let list = [
        (look::VISIBLE, "visible"),
        (look::OUTSIDE, "outside"),
        (look::SMALL, "too small"),
        (look::OCCLUDED, "occluded"),
    ];
    show(ui, &list.map(|(color, text)| (color, text.to_owned())));
}

fn show(ui: &mut egui::Ui, entries: &[(Color32, String)]) {
    if entries.is_empty() {
        return;
    }
    look::strip_frame().show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 5.0;
            for (color, text) in entries {
                let (square, _) = ui.allocate_exact_size(Vec2::splat(10.0), Sense::hover());
                ui.painter()
                    .rect_filled(square, CornerRadius::same(2), *color);
                ui.label(RichText::new(text).small().color(look::TEXT));
                ui.add_space(4.0);
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_can_be_told_apart() {
        let colors: Vec<_> = (0..=8).map(level_color).collect();
        for (i, a) in colors.iter().enumerate() {
            for b in &colors[..i] {
                let apart = |c: fn(&Color32) -> u8| u32::from(c(a).abs_diff(c(b)));
                let sum = apart(Color32::r) + apart(Color32::g) + apart(Color32::b);
                assert!(sum > 90, "{a:?} and {b:?}");
            }
        }
    }

    #[test]
    fn variable_rates_have_the_colours_of_their_view() {
        let settings = Settings::default().with(|s| {
            s.shading.mode = Shading::Variable;
            s.picture.view = DebugView::Rate;
            s.variable.blocks_4x4 = true;
        });
        // As `color_of` in `variable/view.wgsl`: red for tall samples, green for wide ones.
        let color_of = |across: u32, down: u32| {
            let channel = |is: bool| if is { 255 } else { 0 };
            match (across, down) {
                (4, 4) => Color32::WHITE,
                size => Color32::from_rgb(
                    channel(size == (1, 2)),
                    channel(size == (2, 1)),
                    channel(size == (2, 2)),
                ),
            }
        };
        let all = entries(&settings);
        assert_eq!(all.len(), 5);
        for (color, text) in all {
            let (across, down) = text.split_once(" x ").expect("a sample's size");
            let [across, down] = [across, down].map(|n| n.parse().expect("a number"));
            assert_eq!(color, color_of(across, down), "{text}");
        }
        let quads = settings.clone().with(|s| s.variable.blocks_4x4 = false);
        assert_eq!(entries(&quads).len(), 4);
        let coarse = settings.with(|s| s.shading.mode = Shading::Coarse);
        assert_eq!(entries(&coarse)[0].1, "1 x 1");
        assert_eq!(entries(&coarse)[0].0, level_color(0));
    }
}
