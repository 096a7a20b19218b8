//! Named views and the walk through the market. The quarter's middle is the same in all sizes,
//! so that all of this holds for all of them.

use glam::Vec3;

use super::DemoOptions;
use crate::Camera;
use crate::generate::build::named;

/// Name, eye, target and vertical field of view in degrees.
const VIEWS: [(&str, [f32; 3], [f32; 3], f32); 5] = [
    ("alley", [-0.6, 1.7, 46.5], [0.4, 4.0, 10.0], 58.0),
    ("square", [6.8, 1.7, 9.4], [-1.6, 4.6, -10.0], 66.0),
    ("overview", [26.0, 44.0, 47.0], [-1.0, 2.0, -3.0], 52.0),
    ("arcade", [-6.1, 1.7, 46.6], [-5.6, 2.1, 30.0], 60.0),
    ("lanterns", [-0.4, 2.0, 40.4], [1.9, 2.1, 37.2], 46.0),
];

/// The named cameras, the default first.
pub(super) fn views() -> Vec<Camera> {
    VIEWS
        .into_iter()
        .map(|(name, eye, target, degrees)| {
            let camera = Camera::look_at(eye.into(), target.into(), Vec3::Y, degrees.to_radians());
            named(camera, name)
        })
        .collect()
}

/// Eyes and targets of the walk: up the alley, under the western arcade, around the fountain,
/// through the clock tower's gate.
const WALK: [([f32; 3], [f32; 3]); 12] = [
    ([0.0, 1.7, 47.0], [0.0, 3.0, 30.0]),
    ([0.6, 1.7, 41.0], [-1.0, 3.2, 25.0]),
    ([-0.5, 1.7, 35.0], [1.2, 2.6, 20.0]),
    ([0.4, 1.7, 29.0], [-2.0, 2.6, 14.0]),
    ([0.0, 1.7, 23.0], [0.0, 4.0, 0.0]),
    ([1.5, 1.7, 16.0], [-1.0, 4.0, -6.0]),
    ([4.6, 1.8, 9.0], [-1.0, 3.5, -4.0]),
    ([6.6, 1.8, 1.5], [-2.0, 3.4, -6.0]),
    ([5.4, 1.8, -6.5], [-3.0, 4.0, -18.0]),
    ([1.8, 1.7, -14.0], [0.0, 4.0, -27.0]),
    ([0.0, 1.7, -22.0], [0.0, 2.6, -38.0]),
    ([0.0, 1.7, -36.0], [0.3, 2.8, -52.0]),
];

/// Uniform Catmull-Rom through the keyframes; the ends are repeated.
fn spline(t: f32, point: impl Fn(usize) -> Vec3) -> Vec3 {
    let spans = WALK.len() - 1;
    let x = t.clamp(0.0, 1.0) * spans as f32;
    let i = (x as usize).min(spans - 1);
    let u = x - i as f32;
    let p = |k: usize| point(k.saturating_sub(1).min(WALK.len() - 1));
    let (a, b, c, d) = (p(i), p(i + 1), p(i + 2), p(i + 3));
    let cubic = (b - c) * 3.0 + d - a;
    let square = a * 2.0 - b * 5.0 + c * 4.0 - d;
    b + ((c - a) + (square + cubic * u) * u) * (0.5 * u)
}

/// The camera of a walk through the demo scene at `t` in [0, 1]: up the main alley, around the
/// fountain and through the clock tower's gate, at eye level and never through a wall.
#[must_use]
pub fn demo_path(_options: &DemoOptions, t: f32) -> Camera {
    let eye = spline(t, |i| WALK[i].0.into());
    let target = spline(t, |i| WALK[i].1.into());
    named(
        Camera::look_at(eye, target, Vec3::Y, 60f32.to_radians()),
        "walk",
    )
}
