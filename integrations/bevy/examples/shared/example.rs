//! What an example does with its command line.

use super::arguments::Arguments;
use super::house::House;
use super::modes::Mode;
use super::{figures, window};
use bevy::prelude::{Msaa, UVec2};

/// Opens a window on the house that the command line says, `default` where it says nothing; with
/// `--frames` prints what each of the ways of culling costs instead.
pub fn run(name: &str, default: House, modes: &[Mode]) {
    let arguments = Arguments::read();
    let house = House {
        side: arguments.number("side", default.side),
        furniture: arguments.number("furniture", default.furniture),
        doors: default.doors,
        lights: arguments.number("lights", default.lights),
    };
    let size = arguments.size(UVec2::new(640, 360));
    let msaa = Msaa::from_samples(arguments.number("msaa", 1));
    match arguments.frames() {
        Some(frames) => figures::print(house, size, msaa, frames, modes),
        None => window::run(name, house, size, msaa),
    }
}
