//! A limit of what a frame draws into the atlas: tiles wait, and all of them get there.

use foveal_generate as generate;
use foveal_scene::{Camera, Scene};
use glam::Vec3;

use super::culling_tests::{market, shift, walked};
use super::tests::shadowed;
use crate::testing::{Film, picture, rendered, shifted};
use crate::{Culling, Settings, Shading, ShadowSizes, ShadowStats, Shadows};

/// Frames in which light history shades each pixel of a still picture once.
const ROUND: u64 = 16;

fn limited(triangles: u32) -> Settings {
    shadowed(Shadows::Hard).with(|s| {
        s.lighting.shadow_budget = triangles;
        s.culling.mode = Culling::Occlusion;
    })
}

/// A part of the market.
fn stalls() -> Scene {
    let options = generate::DemoOptions {
        instances: 1_000,
        lights: 5,
        ..Default::default()
    };
    generate::demo(&options).expect("it is generated")
}

/// Draws a film's next frame.
fn draw(film: &mut Film, camera: &Camera) -> (Vec<u8>, ShadowStats) {
    let stats = film.draw(camera).shadows.expect("shadows are on");
    (picture(&film.renderer), stats)
}

/// The same in another pose.
fn draw_pose(film: &mut Film, scene: &Scene, camera: &Camera) -> (Vec<u8>, ShadowStats) {
    pollster::block_on(film.renderer.update_pose(scene)).expect("the pose fits");
    draw(film, camera)
}

/// Draws a still camera's frames until no tile waits; the picture of the last one.
fn settle(film: &mut Film, camera: &Camera) -> (Vec<u8>, u64) {
    for frames in 1..500 {
        let (shown, stats) = draw(film, camera);
        if stats.tiles_waiting == 0 {
            return (shown, frames);
        }
        assert!(stats.tiles_drawn > 0, "one at least: {stats:?}");
    }
    panic!("tiles wait for ever");
}

/// Bytes that differ, and the most by which they do.
fn off(a: &[u8], b: &[u8]) -> (usize, u8) {
    let off = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    off.fold((0, 0), |(count, most), d| {
        (count + usize::from(d > 0), most.max(d))
    })
}

#[test]
fn a_frame_stops_at_its_budget_and_a_still_camera_sees_all_shadows_in_the_end() {
    let scene = market();
    let budget = 3_000;
    let mut film = Film::new(&scene, &limited(budget));
    let (first, stats) = draw(&mut film, &scene.cameras[0]);
    let unlimited = rendered(&scene, &scene.cameras[0], &limited(0));
    assert!(
        first == picture(&unlimited),
        "a first frame draws all tiles"
    );
    assert!(stats.triangles > u64::from(10 * budget) && stats.tiles_waiting == 0);
    // No tile has more triangles than the scene.
    let triangles = |mesh: usize| scene.meshes[mesh].indices.len() as u64 / 3;
    let largest: u64 = (scene.instances.iter())
        .map(|i| triangles(i.mesh as usize))
        .sum();
    let (mut waiting, mut most) = (0, 0);
    for step in 1..6 {
        let (_, stats) = draw(&mut film, &walked(&scene, step));
        waiting = waiting.max(stats.tiles_waiting);
        most = most.max(stats.triangles);
        assert!(stats.tiles_waiting == 0 || stats.triangles >= u64::from(budget));
    }
    assert!(waiting > 10, "{waiting} tiles wait");
    assert!(most < u64::from(budget) + largest, "{most} triangles");
    let there = walked(&scene, 5);
    let (shown, frames) = settle(&mut film, &there);
    assert!(frames > 3, "{frames} frames");
    let (count, by) = off(&shown, &picture(&rendered(&scene, &there, &limited(0))));
    // A tile that lies elsewhere is rasterized with other rounding.
    assert!(count < 40 && by < 40, "{count} bytes differ, by up to {by}");
    let (again, stats) = draw(&mut film, &there);
    assert!(again == shown && stats.tiles_drawn == 0);
}

