//! Settings of coarse shading: the shading rate, the method that visits samples, and the
//! reconstruction of pixels from them.

#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

/// Number of samples that the lighting stage shades.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Shading {
    /// One sample per pixel: the reference.
    #[default]
    Full,
    /// One sample per square block of pixels. The rate map gives the block sizes.
    Coarse,
    /// One sample per 1 x 1, 2 x 1, 1 x 2 or 2 x 2 pixels, or 4 x 4 with
    /// [`VariableSettings::blocks_4x4`](crate::VariableSettings::blocks_4x4), as the picture's
    /// content allows.
    Variable,
}

/// Method that visits the samples of coarse shading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum CoarseBackend {
    /// The method that the first frames show to be faster on this device.
    #[default]
    Auto,
    /// Full-screen draws per level behind a stencil test.
    Stencil,
    /// Indirect dispatches over lists of blocks.
    Compute,
}

/// Source of the requested level. Level l requests one sample per 2^l x 2^l pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum RateSource {
    /// The eye's resolution: the angle to the gaze on
    /// [`EyeSettings::display`](crate::EyeSettings::display), for
    /// [`EyeSettings::quality_jod`](crate::EyeSettings::quality_jod).
    #[default]
    Foveated,
    /// The distance to the gaze in pixels, between
    /// [`CoarseSettings::fovea_inner`](crate::CoarseSettings::fovea_inner) and
    /// [`CoarseSettings::fovea_outer`](crate::CoarseSettings::fovea_outer), as in the technique's
    /// source.
    Radii,
    /// [`CoarseSettings::constant_level`](crate::CoarseSettings::constant_level) everywhere.
    Constant,
    /// A picture stretched over the frame: black requests every pixel, white requests level 8.
    Image,
    /// The contrast of the previous frame. Only for [`Shading::Variable`].
    Content,
    /// The lens of the headset output: coarser where the screen has fewer pixels.
    Lens,
}

/// Use of the second source of levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum RateCombine {
    /// The second source is ignored.
    #[default]
    First,
    /// The coarser level at each pixel.
    Coarser,
    /// The finer level at each pixel.
    Finer,
}

/// Geometric edges that are shaded more finely than requested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum RefineEdges {
    /// All edges: one level finer than requested with [`Composite::Light`], two with the other
    /// composites. With [`Composite::Light`] bumpy surfaces are two levels finer too.
    #[default]
    Graded,
    /// Edges near the gaze, pixel by pixel: where the requested level is at most half the coarsest
    /// level.
    Inner,
    /// All edges, pixel by pixel.
    Everywhere,
    /// No edges.
    Off,
}

/// Pixel of a block that its sample shades.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum CoarseSample {
    /// The pixel at the block's centre.
    #[default]
    Center,
    /// The one of five pixels whose depth and normal are nearest to the average of the five.
    Typical,
}

/// Reconstruction of pixels from samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Composite {
    /// Samples hold light without the surface's own colour. Each pixel's own surface is lit by the
    /// samples around it. Pixels that no sample fits are shaded, in larger blocks one of 2 x 2.
    #[default]
    Light,
    /// Samples hold colours. Continuous patches through the samples join them, guided by geometry;
    /// exact where radiance is linear.
    Smooth,
    /// Samples hold colours. Four taps interpolate them, as in the original method.
    Paper,
    /// Samples hold colours. Each pixel takes its block's sample.
    Nearest,
}

/// Coarsest level of the renderer: blocks of 256 x 256 pixels.
pub const COARSEST_LEVEL: u8 = 8;
