//! The CPU twins of the tone map and of the views.

use foveal_generate as generate;
use foveal_scene::Projection;
use glam::{Mat3, Vec2, Vec3};

use crate::shading::twin::unit_from_octahedral;
use crate::testing::{f32_of_half, picture, radiance, rendered, small, srgb_of_linear, texels};
use crate::{DebugView, Frame, ToneMap};

fn aces(color: Vec3) -> Vec3 {
    let into = Mat3::from_cols_array(&[
        0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777,
    ]);
    let out = Mat3::from_cols_array(&[
        1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602,
    ]);
    let v = into * color;
    out * ((v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.432_951) + 0.238081))
}

fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

fn assert_close(device: &[u8], twin: &[Vec3], what: &str) {
    for (i, (d, t)) in device.chunks_exact(4).zip(twin).enumerate() {
        for channel in 0..3 {
            let expected = byte(t[channel]);
            assert!(
                d[channel].abs_diff(expected) <= 1,
                "{what}, texel {i}: device {d:?}, twin {t}"
            );
        }
        assert_eq!(d[3], 255);
    }
}

#[test]
fn the_tone_map_equals_its_twin() {
    let scene = generate::cornell();
    for tone_map in [ToneMap::Aces, ToneMap::Linear] {
        let settings = small(61, 40).with(|s| {
            s.picture.tone_map = tone_map;
            s.picture.exposure_stops = 0.5;
        });
        let renderer = rendered(&scene, &scene.cameras[0], &settings);
        let expected: Vec<Vec3> = radiance(&renderer)
            .into_iter()
            .map(|radiance| {
                let exposed = radiance * 0.5f32.exp2();
                let mapped = if tone_map == ToneMap::Aces {
                    aces(exposed)
                } else {
                    exposed
                };
                mapped.clamp(Vec3::ZERO, Vec3::ONE).map(srgb_of_linear)
            })
            .collect();
        let shown = picture(&renderer);
        assert_close(&shown, &expected, "tone map");
        assert!(
            shown.iter().any(|&b| b > 200) && shown.iter().any(|&b| b < 50),
            "the test needs contrast"
        );
    }
}

#[test]
fn the_views_equal_their_twins() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    let mut before = camera.clone();
    before.world_from_view.w_axis.x += 0.1;
    for view in [
        DebugView::Depth,
        DebugView::Normals,
        DebugView::BaseColor,
        DebugView::Motion,
    ] {
        let mut renderer = rendered(
            &scene,
            camera,
            &small(61, 40).with(|s| s.picture.view = view),
        );
        pollster::block_on(renderer.render(&Frame::new(camera).with_previous(&before)))
            .expect("drawn");
        let gbuffer = &renderer.targets().gbuffer;
        let words: Vec<[u32; 4]> = texels(&gbuffer.surface_view);
        let identity: Vec<[u32; 2]> = texels(&gbuffer.identity_view);
        let depth: Vec<f32> = texels(&gbuffer.depth_view);
        let Projection::Perspective { near_m, .. } = camera.projection else {
            panic!("a perspective camera")
        };
        let expected: Vec<Vec3> = (0..depth.len())
            .map(|i| match view {
                _ if depth[i] == 0.0 && view != DebugView::Motion => Vec3::ZERO,
                DebugView::Depth => Vec3::splat(
                    1.0 - (((near_m / depth[i]).max(near_m) / near_m).log2() / 16.0).min(1.0),
                ),
                DebugView::Normals => unit_from_octahedral(words[i][1]) * 0.5 + 0.5,
                DebugView::BaseColor => {
                    let [r, g, b, _] = words[i][0].to_le_bytes().map(|b| f32::from(b) / 255.0);
                    Vec3::new(r, g, b)
                }
                _ => {
                    let halves =
                        [identity[i][1] as u16, (identity[i][1] >> 16) as u16].map(f32_of_half);
                    (Vec2::from(halves) / 32.0 + 0.5)
                        .extend(0.5)
                        .clamp(Vec3::ZERO, Vec3::ONE)
                }
            })
            .collect();
        assert_close(&picture(&renderer), &expected, &format!("{view:?}"));
    }
}

#[test]
fn motion_is_the_distance_in_pixels_that_a_point_moved() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    let mut before = camera.clone();
    before.world_from_view.w_axis.x += 0.05;
    before.world_from_view.w_axis.y -= 0.02;
    let settings = small(61, 40).with(|s| s.picture.view = DebugView::Motion);
    let size = Vec2::new(61.0, 40.0);
    let mut renderer = rendered(&scene, camera, &settings);
    pollster::block_on(renderer.render(&Frame::new(camera).with_previous(&before))).expect("drawn");
    let identity: Vec<[u32; 2]> = texels(&renderer.targets().gbuffer.identity_view);
    let depth: Vec<f32> = texels(&renderer.targets().gbuffer.depth_view);
    let mut seen = 0;
    for (i, (identity, depth)) in identity.iter().zip(depth).enumerate() {
        if identity[0] == 0 {
            continue;
        }
        let pixel = Vec2::new((i % 61) as f32, (i / 61) as f32) + 0.5;
        let position = crate::shading::twin::position_at(camera, size, pixel, depth);
        let ndc = before
            .clip_from_world(size.x / size.y)
            .project_point3(position);
        let then = (Vec2::new(ndc.x, -ndc.y) * 0.5 + 0.5) * size;
        let moved = Vec2::new(
            f32_of_half(identity[1] as u16),
            f32_of_half((identity[1] >> 16) as u16),
        );
        assert!(
            (pixel - then - moved).abs().max_element() < 0.02,
            "at {pixel}: {moved}, expected {}",
            pixel - then
        );
        seen += 1;
    }
    assert!(seen > 500, "the test must see surfaces");
}