#[test]
fn tiles_that_see_a_thing_move_show_what_they_held_and_each_has_its_turn() {
    let mut scene = stalls();
    let camera = scene.cameras[0].clone();
    let mut film = Film::new(&scene, &limited(1));
    let mut unlimited = Film::new(&scene, &limited(0));
    let (before, stats) = draw(&mut film, &camera);
    let tiles = stats.tiles;
    draw(&mut unlimited, &camera);
    let (mut longest, mut busiest, mut expected) = (0, 0, Vec::new());
    let instances = scene.instances.len();
    for _ in 0..2 * tiles + 10 {
        shift(
            &mut scene,
            (0..instances).step_by(13),
            Vec3::new(0.004, 0.0, 0.002),
        );
        let (_, stats) = draw_pose(&mut film, &scene, &camera);
        assert!(stats.tiles_drawn == 1, "{stats:?}");
        longest = longest.max(stats.longest_wait);
        let all = draw_pose(&mut unlimited, &scene, &camera);
        expected = all.0;
        assert_eq!(all.1.tiles_waiting, 0);
        busiest = busiest.max(all.1.tiles_drawn);
    }
    // One after the other, so that none waits for longer than all others take.
    assert!(
        busiest > 5 && longest + 1 >= busiest,
        "{longest} frames, {busiest} tiles"
    );
    assert!(longest <= tiles, "{longest} frames, {tiles} tiles");
    let (shown, _) = settle(&mut film, &camera);
    assert!(before != shown);
    assert_eq!(off(&shown, &expected), (0, 0));
}

#[test]
fn tiles_of_a_light_that_has_moved_do_not_wait() {
    let mut scene = stalls();
    let camera = scene.cameras[0].clone();
    let mut film = Film::new(&scene, &limited(1));
    let mut unlimited = Film::new(&scene, &limited(0));
    draw(&mut film, &camera);
    draw(&mut unlimited, &camera);
    for step in 0..6 {
        for light in &mut scene.lights {
            light.position.x += 0.05;
            light.direction = (light.direction + Vec3::new(0.02, 0.0, 0.0)).normalize();
        }
        let (shown, stats) = draw_pose(&mut film, &scene, &camera);
        let (expected, all) = draw_pose(&mut unlimited, &scene, &camera);
        assert!(
            stats.tiles_drawn > 5 && stats.tiles_drawn == all.tiles_drawn,
            "{step}"
        );
        assert_eq!(off(&shown, &expected), (0, 0));
    }
}

#[test]
fn light_that_is_kept_follows_tiles_that_are_drawn_late() {
    let mut scene = stalls();
    let camera = scene.cameras[0].clone();
    let settings = |budget| {
        limited(budget).with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.history = true;
        })
    };
    let mut film = Film::new(&scene, &settings(1));
    let mut unlimited = Film::new(&scene, &settings(0));
    for step in 0..4 {
        let instances = scene.instances.len();
        shift(
            &mut scene,
            (0..instances).step_by(31),
            Vec3::new(0.1, 0.0, 0.05),
        );
        let camera = shifted(&camera, 0.02 * step as f32);
        draw_pose(&mut film, &scene, &camera);
        draw_pose(&mut unlimited, &scene, &camera);
    }
    let there = shifted(&camera, 0.06);
    let (_, frames) = settle(&mut film, &there);
    assert!(
        frames > ROUND,
        "{frames}: every pixel is shaded before the last tile is drawn"
    );
    // The frame that drew the last tile knew: to the next one nothing is new.
    draw(&mut film, &there);
    let history = film.renderer.history();
    assert!(history.parameters.reset == 0 && history.changed_places.is_empty());
    let shown = |film: &mut Film| (0..ROUND + 2).map(|_| draw(film, &there).0).last();
    let (shown, expected) = (shown(&mut film), shown(&mut unlimited));
    let (count, by) = off(&shown.expect("frames"), &expected.expect("frames"));
    assert!(count < 40 && by < 40, "{count} bytes differ, by up to {by}");
}

#[test]
fn a_limit_that_no_frame_reaches_changes_nothing() {
    let scene = market();
    // With a limit, tiles of other sizes stay.
    let sizes = |settings: Settings| {
        settings.with(|s| {
            s.lighting.shadow_sizes = ShadowSizes::Rate;
            s.shading.mode = Shading::Coarse;
        })
    };
    let mut film = Film::new(&scene, &sizes(limited(100_000_000)));
    let mut unlimited = Film::new(&scene, &sizes(limited(0)));
    for step in 0..4 {
        let camera = walked(&scene, step);
        let (a, b) = (draw(&mut film, &camera), draw(&mut unlimited, &camera));
        assert!(a.0 == b.0, "frame {step}");
        assert_eq!(a.1, b.1);
    }
}
