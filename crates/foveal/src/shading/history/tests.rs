//! What light that is kept from frame to frame must keep to.

use foveal_generate as generate;
use foveal_scene::{Camera, Scene};

use glam::UVec2;

use super::lit::ROUND;
use super::targets::HistoryTargets;
use super::twin::{Before, Fate, Seen};
use crate::stereo::EyeLayout;
use crate::testing::{
    Film, f32_of_half, rate_cells, rendered, rounds_alike, shifted, small, texels,
};
use crate::{Antialiasing, FrameStats, Geometry, RateSource, Renderer, Settings, Shading, Stereo};

const SIZE: (u32, u32) = (157, 101);

pub(super) fn scene() -> Scene {
    let mut scene = generate::by_name("demo:1000").expect("a scene of that name");
    generate::add_point_lights(&mut scene, 20, 5);
    scene
}

pub(super) fn kept() -> Settings {
    small(SIZE.0, SIZE.1).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.history = true;
        // Small pictures have few levels by what the eye resolves.
        s.coarse.source = RateSource::Radii;
        s.coarse.fovea_inner = 0.1;
        s.coarse.fovea_outer = 1.0;
    })
}

/// The eyes' radiances, without what lies between their pictures.
pub(super) fn seen(renderer: &Renderer) -> Vec<[u16; 4]> {
    let layout = EyeLayout::of(renderer.settings());
    let texels: Vec<[u16; 4]> = texels(&renderer.targets().radiance_view);
    let rows = texels.chunks_exact(layout.target_size().0 as usize);
    let width = layout.width as usize;
    rows.flat_map(|row| {
        let eyes = (0..layout.eyes).map(|eye| (eye * layout.stride) as usize);
        eyes.flat_map(|first| row[first..first + width].to_vec())
            .collect::<Vec<_>>()
    })
    .collect()
}

/// The same frame with every pixel shaded: by a map of pixels where there are two eyes, whose
/// pictures' places in the target depend on the way of shading.
fn full(scene: &Scene, camera: &Camera, settings: &Settings) -> Vec<[u16; 4]> {
    let settings = settings.clone().with(|s| {
        s.shading.mode = if settings.stereo.mode == Stereo::Off {
            Shading::Full
        } else {
            Shading::Coarse
        };
        s.coarse.history = false;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = 0;
    });
    seen(&rendered(scene, camera, &settings))
}

/// The same frame with samples reshaded.
fn anew(scene: &Scene, camera: &Camera, settings: &Settings) -> Vec<[u16; 4]> {
    let settings = settings.clone().with(|s| s.coarse.history = false);
    seen(&rendered(scene, camera, &settings))
}

/// Mean difference of radiances, each at most 1.
fn error(a: &[[u16; 4]], b: &[[u16; 4]]) -> f64 {
    let channels = |texel: &[u16; 4]| [0, 1, 2].map(|c| f64::from(f32_of_half(texel[c])).min(1.0));
    let sum: f64 = (a.iter().zip(b))
        .map(|(a, b)| {
            let pairs = channels(a).into_iter().zip(channels(b));
            pairs.map(|(a, b)| (a - b).abs()).sum::<f64>()
        })
        .sum();
    sum / (3 * a.len()) as f64
}

pub(super) fn differing(a: &[[u16; 4]], b: &[[u16; 4]]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

fn shaded(stats: &FrameStats) -> f64 {
    stats
        .coarse
        .as_ref()
        .expect("coarse shading")
        .shaded_fraction
}

fn turned(camera: &Camera, radians: f32) -> Camera {
    let mut camera = camera.clone();
    camera.world_from_view *= glam::Mat4::from_rotation_y(radians);
    camera
}

#[test]
fn at_rest_the_picture_becomes_full_shadings_and_nothing_more_is_shaded() {
    let scene = scene();
    let camera = &scene.cameras[0];
    for settings in [
        kept(),
        kept().with(|s| s.geometry.path = Geometry::Visibility),
        kept().with(|s| s.stereo.mode = Stereo::Instanced),
        kept().with(|s| s.coarse.coarsest_level = 4),
        kept().with(|s| s.antialiasing.mode = Antialiasing::Msaa),
        kept().with(|s| {
            s.antialiasing.mode = Antialiasing::Msaa;
            s.geometry.path = Geometry::Visibility;
        }),
    ] {
        let mut film = Film::new(&scene, &settings);
        for frame in 0..4 {
            film.draw(&shifted(camera, 0.02 * frame as f32));
        }
        let there = shifted(camera, 0.06);
        let full = full(&scene, &there, &settings);
        assert!(differing(&seen(&film.renderer), &full) > 1000);
        let mut sum = 0.0;
        for _ in 0..ROUND {
            sum += shaded(&film.draw(&there));
        }
        assert!(sum <= 1.0 + 1e-9 && sum > 0.5, "each pixel once: {sum}");
        let Settings {
            geometry,
            stereo,
            antialiasing,
            ..
        } = &settings;
        // Full shading is another shader, whose last bits may differ.
        let most = if rounds_alike() { 0 } else { 10 };
        let off = differing(&seen(&film.renderer), &full);
        assert!(
            off <= most,
            "{geometry:?} {stereo:?} {antialiasing:?}: {off}"
        );
        for _ in 0..2 {
            assert_eq!(shaded(&film.draw(&there)), 0.0);
            assert_eq!(differing(&seen(&film.renderer), &full), off);
        }
    }
}

#[test]
fn samples_by_blocks_take_no_memory_beside_kept_light() {
    let scene = generate::cornell();
    let bytes = |history| {
        let settings = small(1280, 720).with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.history = history;
        });
        let mut film = Film::new(&scene, &settings);
        film.draw(&scene.cameras[0]);
        let targets = film.renderer.targets();
        let coarse = targets.coarse.as_ref().expect("coarse shading");
        let kept = coarse.history.as_ref().map_or(0, HistoryTargets::bytes);
        (coarse.bytes() - kept) as f64 / (1280.0 * 720.0)
    };
    let [own, beside] = [false, true].map(bytes);
    assert!(
        own > 30.0 && beside < 10.0,
        "{own} and {beside} bytes a pixel"
    );
}

