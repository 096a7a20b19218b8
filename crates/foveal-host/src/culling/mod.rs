//! A scene as the culler takes it: occluders, eyes, threads, and the comparison with the reference.

mod args;
mod around;
pub mod camera_file;
mod check;
mod eye;
mod frustum;
pub mod mocrec;
mod occludees;
mod occluders;
mod subject;
mod views;
mod workers;

pub use args::{CullingArgs, ViewArgs};
pub use around::Clock;
pub use check::Check;
pub use eye::NamedEye;
pub use frustum::{clip_position, corners};
pub use occludees::Occludees;
pub use occluders::{Choice, Occluders, Shape};
pub use subject::Subject;
pub use views::{defaults, named_eye, own_cameras};
pub use workers::Workers;
