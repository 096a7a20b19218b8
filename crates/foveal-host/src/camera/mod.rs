//! Where each frame is seen from: flags, paths in files, and views from within buildings.

mod args;
mod inside;
mod path;
mod viewpoint;

pub use args::CameraArgs;
pub(crate) use args::check_direction;
pub use path::CameraPath;
pub(crate) use viewpoint::of_every_scene;
pub use viewpoint::{Viewpoint, near_m};
