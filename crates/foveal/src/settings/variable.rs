//! Settings of the geometry pass and of variable shading, whose rate follows the picture's content.

#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

/// Way to fill the G-buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Geometry {
    /// The rasterizer evaluates materials for every fragment that passes the depth test.
    #[default]
    Gbuffer,
    /// The rasterizer writes the triangle at each pixel (a visibility buffer); materials are
    /// resolved once per pixel afterwards.
    Visibility,
}

/// Work done once per sample instead of once per pixel in coarse and variable shading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum RateStage {
    /// [`RateStage::Both`] where it is possible: with [`Geometry::Visibility`], without
    /// anti-aliasing, and without [`Composite::Light`](crate::Composite::Light), which needs each
    /// pixel's surface. Else lighting.
    #[default]
    Auto,
    /// Lighting.
    Lighting,
    /// Materials, as in variable shading's source. Needs [`Geometry::Visibility`] and
    /// [`Shading::Variable`](crate::Shading::Variable).
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

/// Measure of the contrast in variable shading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Contrast {
    /// Differences within 2 x 2 pixels.
    #[default]
    Quad,
    /// Differences of each pixel to its four neighbours, as in the original method.
    Neighbors,
    /// Sobel kernels of 3 x 3 pixels.
    Sobel,
}
