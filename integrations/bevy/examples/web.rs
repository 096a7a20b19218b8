//! A walk through a house in a browser, drawn by WebGL 2.
//!
//! `./run bevy-web` in the repository's root builds it, packs it into a page and tests that in
//! Chromium; `node web/serve.mjs 8000 integrations/bevy/target/page` then serves the page. What the
//! page calls is in `page`. Elsewhere than in a browser the same walk opens in a window.

mod shared;

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy_foveal_cull::{CpuOcclusionPlugin, CpuOcclusionStats};
use shared::house::House;
use shared::modes::Mode;
use shared::place::Place;
use shared::twice::Twice;

/// Metres that the walker goes in a second.
const PACE: f32 = 2.4;

const HOUSE: House = House {
    side: 6,
    furniture: 20,
    doors: false,
    lights: 1,
    range: 15.0,
};

fn main() {
    let window = Window {
        title: "bevy_foveal_cull".into(),
        canvas: Some("#walk".into()),
        resolution: (640, 360).into(),
        ..default()
    };
    App::new()
        .add_plugins((
            DefaultPlugins.set(WindowPlugin {
                primary_window: Some(window),
                ..default()
            }),
            CpuOcclusionPlugin,
        ))
        .add_systems(Startup, setup)
        .add_systems(Update, (obey, walk, step).chain())
        .add_systems(Last, (Twice::note, report).chain())
        .run();
}

fn setup(world: &mut World) {
    HOUSE.spawn(world);
    world.spawn((Camera3d::default(), Tonemapping::Reinhard, Msaa::Off));
    Mode::All.set(world);
}

/// Goes on with the walk, unless two walks are being compared.
fn walk(
    time: Res<Time>,
    twice: Option<Res<Twice>>,
    mut camera: Single<&mut Transform, With<Camera3d>>,
) {
    if twice.is_none() {
        **camera = Place::walker(&HOUSE, time.elapsed_secs() * PACE % HOUSE.length());
    }
}

fn step(world: &mut World) {
    Twice::step(world, &HOUSE);
}

/// Does what the page has asked for.
fn obey(world: &mut World) {
    let asked = page::take_orders();
    if let Some(culling) = asked.culling {
        let mode = if culling { Mode::All } else { Mode::Frustum };
        mode.set(world);
    }
    if let Some(samples) = asked.samples {
        let mut cameras = world.query_filtered::<&mut Msaa, With<Camera3d>>();
        for mut msaa in cameras.iter_mut(world) {
            *msaa = Msaa::from_samples(samples);
        }
    }
    if let Some(frames) = asked.compare {
        world.insert_resource(Twice::new(frames, [Mode::Frustum, Mode::All]));
    }
}

/// Tells the page what was done.
fn report(mut commands: Commands, stats: Res<CpuOcclusionStats>, twice: Option<Res<Twice>>) {
    page::say_stats(stats_as_json(&stats));
    if let Some(twice) = twice.filter(|twice| twice.is_done()) {
        let found = twice.compare();
        page::say_comparison(format!(
            "{{\"frames\": {}, \"missing\": {}, \"differ\": {}, \"most_pixels\": {}, \
             \"moved\": {}, \"culled\": {}}}",
            found.frames,
            found.missing,
            found.differ,
            found.most_pixels,
            found.moved,
            stats_as_json(&twice.culled),
        ));
        commands.remove_resource::<Twice>();
    }
}

fn stats_as_json(stats: &CpuOcclusionStats) -> String {
    let time = stats.update_time + stats.camera_time + stats.light_time;
    format!(
        "{{\"meshes\": {}, \"meshes_hidden\": {}, \"casters\": {}, \"casters_hidden\": {}, \
         \"casters_unseen\": {}, \"refused_views\": {}, \"culler_ms\": {:.3}}}",
        stats.meshes,
        stats.meshes_hidden,
        stats.casters,
        stats.casters_hidden,
        stats.casters_unseen,
        stats.refused_views,
        time.as_secs_f64() * 1e3,
    )
}

/// What the page and the walk say to each other: they take turns on one thread.
#[allow(dead_code, unreachable_pub, reason = "the page calls functions")]
mod page {
    use std::sync::{Mutex, PoisonError};
    #[cfg(target_arch = "wasm32")]
    use wasm_bindgen::prelude::wasm_bindgen;

    /// What the page has asked for since the last frame.
    #[derive(Default)]
    pub struct Orders {
        /// Culling on or off.
        pub culling: Option<bool>,
        /// Samples a pixel.
        pub samples: Option<u32>,
        /// Two walks of so many frames, without culling and with it.
        pub compare: Option<usize>,
    }

    static ORDERS: Mutex<Orders> = Mutex::new(Orders {
        culling: None,
        samples: None,
        compare: None,
    });
    static STATS: Mutex<String> = Mutex::new(String::new());
    static COMPARISON: Mutex<String> = Mutex::new(String::new());

    fn with<T, R>(cell: &Mutex<T>, act: impl FnOnce(&mut T) -> R) -> R {
        act(&mut cell.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub fn take_orders() -> Orders {
        with(&ORDERS, core::mem::take)
    }

    pub fn say_stats(json: String) {
        with(&STATS, |said| *said = json);
    }

    pub fn say_comparison(json: String) {
        with(&COMPARISON, |said| *said = json);
    }

    /// Switches culling on or off.
    #[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
    pub fn set_culling(on: bool) {
        with(&ORDERS, |orders| orders.culling = Some(on));
    }

    /// Starts two walks of so many frames, without culling and with it, at 1 or 4 samples a pixel.
    #[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
    pub fn compare(frames: usize, samples: u32) {
        let samples = if samples == 4 { 4 } else { 1 };
        with(&ORDERS, |orders| {
            orders.compare = Some(frames.clamp(1, 1000));
            orders.samples = Some(samples);
        });
        with(&COMPARISON, String::clear);
    }

    /// What the two walks have shown, as JSON; empty until they are over.
    #[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
    pub fn comparison() -> String {
        with(&COMPARISON, |said| said.clone())
    }

    /// What was culled in the last frame, as JSON; empty before the first.
    #[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
    pub fn stats() -> String {
        with(&STATS, |said| said.clone())
    }
}
