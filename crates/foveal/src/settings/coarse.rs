//! Choices about coarse pixel shading: how finely which place is shaded, by what means, and how the samples
//! are joined to a picture.

use serde::{Deserialize, Serialize};

use super::{Settings, View};
use crate::Error;

/// How many samples the deferred stage shades.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shading {
    /// One per pixel: the reference.
    #[default]
    Full,
    /// One per square block of pixels, the blocks' sizes taken from the rate map.
    Coarse,
    /// One per 1 x 1, 2 x 1, 1 x 2 or 2 x 2 pixels, as the picture's content allows.
    Variable,
}

/// By what means coarse samples are visited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Backend {
    /// Whichever the first frames show to be faster here.
    #[default]
    Auto,
    /// Full-screen draws per level behind a stencil test.
    Stencil,
    /// Lists of blocks and indirect dispatches.
    Compute,
}

/// Where wished levels come from. Level l asks for one sample per 2^l x 2^l pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RateSource {
    /// What the eye resolves: the angle to the gaze on [`Settings::display`], for [`Settings::quality`].
    #[default]
    Foveated,
    /// The distance to the gaze in pixels, between [`Settings::fovea_inner`] and [`Settings::fovea_outer`]: the map of coarse
    /// shading's source.
    Radii,
    /// [`Settings::rate_level`] everywhere.
    Constant,
    /// A picture stretched over the frame: black asks for every pixel, white for the coarsest level.
    Image,
    /// The contrast of the frame before; for [`Shading::Variable`] alone.
    Content,
    /// The lens of the headset output: coarser where the screen has fewer pixels.
    Lens,
}

/// What becomes of the second source of wishes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RateCombine {
    /// It is not looked at.
    #[default]
    First,
    /// Per pixel the coarser wish holds.
    Coarser,
    /// Per pixel the finer wish holds.
    Finer,
}

/// Where geometric edges are shaded more finely than wished.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RefineEdges {
    /// Two levels finer than wished, everywhere.
    #[default]
    Graded,
    /// Pixel by pixel outside the periphery: where the wish is at most half the coarsest level.
    Inner,
    /// Pixel by pixel everywhere.
    Everywhere,
    /// Nowhere.
    Off,
}

/// Which of its pixels a block's sample looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CoarseSample {
    /// The one at the centre.
    #[default]
    Center,
    /// That of five whose depth and normal are nearest to the five's average.
    Typical,
}

/// How samples become pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Composite {
    /// Samples hold light, freed of the surface's own colour; each pixel's own surface is put into the light of the samples
    /// around it. Pixels that no sample speaks for are shaded.
    #[default]
    Light,
    /// Samples hold colours, joined by continuous patches through them, guided by geometry; exact where radiance is linear.
    Smooth,
    /// Four taps, as in the technique's source.
    Paper,
    /// The block's sample as it is.
    Nearest,
}

/// The coarsest level that the renderer knows: blocks of 256 x 256 pixels.
pub const COARSEST_LEVEL: u8 = 8;

/// Checks the settings of coarse shading.
pub(super) fn validate(s: &Settings) -> Result<(), Error> {
    let wrong = |name, value: String, expected| {
        Err(Error::Setting {
            name,
            value,
            expected,
        })
    };
    let shows_tiles = matches!(s.view, View::Rate | View::Blocks | View::Shaded);
    if shows_tiles && s.shading == Shading::Full {
        let value = format!("{:?}", s.view).to_lowercase();
        return wrong("view", value, "another one unless shading is coarse");
    }
    for (name, level) in [
        ("coarsest-level", s.coarsest_level),
        ("rate-level", s.rate_level),
    ] {
        if level > COARSEST_LEVEL {
            return wrong(name, level.to_string(), "between 0 and 8");
        }
    }
    if !s.gaze.iter().all(|g| g.is_finite() && g.abs() <= 16.0) {
        let value = format!("{},{}", s.gaze[0], s.gaze[1]);
        return wrong("gaze", value, "two numbers between -16 and 16");
    }
    for (name, value) in [
        ("fovea-inner", s.fovea_inner),
        ("fovea-outer", s.fovea_outer),
    ] {
        if !(0.0..=1000.0).contains(&value) {
            return wrong(name, value.to_string(), "between 0 and 1000");
        }
    }
    if !(0.1..=10.0).contains(&s.fovea_curve) {
        return wrong(
            "fovea-curve",
            s.fovea_curve.to_string(),
            "between 0.1 and 10",
        );
    }
    Ok(())
}
