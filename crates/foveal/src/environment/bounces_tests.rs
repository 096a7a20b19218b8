//! Light of further bounces between microfacets: a white furnace, and shaders against the twin.

use foveal_generate as generate;
use foveal_scene::Scene;
use glam::{Vec2, Vec3};

use super::EnvironmentMap;
use super::frame_tests::rendered;
use super::reflectance::looked_up;
use super::tests::reflected_part;
use super::twin::Around;
use crate::shading::dielectric::PLAIN_DIELECTRIC;
use crate::shading::twin::{Surface, light_surface, position_at, to_eye, unpack_surface};
use crate::testing::{Film, picture, radiance, small, texels};
use crate::{Background, EnvironmentSource, LightingModel, Settings, Shading};

fn entry(s: &Surface, v: Vec3) -> Vec3 {
    looked_up(s.normal.dot(v).clamp(0.0, 1.0), s.roughness)
}

/// `reflected_once` in `shared/environment.wgsl`.
fn once(s: &Surface, v: Vec3) -> Vec3 {
    let terms = entry(s, v);
    s.reflectance_at_normal() * terms.x + terms.y * s.reflectance_at_grazing()
}

/// `further_bounces` in `shared/environment.wgsl`.
fn gain(s: &Surface, v: Vec3) -> Vec3 {
    let terms = entry(s, v);
    1.0 + s.reflectance_at_normal() * (1.0 / (terms.x + terms.y) - 1.0)
}

/// `reflected_further` in `shared/environment.wgsl`.
fn further(s: &Surface, v: Vec3) -> Vec3 {
    let terms = entry(s, v);
    let (lost, f0) = (1.0 - terms.x - terms.y, s.reflectance_at_normal());
    let mean = f0 + (s.reflectance_at_grazing() - f0) / 21.0;
    once(s, v) * mean * lost / (1.0 - mean * lost)
}

fn metal(color: Vec3, roughness: f32) -> Surface {
    Surface {
        position: Vec3::ZERO,
        normal: Vec3::Z,
        vertex_normal: Vec3::Z,
        base_color: color,
        metallic: 1.0,
        roughness,
        occlusion: 1.0,
        emissive: Vec3::ZERO,
        dielectric: PLAIN_DIELECTRIC,
    }
}

fn views() -> impl Iterator<Item = (f32, Vec3)> {
    [0.1f32, 0.25, 0.4, 0.7, 1.0].into_iter().map(|cosine| {
        (
            cosine,
            Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine),
        )
    })
}

#[test]
fn a_white_metal_in_a_white_furnace_is_not_seen_however_rough_it_is() {
    let mut darkest: f32 = 1.0;
    for step in 1..=20 {
        let s = metal(Vec3::ONE, step as f32 / 20.0);
        for (cosine, v) in views() {
            // Lights everywhere.
            let lights = reflected_part(&s, v, 100_000);
            let lit = lights * gain(&s, v);
            assert!(
                (lit - 1.0).abs().max_element() < 0.02,
                "{step}, {cosine}: {lit}"
            );
            let around = once(&s, v) + further(&s, v);
            assert!(
                (around - 1.0).abs().max_element() < 0.02,
                "{step}, {cosine}: {around}"
            );
            darkest = darkest.min(lights.max_element());
        }
    }
    assert!(darkest < 0.6, "{darkest}: there is something to give back");
}

#[test]
fn coloured_metals_deepen_and_nothing_reflects_more_than_arrives() {
    let gold = Vec3::new(1.0, 0.77, 0.34);
    for step in 1..=10 {
        let s = metal(gold, step as f32 / 10.0);
        for (_, v) in views() {
            let gain = gain(&s, v);
            assert!(gain.x >= gain.y && gain.y >= gain.z && gain.z >= 1.0);
            let all = once(&s, v) + further(&s, v);
            assert!(all.max_element() <= 1.001 && all.z < 0.75, "{all}");
            let lit = reflected_part(&s, v, 10_000) * gain;
            assert!(lit.max_element() <= 1.02 && lit.z < 0.75, "{lit}");
            let plain = Surface { metallic: 0.0, ..s };
            assert!(further(&plain, v).max_element() < 0.02);
        }
    }
}

