//! Scenes made by the project's own code: the demo, the benches' and the tests' scenes.
//!
//! Everything is deterministic: integer hashes give the chance, and trigonometry is the crate's
//! own, so that a scene is the same on every machine. [`by_name`] finds a scene by the name that
//! the command line takes; all other functions give one scene each. Metres, y up; night, but for the yard.

#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test may stop at once"))]

mod alpha;
mod bench;
mod build;
mod cornell;
mod demo;
mod error;
mod hash;
mod lights;
mod lobes;
mod materials_grid;
mod names;
mod registry;
mod surroundings;
mod texture;
mod trig;
mod yard;

pub use alpha::alpha;
pub use bench::{materials, materials2};
pub use cornell::cornell;
pub use demo::{DemoOptions, demo, demo_path};
pub use error::GenerateError;
pub use lights::add_point_lights;
pub use lobes::lobes;
pub use materials_grid::materials_grid;
pub use names::NAMES;
pub use registry::by_name;
pub use surroundings::surroundings;
pub use yard::yard;

#[cfg(test)]
mod tests;
