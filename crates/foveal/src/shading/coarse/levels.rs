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
pub(super) fn shading_constants(settings: &Settings) -> Vec<(&'static str, f64)> {
    let mut constants = lighting_constants(settings);
    let typical = settings.coarse.sample == CoarseSample::Typical;
    constants.push(("TYPICAL", f64::from(u8::from(typical))));
    constants
}
