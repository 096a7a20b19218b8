//! Fuzz targets of Foveal: each takes bytes and panics at what must not be.
//!
//! The `foveal-fuzz` program and the tests run them on stable Rust with random changes to good
//! inputs; `fuzz/` in the repository's root runs the same targets under `cargo fuzz`, whose inputs
//! follow the branches that the program takes.
//!
//! ```
//! for target in foveal_fuzz::TARGETS {
//!     (target.run)(b"no good input");
//! }
//! ```
//!
//! Without the feature `renderer`, which is on by default, there are the culler's targets alone.
#![deny(unsafe_code)]

mod campaign;
mod memory;
mod mutate;
mod random;
mod targets;

pub use campaign::{Campaign, Failure, Outcome};
pub use memory::Counting;
pub use targets::{TARGETS, Target, c_calls, culler, mesh_bytes, world};
#[cfg(feature = "renderer")]
pub use targets::{cameras, environment, import, records, report, settings};
