//! Deferred shading: lighting evaluated at samples.
//!
//! The lighting code is one and the same for all ways of shading; rate, backend and anti-aliasing
//! differ only in the samples that they ask for.

mod balance;
mod coarse;
#[cfg(test)]
pub(crate) mod dielectric;
mod history;
mod pass;
#[cfg(test)]
pub(crate) mod twin;
#[cfg(test)]
mod twin_tests;
#[cfg(test)]
mod unlit_tests;
mod variable;
#[cfg(test)]
pub(crate) use variable::twin::extent as sample_extent;

pub(crate) use crate::formats::RADIANCE_FORMAT;
pub(crate) use balance::{Balance, Compared, RatePlan};
#[cfg(test)]
pub(crate) use coarse::sample_texel;
pub(crate) use coarse::{
    CoarseShading, CoarseTargets, CountPass, LEVELS, LevelNumbers, STENCIL_FORMAT, stencil_state,
};

#[cfg(test)]
pub(crate) use history::HistoryParameters;
pub(crate) use history::{HistoryStage, HistoryTargets};
pub(crate) use pass::{ShadingPass, lighting_constants};
#[cfg(test)]
pub(crate) use variable::RatesUniform;
pub(crate) use variable::{VariableStage, VariableTargets};
