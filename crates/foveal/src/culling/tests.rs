//! Culling in frames: when occluders are rasterized, and what sub-samples show.

use foveal_scene::{Material, Scene};
use glam::{Mat4, Vec3};

use crate::forward::twin::{front, quads};
use crate::testing::{Film, picture, rendered, small};
use crate::{Antialiasing, Culling, Settings, Shadows};

fn unlit(color: Vec3) -> Material {
    Material {
        base_color: color.extend(1.0),
        unlit: true,
        ..Material::default()
    }
}

/// Puts a quad, of side 2 before, elsewhere.
fn place(scene: &mut Scene, quad: usize, at: Vec3, half: f32) {
    let matrix = Mat4::from_translation(at) * Mat4::from_scale(Vec3::splat(half));
    let bounds = scene.meshes[0].bounds.transformed(matrix);
    scene.instances[quad].world_from_object = matrix;
    scene.instances[quad].bounds = bounds;
    scene.objects[quad].bounds = bounds;
}

/// Two walls with a slit between the middle columns of pixels, 0.3 of a pixel wide, and a bright thing
/// behind it.
fn slit() -> Scene {
    let colors = [
        Vec3::new(0.1, 0.1, 0.2),
        Vec3::new(0.1, 0.2, 0.1),
        Vec3::ONE,
    ];
    let mut scene = quads(colors.map(unlit).to_vec(), &[1.0, 1.0, 0.0]);
    place(&mut scene, 0, Vec3::new(-2.01, 0.0, 1.0), 2.0);
    place(&mut scene, 1, Vec3::new(2.01, 0.0, 1.0), 2.0);
    place(&mut scene, 2, Vec3::ZERO, 0.3);
    scene
}

#[test]
fn what_shows_between_pixel_centres_stays_in_anti_aliased_pictures() {
    let scene = slit();
    let drawn = |mode, antialiasing| {
        let settings = small(32, 32).with(|s| {
            s.culling.mode = mode;
            s.antialiasing.mode = antialiasing;
            s.antialiasing.samples = 16;
        });
        let renderer = rendered(&scene, &front(), &settings);
        (picture(&renderer), renderer)
    };
    for antialiasing in [Antialiasing::None, Antialiasing::Msaa, Antialiasing::Ssaa] {
        let (expected, _) = drawn(Culling::Off, antialiasing);
        let shows = expected.chunks_exact(4).any(|p| p[0] > 100);
        assert_eq!(
            shows,
            antialiasing != Antialiasing::None,
            "{antialiasing:?}"
        );
        for mode in [Culling::Auto, Culling::Occlusion] {
            let (culled, renderer) = drawn(mode, antialiasing);
            assert!(culled == expected, "{mode:?}, {antialiasing:?}");
            let hidden = renderer.culling().map(|c| c.stats.occludees_occluded);
            let expected = u64::from(antialiasing == Antialiasing::None);
            assert_eq!(hidden, Some(expected), "{mode:?}, {antialiasing:?}");
        }
    }
}

#[test]
fn what_pixel_centres_show_stays_at_every_scale_of_the_buffer() {
    // A slit on a column of pixel centres, at each place among the buffer's samples.
    for scale in [1, 2, 3, 4, 8, 16] {
        for moved in 0..4 {
            let width = 33 + 2 * moved;
            let mut scene = slit();
            place(&mut scene, 2, Vec3::ZERO, 0.02);
            let settings = small(width, width).with(|s| {
                s.culling.buffer_scale = scale;
                s.culling.mode = Culling::Occlusion;
            });
            let off = settings.clone().with(|s| s.culling.mode = Culling::Off);
            let expected = picture(&rendered(&scene, &front(), &off));
            assert!(expected.chunks_exact(4).any(|p| p[0] > 100), "{width}");
            let culled = picture(&rendered(&scene, &front(), &settings));
            assert!(culled == expected, "{scale}, {width}");
        }
    }
}

/// A wall before three quads.
fn room() -> Scene {
    let colors = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
    let mut scene = quads(colors.map(unlit).to_vec(), &[1.0, 0.0, 0.0, 0.0]);
    for (quad, x) in [(1, -0.5), (2, 0.0), (3, 0.5)] {
        place(&mut scene, quad, Vec3::new(x, 0.0, 0.0), 0.2);
    }
    scene
}

