//! What the examples and the picture tests share: a house, a walk, and Bevy without a window.
#![allow(dead_code, reason = "each example and test uses a part of it")]
#![allow(unreachable_pub, reason = "a module of a program")]

pub mod house;
pub mod modes;
pub mod place;
pub mod twice;

// A browser has no command line, and its example no files.
#[cfg(not(target_arch = "wasm32"))]
pub mod arguments;
#[cfg(not(target_arch = "wasm32"))]
pub mod example;
#[cfg(not(target_arch = "wasm32"))]
pub mod figures;
#[cfg(not(target_arch = "wasm32"))]
pub mod headless;
#[cfg(not(target_arch = "wasm32"))]
pub mod level;
#[cfg(not(target_arch = "wasm32"))]
pub mod paths;
#[cfg(not(target_arch = "wasm32"))]
pub mod window;
