//! Levels of coarse shading, and what they ask for.

use crate::shading::lighting_constants;
use crate::{CoarseBackend, CoarseSample, Composite, Settings};

/// Most levels that there can be.
pub(crate) const LEVELS: u32 = crate::COARSEST_LEVEL as u32 + 1;

/// Whether some stage visits tiles by lists.
pub(super) fn needs_lists(settings: &Settings) -> bool {
    settings.coarse.backend != CoarseBackend::Stencil
        || settings.coarse.composite == Composite::Smooth
}

/// Settings that change the shading shaders.
fn shading_constants(settings: &Settings) -> Vec<(&'static str, f64)> {
    let mut constants = lighting_constants(settings);
    let typical = settings.coarse.sample == CoarseSample::Typical;
    constants.push(("TYPICAL", f64::from(u8::from(typical))));
    constants
}

/// The shading pipeline for larger blocks and that for single pixels, by their constants. They are the
/// same where samples hold no light.
pub(super) fn by_size<P: Clone>(
    settings: &Settings,
    pipeline: impl Fn(&[(&'static str, f64)]) -> P,
) -> [P; 2] {
    let mut constants = shading_constants(settings);
    let of_blocks = pipeline(&constants);
    if settings.coarse.composite != Composite::Light {
        return [of_blocks.clone(), of_blocks];
    }
    constants.push(("SINGLE_PIXELS", 1.0));
    [of_blocks, pipeline(&constants)]
}
