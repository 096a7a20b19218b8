//! What an example does with its command line.

use super::arguments::Arguments;
use super::figures::Picture;
use super::house::House;
use super::level::Level;
use super::modes::Mode;
use super::place::Place;
use super::{figures, window};
use bevy::prelude::{Msaa, UVec2};
use std::path::Path;
use std::process::exit;

/// Opens a window on the house that the command line says, `default` where it says nothing; with
/// `--frames` prints what each of the ways of culling costs instead.
pub fn run(name: &str, default: House, modes: &[Mode]) {
    let arguments = Arguments::read();
    let house = House {
        side: arguments.number("side", default.side),
        furniture: arguments.number("furniture", default.furniture),
        doors: default.doors,
        lights: arguments.number("lights", default.lights),
        range: arguments.number("range", default.range),
    };
    run_in(name, &arguments, house, house.lights, modes);
}

/// The same in the level that the command line names.
#[expect(clippy::print_stderr, reason = "a program says what is wrong")]
pub fn run_level(name: &str, modes: &[Mode]) {
    let arguments = Arguments::read();
    let Some(file) = arguments.file() else {
        eprintln!("Which level? cargo run --example {name} -- FILE.glb");
        exit(2)
    };
    let lights = arguments.number("lights", 0);
    let level = Level::open(Path::new(file), lights);
    if lights == 0 {
        run_in(name, &arguments, level, lights, modes);
    } else {
        let modes = [modes, &[Mode::All]].concat();
        run_in(name, &arguments, level, lights, &modes);
    }
}

fn run_in(
    name: &str,
    arguments: &Arguments,
    place: impl Place + Clone,
    lights: usize,
    modes: &[Mode],
) {
    let picture = Picture {
        size: arguments.size(UVec2::new(640, 360)),
        msaa: Msaa::from_samples(arguments.number("msaa", 1)),
        from: arguments.number("from", 0.0),
        save: arguments.text("save").map(Into::into),
    };
    match arguments.frames() {
        Some(frames) => figures::print(place, lights, &picture, frames, modes),
        None => window::run(name, place, &picture),
    }
}
