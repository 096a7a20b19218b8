//! Checks of variable shading's settings, and the stage that is done at a rate.

use super::refusal::{within, wrong};
use crate::Error;
use crate::Geometry;
use crate::RateStage;
use crate::settings::{
    Antialiasing, Composite, DebugView, RateCombine, RateSource, Settings, Shading,
};

impl Settings {
    /// Work done once per sample, with [`RateStage::Auto`] decided. Never `Auto`.
    pub(crate) fn stage(&self) -> RateStage {
        let light =
            self.shading.mode == Shading::Coarse && self.coarse.composite == Composite::Light;
        let material = self.geometry.path == Geometry::Visibility
            && self.antialiasing.mode == Antialiasing::None
            && !light;
        match (self.shading.mode, self.rate.stage) {
            (Shading::Full, _) => RateStage::Lighting,
            (_, RateStage::Auto) if material => RateStage::Both,
            (_, RateStage::Auto) => RateStage::Lighting,
            (_, stage) => stage,
        }
    }

    /// Whether only the samples of coarse shading have surfaces, so that comparisons of other
    /// pixels use depth alone.
    pub(crate) fn sees_by_depth(&self) -> bool {
        self.shading.mode == Shading::Coarse && self.stage().has_material()
    }
}

/// Checks the settings of variable shading.
pub(super) fn validate(s: &Settings) -> Result<(), Error> {
    let name = |value: &dyn std::fmt::Debug| format!("{value:?}").to_lowercase();
    let variable = s.shading.mode == Shading::Variable;
    for (setting, source) in [
        ("rate", s.coarse.source),
        ("rate-other", s.coarse.other_source),
    ] {
        let used = setting == "rate" || s.coarse.combine != RateCombine::First;
        if used && source == RateSource::Content && s.shading.mode == Shading::Coarse {
            return wrong(
                setting,
                name(&source),
                "another one unless shading is variable",
            );
        }
        if used && matches!(source, RateSource::Image | RateSource::Lens) && variable {
            return wrong(
                setting,
                name(&source),
                "another one where shading is variable",
            );
        }
    }
    if s.picture.view == DebugView::Unknown && !variable {
        return wrong(
            "view",
            name(&s.picture.view),
            "another one unless shading is variable",
        );
    }
    if variable && s.picture.view == DebugView::Blocks {
        return wrong(
            "view",
            name(&s.picture.view),
            "another one unless shading is coarse",
        );
    }
    if s.shading.mode == Shading::Coarse && s.rate.stage == RateStage::Material {
        return wrong(
            "rate-stage",
            name(&s.rate.stage),
            "another one unless shading is variable",
        );
    }
    if s.sees_by_depth() && s.coarse.composite == Composite::Light {
        return wrong(
            "rate-stage",
            name(&s.rate.stage),
            "lighting where the composite is light",
        );
    }
    if s.stage().has_material() {
        if s.geometry.path != Geometry::Visibility {
            return wrong(
                "rate-stage",
                name(&s.rate.stage),
                "lighting unless the geometry is visibility",
            );
        }
        if s.antialiasing.mode != Antialiasing::None {
            return wrong(
                "rate-stage",
                name(&s.rate.stage),
                "lighting where edges are smoothed",
            );
        }
    }
    for (setting, value) in [
        ("contrast-threshold", s.variable.threshold),
        ("velocity-gain", s.variable.velocity_gain),
    ] {
        within(setting, value, 0.0..=10.0, "between 0 and 10")?;
    }
    Ok(())
}
