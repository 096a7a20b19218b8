//! The strongest test of culling: the picture does not change by a bit, and less is drawn.
#![allow(
    clippy::print_stdout,
    reason = "a test says what it skipped and what it measured"
)]

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use foveal::{Culling, CullingEyes, Frame, FrameStats, Gpu, Output, Renderer, Settings, Stereo};
use foveal_generate as generate;
use foveal_generate::DemoOptions;
use foveal_scene::{Camera, LoadOptions, Projection, Scene};
use glam::{Mat4, Vec3};

/// Every look takes a microsecond.
fn clock_ns() -> u64 {
    static LOOKS: AtomicU64 = AtomicU64::new(0);
    LOOKS.fetch_add(1, Ordering::Relaxed) * 1000
}

/// One picture and its figures per camera.
fn draw(scene: &Scene, cameras: &[Camera], settings: &Settings) -> Vec<(Vec<u8>, FrameStats)> {
    pollster::block_on(async {
        let gpu = Gpu::open(None)
            .await
            .expect("the tests need a graphics adapter");
        let mut renderer = Renderer::new(
            &gpu,
            settings,
            foveal::RendererOptions::default().with_clock(clock_ns),
        )
        .await
        .expect("settings fit");
        renderer.set_scene(scene).await.expect("scene fits");
        let mut drawn = Vec::new();
        for camera in cameras {
            let stats = renderer.render(&Frame::new(camera)).await.expect("drawn");
            drawn.push((renderer.read_picture().await.expect("read back"), stats));
        }
        drawn
    })
}

/// Draws with and without culling; returns how many objects were hidden and outside in all.
fn assert_same_pictures(
    name: &str,
    scene: &Scene,
    cameras: &[Camera],
    width: u32,
    height: u32,
) -> (u64, u64) {
    let settings = |culling| {
        Settings::default().with(|s| {
            s.picture.width = width;
            s.picture.height = height;
            s.culling.mode = culling;
        })
    };
    let reference = draw(scene, cameras, &settings(Culling::Off));
    let (mut occluded, mut outside) = (0, 0);
    for culling in [Culling::Auto, Culling::Frustum, Culling::Occlusion] {
        let culled = draw(scene, cameras, &settings(culling));
        for (i, ((expected, all), (picture, some))) in reference.iter().zip(&culled).enumerate() {
            let differing = expected
                .chunks_exact(4)
                .zip(picture.chunks_exact(4))
                .filter(|(a, b)| a != b)
                .count();
            assert_eq!(
                differing,
                0,
                "{name}, {culling:?}, camera {i} at {}: pixels differ",
                cameras[i].eye()
            );
            assert!(some.triangles <= all.triangles);
            let objects = some.objects_visible + some.objects_outside + some.objects_occluded;
            assert_eq!(objects, scene.objects.len() as u64);
            outside += some.objects_outside;
            occluded += some.objects_occluded;
        }
    }
    (occluded, outside)
}

#[test]
fn the_walk_through_the_demo_scene_looks_the_same_with_and_without_culling() {
    let options = DemoOptions {
        instances: 1500,
        ..DemoOptions::default()
    };
    let scene = generate::demo(&options).expect("options fit");
    let mut cameras: Vec<Camera> = (0..6)
        .map(|i| generate::demo_path(&options, i as f32 / 6.0))
        .collect();
    cameras.extend(scene.cameras.iter().cloned());
    // A size that is no multiple of four.
    let (occluded, outside) = assert_same_pictures("demo", &scene, &cameras, 253, 143);
    assert!(
        occluded > 500 && outside > 500,
        "{occluded} hidden, {outside} outside"
    );
}

#[test]
fn a_result_that_is_kept_while_the_eye_moves_a_little_leaves_the_picture_as_it_is() {
    let options = DemoOptions {
        instances: 1500,
        ..DemoOptions::default()
    };
    let scene = generate::demo(&options).expect("options fit");
    // Two places, and small steps around each, all with the same direction.
    let cameras: Vec<Camera> = [0.1, 0.6]
        .map(|t| generate::demo_path(&options, t))
        .iter()
        .flat_map(|camera| {
            [
                [0.0; 3],
                [0.03, 0.0, 0.0],
                [0.0, -0.02, 0.03],
                [-0.049, 0.0, 0.0],
            ]
            .map(|step| {
                let mut moved = camera.clone();
                moved.world_from_view =
                    Mat4::from_translation(Vec3::from_array(step)) * camera.world_from_view;
                moved
            })
        })
        .collect();
    let settings = |culling| {
        Settings::default().with(|s| {
            s.picture.width = 253;
            s.picture.height = 143;
            s.culling.mode = culling;
            s.culling.radius_m = 0.05;
        })
    };
    let reference = draw(&scene, &cameras, &settings(Culling::Off));
    for culling in [Culling::Auto, Culling::Frustum, Culling::Occlusion] {
        let culled = draw(&scene, &cameras, &settings(culling));
        let mut hidden = 0;
        for (i, ((expected, _), (picture, stats))) in reference.iter().zip(&culled).enumerate() {
            assert!(expected == picture, "{culling:?}, camera {i}");
            assert_eq!(stats.culling_reused, i % 4 != 0, "{culling:?}, camera {i}");
            hidden += stats.objects_occluded;
        }
        assert_eq!(hidden > 200, culling != Culling::Frustum, "{hidden}");
    }
}

