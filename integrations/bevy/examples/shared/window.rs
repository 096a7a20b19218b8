//! A walk through a house in a window: keys switch the way of culling, the title shows what it does.

use super::house::{Door, House};
use super::modes::Mode;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::diagnostic::{DiagnosticsStore, FrameTimeDiagnosticsPlugin};
use bevy::prelude::*;
use bevy_foveal_cull::{CpuOcclusionPlugin, CpuOcclusionStats};

/// Opens the window: 1, 2, 3 and 4 switch the way of culling, space stops the walk.
pub fn run(name: &str, house: House, size: UVec2, msaa: Msaa) {
    let window = Window {
        title: name.into(),
        resolution: (size.x, size.y).into(),
        ..default()
    };
    App::new()
        .add_plugins((
            DefaultPlugins.set(WindowPlugin {
                primary_window: Some(window),
                ..default()
            }),
            FrameTimeDiagnosticsPlugin::default(),
            CpuOcclusionPlugin,
        ))
        .insert_resource(Walk {
            house,
            rooms: 0.0,
            stopped: false,
            mode: Mode::All,
            msaa,
        })
        .add_systems(Startup, setup)
        .add_systems(Update, (keys, walk, swing, title))
        .run();
}

#[derive(Resource)]
struct Walk {
    house: House,
    rooms: f32,
    stopped: bool,
    mode: Mode,
    msaa: Msaa,
}

fn setup(world: &mut World) {
    let Walk {
        house, mode, msaa, ..
    } = *world.resource::<Walk>();
    house.spawn(world);
    world.spawn((Camera3d::default(), Tonemapping::Reinhard, msaa));
    mode.set(world);
}

fn keys(world: &mut World) {
    let keys = world.resource::<ButtonInput<KeyCode>>();
    let stop = keys.just_pressed(KeyCode::Space);
    let chosen = [
        (KeyCode::Digit1, Mode::Frustum),
        (KeyCode::Digit2, Mode::Gpu),
        (KeyCode::Digit3, Mode::Camera),
        (KeyCode::Digit4, Mode::All),
    ]
    .into_iter()
    .find(|(key, _)| keys.just_pressed(*key));
    world.resource_mut::<Walk>().stopped ^= stop;
    if let Some((_, mode)) = chosen {
        world.resource_mut::<Walk>().mode = mode;
        mode.set(world);
    }
}

fn walk(
    time: Res<Time>,
    mut walk: ResMut<Walk>,
    mut camera: Single<&mut Transform, With<Camera3d>>,
) {
    let end = (walk.house.side * walk.house.side - 1) as f32;
    if !walk.stopped {
        walk.rooms = (walk.rooms + time.delta_secs() * 0.4) % end;
    }
    **camera = walk.house.walker(walk.rooms);
}

fn swing(time: Res<Time>, mut doors: Query<(&Door, &mut Transform)>) {
    for (door, mut leaf) in &mut doors {
        *leaf = door.at(time.elapsed_secs());
    }
}

fn title(
    walk: Res<Walk>,
    stats: Res<CpuOcclusionStats>,
    diagnostics: Res<DiagnosticsStore>,
    mut window: Single<&mut Window>,
) {
    let frame = diagnostics
        .get(&FrameTimeDiagnosticsPlugin::FRAME_TIME)
        .and_then(|d| d.smoothed())
        .unwrap_or_default();
    window.title = format!(
        "{}: {frame:.1} ms; {} of {} meshes hidden, {} of {} casters; culled in {:.2} ms",
        walk.mode.name(),
        stats.meshes_hidden,
        stats.meshes,
        stats.casters_hidden,
        stats.casters,
        (stats.update_time + stats.camera_time + stats.light_time).as_secs_f64() * 1e3,
    );
}
