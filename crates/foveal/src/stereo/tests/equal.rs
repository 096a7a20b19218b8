//! What must come out the same: two eyes in one place as one, and all ways of submission.

use foveal_generate as generate;
use foveal_scene::{Camera, Scene};
use glam::Vec3;

use super::{WAYS, halves, two_eyes};
use crate::testing::{gpu, picture, rendered, rounds_alike, small, texels};
use crate::{
    Antialiasing, CoarseBackend, Composite, Culling, DebugView, EyeClipping, LightAssignment,
    RateSource, SamplePattern, Settings, Shading, Stereo,
};

/// Differing pixels of two pictures and the largest difference of a channel.
pub(super) fn difference(a: &[[u8; 4]], b: &[[u8; 4]]) -> (usize, u8) {
    let pairs = || a.iter().zip(b).filter(|(a, b)| a != b);
    let largest = pairs()
        .flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)))
        .max();
    (pairs().count(), largest.unwrap_or(0))
}

/// Every generated scene, with its first camera.
fn scenes() -> Vec<Scene> {
    generate::NAMES
        .iter()
        .map(|name| generate::by_name(name).expect("a generated scene"))
        .collect()
}

/// Deferred stages in all combinations that read neighbours, and views.
fn pipelines(base: &Settings) -> Vec<(&'static str, Settings)> {
    let coarse = |composite, backend| {
        base.clone().with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.coarsest_level = 5;
            s.coarse.composite = composite;
            s.coarse.backend = backend;
        })
    };
    let msaa = |pattern| {
        base.clone().with(|s| {
            s.antialiasing.mode = Antialiasing::Msaa;
            s.antialiasing.pattern = pattern;
        })
    };
    vec![
        ("full", base.clone()),
        ("light", coarse(Composite::Light, CoarseBackend::Compute)),
        ("smooth", coarse(Composite::Smooth, CoarseBackend::Compute)),
        ("paper", coarse(Composite::Paper, CoarseBackend::Stencil)),
        (
            "nearest",
            coarse(Composite::Nearest, CoarseBackend::Compute),
        ),
        ("msaa, grid", msaa(SamplePattern::Grid)),
        ("msaa, rotated", msaa(SamplePattern::Rotated)),
        (
            "msaa and coarse",
            coarse(Composite::Smooth, CoarseBackend::Compute)
                .with(|s| s.antialiasing.mode = Antialiasing::Msaa),
        ),
        (
            "visibility",
            base.clone()
                .with(|s| s.geometry.path = crate::Geometry::Visibility),
        ),
        (
            "visibility, msaa",
            msaa(SamplePattern::Grid).with(|s| s.geometry.path = crate::Geometry::Visibility),
        ),
        (
            "depth",
            base.clone().with(|s| s.picture.view = DebugView::Depth),
        ),
    ]
}