#[test]
fn the_first_frame_is_that_of_samples_shaded_anew() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let mut film = Film::new(&scene, &kept());
    film.draw(camera);
    let anew = anew(&scene, camera, &kept());
    let off = error(&seen(&film.renderer), &anew);
    assert!(off < 1e-4, "{off}");
}

#[test]
fn while_the_camera_moves_less_is_shaded_and_the_picture_is_no_worse() {
    let scene = scene();
    let camera = &scene.cameras[0];
    for settings in [kept(), kept().with(|s| s.stereo.mode = Stereo::TwoPass)] {
        let mut film = Film::new(&scene, &settings);
        let (mut first, mut later, mut errors) = (0.0, 0.0, [0.0; 2]);
        for frame in 0..12 {
            let there = turned(&shifted(camera, 0.02 * frame as f32), 0.002 * frame as f32);
            let lit = shaded(&film.draw(&there));
            if frame == 0 {
                first = lit;
            } else if frame > 5 {
                later += lit / 6.0;
                let full = full(&scene, &there, &settings);
                errors[0] += error(&seen(&film.renderer), &full);
                errors[1] += error(&anew(&scene, &there, &settings), &full);
            }
        }
        println!("shaded {first:.3}, later {later:.3}; errors {errors:?}");
        assert!(later < 0.6 * first, "{later} of {first}");
        assert!(errors[0] < 1.3 * errors[1], "{errors:?}");
    }
}

#[test]
fn a_lamp_that_goes_out_leaves_nothing_behind() {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 3, 5);
    let camera = scene.cameras[0].clone();
    let mut film = Film::new(&scene, &kept());
    for frame in 0..6 {
        film.draw(&shifted(&camera, 0.01 * frame as f32));
    }
    let there = shifted(&camera, 0.06);
    let lit = full(&scene, &there, &kept());
    for lamp in &mut scene.lights[1..] {
        lamp.intensity = 0.0;
    }
    pollster::block_on(film.renderer.update_pose(&scene)).expect("the pose fits");
    film.draw(&there);
    let dark = full(&scene, &there, &kept());
    let gone = error(&lit, &dark);
    let left = error(&seen(&film.renderer), &dark);
    let anew = error(&anew(&scene, &there, &kept()), &dark);
    println!("went out {gone:.5}, left {left:.5}, anew {anew:.5}");
    assert!(gone > 0.01);
    assert!(left <= 1.1 * anew + 0.02 * gone, "{left} {anew}");
}

/// Errors of the picture after a cut to a view that is turned so far, and of a new renderer's there.
fn after_a_cut(radians: f32) -> (f64, f64) {
    let scene = scene();
    let camera = &scene.cameras[0];
    let mut film = Film::new(&scene, &kept());
    for frame in 0..3 {
        film.draw(&shifted(camera, 0.02 * frame as f32));
    }
    let elsewhere = turned(&shifted(camera, 3.0), radians);
    film.draw(&elsewhere);
    let full = full(&scene, &elsewhere, &kept());
    let anew = error(&anew(&scene, &elsewhere, &kept()), &full);
    (error(&seen(&film.renderer), &full), anew)
}

