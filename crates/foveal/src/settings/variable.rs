//! Settings of the geometry pass and of variable shading, whose rate follows the picture's content.

use serde::{Deserialize, Serialize};

use super::{Antialiasing, Composite, DebugView, RateCombine, RateSource, Settings, Shading};
use crate::Error;

/// Way to fill the G-buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Geometry {
    /// The rasterizer evaluates materials for every fragment that passes the depth test.
    #[default]
    Gbuffer,
    /// The rasterizer writes the triangle at each pixel (a visibility buffer); materials are
    /// resolved once per pixel afterwards.
    Visibility,
}

/// Work done once per sample instead of once per pixel in coarse and variable shading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RateStage {
    /// [`RateStage::Both`] where it is possible: with [`Geometry::Visibility`], without
    /// anti-aliasing, and without [`Composite::Light`], which needs each pixel's surface. Else
    /// lighting.
    #[default]
    Auto,
    /// Lighting.
    Lighting,
    /// Materials, as in variable shading's source. Needs [`Geometry::Visibility`] and
    /// [`Shading::Variable`].
    Material,
    /// Materials and lighting. Needs [`Geometry::Visibility`].
    Both,
}

impl RateStage {
    /// Whether materials are resolved once per sample.
    pub(crate) fn has_material(self) -> bool {
        matches!(self, Self::Material | Self::Both)
    }

    /// Whether lighting is evaluated once per sample.
    pub(crate) fn has_lighting(self) -> bool {
        self != Self::Material
    }
}

impl Settings {
    /// Work done once per sample, with [`RateStage::Auto`] decided. Never `Auto`.
    pub(crate) fn stage(&self) -> RateStage {
        let light =
            self.shading.mode == Shading::Coarse && self.coarse.composite == Composite::Light;
        let material = self.geometry.path == Geometry::Visibility
            && self.antialiasing.mode == Antialiasing::None
            && !light;
        match (self.shading.mode, self.shading.stage) {
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

/// Measure of the contrast in variable shading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Contrast {
    /// Differences within 2 x 2 pixels.
    #[default]
    Quad,
    /// Differences of each pixel to its four neighbours, as in the technique's source.
    Neighbors,
    /// Sobel kernels of 3 x 3 pixels.
    Sobel,
}

/// Checks the settings of variable shading.
pub(super) fn validate(s: &Settings) -> Result<(), Error> {
    let wrong = |name, value: String, expected| {
        Err(Error::Setting {
            name,
            value,
            expected,
        })
    };
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
    if s.shading.mode == Shading::Coarse && s.shading.stage == RateStage::Material {
        return wrong(
            "rate-stage",
            name(&s.shading.stage),
            "another one unless shading is variable",
        );
    }
    if s.sees_by_depth() && s.coarse.composite == Composite::Light {
        return wrong(
            "rate-stage",
            name(&s.shading.stage),
            "lighting where the composite is light",
        );
    }
    if s.stage().has_material() {
        if s.geometry.path != Geometry::Visibility {
            return wrong(
                "rate-stage",
                name(&s.shading.stage),
                "lighting unless the geometry is visibility",
            );
        }
        if s.antialiasing.mode != Antialiasing::None {
            return wrong(
                "rate-stage",
                name(&s.shading.stage),
                "lighting where edges are smoothed",
            );
        }
    }
    for (setting, value) in [
        ("contrast-threshold", s.variable.threshold),
        ("velocity-gain", s.variable.velocity_gain),
    ] {
        if !(0.0..=10.0).contains(&value) {
            return wrong(setting, value.to_string(), "between 0 and 10");
        }
    }
    Ok(())
}
