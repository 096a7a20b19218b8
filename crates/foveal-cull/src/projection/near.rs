//! Boxes that cross the near plane, clipped to the frustum.
//!
//! The part of such a box inside the frustum is a convex polytope. Its screen rectangle and nearest
//! depth are those of its corners, and the corners come from clipping the six faces. A box that
//! contains the near rectangle covers a part of the near plane and is visible.

use super::clip::{ClipPolygon, NEAR};
use super::screen::Screen;
use glam::{DVec4, Vec3};

/// The part of a box inside the frustum.
pub(crate) enum Clipped {
    /// Empty: the box is outside the frustum.
    Outside,
    /// Meets the near plane on the screen, or is not known.
    Visible,
    /// Its rectangle (x0, y0, x1, y1) in samples, dilated, and its nearest depth.
    Rect([f32; 4], f32),
}

pub(crate) fn clip_box(s: &Screen<'_>, center: Vec3, half: Vec3) -> Clipped {
    if !(center.is_finite() && half.is_finite() && half.cmpge(Vec3::ZERO).all()) {
        return Clipped::Visible;
    }
    let rows = s.rows.map(|r| DVec4::from_array(r.map(f64::from)));
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        let p = center.as_dvec3() + half.as_dvec3() * glam::DVec3::new(sign(1), sign(2), sign(4));
        let p = p.extend(1.0);
        DVec4::new(
            rows[0].dot(p),
            rows[1].dot(p),
            rows[2].dot(p),
            rows[3].dot(p),
        )
    };
    let corners: [DVec4; 8] = core::array::from_fn(corner);
    let m = f64::from(s.dilate);
    let (w, h) = (f64::from(s.width), f64::from(s.height));
    // The dilated edges of the screen, the near plane and the far plane.
    let planes = [
        NEAR,
        DVec4::new(1.0, 0.0, 0.0, m),
        DVec4::new(-1.0, 0.0, 0.0, w + m),
        DVec4::new(0.0, 1.0, 0.0, m),
        DVec4::new(0.0, -1.0, 0.0, h + m),
        DVec4::new(0.0, 0.0, 1.0, -f64::from(s.far_depth)),
    ];
    if planes
        .iter()
        .any(|p| corners.iter().all(|c| p.dot(*c) < 0.0))
    {
        return Clipped::Outside;
    }
    const FACES: [[usize; 4]; 6] = [
        [0, 2, 6, 4],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 3, 7, 6],
        [0, 1, 3, 2],
        [4, 5, 7, 6],
    ];
    let mut rect = [
        f64::INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NEG_INFINITY,
    ];
    let mut depth = f64::NEG_INFINITY;
    for face in FACES {
        let mut polygon = ClipPolygon::new(&face.map(|i| corners[i]));
        for plane in planes {
            polygon.clip(plane);
        }
        for c in &polygon.corners[..polygon.count] {
            if c.w <= 0.0 {
                return Clipped::Visible;
            }
            let (x, y, d) = (c.x / c.w, c.y / c.w, c.z / c.w);
            rect = [
                rect[0].min(x),
                rect[1].min(y),
                rect[2].max(x),
                rect[3].max(y),
            ];
            depth = depth.max(d);
        }
    }
    // The whole near rectangle may be inside the box, and then none of the faces meets it.
    if contains_near_center(s, &rows, center, half) {
        return Clipped::Visible;
    }
    if depth == f64::NEG_INFINITY {
        return Clipped::Outside;
    }
    // Nothing can be in front of the near plane.
    if depth >= 1.0 - 1e-5 {
        return Clipped::Visible;
    }
    Clipped::Rect(
        [
            (rect[0] - m) as f32,
            (rect[1] - m) as f32,
            (rect[2] + m) as f32,
            (rect[3] + m) as f32,
        ],
        (depth * (1.0 + 1e-6)) as f32,
    )
}

/// Whether the centre of the near rectangle is inside the box.
fn contains_near_center(s: &Screen<'_>, rows: &[DVec4; 4], center: Vec3, half: Vec3) -> bool {
    let m = glam::DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
    let inverse = m.inverse();
    if !inverse.is_finite() {
        return true;
    }
    let p = inverse
        * DVec4::new(
            f64::from(s.width) * 0.5,
            f64::from(s.height) * 0.5,
            1.0,
            1.0,
        );
    let p = p.truncate() / p.w;
    let d = (p - center.as_dvec3()).abs() - half.as_dvec3() * (1.0 + 1e-6);
    !d.is_finite() || d.max_element() <= 1e-9
}