#[test]
fn a_cut_remembers_nothing() {
    let (left, anew) = after_a_cut(2.5);
    assert!(left <= 1.001 * anew, "{left} {anew}");
    // Here both views show some of the scene. 0.0123 is a new renderer's error where it interpolates
    // the samples that disagree, too: what is kept may be as far off.
    let (left, anew) = after_a_cut(1.0);
    assert!(left <= 1.25 * anew.max(0.0123), "{left} {anew}");
}

#[test]
fn a_gaze_that_jumps_sees_every_pixel_in_the_next_frame() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let left = kept().with(|s| s.eye.gaze = [0.1, 0.5]);
    let right = left.clone().with(|s| s.eye.gaze = [0.9, 0.5]);
    let mut film = Film::new(&scene, &left);
    for frame in 0..4 {
        film.draw(&shifted(camera, 0.001 * frame as f32));
    }
    pollster::block_on(film.renderer.set_settings(&right)).expect("a gaze is only a setting");
    let there = shifted(camera, 0.004);
    let stats = film.draw(&there);
    assert!(shaded(&stats) < 0.9);
    let full = full(&scene, &there, &right);
    let found = seen(&film.renderer);
    let around = (-3..3).flat_map(|x| (-3..3).map(move |y| (50 + y) * 157 + 141 + x));
    let (mut same, mut pixels) = (0, 0);
    for at in around.map(|at: i32| at as usize) {
        // A pixel whose own light is kept is as good.
        let channels = |texel: [u16; 4]| [0, 1, 2].map(|c| f32_of_half(texel[c]));
        for (a, b) in channels(found[at]).into_iter().zip(channels(full[at])) {
            assert!((a - b).abs() <= 0.02 * b + 0.01, "pixel {at}: {a} {b}");
        }
        same += usize::from(found[at] == full[at]);
        pixels += 1;
    }
    assert!(same * 10 >= pixels * 9, "{same} of {pixels}");
}

#[test]
fn once_every_pixel_is_shaded_the_eyes_may_look_anywhere() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let looks = |x: f32| kept().with(|s| s.eye.gaze = [x, 0.5]);
    let look = |film: &mut Film, x: f32| {
        let there = looks(x);
        pollster::block_on(film.renderer.set_settings(&there)).expect("a gaze is only a setting");
    };
    let mut film = Film::new(&scene, &looks(0.1));
    film.draw(camera);
    // Trackers tremble.
    for frame in 0..ROUND {
        look(&mut film, 0.1 + 0.004 * (frame % 3) as f32);
        film.draw(camera);
    }
    let full = full(&scene, camera, &kept());
    assert_eq!(differing(&seen(&film.renderer), &full), 0);
    for x in [0.9, 0.2, 0.85] {
        look(&mut film, x);
        assert_eq!(shaded(&film.draw(camera)), 0.0);
        assert_eq!(differing(&seen(&film.renderer), &full), 0, "gaze {x}");
    }
    // All light is a pixel's own, whatever blocks it lay in where the eyes looked before.
    let stats = film.draw(&shifted(camera, 0.001));
    assert!(shaded(&stats) < 0.1, "{}", shaded(&stats));
}

/// The sum of what all pixels show.
fn total(picture: &[[u16; 4]]) -> f64 {
    let channels = |texel: &[u16; 4]| texel.map(|bits| f64::from(f32_of_half(bits)));
    let light = |[r, g, b, _]: [f64; 4]| r + g + b;
    picture.iter().map(|texel| light(channels(texel))).sum()
}

#[test]
fn daylight_in_lux_is_kept_whole() {
    let mut scene = generate::cornell();
    let sun = foveal_scene::Light {
        kind: foveal_scene::LightKind::Directional,
        color: glam::Vec3::ONE,
        intensity: 1.2e5,
        direction: glam::Vec3::new(0.3, -0.4, -1.0).normalize(),
        ..scene.lights[0].clone()
    };
    scene.lights = vec![sun];
    let camera = scene.cameras[0].clone();
    let settings = kept().with(|s| {
        s.picture.exposure_stops = -15.0;
        s.coarse.fovea_inner = 0.0;
        s.coarse.fovea_outer = 0.1;
    });
    let mut film = Film::new(&scene, &settings);
    for frame in 0..4 {
        let there = shifted(&camera, 0.01 * frame as f32);
        film.draw(&there);
        let full = total(&full(&scene, &there, &settings));
        let ratio = total(&seen(&film.renderer)) / full;
        assert!((ratio - 1.0).abs() < 0.03, "frame {frame}: {ratio}");
    }
}

