//! The reference beside the chosen settings: the split's switch, and which of the two is faster.

use egui::{Color32, RichText, Ui};
use foveal::{Output, Settings};
use foveal_measure::{Comparison, ENOUGH_PAIRS, Finding, LEAST_PAIRS, Spread};

use super::{card, figure};
use crate::app::App;
use crate::look;
use crate::worker::{Compared, Quality};

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    card(ui, "Compare", |ui| {
        ui.checkbox(&mut app.display.compare, "Reference on the left (X)");
        if !app.display.compare {
            return;
        }
        reference(app, ui);
        if let Some(Err(why)) = app.reference_beside() {
            ui.label(RichText::new(why).color(look::BAD));
            return;
        }
        let Some(shown) = &app.shown else { return };
        if let Some(compared) = &shown.compared {
            times(ui, compared);
        }
        let flip = shown
            .flip
            .map_or("...".to_owned(), |flip| format!("{flip:.4}"));
        figure(ui, "FLIP error", flip);
        let stereo = &app.settings.stereo;
        let is_bent = app.settings.is_stereo() && stereo.output == Output::Headset;
        quality(ui, app.quality.as_deref(), is_bent);
    });
    ui.add_space(6.0);
}

/// What an eye sees, and at which display. `is_bent`: pictures are drawn for a headset's lens, through
/// which the metric does not look.
fn quality(ui: &mut Ui, found: Option<&Quality>, is_bent: bool) {
    let (name, jod) = match found {
        Some(found) => (
            format!("JOD ({})", found.display),
            format!("{:.2}", found.jod),
        ),
        None if is_bent => ("JOD".to_owned(), "not of headset output".to_owned()),
        None => ("JOD".to_owned(), "...".to_owned()),
    };
    ui.scope(|ui| figure(ui, &name, jod))
        .response
        .on_hover_text(
            "What an eye sees of the difference that looks at the gaze on the display of the settings (Eye), by FovVideoVDP: \
             10 is no visible difference, 9 one that three quarters of observers see. Measured once the view stands still.",
        );
}

/// What the chosen settings are compared with.
fn reference(app: &mut App, ui: &mut Ui) {
    ui.horizontal(|ui| {
        let plain = Settings::default();
        let against_plain = app.reference == plain;
        if ui
            .selectable_label(against_plain, "Defaults")
            .on_hover_text("Every pixel shaded once, no anti-aliasing")
            .clicked()
        {
            app.reference = plain;
        }
        if ui
            .selectable_label(!against_plain, "As now")
            .on_hover_text("Takes the present settings for the reference; then change them")
            .clicked()
        {
            app.reference = app.settings.clone();
        }
    });
}

fn times(ui: &mut Ui, compared: &Compared) {
    let Some(frame) = &compared.frame else {
        let text = match compared.pairs {
            0 => "Whole frame: warming up".to_owned(),
            pairs => format!("Whole frame: {pairs} of {LEAST_PAIRS} pairs"),
        };
        ui.label(RichText::new(text).color(look::FAINT));
        return;
    };
    verdict(ui, "Whole frame", frame, 15.0);
    side(ui, "Reference", &frame.reference);
    side(ui, "Chosen", &frame.chosen);
    if let Some(passes) = &compared.passes {
        verdict(ui, "GPU passes", passes, 13.0);
    }
    let pairs = if compared.is_done {
        format!("{} pairs of frames", frame.pairs)
    } else {
        format!("{} pairs of frames of up to {ENOUGH_PAIRS}", compared.pairs)
    };
    ui.label(RichText::new(pairs).small().color(look::FAINT))
        .on_hover_text(
            "Both sides draw the same view in turn, in an order that is drawn by lot. The ratio is the reference's time \
             by the chosen side's: above 1 the chosen side is faster. In brackets: the interval that holds the true ratio \
             in 998 of 1,000 cases. Below each side: the median time, and between what times four of five frames lie.",
        );
}

/// A ratio, coloured where it is one.
fn verdict(ui: &mut Ui, name: &str, found: &Comparison, size: f32) {
    ui.label(RichText::new(name).color(look::FAINT));
    ui.label(
        RichText::new(found.text())
            .size(size)
            .strong()
            .color(color(found.finding)),
    );
}

fn color(finding: Finding) -> Color32 {
    match finding {
        Finding::Faster => look::GOOD,
        Finding::Slower => look::BAD,
        Finding::NoDifference | Finding::TooFew => look::FAINT,
    }
}

/// The median time of a side, and between what times most frames lie.
fn side(ui: &mut Ui, name: &str, times: &Spread) {
    figure(ui, name, look::ms(times.median));
    let between = format!("{} to {}", look::ms(times.low), look::ms(times.high));
    ui.horizontal(|ui| {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(between).small().color(look::FAINT));
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_difference_has_a_colour() {
        assert_eq!(color(Finding::Faster), look::GOOD);
        assert_eq!(color(Finding::Slower), look::BAD);
        for grey in [Finding::NoDifference, Finding::TooFew] {
            assert_eq!(color(grey), look::FAINT);
        }
    }
}
