//! Variable shading on the device against its twins, against full shading, and against time.

use foveal_generate as generate;
use foveal_scene::Scene;
use glam::{UVec2, Vec2, Vec3};

use super::probes::{Probe, Probes};
use super::twin::{self, Seen};
use crate::gpu::read_buffer;
use crate::shading::twin::{shade, unpack_surface};
pub(super) use crate::testing::{Film, shifted};
use crate::testing::{f32_of_half, gpu, picture, small, texels};
use crate::{
    Antialiasing, Contrast, DebugView, Geometry, RateCombine, RateSource, RateStage, Settings,
    Shading,
};

/// Odd sizes; the last is smaller than a quad.
const SIZES: [(u32, u32); 3] = [(157, 101), (64, 48), (1, 1)];

fn scene() -> Scene {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 8, 5);
    scene
}

pub(super) fn variable(size: (u32, u32)) -> Settings {
    small(size.0, size.1).with(|s| {
        s.shading.mode = Shading::Variable;
        s.coarse.source = RateSource::Content;
        s.rate.force = true;
    })
}

impl Film {
    pub(super) fn mask(&self) -> Vec<u32> {
        texels(&self.renderer.targets().variable.as_ref().unwrap().mask)
    }

    /// What is known after `frames` frames.
    pub(super) fn known(&self, frames: u32) -> Vec<[u32; 2]> {
        let t = self.renderer.targets().variable.as_ref().unwrap();
        texels(&t.known[usize::from(frames.is_multiple_of(2))])
    }

    pub(super) fn seen(&self) -> Seen {
        let s = self.renderer.settings();
        let g = &self.renderer.targets().gbuffer;
        Seen {
            size: UVec2::new(s.picture.width, s.picture.height),
            identity: texels(&g.identity_view),
            depth: texels(&g.depth_view),
        }
    }
}

