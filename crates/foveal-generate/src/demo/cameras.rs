//! Named views and the walk through the market. The quarter's middle is the same in all sizes,
//! so that all of this holds for all of them.

use glam::Vec3;

use super::options::DemoOptions;
use crate::build::named;
use foveal_scene::Camera;

/// Name, eye, target and vertical field of view in degrees.
const VIEWS: [(&str, [f32; 3], [f32; 3], f32); 5] = [
    ("alley", [-0.6, 1.7, 46.5], [0.4, 4.0, 10.0], 58.0),
    ("square", [-1.9, 1.7, 13.6], [0.9, 5.0, -8.0], 62.0),
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

/// Eyes and targets of the walk: up the alley, around the fountain, through the clock tower's gate.
const WALK: [([f32; 3], [f32; 3]); 15] = [
    ([0.0, 1.7, 47.0], [0.0, 3.0, 30.0]),
    ([0.6, 1.7, 41.0], [-1.0, 3.2, 25.0]),
    ([-0.5, 1.7, 35.0], [1.2, 2.6, 20.0]),
    ([0.4, 1.7, 29.0], [-2.0, 2.6, 14.0]),
    ([0.0, 1.7, 23.0], [0.0, 4.0, 2.0]),
    ([0.2, 1.7, 16.5], [-0.6, 4.2, -6.0]),
    ([0.9, 1.7, 10.6], [-1.0, 3.8, -8.0]),
    ([2.3, 1.8, 6.0], [-0.6, 3.2, -8.0]),
    ([4.3, 1.8, 3.6], [0.0, 3.0, -9.0]),
    ([5.6, 1.8, 0.4], [0.6, 3.0, -12.0]),
    ([4.5, 1.8, -3.6], [-0.6, 4.0, -16.0]),
    ([2.2, 1.8, -6.4], [-1.0, 4.6, -22.0]),
    ([0.5, 1.7, -12.0], [0.0, 4.0, -29.0]),
    ([0.0, 1.7, -21.0], [0.0, 2.8, -38.0]),
    ([0.0, 1.7, -34.0], [0.3, 2.8, -52.0]),
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