const WIDTH: u32 = 97;
const HEIGHT: u32 = 65;

fn with_bounces(change: impl FnOnce(&mut Settings)) -> Settings {
    small(WIDTH, HEIGHT).with(|s| {
        s.lighting.multiple_scattering = true;
        change(s);
    })
}

#[test]
fn white_metals_vanish_in_a_white_environment_on_the_device() {
    let mut scene = generate::materials_grid();
    scene.lights.clear();
    for material in &mut scene.materials {
        material.base_color = glam::Vec4::ONE;
        (material.metallic, material.emissive) = (1.0, Vec3::ZERO);
        material.metallic_roughness_texture = None;
        material.base_color_texture = None;
        material.occlusion_texture = None;
    }
    let map = EnvironmentMap::new(64, 32, &[[1.0; 3]; 64 * 32]).unwrap();
    let far = |bounces: bool| {
        let settings = with_bounces(|s| {
            s.lighting.multiple_scattering = bounces;
            s.lighting.environment = EnvironmentSource::Image;
        });
        let drawn = radiance(&rendered(&scene, &scene.cameras[0], &settings, &map));
        drawn
            .iter()
            .map(|r| (*r - 1.0).abs().max_element())
            .fold(0.0, f32::max)
    };
    let (with, without) = (far(true), far(false));
    assert!(with < 0.02, "{with}");
    assert!(without > 0.3, "{without}");
}

/// Each pixel's radiance on the device and by the twin, which adds further bounces to what it has
/// without.
fn assert_equals_twin(scene: &Scene, settings: &Settings, map: Option<&EnvironmentMap>) {
    let camera = &scene.cameras[0];
    let black = EnvironmentMap::new(64, 32, &[[0.0; 3]; 64 * 32]).unwrap();
    let renderer = rendered(scene, camera, settings, map.unwrap_or(&black));
    let around = map.map(|map| Around::new(map, settings));
    let words: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_view);
    let depth: Vec<f32> = texels(&renderer.targets().gbuffer.depth_view);
    let lights = renderer.lights().1;
    let size = Vec2::new(WIDTH as f32, HEIGHT as f32);
    let (mut seen, mut gained) = (0, 0);
    for (i, device) in radiance(&renderer).into_iter().enumerate() {
        if depth[i] == 0.0 {
            continue;
        }
        let pixel = Vec2::new((i as u32 % WIDTH) as f32, (i as u32 / WIDTH) as f32) + 0.5;
        let s = unpack_surface(words[i], position_at(camera, size, pixel, depth[i]));
        let v = to_eye(camera, s.position);
        let before = light_surface(scene, lights, LightingModel::Ggx, &s, v);
        let by_lights = before.radiance - s.emissive - crate::shading::twin::ambient(scene, &s, v);
        let ambient = around.as_ref().map_or(Vec3::ZERO, |around| {
            around.ambient(&s, v) + further(&s, v) * around.irradiance(s.normal) * s.occlusion
        });
        let twin = s.emissive + ambient + by_lights + (gain(&s, v) - 1.0) * before.specular;
        let tolerance = 0.02 * twin.max_element().max(0.05);
        assert!(
            (device - twin).abs().max_element() <= tolerance,
            "at {pixel}: device {device}, twin {twin}"
        );
        seen += 1;
        gained += u32::from((gain(&s, v) - 1.0).max_element() > 0.1);
    }
    assert!(seen > 1_000 && gained > 50, "{seen}, {gained}");
}