/// Values that differ; a rounded one may fall to either side of a threshold.
pub(super) fn differing<T: PartialEq>(a: &[T], b: &[T]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

/// What was reprojected into what is known, whose notes of quads shaded in full must be those of
/// `mask`.
pub(super) fn reprojected(known: &[[u32; 2]], mask: &[u32]) -> Vec<[u32; 2]> {
    let cells = known.iter().zip(mask);
    cells
        .map(|(&[lumas, place], rate)| {
            assert_eq!(place & twin::FULL != 0, rate & 7 == 0);
            [lumas, place & !twin::FULL]
        })
        .collect()
}

/// Quads of which other things are known: luminances may differ by one step, distances by one of
/// theirs.
pub(super) fn known_otherwise(a: &[[u32; 2]], b: &[[u32; 2]]) -> usize {
    let alike = |a: &[u32; 2], b: &[u32; 2]| {
        let bytes = a[0].to_le_bytes().into_iter().zip(b[0].to_le_bytes());
        let [x, y] = [a[1], b[1]].map(twin::distance_of);
        a[1] & 0xffff == b[1] & 0xffff
            && (x - y).abs() <= 0.008 * x
            && bytes.fold(0, |m, (a, b)| m.max(a.abs_diff(b))) <= 1
    };
    a.iter().zip(b).filter(|(a, b)| !alike(a, b)).count()
}

#[test]
fn reprojection_rates_and_samples_equal_their_twins() {
    let scene = scene();
    let camera = &scene.cameras[0];
    for size in SIZES {
        for (contrast, rate_4x4, step) in [
            (Contrast::Quad, false, 0.0),
            (Contrast::Neighbors, true, 0.02),
            (Contrast::Sobel, true, 0.1),
        ] {
            let settings = variable(size).with(|s| {
                s.variable.contrast = contrast;
                s.variable.blocks_4x4 = rate_4x4;
            });
            let mut film = Film::new(&scene, &settings);
            let mut probes = Probes::default();
            film.draw(camera);
            probes.next();
            let mut rates_seen = [0; 8];
            for frame in 1..6 {
                let [now, previous] = [frame, frame - 1].map(|f| shifted(camera, step * f as f32));
                let before = film.known(frame);
                let shown: Vec<[u8; 4]> = picture(&film.renderer).as_chunks().0.to_vec();
                film.draw(&now);
                if step != 0.0 {
                    probes.disturb();
                }
                let probe = probes.next();
                let seen = film.seen();
                let (known, mask) = (film.known(frame + 1), film.mask());
                let reprojected = reprojected(&known, &mask);
                let quads = known.len();
                let twin = twin::reproject(&seen, [&now, &previous], &before, &shown);
                let off = known_otherwise(&reprojected, &twin);
                assert!(off <= quads / 200, "{off} of {quads} known otherwise");
                let twin = twin::rates(&settings, &seen, [&now, &previous], &reprojected, probe);
                let off = differing(&mask, &twin);
                assert!(off <= quads / 400, "{off} of {quads} rates, {contrast:?}");
                mask.iter().for_each(|m| rates_seen[*m as usize & 7] += 1);

                let t = film.renderer.targets().variable.as_ref().unwrap();
                let words = |buffer| -> Vec<u32> {
                    let bytes = pollster::block_on(read_buffer(gpu(), buffer)).unwrap();
                    bytemuck::pod_collect_to_vec(&bytes)
                };
                let count = words(&t.listed)[3];
                let mut listed = words(&t.samples)[..count as usize].to_vec();
                listed.sort_unstable();
                assert_eq!(listed, twin::samples(&mask, seen.size));
            }
            if size.0 > 100 {
                let wanted = if rate_4x4 { 5 } else { 4 };
                let found = rates_seen.iter().filter(|&&n| n > 0).count();
                assert_eq!(found, wanted, "{rates_seen:?}");
            }
        }
    }
}

#[test]
fn foveation_and_content_combine_to_the_coarser_or_finer_rate() {
    let scene = scene();
    let camera = &scene.cameras[0];
    for rate_combine in [RateCombine::Coarser, RateCombine::Finer] {
        let settings = (variable(SIZES[0])).with(|s| {
            s.coarse.other_source = RateSource::Radii;
            s.coarse.combine = rate_combine;
            s.variable.blocks_4x4 = true;
            s.coarse.fovea_inner = 0.2;
            s.coarse.fovea_outer = 0.5;
        });
        let mut film = Film::new(&scene, &settings);
        film.draw(camera);
        film.draw(camera);
        let mask = film.mask();
        let known = reprojected(&film.known(2), &mask);
        let twin = twin::rates(&settings, &film.seen(), [camera; 2], &known, Probe::NONE);
        assert!(differing(&mask, &twin) <= mask.len() / 400);
        assert!(mask.iter().any(|m| m & 7 == 0) && mask.iter().any(|m| m & 3 == 3));
    }
}

#[test]
fn blocks_are_only_where_sources_ask_for_them() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let blocks = |source, level, other: Option<RateCombine>| {
        let settings = variable(SIZES[0]).with(|s| {
            s.coarse.source = source;
            s.coarse.constant_level = level;
            s.coarse.other_source = RateSource::Content;
            s.coarse.combine = other.unwrap_or(RateCombine::First);
            s.variable.blocks_4x4 = true;
        });
        let mut film = Film::new(&scene, &settings);
        film.draw(camera);
        film.draw(camera);
        film.mask().iter().filter(|&&m| m & 7 == 7).count()
    };
    let content = blocks(RateSource::Content, 0, None);
    assert!(content > 0);
    assert_eq!(blocks(RateSource::Constant, 1, None), 0);
    assert_eq!(blocks(RateSource::Constant, 1, Some(RateCombine::Finer)), 0);
    assert!(blocks(RateSource::Constant, 2, None) > content);
    assert_eq!(
        blocks(RateSource::Constant, 2, Some(RateCombine::Finer)),
        content
    );
    assert!(blocks(RateSource::Constant, 1, Some(RateCombine::Coarser)) >= content);
}

