//! Environment light: the radiance that comes from everywhere besides the lights.
//!
//! An equirectangular picture, the cube of a scene file, or the scene's sky becomes a cube map
//! ([`EnvironmentMap`]):
//! level 0 is the picture, each further level is what a rougher mirror reflects of it
//! (`prefilter.rs`), and nine coefficients give its irradiance (`irradiance.rs`). A table says which
//! part of it a mirror reflects (`reflectance.rs`). All of that is computed on the CPU, once per
//! picture, so that every device has the same values.
//! `shared/environment.wgsl` looks it up; its CPU twin is `twin.rs`.

mod binding;
#[cfg(test)]
mod bounces_tests;
mod cube;
#[cfg(test)]
mod frame_tests;
mod irradiance;
mod map;
mod picture;
mod prefilter;
mod reflectance;
mod stage;
#[cfg(test)]
mod tests;
#[cfg(test)]
pub(crate) mod twin;

pub(crate) use binding::EnvironmentBinding;
pub use map::EnvironmentMap;
pub(crate) use stage::{
    ChosenEnvironment, EnvironmentStage, EnvironmentTerms, ToBind, environment_constants, resolved,
};
