//! A walk through a house of many rooms.
//!
//! `cargo run --example rooms` opens a window: 1, 2, 3 and 4 switch the way of culling (the frustum
//! alone, Bevy's GPU culling, this crate's for the camera, and for lights too), space stops the walk.
//! `-- --frames 100` draws without a window instead and prints what each way costs. `--size 640x360`,
//! `--side 12` (rooms along each side), `--furniture 30` (pieces a room) and `--lights 2` (with
//! shadows) change the scene, `--msaa 4` its samples.

mod shared;

use bevy::prelude::{Msaa, UVec2};
use shared::arguments::Arguments;
use shared::house::House;
use shared::modes::Mode;
use shared::{figures, window};

fn main() {
    let arguments = Arguments::read();
    let house = House {
        side: arguments.number("side", 12),
        furniture: arguments.number("furniture", 30),
        doors: false,
        lights: arguments.number("lights", 0),
    };
    let size = arguments.size(UVec2::new(640, 360));
    let msaa = Msaa::from_samples(arguments.number("msaa", 1));
    match arguments.frames() {
        Some(frames) => {
            let modes = [
                Mode::Frustum,
                Mode::Prepass,
                Mode::Gpu,
                Mode::Camera,
                Mode::CameraPrepass,
            ];
            figures::print(house, size, msaa, frames, &modes);
        }
        None => window::run("rooms", house, size, msaa),
    }
}