#[test]
fn each_sample_fills_its_pixels_and_single_pixels_are_full_shading() {
    let scene = scene();
    let camera = &scene.cameras[0];
    for size in SIZES {
        let settings = variable(size).with(|s| s.variable.blocks_4x4 = true);
        let full = {
            let mut film = Film::new(&scene, &small(size.0, size.1));
            film.draw(camera);
            film.radiance()
        };
        let mut film = Film::new(&scene, &settings);
        film.draw(camera);
        assert!(film.radiance() == full, "the first frame is shaded in full");
        let stats = film.draw(camera);
        let (mask, radiance, seen) = (film.mask(), film.radiance(), film.seen());
        let words: Vec<[u32; 4]> = texels(&film.renderer.targets().gbuffer.surface_view);
        let lights = film.renderer.lights().1;
        let mut coarse = 0;
        for sample in twin::samples(&mask, seen.size) {
            let first = twin::first_pixel(sample);
            let quad = first / 2;
            let extent = twin::extent(mask[(quad.y * size.0.div_ceil(2) + quad.x) as usize]);
            let end = (first + extent).min(seen.size);
            let at = |x, y| (y * size.0 + x) as usize;
            let color = radiance[at(first.x, first.y)];
            let pixels: Vec<usize> = (first.y..end.y)
                .flat_map(|y| (first.x..end.x).map(move |x| at(x, y)))
                .collect();
            assert!(pixels.iter().all(|&i| radiance[i] == color), "at {first}");
            if pixels.len() == 1 {
                assert_eq!(color, full[pixels[0]], "at {first}");
                continue;
            }
            coarse += 1;
            // Surfaces of the box are plain: their average is each of them but for the normals of
            // the balls.
            let normals = pixels
                .iter()
                .map(|&i| unpack_surface(words[i], Vec3::ZERO).normal);
            let same = normals
                .clone()
                .all(|n| n.dot(normals.clone().next().unwrap()) > 0.999_999);
            if !same {
                continue;
            }
            let last = pixels[pixels.len() - 1];
            let depth = 0.5 * (seen.depth[pixels[0]] + seen.depth[last]);
            let centre = 0.5 * (first + end).as_vec2();
            let expected = shade(
                &scene,
                camera,
                lights,
                settings.lighting.model,
                Vec2::new(size.0 as f32, size.1 as f32),
                centre,
                words[pixels[0]],
                depth,
            );
            let shown = Vec3::new(
                f32_of_half(color[0]),
                f32_of_half(color[1]),
                f32_of_half(color[2]),
            );
            assert!(
                (shown - expected).abs().max_element() <= 0.01 * expected.max_element().max(0.02),
                "at {first}: {shown}, not {expected}"
            );
        }
        assert!(size.0 < 100 || coarse > 1000, "{coarse} coarse samples");
        let samples = twin::samples(&mask, seen.size).len() as u64;
        assert_eq!(stats.shaded_samples, samples);
        let stats = stats.variable.unwrap();
        assert_eq!(stats.samples_per_rate.iter().sum::<u64>(), samples);
    }
}

#[test]
fn a_still_camera_has_a_constant_mask_and_picture_from_the_third_frame_on() {
    let scene = scene();
    let camera = &scene.cameras[0];
    for (stage, contrast) in [
        (RateStage::Lighting, Contrast::Quad),
        (RateStage::Both, Contrast::Neighbors),
        (RateStage::Material, Contrast::Sobel),
    ] {
        let settings = variable((93, 61)).with(|s| {
            s.geometry.path = Geometry::Visibility;
            s.rate.stage = stage;
            s.variable.contrast = contrast;
        });
        let mut film = Film::new(&scene, &settings);
        for _ in 0..3 {
            film.draw(camera);
        }
        let (mask, shown) = (film.mask(), picture(&film.renderer));
        assert!(mask.contains(&3) && mask.contains(&0));
        for frame in 4..=100 {
            film.draw(camera);
            assert!(film.mask() == mask, "mask of frame {frame}, {stage:?}");
            assert!(picture(&film.renderer) == shown, "frame {frame}, {stage:?}");
        }
    }
}

