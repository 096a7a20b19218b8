//! The picture: with what is drawn over it, and what the pointer does to it.

use egui::{
    Align2, CentralPanel, Color32, CornerRadius, CursorIcon, PointerButton, Pos2, Rect, RichText,
    Sense, Stroke, StrokeKind, Vec2,
};
use foveal::{DebugView, RateSource};

use crate::app::App;
use crate::app::drops::endings;
use crate::navigator::Hands;
use crate::needs::{Switch, of_culling};
use crate::{boxes, legend, look};

/// The greys of the culler's depth: from its own nearest (white) to its farthest, logarithmic;
/// black where nothing is proven.
pub(crate) fn depth_grays(near_over_distance: &[f32]) -> impl Iterator<Item = u8> + '_ {
    let covered = || near_over_distance.iter().copied().filter(|&d| d > 0.0);
    let near = covered().fold(f32::MIN_POSITIVE, f32::max).log2();
    let far = covered().fold(1.0, f32::min).log2();
    let span = (near - far).max(1e-6);
    near_over_distance.iter().map(move |&depth| {
        if depth > 0.0 {
            (56.0 + 199.0 * ((depth.log2() - far) / span).clamp(0.0, 1.0)) as u8
        } else {
            0
        }
    })
}

pub(crate) fn show(app: &mut App, ui: &mut egui::Ui) {
    let frame = egui::Frame::new().fill(look::BACKGROUND);
    CentralPanel::no_frame().frame(frame).show(ui, |ui| {
        let place = ui.max_rect();
        let pixels = ui.ctx().pixels_per_point();
        app.place = (
            (place.width() * pixels) as u32,
            (place.height() * pixels) as u32,
        );
        let response = ui.interact(
            place,
            ui.scope_id().with("picture"),
            Sense::click_and_drag(),
        );
        let rect = picture(app, ui, place);
        let over_split = rect.is_some_and(|rect| split(app, ui, rect));
        if let Some(rect) = rect
            && app.display.gaze_follows
            && app.missing("gaze").is_none()
        {
            if let Some(at) = response.hover_pos() {
                let place = (at - rect.min) / rect.size();
                app.look_at(glam::Vec2::new(place.x, place.y));
            }
            gaze(app, ui, rect);
        }
        let mut hands = Hands::default();
        if !over_split {
            let drag = response.drag_delta();
            let drag = glam::Vec2::new(drag.x, drag.y);
            if response.dragged_by(PointerButton::Primary) {
                hands.turn = drag;
            } else if response.dragged_by(PointerButton::Middle) {
                if ui.input(|i| i.modifiers.shift) {
                    hands.pan = drag;
                } else {
                    hands.orbit = drag;
                }
            } else if response.dragged() {
                hands.shift = drag;
            }
        }
        if let (true, Some(rect), Some(at)) =
            (response.clicked(), rect, response.interact_pointer_pos())
            && rect.contains(at)
            && !over_split
        {
            let place = (at - rect.min) / rect.size();
            let place = glam::Vec2::new(place.x, place.y);
            app.select_at(place);
        }
        if response.hovered() {
            // With Shift, which hurries, the interface takes the wheel for one that goes sideways.
            let by = ui.input(|i| i.smooth_scroll_delta());
            let is_sideways = ui.input(|i| i.modifiers.shift);
            hands.scroll = if is_sideways { by.x } else { by.y } / 50.0;
        }
        if response.clicked() || response.dragged() {
            // Keys belong to the picture again.
            ui.ctx().memory_mut(|m| {
                if let Some(focused) = m.focused() {
                    m.surrender_focus(focused);
                }
            });
        }
        let context = ui.ctx().clone();
        app.steer(&context, hands);
        legends(app, ui, place);
        depth(app, ui, place);
        drop_here(ui, place);
        messages(app, ui, place);
    });
}

