//! Coarse shading that is off, or compared with full shading.

use foveal_generate as generate;
use foveal_scene::{Camera, Scene};

use crate::testing::{Film, picture, rendered, shifted, small};
use crate::{
    CoarseBackend, CoarseStats, Composite, FrameStats, Geometry, RateSource, Settings, Shading,
    Stereo,
};

const SIZE: (u32, u32) = (121, 83);

fn scene() -> Scene {
    let mut scene = generate::by_name("demo:1000").expect("a scene of that name");
    generate::add_point_lights(&mut scene, 20, 5);
    scene
}

fn coarse() -> Settings {
    small(SIZE.0, SIZE.1).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.backend = CoarseBackend::Compute;
        s.coarse.source = RateSource::Radii;
        s.coarse.fovea_inner = 0.1;
        s.coarse.fovea_outer = 1.0;
    })
}

fn ways() -> [Settings; 5] {
    [
        coarse().with(|s| s.coarse.history = true),
        coarse().with(|s| {
            s.coarse.history = true;
            s.geometry.path = Geometry::Visibility;
        }),
        coarse(),
        coarse().with(|s| s.coarse.composite = Composite::Smooth),
        // Materials at samples too.
        coarse().with(|s| {
            s.coarse.composite = Composite::Smooth;
            s.geometry.path = Geometry::Visibility;
        }),
    ]
}

fn stats(frame: FrameStats) -> CoarseStats {
    frame.coarse.expect("coarse shading")
}

/// The picture of every pixel shaded.
fn full(scene: &Scene, camera: &Camera, settings: &Settings) -> Vec<u8> {
    let settings = settings.clone().with(|s| s.shading.mode = Shading::Full);
    picture(&rendered(scene, camera, &settings))
}

#[test]
fn while_it_is_off_pictures_are_full_shadings() {
    let scene = scene();
    let camera = &scene.cameras[0];
    for settings in ways() {
        let mut film = Film::new(&scene, &settings);
        film.draw(camera);
        film.renderer.turn_coarse_off();
        for x in [0.1, 0.2] {
            let camera = shifted(camera, x);
            let stats = stats(film.draw(&camera));
            assert!(!stats.active && stats.notice.contains("--force-rate true"));
            assert_eq!(
                (stats.shaded_fraction, stats.shaded_samples()),
                (1.0, 121 * 83)
            );
            let now = picture(&film.renderer);
            assert!(now == full(&scene, &camera, &settings), "{settings:?}");
        }
    }
}

#[test]
fn while_it_is_off_and_all_rests_nothing_is_shaded_again() {
    let mut scene = scene();
    let camera = scene.cameras[0].clone();
    let settings = &ways()[0];
    let mut film = Film::new(&scene, settings);
    film.renderer.turn_coarse_off();
    film.draw(&camera);
    let first = picture(&film.renderer);
    for _ in 0..3 {
        let stats = stats(film.draw(&camera));
        assert_eq!((stats.shaded_fraction, stats.shaded_samples()), (0.0, 0));
        assert!(picture(&film.renderer) == first);
    }
    // Lights that change are seen at once.
    for light in &mut scene.lights {
        light.intensity *= 3.0;
    }
    pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
    assert_eq!(stats(film.draw(&camera)).shaded_fraction, 1.0);
    let changed = picture(&film.renderer);
    assert!(changed != first);
    assert!(changed == full(&scene, &camera, settings));
    assert_eq!(stats(film.draw(&camera)).shaded_fraction, 0.0);
}

#[test]
fn without_history_it_comes_back_only_while_something_moves() {
    let mut scene = generate::cornell();
    let camera = &scene.cameras[0].clone();
    let settings = coarse().with(|s| (s.picture.width, s.picture.height) = (16, 9));
    let mut film = Film::new(&scene, &settings);
    let is_active =
        |film: &mut Film, x: u16| stats(film.draw(&shifted(camera, 1e-3 * f32::from(x)))).active;
    film.renderer.turn_coarse_off();
    assert!((0..300).all(|_| !is_active(&mut film, 0)));
    assert!((0..300).any(|x| is_active(&mut film, x)));
    film.renderer.turn_coarse_off();
    let mut posed = |film: &mut Film| {
        scene.lights[0].intensity *= 0.999;
        pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
        is_active(film, 299)
    };
    assert!((0..300).any(|_| posed(&mut film)));
}

#[test]
fn light_is_kept_anew_after_it_was_off() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let settings = &ways()[0];
    let mut film = Film::new(&scene, settings);
    film.draw(camera);
    film.renderer.turn_coarse_off();
    film.draw(&shifted(camera, 0.5));
    film.renderer.compare_coarse();
    let there = shifted(camera, 0.6);
    assert!(stats(film.draw(&there)).active);
    // As a first frame: nothing of what was kept before is used.
    assert!(picture(&film.renderer) == picture(&rendered(&scene, &there, settings)));
}

#[test]
fn comparing_changes_no_picture_and_tells_both_times() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let eyes = coarse().with(|s| s.stereo.mode = Stereo::Instanced);
    for settings in ways().into_iter().chain([eyes]) {
        let [mut plain, mut comparing] = [0; 2].map(|_| Film::new(&scene, &settings));
        comparing.renderer.compare_coarse();
        for x in [0.0, 0.1] {
            let camera = shifted(camera, x);
            let without = stats(plain.draw(&camera));
            let with = stats(comparing.draw(&camera));
            assert!(picture(&plain.renderer) == picture(&comparing.renderer));
            assert_eq!(without.samples_per_level, with.samples_per_level);
            assert_eq!(without.full_ms, 0.0);
            assert!(with.full_ms > 0.0 && with.coarse_ms > 0.0, "{with:?}");
        }
    }
}
