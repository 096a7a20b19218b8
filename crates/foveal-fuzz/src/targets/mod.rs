//! Targets: what each of them does with an input, and the good inputs that it begins with.

mod c_arguments;
mod c_calls;
mod c_occludees;
mod c_receivers;
#[cfg(feature = "renderer")]
mod cameras;
mod culler;
#[cfg(feature = "renderer")]
mod environment;
#[cfg(feature = "renderer")]
mod import;
mod list;
mod mesh_bytes;
mod receivers;
#[cfg(feature = "renderer")]
mod records;
#[cfg(feature = "renderer")]
mod report;
mod scenes;
#[cfg(feature = "renderer")]
mod settings;
mod world;

pub use c_calls::c_calls;
#[cfg(feature = "renderer")]
pub use cameras::cameras;
pub use culler::culler;
#[cfg(feature = "renderer")]
pub use environment::environment;
#[cfg(feature = "renderer")]
pub use import::import;
pub use list::{TARGETS, Target};
pub use mesh_bytes::mesh_bytes;
#[cfg(feature = "renderer")]
pub use records::records;
#[cfg(feature = "renderer")]
pub use report::report;
#[cfg(feature = "renderer")]
pub use settings::settings;
pub use world::world;
