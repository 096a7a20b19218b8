//! What the examples and the picture tests share: a house, a walk, and Bevy without a window.
#![allow(dead_code, reason = "each example and test uses a part of it")]
#![allow(unreachable_pub, reason = "a module of a program")]

pub mod arguments;
pub mod example;
pub mod figures;
pub mod headless;
pub mod house;
pub mod level;
pub mod modes;
pub mod paths;
pub mod place;
pub mod window;
