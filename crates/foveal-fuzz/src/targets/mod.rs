//! Targets: what each of them does with an input, and the good inputs that it begins with.

mod c_calls;
mod cameras;
mod culler;
mod environment;
mod import;
mod list;
mod mesh_bytes;
mod records;
mod report;
mod scenes;
mod settings;
mod world;

pub use c_calls::c_calls;
pub use cameras::cameras;
pub use culler::culler;
pub use environment::environment;
pub use import::import;
pub use list::{TARGETS, Target};
pub use mesh_bytes::mesh_bytes;
pub use records::records;
pub use report::report;
pub use settings::settings;
pub use world::world;
