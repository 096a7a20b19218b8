//! The `foveal` program.
fn main() {}