#[test]
fn shaders_give_back_what_the_twin_does() {
    let mut scene = generate::materials_grid();
    generate::add_point_lights(&mut scene, 6, 3);
    assert_equals_twin(
        &scene,
        &with_bounces(|s| s.lighting.environment = EnvironmentSource::None),
        None,
    );
    let (width, height, rgb) = generate::surroundings(256);
    let rgb: Vec<_> = rgb
        .into_iter()
        .map(|t| t.map(|v: f32| v.min(4.0)))
        .collect();
    let map = EnvironmentMap::new(width, height, &rgb).unwrap();
    assert_equals_twin(
        &scene,
        &with_bounces(|s| s.lighting.environment = EnvironmentSource::Image),
        Some(&map),
    );
}

#[test]
fn the_switch_is_followed_back_and_forth() {
    let scene = generate::materials_grid();
    let camera = scene.cameras[0].clone();
    let settings = |bounces| with_bounces(|s| s.lighting.multiple_scattering = bounces);
    let mut film = Film::new(&scene, &settings(false));
    film.draw(&camera);
    let off = picture(&film.renderer);
    for bounces in [true, false, true] {
        pollster::block_on(film.renderer.set_settings(&settings(bounces))).unwrap();
        film.draw(&camera);
        let fresh = crate::testing::rendered(&scene, &camera, &settings(bounces));
        assert_eq!(picture(&film.renderer), picture(&fresh));
        assert_eq!(picture(&film.renderer) == off, !bounces);
    }
}

#[test]
fn samples_of_light_hold_light_without_further_bounces() {
    let mut scene = generate::materials_grid();
    generate::add_point_lights(&mut scene, 6, 3);
    let camera = scene.cameras[0].clone();
    let error = |bounces: bool| {
        let drawn = |coarse: bool| {
            let settings = with_bounces(|s| {
                s.lighting.multiple_scattering = bounces;
                s.lighting.background = Background::None;
                if coarse {
                    s.shading.mode = Shading::Coarse;
                    s.rate.force = true;
                    s.coarse.history = false;
                    s.coarse.source = crate::RateSource::Constant;
                    s.coarse.constant_level = 2;
                    // Curved surfaces would be shaded at every pixel.
                    s.coarse.refine_edges = crate::RefineEdges::Off;
                }
            });
            radiance(&crate::testing::rendered(&scene, &camera, &settings))
        };
        let (full, coarse) = (drawn(false), drawn(true));
        let sum = |r: &[Vec3]| r.iter().map(|r| r.element_sum()).sum::<f32>();
        let apart: f32 = full
            .iter()
            .zip(&coarse)
            .map(|(a, b)| (*a - *b).abs().element_sum())
            .sum();
        (apart / sum(&full), sum(&coarse) / sum(&full))
    };
    let (with, without) = (error(true), error(false));
    assert!(with.0 < 1.2 * without.0, "{with:?}, {without:?}");
    assert!((with.1 - 1.0).abs() < 0.05, "{with:?}, {without:?}");
}

/// Forward, in the way of coarse shading, with two eyes and with sub-samples.
#[test]
fn every_way_of_drawing_gives_light_back() {
    let ways: [fn(&mut Settings); 4] = [
        |_| (),
        |s| {
            s.shading.mode = Shading::Coarse;
            s.rate.force = true;
        },
        |s| s.stereo.mode = crate::Stereo::TwoPass,
        |s| s.antialiasing.mode = crate::Antialiasing::Msaa,
    ];
    for name in ["lobes", "materials-grid"] {
        let mut scene = generate::by_name(name).expect("it is generated");
        for material in &mut scene.materials {
            (material.metallic, material.roughness) = (1.0, 1.0);
        }
        let camera = &scene.cameras[0];
        for (number, way) in ways.into_iter().enumerate() {
            let [without, with] = [false, true].map(|bounces| {
                let settings = with_bounces(way).with(|s| {
                    s.lighting.multiple_scattering = bounces;
                    s.lighting.background = Background::None;
                });
                let drawn = picture(&crate::testing::rendered(&scene, camera, &settings));
                drawn.iter().map(|&b| u64::from(b)).sum::<u64>()
            });
            assert!(
                with > without + without / 50,
                "{name}, {number}: {with}, {without}"
            );
        }
    }
}
