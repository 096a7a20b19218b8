//! Culling in frames: when occluders are rasterized, and what sub-samples show.

use foveal_scene::{Camera, Material, Scene};
use glam::{Mat4, Vec3};

use crate::forward::twin::{front, quads};
use crate::testing::{gpu, picture, rendered, small};
use crate::{
    Antialiasing, Culling, Frame, FrameStats, Renderer, RendererOptions, Settings, Shadows,
};

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

/// What frames from these cameras say.
fn stats(scene: &Scene, cameras: &[Camera], settings: &Settings) -> Vec<FrameStats> {
    pollster::block_on(async {
        let mut renderer = Renderer::new(gpu(), settings, RendererOptions::default())
            .await
            .expect("settings fit");
        renderer.set_scene(scene).await.expect("scene fits");
        let mut stats = Vec::new();
        for camera in cameras {
            stats.push(renderer.render(&Frame::new(camera)).await.expect("drawn"));
        }
        stats
    })
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
    let mut hidden = 0;
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
            let renderer = rendered(&scene, &front(), &settings);
            assert!(picture(&renderer) == expected, "{scale}, {width}");
            hidden += renderer.culling().unwrap().stats.occludees_occluded;
        }
    }
    assert_eq!(hidden, 0);
}

/// A wall, and behind it, or beside each other where it is `open`, three quads.
fn room(open: bool) -> (Scene, Camera) {
    let colors = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
    let mut scene = quads(colors.map(unlit).to_vec(), &[1.0, 0.0, 0.0, 0.0]);
    for (quad, x) in [(1, -0.5), (2, 0.0), (3, 0.5)] {
        let z = if open { 1.0 } else { 0.0 };
        place(&mut scene, quad, Vec3::new(x, 0.0, z), 0.2);
    }
    if open {
        place(&mut scene, 0, Vec3::new(0.0, 0.6, 1.0), 0.2);
    }
    (scene, front())
}

/// Whether each of some frames from one place rasterized occluders.
fn rasterized(open: bool, frames: usize, shadows: Shadows) -> Vec<bool> {
    let (scene, camera) = room(open);
    let settings = small(128, 128).with(|s| s.lighting.shadows = shadows);
    assert_eq!(settings.culling.mode, Culling::Auto);
    let stats = stats(&scene, &vec![camera; frames], &settings);
    stats.iter().map(|s| s.occluder_triangles > 0).collect()
}

#[test]
fn auto_rasterizes_occluders_while_they_hide_enough() {
    assert_eq!(rasterized(false, 5, Shadows::Off), [true; 5]);
    let open = rasterized(true, 64, Shadows::Off);
    let expected: Vec<bool> = (0..64).map(|i| i % 31 == 0).collect();
    assert_eq!(open, expected);
}

#[test]
fn auto_rasterizes_occluders_in_every_frame_with_shadows() {
    assert_eq!(rasterized(true, 5, Shadows::Hard), [true; 5]);
}

#[test]
fn auto_leaves_pictures_as_they_are_while_it_tries_and_rests() {
    let (scene, camera) = room(true);
    pollster::block_on(async {
        let settings = small(128, 128);
        let off = settings.clone().with(|s| s.culling.mode = Culling::Off);
        let expected = picture(&rendered(&scene, &camera, &off));
        let mut renderer = Renderer::new(gpu(), &settings, RendererOptions::default())
            .await
            .expect("settings fit");
        renderer.set_scene(&scene).await.expect("scene fits");
        for frame in 0..33 {
            renderer.render(&Frame::new(&camera)).await.expect("drawn");
            assert!(picture(&renderer) == expected, "{frame}");
        }
    });
}

#[test]
fn auto_looks_again_in_another_scene_and_where_the_eye_turns() {
    pollster::block_on(async {
        let (scene, camera) = room(true);
        let mut renderer = Renderer::new(gpu(), &small(128, 128), RendererOptions::default())
            .await
            .expect("settings fit");
        renderer.set_scene(&scene).await.expect("scene fits");
        let away = |degrees: f32| {
            let mut camera = camera.clone();
            camera.world_from_view *= Mat4::from_rotation_y(degrees.to_radians());
            camera
        };
        let mut rasterizes = async |camera: &Camera| {
            let frame = renderer.render(&Frame::new(camera)).await;
            frame.expect("drawn").occluder_triangles > 0
        };
        assert!(rasterizes(&camera).await);
        assert!(!rasterizes(&away(10.0)).await);
        assert!(rasterizes(&away(30.0)).await);
        assert!(!rasterizes(&away(20.0)).await);
        let (scene, camera) = room(false);
        renderer.set_scene(&scene).await.expect("scene fits");
        let frame = renderer.render(&Frame::new(&camera)).await;
        assert!(frame.expect("drawn").occluder_triangles > 0);
    });
}

#[test]
fn settings_whose_scenes_lack_occluders_need_the_scene_again() {
    let with = |mode| Settings::default().with(|s| s.culling.mode = mode);
    let bare = [Culling::Off, Culling::Frustum];
    let baked = [Culling::Auto, Culling::Occlusion];
    for before in [bare, baked].concat() {
        for now in [bare, baked].concat() {
            let expected = baked.contains(&now) && bare.contains(&before);
            let again = with(now).needs_scene_again(&with(before));
            assert_eq!(again, expected, "{before:?}, {now:?}");
        }
    }
}
