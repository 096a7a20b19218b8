//! Ambient occlusion: which part of the environment's light reaches a place, as far as the picture's
//! depth tells.
//!
//! One pass looks around at samples: at each pixel, or with coarse shading once per block of the rate
//! map (`horizons.wgsl`). A second one joins nine of them for each pixel (`resolve.wgsl`). What it
//! writes is bound with the environment: `shared/environment.wgsl`, `environment_seen`. The CPU twin
//! is `twin.rs`. The reduced renderer draws both passes (`drawn.rs`), which others dispatch.

mod drawn;
mod stage;
mod targets;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;

pub(crate) use stage::{AmbientStage, OcclusionUniform, Reach};
pub(crate) use targets::{AmbientTargets, visibility_format};