/// Two eyes see the same by each way of culling; returns how many objects each eye by itself and
/// one test for both hid.
///
/// The way of submission is given: `auto` takes what was fastest in a trial of each renderer, and
/// ways round edges differently.
fn assert_same_to_two_eyes(
    name: &str,
    scene: &Scene,
    cameras: &[Camera],
    stereo: Stereo,
    culling_radius: f32,
) -> [u64; 2] {
    let settings = |culling, culling_eyes| {
        Settings::default().with(|s| {
            s.picture.width = 189;
            s.picture.height = 107;
            s.culling.mode = culling;
            s.culling.eyes = culling_eyes;
            s.culling.radius_m = culling_radius;
            s.stereo.mode = stereo;
            s.stereo.output = Output::SideBySide;
        })
    };
    let reference = draw(scene, cameras, &settings(Culling::Off, CullingEyes::Each));
    [CullingEyes::Each, CullingEyes::Shared].map(|eyes| {
        let culled = draw(scene, cameras, &settings(Culling::Occlusion, eyes));
        for (i, ((expected, _), (picture, _))) in reference.iter().zip(&culled).enumerate() {
            assert!(
                expected == picture,
                "{name}, {stereo:?}, {eyes:?}, camera {i}"
            );
        }
        culled.iter().map(|(_, stats)| stats.objects_occluded).sum()
    })
}

#[test]
fn two_eyes_see_the_same_whether_culled_for_each_or_for_both_at_once() {
    let options = DemoOptions {
        instances: 1500,
        ..DemoOptions::default()
    };
    let scene = generate::demo(&options).expect("options fit");
    let mut cameras: Vec<Camera> = (0..4)
        .map(|i| generate::demo_path(&options, i as f32 / 4.0))
        .collect();
    // A small step, over which a result may be kept.
    let mut moved = cameras[3].clone();
    moved.world_from_view = Mat4::from_translation(Vec3::splat(0.01)) * moved.world_from_view;
    cameras.push(moved);
    for (stereo, radius, least) in [
        (Stereo::Instanced, 0.0, [200, 100]),
        (Stereo::TwoPass, 0.0, [200, 100]),
        (Stereo::Instanced, 0.02, [50, 50]),
    ] {
        let [each, shared] = assert_same_to_two_eyes("demo", &scene, &cameras, stereo, radius);
        println!("demo, {radius} m: {each} objects hidden for each eye, {shared} for both at once");
        assert!(each > least[0] && shared > least[1], "{each} {shared}");
    }
    if let Some(path) = shared("IntelCastle.glb") {
        let options = LoadOptions {
            max_texture_size: 64,
            ..LoadOptions::default()
        };
        let mut scene = foveal_scene::load(&path, &options).expect("loads");
        scene.light_by_default();
        let cameras = around(&scene);
        let [each, shared] =
            assert_same_to_two_eyes("IntelCastle", &scene, &cameras, Stereo::Instanced, 0.0);
        println!("IntelCastle: {each} objects hidden for each eye, {shared} for both at once");
        assert!(shared > 0 && shared <= each, "{each} {shared}");
    }
}

#[test]
fn a_time_budget_draws_more_and_leaves_the_picture_as_it_is() {
    let scene = generate::demo(&DemoOptions {
        instances: 1500,
        ..DemoOptions::default()
    })
    .expect("options fit");
    let draw = |culling, culling_budget| {
        let settings = Settings::default().with(|s| {
            s.picture.width = 120;
            s.picture.height = 90;
            s.culling.mode = culling;
            s.culling.budget_ms = culling_budget;
            s.culling.threads = 1;
        });
        draw(&scene, &scene.cameras[..1], &settings).remove(0)
    };
    let (expected, _) = draw(Culling::Off, 0.0);
    let (all, free) = draw(Culling::Occlusion, 0.0);
    let (some, short) = draw(Culling::Occlusion, 0.002);
    assert!(expected == all && expected == some);
    assert_eq!(free.occluders_over_budget, 0);
    assert!(short.occluders_over_budget > 0);
    assert!(short.objects_visible > free.objects_visible);
}

#[test]
fn an_orthographic_view_looks_the_same_with_and_without_culling() {
    let scene = generate::cornell();
    let mut camera = scene.cameras[0].clone();
    camera.projection = Projection::Orthographic {
        height_m: 3.0,
        near_m: 0.1,
        far_m: 40.0,
    };
    assert_same_pictures(
        "cornell",
        &scene,
        &[camera, scene.cameras[0].clone()],
        120,
        90,
    );
}

fn shared(scene: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data/scenes")
        .join(scene);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {} is not there", path.display());
    None
}

/// Cameras in the scene's centre that look all around, and one from outside.
fn around(scene: &Scene) -> Vec<Camera> {
    let bounds = scene.bounds();
    let eye = bounds.center() - 0.3 * bounds.size() * Vec3::Y;
    let directions = [
        Vec3::X,
        Vec3::NEG_X,
        Vec3::new(0.3, -0.1, 1.0),
        Vec3::new(-0.2, 0.3, -1.0),
    ];
    let mut cameras: Vec<Camera> = directions
        .map(|d| Camera::look_at(eye, eye + d, Vec3::Y, 1.2))
        .to_vec();
    cameras.extend(scene.cameras.iter().cloned());
    cameras.push(scene.overview_camera());
    cameras
}

#[test]
fn scenes_from_files_look_the_same_with_and_without_culling() {
    for name in ["Sponza.glb", "IntelCastle.glb", "oa_minia.glb"] {
        let Some(path) = shared(name) else { continue };
        let options = LoadOptions {
            max_texture_size: 64,
            ..LoadOptions::default()
        };
        let mut scene = foveal_scene::load(&path, &options).expect("loads");
        scene.light_by_default();
        let (occluded, _) = assert_same_pictures(name, &scene, &around(&scene), 320, 180);
        assert!(occluded > 0, "{name}: nothing is hidden");
    }
}