#[test]
fn after_a_walk_and_back_the_mask_is_that_of_a_fresh_start_within_eight_frames() {
    let scene = scene();
    let camera = &scene.cameras[0];
    for stage in [RateStage::Lighting, RateStage::Both] {
        let settings = (variable(SIZES[0])).with(|s| {
            s.geometry.path = Geometry::Visibility;
            s.rate.stage = stage;
            s.variable.contrast = Contrast::Neighbors;
        });
        let mut fresh = Film::new(&scene, &settings);
        for _ in 0..3 {
            fresh.draw(camera);
        }
        let mut film = Film::new(&scene, &settings);
        let mut coarse_on_the_way = 0;
        for frame in 0..=24u16 {
            let x = 0.03 * f32::from(12 - frame.abs_diff(12));
            film.draw(&shifted(camera, x));
            coarse_on_the_way += film.mask().iter().filter(|&&m| m & 7 != 0).count();
        }
        assert!(coarse_on_the_way > 10_000, "the walk must be coarse");
        assert!(film.mask() != fresh.mask(), "the walk must leave traces");
        for _ in 0..8 {
            film.draw(camera);
        }
        assert!(film.mask() == fresh.mask(), "{stage:?}");
        assert!(picture(&film.renderer) == picture(&fresh.renderer));
    }
}

#[test]
fn measuring_anew_cannot_change_the_mask_of_a_still_picture() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let mut film = Film::new(&scene, &variable(SIZES[0]));
    for _ in 0..3 {
        film.draw(camera);
    }
    let mask = film.mask();
    for frame in 0..20 {
        // Quads are probed in turns, since other things might be seen.
        film.renderer.freeze_culling(frame % 2 == 0);
        film.draw(camera);
        let now = film.mask();
        assert!(now.iter().any(|m| m & twin::PROBED != 0));
        let kept = now.iter().zip(&mask);
        assert!(
            kept.clone()
                .all(|(now, then)| now & twin::PROBED != 0 || now == then),
            "frame {frame}"
        );
    }
}

#[test]
fn quads_are_measured_again_where_culling_is_frozen_and_where_it_goes_on() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let mut film = Film::new(&scene, &variable(SIZES[1]));
    let is_probed = |film: &mut Film| {
        film.draw(camera);
        film.mask().iter().any(|m| m & twin::PROBED != 0)
    };
    for frozen in [true, false] {
        (0..6).for_each(|_| drop(film.draw(camera)));
        assert!(!is_probed(&mut film));
        film.renderer.freeze_culling(frozen);
        assert!(is_probed(&mut film));
    }
}

#[test]
fn what_does_not_follow_the_frame_before_starts_afresh() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let mut film = Film::new(&scene, &variable(SIZES[0]));
    film.draw(camera);
    let stats = film.draw(camera);
    assert!(stats.variable.unwrap().unknown_fraction < 0.01);
    // A cut: the camera before is not the one of the last frame.
    film.last = Some(shifted(camera, 1.0));
    let stats = film.draw(camera);
    assert!((stats.variable.unwrap().unknown_fraction - 1.0).abs() < 1e-9);
    assert!(film.mask().iter().all(|&m| m == twin::UNKNOWN));
    film.draw(camera);
    pollster::block_on(film.renderer.set_scene(&scene)).unwrap();
    let stats = film.draw(camera);
    assert!((stats.variable.unwrap().unknown_fraction - 1.0).abs() < 1e-9);
    let settings = variable((99, 71));
    pollster::block_on(film.renderer.set_settings(&settings)).unwrap();
    let stats = film.draw(camera);
    assert!((stats.variable.unwrap().unknown_fraction - 1.0).abs() < 1e-9);
}

