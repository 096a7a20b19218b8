//! A walk through a house in a window: keys switch the way of culling, the title shows what it does.

use super::figures::Picture;
use super::house::Door;
use super::modes::Mode;
use super::place::Place;
use bevy::asset::{AssetPlugin, UnapprovedPathMode};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::diagnostic::{DiagnosticsStore, FrameTimeDiagnosticsPlugin};
use bevy::prelude::*;
use bevy_foveal_cull::{
    CpuOcclusionOverlay, CpuOcclusionOverlayCamera, CpuOcclusionPlugin, CpuOcclusionStats,
};

/// Opens the window: 1, 2, 3 and 4 switch the way of culling, O the overlay, space stops the walk.
pub fn run(name: &str, place: impl Place, picture: &Picture) {
    let window = Window {
        title: name.into(),
        resolution: (picture.size.x, picture.size.y).into(),
        ..default()
    };
    App::new()
        .add_plugins((
            DefaultPlugins
                .set(WindowPlugin {
                    primary_window: Some(window),
                    ..default()
                })
                .set(AssetPlugin {
                    unapproved_path_mode: UnapprovedPathMode::Allow,
                    ..default()
                }),
            FrameTimeDiagnosticsPlugin::default(),
            CpuOcclusionPlugin,
        ))
        .insert_resource(Walk {
            place: Box::new(place),
            ready: false,
            metres: picture.from,
            stopped: false,
            mode: Mode::All,
            msaa: picture.msaa,
        })
        .add_systems(Startup, setup)
        .add_systems(Update, (load, keys, walk, swing, title))
        .run();
}

#[derive(Resource)]
struct Walk {
    place: Box<dyn Place>,
    ready: bool,
    metres: f32,
    stopped: bool,
    mode: Mode,
    msaa: Msaa,
}

fn setup(world: &mut World) {
    world.resource_scope(|world, mut walk: Mut<Walk>| {
        walk.place.spawn(world);
        world.spawn((Camera3d::default(), Tonemapping::Reinhard, walk.msaa));
    });
}

fn load(world: &mut World) {
    world.resource_scope(|world, mut walk: Mut<Walk>| {
        if !walk.ready && walk.place.is_ready(world) {
            walk.ready = true;
            walk.mode.set(world);
        }
    });
}

fn keys(world: &mut World) {
    let keys = world.resource::<ButtonInput<KeyCode>>();
    let stop = keys.just_pressed(KeyCode::Space);
    let overlay = keys.just_pressed(KeyCode::KeyO);
    let chosen = [
        (KeyCode::Digit1, Mode::Frustum),
        (KeyCode::Digit2, Mode::Gpu),
        (KeyCode::Digit3, Mode::Camera),
        (KeyCode::Digit4, Mode::All),
    ]
    .into_iter()
    .find(|(key, _)| keys.just_pressed(*key));
    world.resource_mut::<Walk>().stopped ^= stop;
    if overlay {
        match world.remove_resource::<CpuOcclusionOverlay>() {
            Some(_) => {}
            None => world.insert_resource(CpuOcclusionOverlay::default()),
        }
    }
    if let Some((_, mode)) = chosen {
        world.resource_mut::<Walk>().mode = mode;
        mode.set(world);
    }
}

fn walk(
    time: Res<Time>,
    mut walk: ResMut<Walk>,
    mut camera: Single<&mut Transform, (With<Camera3d>, Without<CpuOcclusionOverlayCamera>)>,
) {
    if !walk.ready {
        return;
    }
    if !walk.stopped {
        walk.metres = (walk.metres + time.delta_secs() * 2.4) % walk.place.length().max(1.0);
    }
    **camera = walk.place.walker(walk.metres);
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
        stats.casters_hidden + stats.casters_unseen,
        stats.casters,
        (stats.update_time + stats.camera_time + stats.light_time).as_secs_f64() * 1e3,
    );
}