#[test]
fn metals_of_another_colour_mirror_light_of_it_at_once() {
    let mut scene = generate::cornell();
    let paint = |scene: &mut Scene, color: [f32; 4]| {
        for material in &mut scene.materials {
            (material.metallic, material.roughness) = (1.0, 0.5);
            material.base_color = color.into();
        }
    };
    paint(&mut scene, [0.9, 0.0, 0.0, 1.0]);
    let camera = scene.cameras[0].clone();
    let settings = kept().with(|s| s.lighting.environment = crate::EnvironmentSource::None);
    let mut film = Film::new(&scene, &settings);
    for _ in 0..3 {
        film.draw(&camera);
    }
    paint(&mut scene, [0.0, 0.9, 0.0, 1.0]);
    pollster::block_on(film.renderer.update_pose(&scene)).expect("the pose fits");
    film.draw(&camera);
    let anew = total(&anew(&scene, &camera, &settings));
    let ratio = total(&seen(&film.renderer)) / anew;
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

#[test]
fn frames_are_the_same_every_time() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let mut films = [0, 1].map(|_| Film::new(&scene, &kept()));
    for frame in 0..6 {
        let there = turned(&shifted(camera, 0.03 * frame as f32), 0.004 * frame as f32);
        for film in &mut films {
            film.draw(&there);
        }
        assert!(
            seen(&films[0].renderer) == seen(&films[1].renderer),
            "frame {frame}"
        );
    }
}

#[test]
fn other_ways_of_shading_keep_nothing() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    for settings in [
        kept().with(|s| s.coarse.backend = crate::CoarseBackend::Stencil),
        kept().with(|s| s.coarse.composite = crate::Composite::Paper),
        kept().with(|s| s.picture.view = crate::DebugView::Blocks),
    ] {
        assert!(kept().keeps_light() && !settings.keeps_light());
        let mut film = Film::new(&scene, &settings);
        film.draw(camera);
        let first = seen(&film.renderer);
        assert!(shaded(&film.draw(camera)) > 0.0);
        assert_eq!(differing(&seen(&film.renderer), &first), 0);
    }
}

pub(super) fn kept_targets(film: &Film) -> &HistoryTargets {
    let coarse = film.renderer.targets().coarse.as_ref();
    let history = coarse.and_then(|coarse| coarse.history.as_ref());
    history.expect("light is kept")
}

#[test]
fn what_is_carried_and_what_is_shaded_equal_their_twin() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let settings = kept();
    let mut film = Film::new(&scene, &settings);
    let at = |frame: i32| turned(&shifted(camera, 0.03 * frame as f32), 0.004 * frame as f32);
    film.draw(&at(0));
    let mut fates = [0; 4];
    for frame in 1..6 {
        let [now, previous] = [at(frame), at(frame - 1)];
        // Gathering light overwrites what was kept.
        let last = usize::from(!film.renderer.history().lit.even);
        let kept = kept_targets(&film);
        let (light, seen) = (texels(&kept.light[last]), texels(&kept.seen[last]));
        let stats = film.draw(&now);
        let kept = kept_targets(&film);
        let before = Before {
            light,
            seen,
            tiles: texels(&kept.tiles),
        };
        let targets = film.renderer.targets();
        let owner = &targets.coarse.as_ref().expect("coarse shading").rate.owner;
        let owner = rate_cells(owner, 1);
        let frame_seen = Seen {
            size: UVec2::new(SIZE.0, SIZE.1),
            surface: texels(&targets.gbuffer.surface_view),
            depth: texels(&targets.gbuffer.depth_view),
            identity: texels(&targets.gbuffer.identity_view),
            owner,
        };
        let parameters = film.renderer.history().parameters;
        let found: Vec<u32> = texels(&kept.seen[1 - last]);
        let (mut shaded, mut bare, mut off) = (0, 0, 0);
        for (i, &found) in (0..).zip(&found) {
            let texel = UVec2::new(i % SIZE.0, i / SIZE.0);
            let (fate, remembers) =
                frame_seen.reproject([&now, &previous], &before, &parameters, texel);
            fates[fate as usize] += 1;
            shaded += u64::from(fate == Fate::Shaded);
            bare += u64::from(fate == Fate::Bare);
            // The distance's last bit may round either way.
            let distance = |bits: u32| f64::from(f32::from_bits((bits & 0xfffe_0000) >> 1));
            let same = found & 0x1_ffff == remembers & 0x1_ffff
                && (distance(found) - distance(remembers)).abs() <= 0.008 * distance(found);
            off += usize::from(!same);
        }
        // Thresholds may be met by one and missed by the other.
        assert!(off * 200 <= found.len(), "frame {frame}: {off} differ");
        let coarse = stats.coarse.expect("coarse shading");
        let blocks: u64 = coarse.samples_per_level[1..].iter().sum();
        assert!(coarse.samples_per_level[0].abs_diff(shaded) <= 80);
        assert!(blocks > 0 && blocks <= bare + 80, "{blocks} {bare}");
    }
    assert!(fates.iter().all(|&n| n > 100), "{fates:?}");
}