/// 16 quads side by side that hide one: 32 triangles for one of 2.
fn wide() -> Scene {
    let mut scene = quads(vec![unlit(Vec3::Y); 17], &[0.0; 17]);
    for quad in 0..16 {
        let [x, y] = [quad % 4, quad / 4].map(|i| 0.5 * i as f32 - 0.75);
        place(&mut scene, quad, Vec3::new(x, y, 1.0), 0.2);
    }
    place(&mut scene, 16, Vec3::new(-0.875, -0.875, 0.5), 0.05);
    scene
}

/// Settings of pictures in which no quad is too small to be an occluder.
fn auto() -> Settings {
    let settings = small(128, 128);
    assert_eq!(settings.culling.mode, Culling::Auto);
    settings
}

/// How many objects each of some frames from the front finds hidden.
fn hidden(scene: &Scene, settings: &Settings, frames: usize) -> Vec<u64> {
    let mut film = Film::new(scene, settings);
    let frame = |_| film.draw(&front()).objects_occluded;
    (0..frames).map(frame).collect()
}

#[test]
fn auto_rasterizes_occluders_while_they_hide_enough() {
    assert_eq!(hidden(&room(), &auto(), 5), [3; 5]);
    let one_in_31: Vec<u64> = (0..64).map(|i| u64::from(i % 31 == 0)).collect();
    assert_eq!(hidden(&wide(), &auto(), 64), one_in_31);
}

#[test]
fn auto_rasterizes_occluders_in_every_frame_with_shadows() {
    let settings = auto().with(|s| s.lighting.shadows = Shadows::Hard);
    assert_eq!(hidden(&wide(), &settings, 5), [1; 5]);
}

#[test]
fn auto_leaves_pictures_as_they_are_while_it_tries_and_rests() {
    let off = auto().with(|s| s.culling.mode = Culling::Off);
    let expected = picture(&rendered(&wide(), &front(), &off));
    let mut film = Film::new(&wide(), &auto());
    for frame in 0..33 {
        film.draw(&front());
        assert!(picture(&film.renderer) == expected, "{frame}");
    }
}

#[test]
fn auto_looks_again_in_another_scene_and_where_the_eye_turns() {
    let mut film = Film::new(&wide(), &auto());
    let turned = |degrees: f32| {
        let mut camera = front();
        camera.world_from_view *= Mat4::from_rotation_y(degrees.to_radians());
        camera
    };
    for (degrees, looks) in [(0.0, true), (-10.0, false), (-30.0, true), (-20.0, false)] {
        let stats = film.draw(&turned(degrees));
        assert_eq!(stats.occluder_triangles > 0, looks, "{degrees}");
    }
    pollster::block_on(film.renderer.set_scene(&room())).expect("scene fits");
    assert!(film.draw(&turned(-20.0)).occluder_triangles > 0);
}

#[test]
fn settings_need_the_scene_again_where_it_lacks_occluders_or_receivers() {
    let modes = [
        Culling::Off,
        Culling::Frustum,
        Culling::Auto,
        Culling::Occlusion,
    ];
    let all = modes.into_iter().flat_map(|mode| {
        [Shadows::Off, Shadows::Hard, Shadows::Soft].map(|shadows| {
            Settings::default().with(|s| {
                s.culling.mode = mode;
                s.lighting.shadows = shadows;
            })
        })
    });
    let all: Vec<Settings> = all.collect();
    let made = all.iter().map(|settings| {
        let scene = super::CullingScene::new(&room(), settings);
        [!scene.occluders.is_empty(), scene.cells.is_some()]
    });
    let made: Vec<[bool; 2]> = made.collect();
    assert!(made.contains(&[false; 2]) && made.contains(&[true; 2]));
    for (before, had) in all.iter().zip(&made) {
        for (now, has) in all.iter().zip(&made) {
            let expected = has.iter().zip(had).any(|(has, had)| *has && !*had);
            let what = |s: &Settings| (s.culling.mode, s.lighting.shadows);
            let again = now.needs_scene_again(before);
            assert_eq!(again, expected, "{:?}, {:?}", what(before), what(now));
        }
    }
}

#[test]
fn a_picture_that_is_too_large_is_refused_with_the_cullers_own_words() {
    for scale in [1, 4] {
        let most = foveal_cull::MAX_SIDE_PX * u32::from(scale);
        let stage = |width| {
            super::CullingStage::new(&Settings::default().with(|s| {
                s.picture.width = width;
                s.picture.height = 16;
                s.culling.buffer_scale = scale;
            }))
        };
        assert!(stage(most).is_ok());
        let error = stage(most + 1).expect_err("it is too large").to_string();
        assert!(
            error.contains(&format!("the limit is {most}: raise occlusion-scale")),
            "{error}"
        );
        assert!(error.contains("each side must be 1 to"), "{error}");
    }
}
