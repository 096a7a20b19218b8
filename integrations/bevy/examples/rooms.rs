//! A walk through a house of many rooms.
//!
//! `cargo run --example rooms` opens a window: 1, 2, 3 and 4 switch the way of culling (the frustum
//! alone, Bevy's GPU culling, this crate's for the camera, and for lights too), O shows the overlay,
//! space stops the walk. `-- --frames 100` draws without a window instead and prints what each way costs. `--size 640x360`,
//! `--side 12` (rooms along each side), `--furniture 30` (pieces a room) and `--lights 2` (with
//! shadows) change the scene, `--msaa 4` its samples.

mod shared;

use shared::example;
use shared::house::House;
use shared::modes::Mode;

fn main() {
    let house = House {
        side: 12,
        furniture: 30,
        doors: false,
        lights: 0,
        range: 15.0,
    };
    example::run("rooms", house, &Mode::OF_CAMERAS);
}
