//! Light of things that move, with shadows off: nothing announces where it changes.

use foveal_scene::{Camera, Light, LightKind, Material, Scene};
use glam::{Mat4, Vec3};

use crate::forward::twin::quads;
use crate::testing::{Film, f32_of_half, shifted, small, texels};
use crate::{RateSource, Settings, Shading};

/// A board before a wall, and a lamp that it is moved past.
fn scene() -> Scene {
    let material = Material {
        metallic: 0.0,
        double_sided: true,
        ..Material::default()
    };
    let mut scene = quads(vec![material.clone(), material], &[0.0, -1.0]);
    scene.instances[1].world_from_object *= Mat4::from_scale(Vec3::new(6.0, 6.0, 1.0));
    scene.lights = vec![Light {
        kind: LightKind::Point,
        color: Vec3::ONE,
        intensity: 10.0,
        position: Vec3::new(0.0, 0.0, 0.8),
        direction: -Vec3::Y,
        range_m: Some(3.0),
        node: None,
    }];
    move_board(
        &mut scene,
        Mat4::from_translation(Vec3::new(-2.0, 0.0, 0.0)),
    );
    scene
}

fn move_board(scene: &mut Scene, at: Mat4) {
    scene.instances[0].world_from_object = at;
    scene.instances[0].bounds = scene.meshes[0].bounds.transformed(at);
    scene.objects[0].bounds = scene.instances[0].bounds;
}

/// Mean difference of what a moving board shows and what full shading shows of it, in parts of the
/// latter. The camera goes by `steps` metres a frame, before which the pose is set so many `times`.
fn error(settings: &Settings, steps: f32, times: usize, at: impl Fn(f32) -> Mat4) -> f32 {
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 6.0), Vec3::ZERO, Vec3::Y, 0.8);
    let full = settings.clone().with(|s| s.shading.mode = Shading::Full);
    let mut scene = scene();
    let mut films = [Film::new(&scene, settings), Film::new(&scene, &full)];
    let (mut off, mut all) = (0.0, 0.0);
    for frame in 0..24 {
        move_board(&mut scene, at(frame as f32));
        let radiance = films.each_mut().map(|film| {
            for _ in 0..times {
                pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
            }
            film.draw(&shifted(&camera, steps * frame as f32));
            film.radiance()
        });
        let gbuffer = &films[1].renderer.targets().gbuffer;
        let identity: Vec<[u32; 2]> = texels(&gbuffer.identity_view);
        let pixels = radiance[0].iter().zip(&radiance[1]).zip(identity);
        for ((a, b), _) in pixels.filter(|(_, who)| frame > 0 && who[0] & 0xfff == 1) {
            let [a, b] = [a, b].map(|texel| f32_of_half(texel[0]));
            off += (a - b).abs();
            all += b;
        }
    }
    assert!(all > 0.0);
    off / all
}

#[test]
fn what_moves_or_turns_has_the_light_of_where_it_is() {
    let to = |x: f32, z: f32| Mat4::from_translation(Vec3::new(x, 0.0, z));
    let slides = |frame: f32| to(-2.0 + 0.16 * frame, 0.0);
    // By less than an eighth of a pixel a frame, for which light would drift along.
    let creeps = |frame: f32| to(0.3 + 0.006 * frame, 0.0);
    let turns = |frame: f32| to(0.4, 0.0) * Mat4::from_rotation_y(0.06 * frame);
    // Along the line of sight: its pixels hardly move.
    let approaches = |frame: f32| to(0.0, -0.9 + 0.06 * frame);
    for level in [0, 2] {
        let with = |history| {
            small(157, 101).with(|s| {
                s.shading.mode = Shading::Coarse;
                s.coarse.source = RateSource::Constant;
                s.coarse.constant_level = level;
                s.coarse.history = history;
            })
        };
        for (way, steps, at) in [
            ("slides", 0.0, &slides as &dyn Fn(f32) -> _),
            ("creeps", 0.0, &creeps),
            ("turns", 0.0, &turns),
            ("approaches", 0.0, &approaches),
            ("slides past a camera that moves", 0.02, &slides),
        ] {
            // Of poses that are set twice the second one shows nothing in motion.
            for times in [1, 2] {
                let [kept, anew] =
                    [true, false].map(|history| error(&with(history), steps, times, at));
                println!("MOVES level {level}, it {way}, poses {times} times: {kept}, {anew}");
                assert!(
                    kept < 1.5 * anew + 0.02,
                    "level {level}, it {way}, poses {times} times: {kept}, {anew}"
                );
            }
        }
    }
}

/// The shares of pixels that are shaded while a board slides and the camera goes by `steps` metres a
/// frame, all of it `away` from the origin.
fn shaded_shares(away: Vec3, steps: f32) -> Vec<f64> {
    let settings = small(480, 270).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = 1;
        s.coarse.history = true;
    });
    let there = Mat4::from_translation(away);
    let mut scene = scene();
    scene.lights[0].position += away;
    let wall = &mut scene.instances[1];
    wall.world_from_object = there * wall.world_from_object;
    wall.bounds = scene.meshes[0].bounds.transformed(wall.world_from_object);
    scene.objects[1].bounds = wall.bounds;
    let mut film = Film::new(&scene, &settings);
    let shares = (0..8_u16).map(|frame| {
        let frame = f32::from(frame);
        let board = there * Mat4::from_translation(Vec3::new(0.02 * frame - 0.6, 0.0, 0.0));
        move_board(&mut scene, board * Mat4::from_scale(Vec3::splat(0.2)));
        pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
        let eye = away + Vec3::new(steps * frame, 0.1, 0.8);
        let camera = Camera::look_at(eye, away + Vec3::NEG_Z, Vec3::Y, 0.8);
        film.draw(&camera).coarse.unwrap().shaded_fraction
    });
    shares.skip(1).collect()
}

#[test]
fn what_rests_keeps_its_light_far_from_the_origin_too() {
    for steps in [0.0, 0.01] {
        let near = shaded_shares(Vec3::ZERO, steps);
        for away in [1e4, 5e4] {
            let far = shaded_shares(Vec3::new(away, 0.0, away), steps);
            println!("KEEPS by {steps} m: {near:.3?}, {away} m away {far:.3?}");
            let [near, far] = [&near, &far].map(|shares| shares.iter().sum::<f64>());
            assert!(
                far < 1.2 * near,
                "by {steps} m, {away} m away: {near}, {far}"
            );
        }
    }
}
