//! A walk through a level from a glTF file, whose walls and floors are found to occlude.
//!
//! `cargo run --example level -- FILE.glb` opens a window: 1, 2, 3 and 4 switch the way of culling
//! (the frustum alone, Bevy's GPU culling, this crate's for the camera, and for lights too), O shows
//! the overlay, space stops the walk. `--frames 100` draws without a window instead and prints what
//! each way costs. `--size 640x360` and `--msaa 4` change the picture, `--lights 2` adds point lights
//! with shadows along the way, `--from 30` begins after so many metres, `--save FOLDER` writes the
//! first and the last picture of each way.

mod shared;

use shared::example;
use shared::modes::Mode;

fn main() {
    example::run_level("level", &Mode::OF_CAMERAS);
}