/// The picture at its largest; where it is.
fn picture(app: &App, ui: &egui::Ui, place: Rect) -> Option<Rect> {
    let painter = ui.painter_at(place);
    let (Some(shown), Some(texture)) = (&app.shown, &app.picture) else {
        let text = match (app.opening.is_some(), &app.scene) {
            (true, _) => "Loading...",
            (false, Some(_)) => "Drawing the first frame...",
            (false, None) => "No scene",
        };
        let font = egui::FontId::proportional(16.0);
        painter.text(
            place.center(),
            Align2::CENTER_CENTER,
            text,
            font,
            look::FAINT,
        );
        return None;
    };
    let size = Vec2::new(shown.picture.width as f32, shown.picture.height as f32);
    let size = size * (place.size() / size).min_elem();
    let rect = Rect::from_center_size(place.center(), size);
    let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    painter.image(texture.id(), rect, all, Color32::WHITE);
    if let (true, Some(_), Some(reference)) = (
        app.display.compare,
        &shown.reference,
        &app.reference_picture,
    ) {
        let x = app.display.split;
        let left = Rect::from_min_max(
            rect.min,
            Pos2::new(rect.left() + x * rect.width(), rect.bottom()),
        );
        let part = Rect::from_min_max(Pos2::ZERO, Pos2::new(x, 1.0));
        painter.image(reference.id(), left, part, Color32::WHITE);
    }
    if let (Some(eyes), Some(navigator)) = (app.shown_eyes(), &app.navigator) {
        let painter = ui.painter_at(rect);
        if app.display.boxes {
            let from = navigator.camera().eye();
            boxes::draw(&painter, rect, &eyes, from, &shown.boxes);
        }
        if let Some(picked) = &app.selected {
            let stroke = Stroke::new(2.0, look::ACCENT);
            boxes::outline(&painter, rect, &eyes, &picked.bounds, stroke);
        }
    }
    Some(rect)
}

/// The line between reference and picture; whether the pointer holds it.
fn split(app: &mut App, ui: &egui::Ui, rect: Rect) -> bool {
    if !app.display.compare || app.shown.as_ref().is_none_or(|s| s.reference.is_none()) {
        return false;
    }
    let x = rect.left() + app.display.split * rect.width();
    let handle = Rect::from_x_y_ranges(x - 6.0..=x + 6.0, rect.y_range());
    let response = ui
        .interact(handle, ui.scope_id().with("split"), Sense::drag())
        .on_hover_cursor(CursorIcon::ResizeHorizontal);
    if let (true, Some(at)) = (response.dragged(), response.interact_pointer_pos()) {
        app.display.split = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
    }
    let painter = ui.painter_at(rect);
    let stroke = Stroke::new(2.0, Color32::WHITE);
    painter.vline(x, rect.y_range(), stroke);
    let middle = Pos2::new(x, rect.center().y);
    painter.circle(middle, 8.0, Color32::WHITE, Stroke::new(2.0, look::ACCENT));
    for (text, side, align) in [
        ("reference", -10.0, Align2::RIGHT_TOP),
        ("chosen", 10.0, Align2::LEFT_TOP),
    ] {
        let at = Pos2::new(x + side, rect.top() + 8.0);
        let galley = painter.layout_no_wrap(text.to_owned(), look::small_font(), Color32::WHITE);
        let back = align.anchor_size(at, galley.size()).expand(4.0);
        let dark = Color32::from_black_alpha(170);
        painter.rect_filled(back, CornerRadius::same(3), dark);
        painter.galley(back.min + Vec2::splat(4.0), galley, Color32::WHITE);
    }
    response.hovered() || response.dragged()
}

