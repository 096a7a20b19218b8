//! The renderer behind a web page: two pictures of one scene from one camera, a reference on the
//! left and the chosen settings on the right, divided by a slider.
//!
//! The page (`web/page`) holds the controls, the camera and the clock of frames; this crate holds
//! what must be Rust. Settings and figures cross as JSON, in the words of the native program. Built
//! by `./run web`, once for WebGPU and once, with the feature `webgl`, for browsers that have WebGL
//! 2 alone; on anything but `wasm32` the crate is empty, but for tests.
#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test may stop at once"))]

#[cfg(any(target_arch = "wasm32", test))]
mod camera;
#[cfg(target_arch = "wasm32")]
mod present;
#[cfg(all(target_arch = "wasm32", feature = "webgl"))]
mod pump;
#[cfg(target_arch = "wasm32")]
mod scenes;
#[cfg(target_arch = "wasm32")]
mod side;
#[cfg(target_arch = "wasm32")]
mod table;
#[cfg(target_arch = "wasm32")]
mod viewer;

#[cfg(target_arch = "wasm32")]
pub use viewer::{Viewer, default_settings, rehearse, settings_table};
