//! Shaders against the twin, frames against frames.

use foveal_generate as generate;
use foveal_scene::{Camera, Scene};
use glam::{Vec2, Vec3};

use super::EnvironmentMap;
use super::twin::Around;
use crate::shading::twin::{position_at, to_eye, unpack_surface};
use crate::testing::{Film, f32_of_half, gpu, picture, shifted, small, texels};
use crate::{
    Antialiasing, Background, Composite, EnvironmentSource, Frame, RateSource, Renderer,
    RendererOptions, Settings, Shading, Stereo,
};

/// A room's walls, a sky and a small sun, as bright as they are.
fn surroundings() -> EnvironmentMap {
    let (width, height, rgb) = generate::surroundings(256);
    EnvironmentMap::new(width, height, &rgb).unwrap()
}

fn lit_by_image(settings: Settings) -> Settings {
    settings.with(|s| s.lighting.environment = EnvironmentSource::Image)
}

/// A renderer that has drawn `scene` once in the light of `map`.
fn rendered(scene: &Scene, camera: &Camera, settings: &Settings, map: &EnvironmentMap) -> Renderer {
    pollster::block_on(async {
        let mut renderer = Renderer::new(gpu(), settings, RendererOptions::default())
            .await
            .unwrap();
        renderer.set_environment(map.clone()).await.unwrap();
        renderer.set_scene(scene).await.unwrap();
        renderer.render(&Frame::new(camera)).await.unwrap();
        renderer
    })
}

fn radiance(renderer: &Renderer) -> Vec<Vec3> {
    texels::<[u16; 4]>(&renderer.targets().radiance_view)
        .into_iter()
        .map(|t| Vec3::new(f32_of_half(t[0]), f32_of_half(t[1]), f32_of_half(t[2])))
        .collect()
}

#[test]
fn shaders_look_the_map_up_as_the_twin_does() {
    let mut scene = generate::materials_grid();
    scene.lights.clear();
    let camera = &scene.cameras[0];
    let (width, height) = (97, 65);
    let map = surroundings();
    for (rotation, intensity, background) in [
        (0.0, 1.0, Background::Environment),
        (70.0, 2.5, Background::Blurred),
    ] {
        let settings = lit_by_image(small(width, height)).with(|s| {
            s.lighting.environment_rotation_deg = rotation;
            s.lighting.environment_intensity = intensity;
            s.lighting.background = background;
        });
        let renderer = rendered(&scene, camera, &settings, &map);
        let around = Around::new(&map, &settings);
        let words: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_view);
        let depth: Vec<f32> = texels(&renderer.targets().gbuffer.depth_view);
        let size = Vec2::new(width as f32, height as f32);
        let mut seen = [0; 2];
        for (i, device) in radiance(&renderer).into_iter().enumerate() {
            let pixel = Vec2::new((i as u32 % width) as f32, (i as u32 / width) as f32) + 0.5;
            let is_surface = depth[i] > 0.0;
            let position = position_at(
                camera,
                size,
                pixel,
                if is_surface { depth[i] } else { 0.01 },
            );
            let v = to_eye(camera, position);
            let twin = if is_surface {
                around.ambient(&unpack_surface(words[i], position), v)
            } else if background == Background::Blurred {
                around.background(-v, 0.5)
            } else {
                around.background(-v, 0.0)
            };
            // Devices blend texels with fractions of 8 bits.
            let tolerance = 0.02 * twin.max_element().max(0.05);
            assert!(
                (device - twin).abs().max_element() <= tolerance,
                "at {pixel}: device {device}, twin {twin}"
            );
            seen[usize::from(is_surface)] += 1;
        }
        assert!(seen.iter().all(|&n| n > 500), "{seen:?}");
    }
}