/// A circle around where each eye looks.
fn gaze(app: &App, ui: &egui::Ui, rect: Rect) {
    let Some(eyes) = app.shown_eyes() else { return };
    let settings = &app.settings;
    let radius = match settings.coarse.source {
        RateSource::Radii => settings.coarse.fovea_inner,
        _ => 0.0,
    };
    // In pictures' heights; seen even where there is none.
    let radius = radius.max(4.0 / rect.height());
    let across = radius / app.aspect();
    let painter = ui.painter_at(rect);
    for eye in 0..eyes.count() {
        let shift = glam::Vec2::from(settings.stereo.gaze_shift) * eye as f32;
        let at = glam::Vec2::from(settings.eye.gaze) + shift;
        let around = (0..=48).map(|i| {
            let angle = std::f32::consts::TAU * i as f32 / 48.0;
            at + glam::Vec2::from_angle(angle) * glam::Vec2::new(across, radius)
        });
        let circle = boxes::placed(rect, &eyes, eye, around);
        painter.line(circle, Stroke::new(1.0, look::ACCENT));
    }
}

/// What the colours mean, at the lower left.
fn legends(app: &App, ui: &mut egui::Ui, place: Rect) {
    let view = app.settings.picture.view;
    let works = |switch| of_culling(switch, &app.settings).is_none();
    let is_frozen = app.display.frozen && works(Switch::Freeze);
    let has_boxes = app.display.boxes && works(Switch::Boxes);
    if view == DebugView::Final && !has_boxes && !is_frozen {
        return;
    }
    egui::Area::new(ui.scope_id().with("legends"))
        .fixed_pos(place.left_bottom() + Vec2::new(10.0, -10.0))
        .pivot(Align2::LEFT_BOTTOM)
        .constrain_to(place)
        .interactable(false)
        .show(ui.ctx(), |ui| {
            if is_frozen {
                look::strip_frame().show(ui, |ui| {
                    let text = "Culling is frozen: what was found is drawn from anywhere (C)";
                    ui.label(RichText::new(text).color(look::SMALL));
                });
            }
            if has_boxes {
                legend::of_boxes(ui);
            }
            legend::of_view(ui, &app.settings);
        });
}

/// The culler's depth, at the lower right.
fn depth(app: &App, ui: &egui::Ui, place: Rect) {
    let has_depth = app.shown.as_ref().is_some_and(|s| s.depth.is_some());
    if !app.display.depth {
        return;
    }
    let (Some(texture), true) = (&app.depth_picture, has_depth) else {
        return;
    };
    let size = texture.size_vec2();
    let size = size * (0.38 * place.width() / size.x);
    let rect = Rect::from_min_size(place.right_bottom() - size - Vec2::splat(10.0), size);
    let painter = ui.painter_at(place);
    let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    painter.image(texture.id(), rect, all, Color32::WHITE);
    let stroke = Stroke::new(1.0, look::FAINT);
    painter.rect_stroke(rect, CornerRadius::ZERO, stroke, StrokeKind::Outside);
    let text = "occluders' depth: white near, dark far, black open";
    let width = rect.width() - 8.0;
    let galley = painter.layout(text.to_owned(), look::small_font(), look::TEXT, width);
    let back = Rect::from_min_size(rect.min, galley.size() + Vec2::splat(8.0));
    painter.rect_filled(back, CornerRadius::ZERO, Color32::from_black_alpha(190));
    painter.galley(rect.min + Vec2::splat(4.0), galley, look::TEXT);
}

/// While files are held over the window.
fn drop_here(ui: &egui::Ui, place: Rect) {
    if ui.input(|i| i.raw.hovered_files.is_empty()) {
        return;
    }
    let painter = ui.painter_at(place);
    painter.rect_filled(place, CornerRadius::ZERO, Color32::from_black_alpha(150));
    let frame = place.shrink(16.0);
    let stroke = Stroke::new(2.0, look::ACCENT);
    painter.rect_stroke(frame, CornerRadius::same(8), stroke, StrokeKind::Inside);
    painter.text(
        place.center(),
        Align2::CENTER_CENTER,
        format!("Drop scenes ({}) or settings (.toml)", endings()),
        egui::FontId::proportional(16.0),
        look::TEXT,
    );
}

