//! What a result must hold for, and how long it may take: one eye or two, a radius around them, a
//! time budget.

use std::time::Instant;

use anyhow::bail;
use foveal_cull::{Budget, Eye, FrameOptions, View};
use glam::{DAffine3, DVec3};

use super::args::CullingArgs;

/// A clock that starts when it is made.
#[derive(Debug, Clone, Copy)]
pub struct Clock(Instant);

impl Clock {
    /// A clock that starts now.
    #[must_use]
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Nanoseconds since the start.
    #[must_use]
    pub fn now_ns(self) -> u64 {
        u64::try_from(self.0.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }
}

impl CullingArgs {
    /// The view from a camera: its eye, or two beside it; with the radius.
    pub fn view(&self, camera: &Eye) -> anyhow::Result<View> {
        let view = if self.eyes_apart > 0.0 {
            if camera.projection.is_orthographic() {
                bail!("an orthographic camera has no two eyes: leave out --eyes-apart");
            }
            let half = 0.5 * f64::from(self.eyes_apart);
            View::stereo(
                moved(camera, [-half, 0.0, 0.0]),
                moved(camera, [half, 0.0, 0.0]),
            )
        } else {
            View::mono(*camera)
        };
        Ok(view.with_validity_radius(self.validity_radius.into()))
    }

    /// Switches of a frame that begins now by `clock`, which reads nanoseconds.
    pub fn options<'a>(&self, clock: &'a (dyn Fn() -> u64 + Sync)) -> FrameOptions<'a> {
        let deadline = |ms| deadline_ns(clock(), ms);
        FrameOptions::default()
            .with_occluder_size_threshold(self.occluder_size_threshold)
            .with_occluder_pixels_per_quad(self.occluder_pixels_per_quad)
            .with_occludee_size_threshold(self.occludee_size_threshold)
            .with_budget(self.budget_ms.map(|ms| Budget::new(clock, deadline(ms))))
    }
}

/// The moment so many milliseconds from `now_ns`; the last of all where there is none so late.
fn deadline_ns(now_ns: u64, ms: f32) -> u64 {
    now_ns.saturating_add((f64::from(ms) * 1e6) as u64)
}

/// Eyes from which a result for `view` is compared with the reference: its own, and with a radius
/// six more each, moved by almost that along their axes.
pub(super) fn places(view: &View) -> Vec<Eye> {
    let radius = 0.999 * view.validity_radius_m;
    [Some(view.eye), view.second_eye]
        .into_iter()
        .flatten()
        .flat_map(|eye| {
            let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let around = steps
                .into_iter()
                .flat_map(|step| [step.map(|v: f64| v * radius), step.map(|v| -v * radius)])
                .filter(move |_| radius > 0.0)
                .map(move |step| moved(&eye, step));
            std::iter::once(eye).chain(around)
        })
        .collect()
}

/// Moved along its own axes, metres.
fn moved(eye: &Eye, step: [f64; 3]) -> Eye {
    let step = DAffine3::from_translation(DVec3::from_array(step));
    Eye::new(DAffine3::from(eye.world_from_eye) * step, eye.projection)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_without_an_end_is_no_small_one() {
        assert_eq!(deadline_ns(7, 0.5), 500_007);
        assert_eq!(deadline_ns(7, f32::MAX), u64::MAX);
    }
}