#[test]
fn radiance_stays_finite_behind_and_beside_a_blinding_sun() {
    let scene = generate::materials_grid();
    let camera = &scene.cameras[0];
    // Behind the upper half of the spheres.
    let rgb: Vec<[f32; 3]> = (0..64 * 32)
        .map(|i| [if i < 64 * 16 { f32::INFINITY } else { 0.5 }; 3])
        .collect();
    let map = EnvironmentMap::new(64, 32, &rgb).unwrap();
    let bright = |background| {
        lit_by_image(small(96, 64)).with(|s| {
            s.lighting.environment_intensity = 2.0;
            s.lighting.background = background;
        })
    };
    let of = |s: &Settings, shading, composite| {
        s.clone().with(|s| {
            s.shading.mode = shading;
            s.coarse.composite = composite;
        })
    };
    for background in [Background::Environment, Background::Blurred] {
        let full = bright(background);
        let all = [
            full.clone(),
            full.clone()
                .with(|s| s.antialiasing.mode = Antialiasing::Msaa),
            of(&full, Shading::Coarse, Composite::Light),
            of(&full, Shading::Coarse, Composite::Smooth),
            of(&full, Shading::Variable, Composite::Light),
        ];
        for (i, settings) in all.iter().enumerate() {
            let found = radiance(&rendered(&scene, camera, settings, &map));
            assert!(found.iter().all(|r| r.is_finite()), "{background:?}, {i}");
            let brightest = found.iter().map(|r| r.max_element());
            assert_eq!(brightest.fold(0.0, f32::max), 65504.0, "the sun is seen");
        }
    }
}

#[test]
fn the_filtered_sky_resembles_the_gradient_that_it_is_made_from() {
    let mut scene = generate::materials_grid();
    scene.lights.clear();
    let camera = &scene.cameras[0];
    let of = |source| {
        let settings = small(96, 64).with(|s| s.lighting.environment = source);
        let renderer = crate::testing::rendered(&scene, camera, &settings);
        (
            radiance(&renderer),
            texels::<f32>(&renderer.targets().gbuffer.depth_view),
        )
    };
    let (gradient, depth) = of(EnvironmentSource::Gradient);
    let (sky, _) = of(EnvironmentSource::Sky);
    for (i, (a, b)) in gradient.iter().zip(&sky).enumerate() {
        // A rough surface mirrors the gradient unfiltered.
        let most = if depth[i] == 0.0 { 0.01 } else { 0.2 };
        assert!((*a - *b).abs().max_element() < most, "texel {i}: {a}, {b}");
    }
    assert_ne!(gradient, sky);
    let (none, _) = of(EnvironmentSource::None);
    assert!(none.iter().all(|r| *r == Vec3::ZERO));
}

#[test]
fn the_background_is_chosen_apart_from_the_light() {
    let scene = generate::materials_grid();
    let camera = &scene.cameras[0];
    let map = surroundings();
    let of = |background| {
        let settings = lit_by_image(small(96, 64)).with(|s| s.lighting.background = background);
        let renderer = rendered(&scene, camera, &settings, &map);
        (
            radiance(&renderer),
            texels::<f32>(&renderer.targets().gbuffer.depth_view),
        )
    };
    let (sharp, depth) = of(Background::Environment);
    for background in [Background::Blurred, Background::None] {
        let (other, _) = of(background);
        for i in 0..depth.len() {
            if depth[i] > 0.0 {
                assert_eq!(sharp[i], other[i], "a surface");
            } else if background == Background::None {
                assert_eq!(other[i], Vec3::ZERO);
            }
        }
        assert_ne!(sharp, other);
    }
}

#[test]
fn coarse_shading_at_level_0_equals_full_shading() {
    let mut scene = generate::materials_grid();
    generate::add_point_lights(&mut scene, 5, 1);
    let camera = &scene.cameras[0];
    let map = surroundings();
    let full = lit_by_image(small(130, 70));
    let expected = picture(&rendered(&scene, camera, &full, &map));
    for composite in [Composite::Light, Composite::Smooth, Composite::Nearest] {
        for history in [false, true] {
            let coarse = full.clone().with(|s| {
                s.shading.mode = Shading::Coarse;
                s.coarse.source = RateSource::Constant;
                s.coarse.constant_level = 0;
                s.coarse.composite = composite;
                s.coarse.history = history && composite == Composite::Light;
            });
            let found = picture(&rendered(&scene, camera, &coarse, &map));
            assert!(found == expected, "{composite:?}, history {history}");
        }
    }
}

