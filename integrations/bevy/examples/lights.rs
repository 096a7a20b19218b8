//! Point lights with shadows in a house: casters that are hidden from a light, or whose shadow nobody
//! sees, are not drawn for it.
//!
//! `cargo run --example lights` opens a window: 1, 2, 3 and 4 switch the way of culling (the frustum
//! alone, Bevy's GPU culling, this crate's for the camera, and for lights too), O shows the overlay,
//! space stops the walk. `-- --frames 100` draws without a window instead and prints what each way costs. `--size 640x360`,
//! `--side 12` (rooms along each side), `--furniture 30` (pieces a room), `--lights 2` (with
//! shadows) and `--range 15` (how far they shine, metres) change the scene, `--msaa 4` its samples.

mod shared;

use shared::example;
use shared::house::House;
use shared::modes::Mode;

fn main() {
    let house = House {
        side: 8,
        furniture: 30,
        doors: false,
        lights: 2,
        range: 15.0,
    };
    example::run("lights", house, &Mode::OF_LIGHTS);
}
