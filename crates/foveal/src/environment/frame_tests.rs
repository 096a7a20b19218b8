//! Shaders against the twin, frames against frames.

use foveal_generate as generate;
use foveal_scene::{Camera, ImageLight, Scene};
use glam::{Quat, Vec2, Vec3};

use super::EnvironmentMap;
use super::twin::Around;
use crate::shading::twin::{position_at, to_eye, unpack_surface};
use crate::testing::{Film, f32_of_half, gpu, picture, radiance, shifted, small, texels};
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
pub(super) fn rendered(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    map: &EnvironmentMap,
) -> Renderer {
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

/// The map as a scene's file may have it, turned by so many radians about the vertical axis.
fn as_light(map: &EnvironmentMap, turn: f32) -> ImageLight {
    let texel = |&[r, g, b, _]: &[u16; 4]| [r, g, b].map(f32_of_half);
    // The factors of the harmonics, and irradiance is over pi.
    let [zeroth, first, mixed] = [0.282_095, 0.488_603, 1.092_548];
    let factors = [
        zeroth, first, first, first, mixed, mixed, 0.315_392, mixed, 0.546_274,
    ];
    let irradiance = std::array::from_fn(|k| {
        let falls = map.irradiance()[k] * std::f32::consts::PI / factors[k];
        falls.to_array()
    });
    ImageLight {
        name: String::new(),
        rotation: Quat::from_rotation_y(turn),
        intensity: 1.0,
        side: map.side(),
        radiance: map.texels(0).iter().map(texel).collect(),
        irradiance,
    }
}

/// Largest and mean difference of pictures, relative to the larger of a pixel's light and 0.1.
fn apart(a: &[Vec3], b: &[Vec3]) -> (f32, f32) {
    let one =
        |(a, b): (&Vec3, &Vec3)| (*a - *b).abs().max_element() / a.max(*b).max_element().max(0.1);
    let all: Vec<f32> = a.iter().zip(b).map(one).collect();
    let sum: f32 = all.iter().sum();
    (
        all.iter().copied().fold(0.0, f32::max),
        sum / all.len() as f32,
    )
}

#[test]
fn a_scenes_own_environment_lights_it_as_the_same_picture_does() {
    let (width, height, rgb) = generate::surroundings(512);
    let rgb: Vec<_> = rgb.into_iter().map(|t| t.map(|v| v.min(20.0))).collect();
    let map = EnvironmentMap::new(width, height, &rgb).unwrap();
    let mut scene = generate::materials_grid();
    scene.lights.clear();
    let camera = &scene.cameras[0].clone();
    let plain = small(97, 65);
    for (degrees, most, mean) in [(0.0, 0.01, 0.001), (70.0, 1.0, 0.01)] {
        let by_image =
            lit_by_image(plain.clone()).with(|s| s.lighting.environment_rotation_deg = degrees);
        let wanted = radiance(&rendered(&scene, camera, &by_image, &map));
        scene.image_light = Some(as_light(&map, degrees.to_radians()));
        let found = radiance(&crate::testing::rendered(&scene, camera, &plain));
        let found = apart(&found, &wanted);
        assert!(found.0 <= most && found.1 <= mean, "{degrees}: {found:?}");
    }
}

#[test]
fn a_setting_is_stronger_than_a_scenes_own_environment_and_the_next_scene_has_its_own() {
    let mut scene = generate::materials_grid();
    let camera = &scene.cameras[0].clone();
    let plain = small(48, 32);
    let drawn = |scene: &Scene, settings: &Settings| {
        picture(&crate::testing::rendered(scene, camera, settings))
    };
    let gradient = plain
        .clone()
        .with(|s| s.lighting.environment = EnvironmentSource::Gradient);
    let without = drawn(&scene, &plain);
    assert_eq!(without, drawn(&scene, &gradient));
    let bare = scene.clone();
    scene.image_light = Some(as_light(&surroundings(), 0.0));
    let with = drawn(&scene, &plain);
    assert!(with != without);
    assert_eq!(without, drawn(&scene, &gradient));
    for mode in [Shading::Full, Shading::Coarse] {
        let settings = plain.clone().with(|s| s.shading.mode = mode);
        let mut film = Film::new(&bare, &settings);
        let mut alone = Vec::new();
        for scene in [&bare, &scene, &bare] {
            pollster::block_on(film.renderer.set_scene(scene)).unwrap();
            film.last = None;
            film.draw(camera);
            assert_eq!(picture(&film.renderer), drawn(scene, &settings), "{mode:?}");
            assert_eq!(film.renderer.settings(), &settings);
            alone.push(picture(&film.renderer));
        }
        assert!(alone[0] == alone[2] && alone[0] != alone[1]);
        let other = settings.with(|s| s.lighting.environment = EnvironmentSource::Sky);
        pollster::block_on(film.renderer.set_settings(&other)).unwrap();
        pollster::block_on(film.renderer.set_scene(&scene)).unwrap();
        film.draw(camera);
        assert_eq!(picture(&film.renderer), drawn(&bare, &other), "{mode:?}");
    }
}

#[test]
fn a_file_with_an_environment_is_lit_as_by_an_equirectangular_picture_of_it() {
    // Another colour on each side, a lamp, and more light than white.
    let radiance = |[x, y, z]: [f32; 3]| {
        let lamp = if 0.6 * x + 0.64 * y + 0.48 * z > 0.95 {
            8.0
        } else {
            0.0
        };
        [0.6 + 0.5 * x + lamp, 0.6 + 0.5 * y + lamp, 0.6 + 0.5 * z]
    };
    let (width, height) = (1024, 512);
    let direction = |i: u32| {
        let turn = ((i % width) as f32 + 0.5) / width as f32 * std::f32::consts::TAU;
        let down = ((i / width) as f32 + 0.5) / height as f32 * std::f32::consts::PI;
        [
            -down.sin() * turn.cos(),
            down.cos(),
            -down.sin() * turn.sin(),
        ]
    };
    let rgb: Vec<_> = (0..width * height).map(direction).map(radiance).collect();
    let map = EnvironmentMap::new(width, height, &rgb).unwrap();
    let file = foveal_seeds::surrounded(256, &radiance);
    let options = foveal_scene::LoadOptions::default();
    let no_files = |_: &str| Err("no files".into());
    let loaded = foveal_scene::load_bytes(&file.glb(), "a.glb", &options, &no_files).unwrap();
    let mut scene = generate::materials_grid();
    scene.lights.clear();
    let camera = &scene.cameras[0].clone();
    let plain = small(97, 65);
    let wanted = radiance_of(&scene, camera, &lit_by_image(plain.clone()), &map);
    scene.image_light = loaded.image_light;
    let found = radiance_of(&scene, camera, &plain, &map);
    let (most, mean) = apart(&found, &wanted);
    assert!(mean <= 0.01, "{mean}, {most}");
    // The test tells sides apart.
    let light = scene.image_light.as_mut().unwrap();
    light.rotation = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let turned = apart(&radiance_of(&scene, camera, &plain, &map), &wanted);
    assert!(turned.1 > 10.0 * mean, "{turned:?}");
}

fn radiance_of(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    map: &EnvironmentMap,
) -> Vec<Vec3> {
    radiance(&rendered(scene, camera, settings, map))
}
