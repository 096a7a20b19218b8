//! What a program around the renderer needs: scenes, cameras and settings from the command line and
//! from files, a graphics adapter, pictures, a clock, a terminal, and failures as one paragraph.
//!
//! The `foveal` program and its benches share it. Each module stands alone; [`drawing`] joins them
//! to a scene that is drawn moment by moment.
#![deny(unsafe_code)]
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test may stop at once"))]

pub mod atomic_file;
pub mod camera;
pub mod claims;
pub mod clock;
pub mod command_line;
pub mod console;
pub mod culling;
pub mod difference;
pub mod drawing;
pub mod environment;
pub mod failure;
pub mod gpu;
pub mod import_args;
pub mod linear_picture;
pub mod memory;
pub mod picture;
pub mod progress;
pub mod rate_image;
pub mod scene_source;
pub mod settings;
pub mod text_file;
pub mod values;
pub mod video;