#[test]
fn views_of_the_rates_do_not_change_the_rates() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let masks = [
        DebugView::Final,
        DebugView::Rate,
        DebugView::Shaded,
        DebugView::Unknown,
    ]
    .map(|view| {
        let settings = (variable(SIZES[0])).with(|s| s.picture.view = view);
        let mut film = Film::new(&scene, &settings);
        for _ in 0..4 {
            film.draw(camera);
        }
        film.mask()
    });
    assert!(masks.iter().all(|m| *m == masks[0]));
}

#[test]
fn views_of_the_rates_are_of_each_frame_whatever_rates_cost() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let compares = |view| {
        let settings = variable(SIZES[1]).with(|s| {
            s.rate.force = false;
            s.picture.view = view;
        });
        let mut film = Film::new(&scene, &settings);
        (0..6).any(|_| {
            let passes = film.draw(camera).gpu_ms;
            passes.iter().any(|pass| pass.name == "full shading")
        })
    };
    assert!(compares(DebugView::Final), "rates are weighed");
    for view in [DebugView::Rate, DebugView::Shaded, DebugView::Unknown] {
        assert!(!compares(view), "{view:?} hangs on times");
    }
}

#[test]
fn what_has_turned_itself_off_comes_back_only_while_something_moves() {
    let mut scene = scene();
    let camera = &scene.cameras[0].clone();
    let settings = variable((16, 9)).with(|s| s.rate.force = false);
    let mut film = Film::new(&scene, &settings);
    film.renderer.turn_variable_off();
    let is_active = |film: &mut Film, x: u16| {
        let stats = film.draw(&shifted(camera, 1e-3 * f32::from(x)));
        stats.variable.expect("variable shading").active
    };
    assert!((0..300).all(|_| !is_active(&mut film, 0)));
    assert!((0..300).any(|x| is_active(&mut film, x)));
    film.renderer.turn_variable_off();
    let mut posed = |film: &mut Film| {
        scene.lights[0].intensity *= 0.999;
        pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
        is_active(film, 299)
    };
    assert!((0..300).any(|_| posed(&mut film)));
}

#[test]
fn where_every_sub_sample_is_shaded_no_rates_are_found() {
    let scene = scene();
    let camera = &scene.cameras[0];
    for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
        let settings = variable(SIZES[1]).with(|s| {
            s.antialiasing.mode = Antialiasing::Ssaa;
            s.geometry.path = geometry;
        });
        let full = settings.clone().with(|s| s.shading.mode = Shading::Full);
        let [mut film, mut full] = [settings, full].map(|s| Film::new(&scene, &s));
        for _ in 0..3 {
            let (stats, of_full) = (film.draw(camera), full.draw(camera));
            assert!(stats.gpu_ms.iter().all(|pass| pass.name != "rate mask"));
            assert_eq!(stats.shaded_samples, of_full.shaded_samples);
            assert!(picture(&film.renderer) == picture(&full.renderer));
            let variable = stats.variable.unwrap();
            assert!(!variable.active && variable.notice.contains("ssaa"));
        }
    }
}

#[test]
fn with_msaa_lobes_are_added_as_in_full_shading() {
    let scene = generate::by_name("lobes").expect("a scene of that name");
    let camera = &scene.cameras[0];
    let every = variable(SIZES[1]).with(|s| {
        s.antialiasing.mode = Antialiasing::Msaa;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = 0;
    });
    let full = every.clone().with(|s| s.shading.mode = Shading::Full);
    let [mut film, mut full] = [every, full].map(|s| Film::new(&scene, &s));
    film.draw(camera);
    film.draw(camera);
    full.draw(camera);
    assert!(picture(&film.renderer) == picture(&full.renderer));
}