/// What is to be said, at the upper left.
fn messages(app: &mut App, ui: &egui::Ui, place: Rect) {
    if app.messages.is_empty() {
        return;
    }
    let mut dismissed = None;
    egui::Area::new(ui.scope_id().with("messages"))
        .fixed_pos(place.left_top() + Vec2::splat(10.0))
        .constrain_to(place)
        .show(ui.ctx(), |ui| {
            ui.set_max_width((place.width() - 20.0).max(100.0));
            for (index, message) in app.messages.iter().enumerate() {
                look::strip_frame().show(ui, |ui| {
                    ui.horizontal_wrapped(|ui| {
                        let color = if message.is_error {
                            look::BAD
                        } else {
                            look::TEXT
                        };
                        ui.label(RichText::new(&message.text).color(color));
                        if message.is_error && ui.small_button("Dismiss").clicked() {
                            dismissed = Some(index);
                        }
                    });
                });
            }
        });
    if let Some(index) = dismissed {
        app.messages.remove(index);
    }
}

#[cfg(test)]
mod tests {
    use egui::{Event, Modifiers, MouseWheelSource, MouseWheelUnit, TouchPhase};
    use foveal::{Culling, Settings};

    use super::*;
    use crate::app::tests::{Pass, SIZES, loaded, texts};
    use crate::worker::OccluderDepth;

    #[test]
    fn the_wheel_changes_the_speed_with_shift_too() {
        for modifiers in [Modifiers::NONE, Modifiers::SHIFT] {
            let mut app = loaded();
            let context = egui::Context::default();
            let pass = Pass::new(&context, SIZES[0]);
            let speed = |app: &App| app.navigator.as_ref().unwrap().speed_m_s;
            let before = speed(&app);
            let over_picture = Event::PointerMoved(Pos2::new(480.0, 300.0));
            pass.show(&mut app, vec![over_picture]);
            pass.show(&mut app, Vec::new());
            let wheel = Event::MouseWheel {
                unit: MouseWheelUnit::Line,
                delta: Vec2::new(0.0, 1.0),
                phase: TouchPhase::Move,
                source: MouseWheelSource::Unknown,
                modifiers,
            };
            pass.show(&mut app, vec![Event::ModifiersChanged(modifiers), wheel]);
            assert!(speed(&app) > before, "{modifiers:?}");
        }
    }

    #[test]
    fn what_the_depth_s_greys_mean_fits_a_small_window() {
        let mut app = loaded();
        app.display.depth = true;
        app.shown.as_mut().unwrap().depth = Some(OccluderDepth {
            width: 16,
            height: 9,
            near_over_distance: vec![0.5; 16 * 9],
        });
        let context = egui::Context::default();
        let pass = Pass::new(&context, SIZES[0]);
        app.load_textures(&context);
        pass.show(&mut app, Vec::new());
        let said = texts(&pass.show(&mut app, Vec::new()));
        let meaning = said.iter().find(|text| text.says.starts_with("occluders'"));
        assert!(
            meaning.unwrap().rect.right() < SIZES[0].x - 268.0,
            "{meaning:?}"
        );
    }

    #[test]
    fn legends_are_of_what_is_drawn() {
        for (culling, has_boxes) in [(Culling::Off, false), (Culling::Frustum, true)] {
            let mut app = loaded();
            app.use_settings(&Settings::default().with(|s| s.culling.mode = culling));
            (app.display.frozen, app.display.boxes) = (true, true);
            let context = egui::Context::default();
            let pass = Pass::new(&context, SIZES[0]);
            for _ in 0..3 {
                pass.show(&mut app, Vec::new());
            }
            let said = texts(&pass.show(&mut app, Vec::new()));
            for words in ["Culling is frozen", "too small"] {
                let is_said = said.iter().any(|text| text.says.starts_with(words));
                assert_eq!(is_said, has_boxes, "{culling:?}: {words}");
            }
        }
    }
}