#[test]
fn two_eyes_in_one_place_see_what_one_eye_sees() {
    // No multiple of a block, so that the right eye's picture does not begin where the left one's
    // ends.
    let (width, height) = (150, 101);
    for scene in [generate::cornell(), generate::alpha()] {
        let camera = &scene.cameras[0];
        for (name, mono) in pipelines(&small(width, height)) {
            let one: Vec<[u8; 4]> =
                bytemuck::pod_collect_to_vec(&picture(&rendered(&scene, camera, &mono)));
            // What both eyes see alike is drawn once, whatever the way.
            let once = mono.clone().with(|s| {
                s.stereo.mode = Stereo::Instanced;
                s.stereo.ipd_m = 0.0;
                s.stereo.output = crate::Output::SideBySide;
            });
            for both in halves(&scene, camera, &once) {
                assert_eq!(difference(&one, &both), (0, 0), "{}, {name}", scene.name);
            }
            for (stereo, eye_clipping) in WAYS {
                // Another gaze has its own picture.
                let settings = once.clone().with(|s| {
                    s.stereo.mode = stereo;
                    s.stereo.clipping = eye_clipping;
                    s.stereo.gaze_shift = [0.0, f32::MIN_POSITIVE];
                });
                for (eye, both) in halves(&scene, camera, &settings).iter().enumerate() {
                    let (differing, by) = difference(&one, both);
                    let what = format!(
                        "{}, {name}, {stereo:?}, {eye_clipping:?}, eye {eye}",
                        scene.name
                    );
                    // Rasterizers interpolate from the target's corner, which lies elsewhere;
                    // averages of sub-samples are rounded besides.
                    let rounded = match mono.antialiasing.mode {
                        _ if !rounds_alike() => one.len() / 50,
                        Antialiasing::None => 2,
                        _ => 10,
                    };
                    assert!(
                        differing <= rounded && (by <= 1 || !rounds_alike() && by <= 4),
                        "{what}: {differing} pixels by {by}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_right_eye_sees_textures_as_one_eye_does_at_odd_widths() {
    // Devices find mip levels by quads of 2 x 2 texels.
    let scene = generate::alpha();
    let camera = &scene.cameras[0];
    for aa in [Antialiasing::None, Antialiasing::Msaa] {
        let mono = small(151, 101).with(|s| {
            s.antialiasing.mode = aa;
            s.antialiasing.pattern = SamplePattern::Rotated;
        });
        let one: Vec<[u8; 4]> =
            bytemuck::pod_collect_to_vec(&picture(&rendered(&scene, camera, &mono)));
        let both = mono.with(|s| {
            s.stereo.mode = Stereo::Instanced;
            s.stereo.ipd_m = 0.0;
            s.stereo.output = crate::Output::SideBySide;
            // Another gaze has its own picture.
            s.stereo.gaze_shift = [0.0, f32::MIN_POSITIVE];
        });
        let [_, right] = halves(&scene, camera, &both);
        let (differing, by) = difference(&one, &right);
        let most = if rounds_alike() { 15 } else { one.len() / 50 };
        assert!(differing <= most, "{aa:?}: {differing} pixels by {by}");
    }
}

#[test]
fn eyes_that_see_alike_are_drawn_once_whatever_is_asked_for() {
    let scene = generate::alpha();
    let camera = &scene.cameras[0];
    let flat: Vec<[u8; 4]> =
        bytemuck::pod_collect_to_vec(&picture(&rendered(&scene, camera, &small(150, 101))));
    for stereo in [
        Stereo::Auto,
        Stereo::TwoPass,
        Stereo::Instanced,
        Stereo::Multiview,
    ] {
        for eye_tangents in ["", "-1,1,-0.8,0.6,-1,1,-0.8,0.6"] {
            let settings = two_eyes(150, 101).with(|s| {
                s.stereo.mode = stereo;
                s.stereo.ipd_m = 0.0;
                s.stereo.frusta = eye_tangents.parse().expect("it can be read");
            });
            let [left, right] = halves(&scene, camera, &settings);
            assert!(left == right, "{stereo:?}");
            assert!(!eye_tangents.is_empty() || left == flat, "{stereo:?}");
            let stats = rendered(&scene, camera, &settings).redraw(camera);
            assert_eq!(stats.shaded_samples, 150 * 101);
            assert_eq!(stats.stereo.expect("two eyes").mode, "once");
        }
    }
    let apart = two_eyes(150, 101).with(|s| {
        s.stereo.frusta = "-1,1,-0.8,0.6,-1,0.9,-0.8,0.6"
            .parse()
            .expect("it can be read");
        s.stereo.ipd_m = 0.0;
    });
    let [left, right] = halves(&scene, camera, &apart);
    assert!(left != right, "another frustum sees something else");
}

#[test]
fn another_size_changes_no_way() {
    let scene = generate::alpha();
    let camera = &scene.cameras[0];
    for (stereo, eye_clipping) in WAYS.into_iter().chain([(Stereo::Off, EyeClipping::Auto)]) {
        for geometry in [crate::Geometry::Gbuffer, crate::Geometry::Visibility] {
            let settings = two_eyes(120, 90).with(|s| {
                s.stereo.mode = stereo;
                s.stereo.clipping = eye_clipping;
                s.geometry.path = geometry;
            });
            let expected = picture(&rendered(&scene, camera, &settings));
            for first in [(200, 60), (60, 120)] {
                let mut renderer = rendered(
                    &scene,
                    camera,
                    &settings.clone().with(|s| {
                        s.picture.width = first.0;
                        s.picture.height = first.1;
                    }),
                );
                let resized = renderer.set_settings(&settings);
                pollster::block_on(resized).expect("settings fit");
                renderer.redraw(camera);
                assert!(picture(&renderer) == expected, "{stereo:?} from {first:?}");
            }
        }
    }
}

#[test]
fn instancing_equals_two_passes_to_the_bit_on_every_generated_scene() {
    for scene in scenes() {
        let camera = match scene.cameras.first() {
            Some(camera) => camera.clone(),
            None => scene.overview_camera(),
        };
        let reference = two_eyes(320, 240);
        let [plain, with_plane] = [EyeClipping::Discard, EyeClipping::Clip].map(|eye_clipping| {
            let reference = reference.clone().with(|s| s.stereo.clipping = eye_clipping);
            halves(&scene, &camera, &reference)
        });
        for (stereo, eye_clipping) in &WAYS[1..] {
            let settings = reference.clone().with(|s| {
                s.stereo.mode = *stereo;
                s.stereo.clipping = *eye_clipping;
            });
            let expected = match eye_clipping {
                EyeClipping::Clip => &with_plane,
                _ => &plain,
            };
            for (expected, seen) in expected.iter().zip(&halves(&scene, &camera, &settings)) {
                let off = difference(expected, seen);
                let is_near = !rounds_alike() && off.0 <= seen.len() / 50 && off.1 <= 4;
                assert!(
                    off == (0, 0) || is_near,
                    "{}, {stereo:?}, {eye_clipping:?}: {off:?}",
                    scene.name
                );
            }
        }
        // A clipped triangle is another polygon: its last bits differ (0.05 % of the pixels by 1 or
        // 2 in the demo scene, whose ground reaches beyond both borders; 0.35 % by 1 in the yard,
        // whose fence's rails do, each of one colour that rounds up or down along its length;
        // elsewhere a pixel or none).
        let (one_in, most) = match scene.name.as_str() {
            "yard" => (250, 1),
            _ => (1000, 2),
        };
        for (eye, (plain, clipped)) in plain.iter().zip(&with_plane).enumerate() {
            let (differing, by) = difference(plain, clipped);
            let is_far = |(a, b): &(&[u8; 4], &[u8; 4])| (0..3).any(|c| a[c].abs_diff(b[c]) > 4);
            let far = plain.iter().zip(clipped).filter(is_far).count();
            let is_near = if rounds_alike() {
                differing <= plain.len() / one_in && by <= most
            } else {
                // Borders of a clipped polygon are other lines, too, by fractions of a pixel.
                differing <= plain.len() / 50 && far <= plain.len() / 1000
            };
            assert!(
                is_near,
                "{}, eye {eye}: {differing} pixels by {by}, {far} of them far",
                scene.name
            );
        }
    }
}

#[test]
fn large_objects_do_not_leak_over_the_middle() {
    // From within the room its walls reach far beyond both borders of either eye.
    let scene = generate::cornell();
    let frusta = [
        "",
        "-0.4,1.6,-1,1,-1.6,0.4,-1,1",
        "-1.6,0.4,-1,1,-0.4,1.6,-1,1",
    ];
    for (turn, eye_tangents) in frusta.into_iter().enumerate() {
        let angle = turn as f32 * 2.0 + 0.3;
        let eye = Vec3::new(0.1, 1.2, 0.05);
        let at = eye + Vec3::new(angle.sin(), 0.1, angle.cos());
        let camera = Camera::look_at(eye, at, Vec3::Y, 1.3);
        for (shading, aa) in [
            (Shading::Full, Antialiasing::None),
            (Shading::Coarse, Antialiasing::None),
            (Shading::Full, Antialiasing::Ssaa),
        ] {
            let settings = |(stereo, eye_clipping)| {
                two_eyes(121, 97).with(|s| {
                    s.stereo.mode = stereo;
                    s.stereo.clipping = eye_clipping;
                    s.stereo.frusta = eye_tangents.parse().expect("it can be read");
                    s.shading.mode = shading;
                    s.antialiasing.mode = aa;
                    s.coarse.coarsest_level = 4;
                })
            };
            let [reference, clip, discard] = WAYS.map(|way| {
                let renderer = rendered(&scene, &camera, &settings(way));
                texels::<[u32; 2]>(&renderer.targets().gbuffer.identity_view)
            });
            for other in [clip, discard] {
                let pairs = reference.iter().zip(&other);
                let differing = pairs.filter(|(a, b)| a[0] != b[0]).count();
                assert!(
                    differing <= 8,
                    "{differing} texels, turn {turn}, {shading:?}, {aa:?}"
                );
            }
        }
    }
}

#[test]
fn clustered_and_brute_lighting_give_the_same_bytes_for_two_eyes() {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 150, 7);
    for eye_tangents in [
        "",
        "-1.3,0.7,-1.1,0.9,-0.7,1.3,-0.8,1.2",
        "-9,-7,-1,1,7,9,-1,1",
    ] {
        for camera in [scene.cameras[0].clone(), scene.overview_camera()] {
            let clustered = two_eyes(200, 150).with(|s| {
                s.stereo.mode = Stereo::Instanced;
                s.stereo.ipd_m = 0.4;
                s.stereo.convergence_m = 1.0;
                s.stereo.frusta = eye_tangents.parse().expect("it can be read");
            });
            let brute = clustered
                .clone()
                .with(|s| s.lighting.assignment = LightAssignment::Brute);
            let radiance = |settings| {
                let renderer = rendered(&scene, &camera, settings);
                texels::<[u16; 4]>(&renderer.targets().radiance_view)
            };
            assert!(radiance(&clustered) == radiance(&brute), "{eye_tangents}");
        }
    }
}

#[test]
fn what_one_eye_sees_does_not_hang_on_the_others_frustum() {
    let options = generate::DemoOptions::default();
    let scene = generate::demo(&options).expect("the demo scene");
    let camera = generate::demo_path(&options, 0.2);
    for mode in [Shading::Full, Shading::Coarse] {
        let right = |left: &str| {
            let settings = two_eyes(256, 128).with(|s| {
                s.shading.mode = mode;
                s.coarse.source = RateSource::Constant;
                s.coarse.constant_level = 2;
                s.coarse.history = false;
                s.stereo.frusta = format!("{left},-1,1,-0.5,0.5")
                    .parse()
                    .expect("it can be read");
            });
            let [_, right] = halves(&scene, &camera, &settings);
            right
        };
        let expected = right("-1,1,-0.5,0.5");
        for left in ["-0.3,0.3,-0.15,0.15", "-3,3,-1.5,1.5"] {
            let differing = std::iter::zip(right(left), &expected)
                .filter(|(a, b)| a != *b)
                .count();
            // Depth is rounded by what lies beside it in the target.
            assert!(
                differing < 164,
                "{mode:?}, {left}: {differing} of 32768 pixels"
            );
        }
    }
}

#[test]
fn culling_changes_no_picture_of_two_eyes() {
    let options = generate::DemoOptions::default();
    let scene = generate::demo(&options).expect("the demo scene");
    let mut hidden = 0;
    for (i, eye_tangents) in ["", "-1.2,0.8,-0.9,1,-0.8,1.2,-0.9,1"]
        .into_iter()
        .enumerate()
    {
        let camera = generate::demo_path(&options, 0.2 + 0.4 * i as f32);
        let settings = |culling| {
            two_eyes(320, 180).with(|s| {
                s.stereo.mode = Stereo::Instanced;
                s.culling.mode = culling;
                s.stereo.frusta = eye_tangents.parse().expect("it can be read");
            })
        };
        let expected = halves(&scene, &camera, &settings(Culling::Off));
        for culling in [Culling::Auto, Culling::Frustum, Culling::Occlusion] {
            let settings = settings(culling);
            assert!(
                expected == halves(&scene, &camera, &settings),
                "{culling:?}"
            );
            let mut renderer = rendered(&scene, &camera, &settings);
            hidden += renderer.redraw(&camera).objects_occluded;
        }
    }
    assert!(hidden > 100, "the test needs hidden objects: {hidden}");
}

#[test]
fn each_eye_has_its_own_gaze() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    let mono = |gaze| {
        small(200, 120).with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.coarsest_level = 5;
            s.coarse.backend = CoarseBackend::Compute;
            s.picture.view = DebugView::Rate;
            s.eye.gaze = gaze;
        })
    };
    let settings = (mono([0.2, 0.6])).with(|s| {
        s.stereo.mode = Stereo::Instanced;
        s.stereo.ipd_m = 0.0;
        s.stereo.output = crate::Output::SideBySide;
        s.stereo.gaze_shift = [0.6, -0.3];
    });
    let seen = halves(&scene, camera, &settings);
    for (seen, gaze) in seen.iter().zip([[0.2, 0.6], [0.8, 0.3]]) {
        let one: Vec<[u8; 4]> =
            bytemuck::pod_collect_to_vec(&picture(&rendered(&scene, camera, &mono(gaze))));
        let off = difference(seen, &one);
        let is_near = !rounds_alike() && off.0 <= one.len() / 1000 && off.1 <= 1;
        assert!(off == (0, 0) || is_near, "{off:?}");
    }
    assert!(difference(&seen[0], &seen[1]).0 > 1000);
}

#[test]
fn a_device_that_clips_is_asked_to_and_the_stats_say_so() {
    let scene = generate::cornell();
    let has_clip = gpu()
        .device
        .features()
        .contains(wgpu::Features::CLIP_DISTANCES);
    for (stereo, eye_clipping, mode) in [
        (Stereo::TwoPass, EyeClipping::Auto, "two-pass"),
        (Stereo::Instanced, EyeClipping::Discard, "instanced-discard"),
        (
            Stereo::Instanced,
            EyeClipping::Clip,
            if has_clip {
                "instanced-clip"
            } else {
                "instanced-discard"
            },
        ),
    ] {
        let settings = two_eyes(64, 48).with(|s| {
            s.stereo.mode = stereo;
            s.stereo.clipping = eye_clipping;
        });
        let mut renderer = rendered(&scene, &scene.cameras[0], &settings);
        let stats = renderer.redraw(&scene.cameras[0]);
        assert_eq!((stats.width, stats.height), (128, 48));
        assert_eq!(stats.shaded_samples, 128 * 48);
        assert_eq!(stats.stereo.expect("two eyes").mode, mode);
    }
}
