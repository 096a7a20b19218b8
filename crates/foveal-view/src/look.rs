//! How the window looks: one dark style, a few colours with a meaning.

use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, Vec2};

pub(crate) const ACCENT: Color32 = Color32::from_rgb(0x6c, 0xb6, 0xff);
pub(crate) const BACKGROUND: Color32 = Color32::from_rgb(0x14, 0x16, 0x1a);
pub(crate) const PANEL: Color32 = Color32::from_rgb(0x1c, 0x1f, 0x25);
pub(crate) const CARD: Color32 = Color32::from_rgb(0x25, 0x29, 0x31);
pub(crate) const TEXT: Color32 = Color32::from_rgb(0xdc, 0xe0, 0xe6);
pub(crate) const FAINT: Color32 = Color32::from_rgb(0x93, 0x9b, 0xa8);
pub(crate) const BAD: Color32 = Color32::from_rgb(0xff, 0x7b, 0x72);
pub(crate) const GOOD: Color32 = Color32::from_rgb(0x6f, 0xd0, 0x8c);

/// What became of an object.
pub(crate) const VISIBLE: Color32 = Color32::from_rgb(0x5f, 0xd3, 0x7f);
pub(crate) const OUTSIDE: Color32 = Color32::from_rgb(0x5b, 0x8d, 0xef);
pub(crate) const SMALL: Color32 = Color32::from_rgb(0xe6, 0xc3, 0x4c);
pub(crate) const OCCLUDED: Color32 = Color32::from_rgb(0xef, 0x6a, 0x5b);

/// A colour per stage or pass, by its place in the frame.
pub(crate) fn stage_color(index: usize) -> Color32 {
    const COLORS: [Color32; 10] = [
        Color32::from_rgb(0x4e, 0x9a, 0xd9),
        Color32::from_rgb(0xe0, 0x8e, 0x45),
        Color32::from_rgb(0x5f, 0xb8, 0x7a),
        Color32::from_rgb(0xc9, 0x6b, 0xb0),
        Color32::from_rgb(0xd9, 0xc2, 0x4e),
        Color32::from_rgb(0x6b, 0xc7, 0xc9),
        Color32::from_rgb(0xd9, 0x5f, 0x5f),
        Color32::from_rgb(0x93, 0x83, 0xdb),
        Color32::from_rgb(0xa3, 0xb8, 0x5c),
        Color32::from_rgb(0xb0, 0x8a, 0x70),
    ];
    COLORS[index % COLORS.len()]
}

pub(crate) fn small_font() -> FontId {
    FontId::new(11.5, FontFamily::Proportional)
}

/// Applies the style.
pub(crate) fn apply(context: &egui::Context) {
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        style.text_styles = [
            (
                TextStyle::Small,
                FontId::new(11.5, FontFamily::Proportional),
            ),
            (TextStyle::Body, FontId::new(13.0, FontFamily::Proportional)),
            (
                TextStyle::Button,
                FontId::new(13.0, FontFamily::Proportional),
            ),
            (
                TextStyle::Heading,
                FontId::new(16.0, FontFamily::Proportional),
            ),
            (
                TextStyle::Monospace,
                FontId::new(12.0, FontFamily::Monospace),
            ),
        ]
        .into();
        let spacing = &mut style.spacing;
        spacing.item_spacing = Vec2::new(8.0, 6.0);
        spacing.button_padding = Vec2::new(8.0, 3.0);
        spacing.interact_size = Vec2::new(44.0, 22.0);
        spacing.slider_width = 86.0;
        spacing.combo_width = 100.0;
        spacing.indent = 18.0;
        let visuals = &mut style.visuals;
        visuals.panel_fill = PANEL;
        visuals.window_fill = PANEL;
        visuals.extreme_bg_color = BACKGROUND;
        visuals.faint_bg_color = CARD;
        visuals.selection.bg_fill = Color32::from_rgb(0x2d, 0x5a, 0x88);
        visuals.hyperlink_color = ACCENT;
        visuals.override_text_color = None;
        // A window at rest draws nothing.
        visuals.text_cursor.blink = false;
        visuals.widgets.noninteractive.fg_stroke = Stroke::new(1.0, TEXT);
        visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, CARD);
        visuals.widgets.inactive.fg_stroke = Stroke::new(1.0, TEXT);
        visuals.widgets.inactive.bg_fill = Color32::from_rgb(0x33, 0x39, 0x43);
        visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(0x2e, 0x33, 0x3c);
        visuals.slider_trailing_fill = true;
        for widget in [
            &mut visuals.widgets.noninteractive,
            &mut visuals.widgets.inactive,
            &mut visuals.widgets.hovered,
            &mut visuals.widgets.active,
            &mut visuals.widgets.open,
        ] {
            widget.corner_radius = CornerRadius::same(4);
        }
    });
}

/// The frame of a side panel.
pub(crate) fn panel_frame() -> egui::Frame {
    egui::Frame::new()
        .fill(PANEL)
        .inner_margin(Margin::symmetric(10, 8))
}

/// A strip of text on the picture.
pub(crate) fn strip_frame() -> egui::Frame {
    egui::Frame::new()
        .fill(Color32::from_rgba_unmultiplied(0x10, 0x12, 0x16, 225))
        .corner_radius(CornerRadius::same(5))
        .inner_margin(Margin::symmetric(8, 6))
}

/// A whole number with its digits in groups.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Milliseconds with as many places as they deserve.
pub(crate) fn ms(value: f64) -> String {
    if value >= 100.0 {
        format!("{value:.0} ms")
    } else if value >= 10.0 {
        format!("{value:.1} ms")
    } else {
        format!("{value:.2} ms")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_come_in_groups_of_three() {
        for (number, text) in [
            (0, "0"),
            (999, "999"),
            (1000, "1 000"),
            (1234567, "1 234 567"),
        ] {
            assert_eq!(grouped(number), text);
        }
    }
}
