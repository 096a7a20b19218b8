//! Objects' boxes as lines over the picture, coloured by what became of them.

use egui::{Color32, Pos2, Rect, Stroke};
use foveal::{ShownEyes, Visibility};
use foveal_scene::Aabb;
use glam::{Mat4, Vec2, Vec3, Vec4};

use crate::look;

/// More boxes than these would be neither legible nor quick.
const MOST_BOXES: usize = 6000;

/// Corners (as bits x, y, z) that the twelve edges join.
const EDGES: [(usize, usize); 12] = [
    (0, 1),
    (2, 3),
    (4, 5),
    (6, 7),
    (0, 2),
    (1, 3),
    (4, 6),
    (5, 7),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
];

fn color(visibility: Visibility) -> Color32 {
    match visibility {
        Visibility::Visible => look::VISIBLE,
        Visibility::Outside => look::OUTSIDE,
        Visibility::Small => look::SMALL,
        Visibility::Occluded => look::OCCLUDED,
    }
}

/// Draws the nearest boxes over a picture at `rect`, hidden ones last, since they are what one
/// looks for. `from` is where the camera is.
pub(crate) fn draw(
    painter: &egui::Painter,
    rect: Rect,
    eyes: &ShownEyes,
    from: Vec3,
    boxes: &[(Aabb, Visibility)],
) {
    let mut nearest: Vec<_> = boxes.iter().filter(|(b, _)| !b.is_empty()).collect();
    if nearest.len() > MOST_BOXES {
        let distance = |b: &Aabb| b.center().distance_squared(from);
        nearest
            .select_nth_unstable_by(MOST_BOXES, |a, b| distance(&a.0).total_cmp(&distance(&b.0)));
        nearest.truncate(MOST_BOXES);
    }
    nearest.sort_by_key(|(_, visibility)| *visibility == Visibility::Occluded);
    for (bounds, visibility) in nearest {
        let stroke = Stroke::new(1.0, color(*visibility));
        outline(painter, rect, eyes, bounds, stroke);
    }
}

/// Draws one box, as each eye sees it.
pub(crate) fn outline(
    painter: &egui::Painter,
    rect: Rect,
    eyes: &ShownEyes,
    bounds: &Aabb,
    stroke: Stroke,
) {
    let parts = if eyes.bends_lines() { 8 } else { 1 };
    for eye in 0..eyes.count() {
        for [a, b] in lines(&eyes.clip_from_world(eye), bounds) {
            let (a, b) = (Vec2::from(a), Vec2::from(b));
            let points = (0..=parts).map(|i| a.lerp(b, i as f32 / parts as f32));
            painter.line(placed(rect, eyes, eye, points), stroke);
        }
    }
}

/// Where a picture at `rect` has places of an eye's picture.
pub(crate) fn placed(
    rect: Rect,
    eyes: &ShownEyes,
    eye: usize,
    places: impl Iterator<Item = Vec2>,
) -> Vec<Pos2> {
    places
        .filter_map(|place| eyes.shown(eye, place.to_array()))
        .map(|[x, y]| rect.min + rect.size() * egui::Vec2::new(x, y))
        .collect()
}

/// The visible parts of a box's edges, as fractions of an eye's picture from its top left corner.
fn lines(clip_from_world: &Mat4, bounds: &Aabb) -> Vec<[[f32; 2]; 2]> {
    let corner = |i: usize| {
        let pick = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
        let (min, max) = (bounds.min, bounds.max);
        let at = Vec3::new(
            pick(0, min.x, max.x),
            pick(1, min.y, max.y),
            pick(2, min.z, max.z),
        );
        *clip_from_world * at.extend(1.0)
    };
    let corners: [Vec4; 8] = std::array::from_fn(corner);
    let mut lines = Vec::new();
    for (a, b) in EDGES {
        if let Some((a, b)) = clipped(corners[a], corners[b]) {
            let place = |c: Vec4| [0.5 + 0.5 * c.x / c.w, 0.5 - 0.5 * c.y / c.w];
            lines.push([place(a), place(b)]);
        }
    }
    lines
}

/// The part of an edge within the frustum: Liang and Barsky, in clip space. Depth is reversed, so
/// that `z <= w` is before the near plane; nothing is behind the far one.
fn clipped(a: Vec4, b: Vec4) -> Option<(Vec4, Vec4)> {
    let planes = |p: Vec4| [p.w + p.x, p.w - p.x, p.w + p.y, p.w - p.y, p.w - p.z];
    let (from, to) = (planes(a), planes(b));
    let (mut enter, mut leave) = (0.0f32, 1.0f32);
    for (from, to) in from.into_iter().zip(to) {
        if from < 0.0 && to < 0.0 {
            return None;
        }
        let at = from / (from - to);
        if from < 0.0 {
            enter = enter.max(at);
        } else if to < 0.0 {
            leave = leave.min(at);
        }
    }
    (enter < leave).then(|| (a.lerp(b, enter), a.lerp(b, leave)))
}

#[cfg(test)]
mod tests {
    use foveal_scene::Camera;

    use super::*;

    fn unit_box(at: Vec3) -> Aabb {
        Aabb {
            min: at - 0.5,
            max: at + 0.5,
        }
    }

    fn looking_ahead() -> Mat4 {
        Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0).clip_from_world(1.5)
    }

    #[test]
    fn a_box_before_the_camera_has_twelve_lines_around_the_middle() {
        let lines = lines(&looking_ahead(), &unit_box(Vec3::new(0.0, 0.0, -5.0)));
        assert_eq!(lines.len(), 12);
        for [x, y] in lines.into_iter().flatten() {
            assert!((x - 0.5).abs() < 0.25 && (y - 0.5).abs() < 0.25, "{x} {y}");
        }
    }

    #[test]
    fn a_box_behind_has_none_and_one_around_the_eye_stays_within_the_picture() {
        assert!(lines(&looking_ahead(), &unit_box(Vec3::Z * 5.0)).is_empty());
        let around = Aabb {
            min: Vec3::new(-1.0, -1.0, -3.0),
            max: Vec3::new(1.0, 1.0, 1.0),
        };
        let lines = lines(&looking_ahead(), &around);
        assert!(!lines.is_empty());
        for [x, y] in lines.into_iter().flatten() {
            assert!((-1e-3..=1.001).contains(&x) && (-1e-3..=1.001).contains(&y));
        }
    }
}