#[test]
fn another_environment_restarts_the_light_history() {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 8, 3);
    let camera = scene.cameras[0].clone();
    let settings = lit_by_image(small(160, 90)).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.history = true;
        s.coarse.coarsest_level = 3;
    });
    let maps = [
        surroundings(),
        EnvironmentMap::from_radiance(64, 1, |d| d.abs().into()),
    ];
    let mut film = Film::new(&scene, &settings);
    pollster::block_on(film.renderer.set_environment(maps[0].clone())).unwrap();
    for step in 0..4 {
        film.draw(&shifted(&camera, 0.002 * step as f32));
    }
    let kept = film.draw(&camera).shaded_samples;
    let changes: [&dyn Fn(&mut Renderer); 3] = [
        &|r| pollster::block_on(r.set_environment(maps[1].clone())).unwrap(),
        &|r| {
            let turned = r.settings().clone().with(|s| {
                s.lighting.environment_rotation_deg = 90.0;
            });
            pollster::block_on(r.set_settings(&turned)).unwrap();
        },
        &|r| {
            let sky = r.settings().clone().with(|s| {
                s.lighting.environment = EnvironmentSource::Sky;
            });
            pollster::block_on(r.set_settings(&sky)).unwrap();
        },
    ];
    for (i, change) in changes.into_iter().enumerate() {
        let before = film.radiance();
        change(&mut film.renderer);
        let restarted = film.draw(&camera).shaded_samples;
        assert!(restarted > 2 * kept, "change {i}: {restarted} after {kept}");
        assert_ne!(before, film.radiance(), "change {i}");
        film.draw(&camera);
    }
    // The same map again changes nothing.
    film.draw(&camera);
    let settings = film.renderer.settings().clone();
    pollster::block_on(film.renderer.set_settings(&settings)).unwrap();
    assert!(film.draw(&camera).shaded_samples < 2 * kept);
}

#[test]
fn another_light_and_gaze_at_once_keep_pipelines_and_targets() {
    let scene = generate::cornell();
    let settings = lit_by_image(small(96, 64));
    let mut renderer = rendered(&scene, &scene.cameras[0], &settings, &surroundings());
    let before = renderer.targets().radiance_view.clone();
    let turned = settings.clone().with(|s| {
        s.lighting.environment_intensity = 2.0;
        s.lighting.environment_rotation_deg = 40.0;
        s.eye.gaze = [0.2, 0.3];
    });
    pollster::block_on(renderer.set_settings(&turned)).unwrap();
    assert!(renderer.targets().radiance_view == before);
    assert_eq!(*renderer.settings(), turned);
    let other = turned.with(|s| s.lighting.background = Background::None);
    pollster::block_on(renderer.set_settings(&other)).unwrap();
    assert!(renderer.targets().radiance_view != before, "all anew");
}

#[test]
fn two_eyes_see_one_environment() {
    let scene = generate::materials_grid();
    let camera = &scene.cameras[0];
    let map = surroundings();
    let of = |stereo| {
        let settings = lit_by_image(small(96, 64)).with(|s| {
            s.stereo.mode = stereo;
            s.stereo.ipd_m = 0.0;
            s.stereo.output = crate::Output::SideBySide;
        });
        picture(&rendered(&scene, camera, &settings, &map))
    };
    let both = of(Stereo::Instanced);
    let rows = both.chunks_exact(2 * 96 * 4);
    let halves: Vec<(&[u8], &[u8])> = rows.map(|row| row.split_at(96 * 4)).collect();
    // Without a distance between them, both are the same.
    let differing = halves.iter().filter(|(left, right)| left != right).count();
    assert!(differing < 4, "{differing} rows");
}
