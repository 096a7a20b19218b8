//! How far two pictures are apart: FLIP, and what an eye sees at a display.

mod flip;
mod nearness;

pub use flip::{ErrorMap, magma};
pub use nearness::{BENCH_DISPLAY, Nearness, jod, pixels};
