//! Checks of coarse shading's settings, and what follows from them.

use super::refusal::{within, wrong};
use crate::COARSEST_LEVEL;
use crate::Error;
use crate::Shading;
use crate::settings::{CoarseBackend, CoarseSample, Composite, DebugView, Settings};

impl Settings {
    /// Whether light is kept from frame to frame, so that pictures follow on the ones before. Devices
    /// that offer only [`Gpu::reduced_limits`](crate::Gpu::reduced_limits) keep none all the same,
    /// nor does any of a picture that is too large for it
    /// ([`CoarseStats::notice`](crate::CoarseStats::notice) says so).
    #[must_use]
    pub fn keeps_light(&self) -> bool {
        // Other views of a lit frame show its tiles.
        self.picture.view == DebugView::Final && self.is_rated_for_kept_light()
    }

    /// The same whatever the view: views of rates show those of the lit frame.
    pub(crate) fn is_rated_for_kept_light(&self) -> bool {
        self.coarse.history
            && self.shading.mode == Shading::Coarse
            && self.coarse.composite == Composite::Light
            && self.coarse.sample == CoarseSample::Center
            && self.coarse.backend != CoarseBackend::Stencil
    }

    /// Standard deviation of what samples of light say of a pixel, over its luminance, from which on
    /// the pixel is shaded. Found by measurement together with the blocks of a quality
    /// (docs/decisions/0270-led-pixels.md): larger blocks with a finer limit light fewer samples.
    pub(crate) fn most_disagreement(&self) -> f32 {
        0.05 * (2.5 * (9.5 - self.eye.quality_jod)).exp2().clamp(0.4, 2.0)
    }
}

/// Checks the settings of coarse shading.
pub(super) fn validate(s: &Settings) -> Result<(), Error> {
    let shows_tiles = matches!(
        s.picture.view,
        DebugView::Rate | DebugView::Blocks | DebugView::Shaded
    );
    if shows_tiles && s.shading.mode == Shading::Full {
        let value = format!("{:?}", s.picture.view).to_lowercase();
        let expected = if s.picture.view == DebugView::Blocks {
            "another one unless shading is coarse"
        } else {
            "another one unless shading is coarse or variable"
        };
        return wrong("view", value, expected);
    }
    for (name, level) in [
        ("coarsest-level", s.coarse.coarsest_level),
        ("rate-level", s.coarse.constant_level),
    ] {
        within(name, level, 0..=COARSEST_LEVEL, "between 0 and 8")?;
    }
    if !s.eye.gaze.iter().all(|g| g.is_finite() && g.abs() <= 16.0) {
        let value = format!("{},{}", s.eye.gaze[0], s.eye.gaze[1]);
        return wrong("gaze", value, "two numbers between -16 and 16");
    }
    for (name, value) in [
        ("fovea-inner", s.coarse.fovea_inner),
        ("fovea-outer", s.coarse.fovea_outer),
    ] {
        within(name, value, 0.0..=1000.0, "between 0 and 1000")?;
    }
    let curve = s.coarse.fovea_curve;
    within("fovea-curve", curve, 0.1..=10.0, "between 0.1 and 10")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_that_full_shading_lacks_names_the_shading_that_has_it() {
        for view in [
            DebugView::Rate,
            DebugView::Blocks,
            DebugView::Shaded,
            DebugView::Unknown,
        ] {
            let shown_by = |mode| {
                let settings = Settings::default().with(|s| {
                    s.picture.view = view;
                    s.shading.mode = mode;
                });
                settings.validate(&wgpu::Limits::default())
            };
            let error = shown_by(Shading::Full).unwrap_err().to_string();
            for (mode, name) in [(Shading::Coarse, "coarse"), (Shading::Variable, "variable")] {
                let is_named = error.contains(name);
                assert_eq!(shown_by(mode).is_ok(), is_named, "{view:?} {name}: {error}");
            }
        }
    }
}
