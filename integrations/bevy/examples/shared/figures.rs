//! What ways of culling cost and gain: the same frames drawn by each in turn.

use super::headless::{Headless, pixels_that_differ};
use super::house::{Door, House};
use super::modes::Mode;
use bevy::prelude::*;
use bevy_foveal_cull::CpuOcclusionStats;
use std::time::Duration;

/// Walks through the house and prints a table.
#[expect(clippy::print_stdout, reason = "that is what it is for")]
pub fn print(house: House, size: UVec2, msaa: Msaa, frames: usize, modes: &[Mode]) {
    let mut meshes = 0;
    let mut apps: Vec<Headless> = modes
        .iter()
        .map(|mode| {
            Headless::new(size, msaa, |world| {
                meshes = house.spawn(world);
                mode.set(world);
            })
        })
        .collect();
    println!(
        "{meshes} meshes, {} lights with shadows, {}x{} pixels, {} samples a pixel, {frames} \
         frames\n",
        house.lights,
        size.x,
        size.y,
        msaa.samples()
    );
    let mut times = vec![Vec::new(); modes.len()];
    let mut culling = vec![Vec::new(); modes.len()];
    let mut wrong = vec![(0, 0); modes.len()];
    let mut sums = vec![CpuOcclusionStats::default(); modes.len()];
    for frame in 0..frames {
        let rooms = frame as f32 * 0.05;
        let mut first = Vec::new();
        for (i, app) in apps.iter_mut().enumerate() {
            let camera = app.camera;
            let world = app.world();
            if let Some(mut pose) = world.get_mut::<Transform>(camera) {
                *pose = house.walker(rooms);
            }
            let mut doors = world.query::<(&Door, &mut Transform)>();
            for (door, mut leaf) in doors.iter_mut(world) {
                *leaf = door.at(frame as f32 * 0.05);
            }
            // The first frames upload everything and compile shaders.
            for _ in 0..if frame == 0 { 5 } else { 0 } {
                app.frame();
            }
            times[i].push(app.frame());
            let stats = *app.world().resource::<CpuOcclusionStats>();
            culling[i].push(stats.update_time + stats.camera_time + stats.light_time);
            sums[i].meshes += stats.meshes;
            sums[i].meshes_hidden += stats.meshes_hidden;
            sums[i].casters += stats.casters;
            sums[i].casters_hidden += stats.casters_hidden;
            let picture = app.picture();
            if i == 0 {
                first = picture;
            } else {
                let pixels = pixels_that_differ(&first, &picture);
                wrong[i].0 += usize::from(pixels > 0);
                wrong[i].1 = pixels.max(wrong[i].1);
            }
        }
    }
    println!(
        "| culling | frame, median ms | of the first | culler, median ms | meshes to draw | \
         casters to draw | frames that differ | most pixels |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let whole = median(&mut times[0]);
    for (i, mode) in modes.iter().enumerate() {
        let time = median(&mut times[i]);
        let each = |sum: usize| sum as f64 / frames.max(1) as f64;
        let of = |all: usize, hidden: usize| match all {
            0 => "".into(),
            _ => format!("{:.0} of {:.0}", each(all - hidden), each(all)),
        };
        println!(
            "| {} | {:.1} | {:.2} | {:.2} | {} | {} | {} | {} |",
            mode.name(),
            ms(time),
            ms(time) / ms(whole),
            ms(median(&mut culling[i])),
            of(sums[i].meshes, sums[i].meshes_hidden),
            of(sums[i].casters, sums[i].casters_hidden),
            wrong[i].0,
            wrong[i].1,
        );
    }
}

fn median(times: &mut [Duration]) -> Duration {
    times.sort_unstable();
    times.get(times.len() / 2).copied().unwrap_or_default()
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
