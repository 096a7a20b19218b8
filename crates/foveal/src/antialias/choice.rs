//! Which way of anti-aliasing settings ask for.

use super::pattern::Pattern;
use crate::{Antialiasing, Composite, EdgeTest, Geometry, SamplePattern, Settings, Shading};

/// Whether the settings ask for this way.
pub(crate) fn by_triangles(settings: &Settings) -> bool {
    settings.antialiasing.mode == Antialiasing::Msaa
        && settings.geometry.path == Geometry::Visibility
        && settings.antialiasing.edge_test == EdgeTest::Surface
        && settings.antialiasing.pattern == SamplePattern::Grid
}

/// Whether every pixel's colour is a mean of all the surfaces that it shows. Coarse shading leaves the
/// pixels of its blocks alone where samples hold colours, and where sub-samples alone would be seen.
pub(crate) fn averages_all(settings: &Settings) -> bool {
    settings.shading.mode != Shading::Coarse
        || (settings.coarse.composite == Composite::Light
            && settings.antialiasing.mode == Antialiasing::Msaa)
}

/// Whether pixels' means follow the rates of every frame.
pub(crate) fn follows_rates(settings: &Settings) -> bool {
    settings.antialiasing.mode != Antialiasing::None && !averages_all(settings)
}

/// Whether lobes are added to pixels in which their surfaces are black: where the pixel's colour is a
/// mean of all its surfaces. Where it is that of the largest or of the first sub-sample they are laid
/// over.
pub(crate) fn adds_lobes(settings: &Settings) -> bool {
    let finds_all = match settings.antialiasing.mode {
        Antialiasing::None => false,
        Antialiasing::Ssaa => true,
        Antialiasing::Msaa => settings.antialiasing.edge_test == EdgeTest::Surface,
    };
    finds_all && averages_all(settings)
}

/// Side of what a pixel's textures are filtered over, in pixels, where its material is evaluated
/// once for n x n sub-samples: n x n trilinear samples of 1 / n each, 1 / n apart, blur as much as
/// one of this size. In variances: one of size s has s^2 / 4 (a mip level's box and the filter's
/// tent), their places (1 - 1 / n^2) / 12.
pub(crate) fn footprint(settings: &Settings) -> Option<f64> {
    let samples = f64::from(Pattern::of(settings).count());
    by_triangles(settings).then(|| ((1.0 + 2.0 / samples) / 3.0).sqrt())
}
