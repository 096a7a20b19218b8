//! What ways of culling cost and gain: the same frames drawn by each in turn.

use super::headless::Headless;
use super::house::Door;
use super::modes::Mode;
use super::place::Place;
use super::twice::pixels_that_differ;
use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy_foveal_cull::CpuOcclusionStats;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What to draw, and from where on.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Pixels.
    pub size: UVec2,
    /// Samples a pixel.
    pub msaa: Msaa,
    /// Where the walk begins, metres.
    pub from: f32,
    /// Where to save the first and the last picture of each way.
    pub save: Option<PathBuf>,
}

/// Metres that the walker goes in a frame.
const PACE: f32 = 0.3;

/// Walks through a place and prints a table.
#[expect(clippy::print_stdout, reason = "that is what it is for")]
pub fn print(
    place: impl Place + Clone,
    lights: usize,
    picture: &Picture,
    frames: usize,
    modes: &[Mode],
) {
    let (size, msaa) = (picture.size, picture.msaa);
    let mut ready = place.clone();
    let mut apps: Vec<Headless> = modes
        .iter()
        .map(|mode| {
            let mut place = place.clone();
            let mut app = Headless::new(size, msaa, |world| place.spawn(world));
            while !place.is_ready(app.world()) {
                app.frame();
            }
            mode.set(app.world());
            ready = place;
            app
        })
        .collect();
    let place = ready;
    let meshes = apps.first_mut().map_or(0, |app| {
        let world = app.world();
        world.query::<&Mesh3d>().iter(world).count()
    });
    println!(
        "{meshes} meshes, {lights} lights with shadows, {}x{} pixels, {} samples a pixel, {frames} \
         frames, {:.0} to {:.0} m of a walk of {:.0} m\n",
        size.x,
        size.y,
        msaa.samples(),
        picture.from,
        picture.from + PACE * frames as f32,
        place.length(),
    );
    let mut times = vec![Vec::new(); modes.len()];
    let mut culling = vec![Vec::new(); modes.len()];
    let mut wrong = vec![(0, 0); modes.len()];
    let mut sums = vec![CpuOcclusionStats::default(); modes.len()];
    for frame in 0..frames {
        let mut first = Vec::new();
        for (i, app) in apps.iter_mut().enumerate() {
            let camera = app.camera;
            let world = app.world();
            if let Some(mut pose) = world.get_mut::<Transform>(camera) {
                *pose = place.walker(picture.from + PACE * frame as f32);
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
            sums[i].casters_hidden += stats.casters_hidden + stats.casters_unseen;
            let drawn = app.picture();
            if let Some(folder) = picture
                .save
                .as_ref()
                .filter(|_| [0, frames - 1].contains(&frame))
            {
                save(&drawn, size, &folder.join(format!("{frame}-{i}.png")));
            }
            if i == 0 {
                first = drawn;
            } else {
                let pixels = pixels_that_differ(&first, &drawn);
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

/// Writes a picture as PNG.
fn save(rgba: &[u8], size: UVec2, file: &Path) {
    let extent = Extent3d {
        width: size.x,
        height: size.y,
        depth_or_array_layers: 1,
    };
    let format = TextureFormat::Rgba8UnormSrgb;
    let usages = RenderAssetUsages::MAIN_WORLD;
    let image = Image::new(extent, TextureDimension::D2, rgba.to_vec(), format, usages);
    image
        .try_into_dynamic()
        .expect("RGBA is a picture")
        .save(file)
        .expect("the folder can be written to");
}
