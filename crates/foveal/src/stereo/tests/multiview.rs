//! Multiview, on a driver that is right.

use std::sync::OnceLock;
use std::time::Instant;

use foveal_generate as generate;

use super::equal::difference;
use super::{halves, two_eyes};
use crate::stereo::{Submission, Trials};
use crate::testing::{gpu, picture, rendered, small};
use crate::{
    CoarseBackend, Composite, DebugView, Geometry, Output, RateSource, RateStage, Renderer,
    Settings, Shading, Stereo,
};

/// SwiftShader, as Debian's chromium brings it.
const DRIVER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";
/// Tells the process that runs on it from the one that starts it.
const CHILD: &str = "FOVEAL_TEST_ON_SWIFTSHADER";

/// Runs this process's test `name` again on SwiftShader; `true` in that process, which is to do the
/// work.
fn on_swiftshader(name: &str) -> bool {
    if std::env::var_os(CHILD).is_some() {
        return true;
    }
    if !std::path::Path::new(DRIVER).exists() {
        println!("skipped: {DRIVER} is missing (on Debian: apt-get install chromium)");
        return false;
    }
    let this = std::env::current_exe().expect("a test runs from a file");
    let ended = std::process::Command::new(this)
        .args(["--exact", name, "--nocapture"])
        .env("VK_DRIVER_FILES", DRIVER)
        .env("VK_ICD_FILENAMES", DRIVER)
        .env("WGPU_BACKEND", "vulkan")
        .env(CHILD, "1")
        .output()
        .expect("it starts");
    let said = String::from_utf8_lossy(&ended.stdout) + String::from_utf8_lossy(&ended.stderr);
    // A name that no test has runs none, which is a success.
    let has_run = said.contains("test result: ok. 1 passed");
    assert!(ended.status.success() && has_run, "on SwiftShader: {said}");
    false
}

fn of(settings: &Settings, stereo: Stereo) -> Settings {
    settings.clone().with(|s| s.stereo.mode = stereo)
}

/// Settings in which geometry is drawn and read in all ways.
fn pipelines(base: &Settings) -> Vec<Settings> {
    let shading = |shading| base.clone().with(|s| s.shading.mode = shading);
    let coarse = |composite, backend| {
        shading(Shading::Coarse).with(|s| {
            s.coarse.coarsest_level = 4;
            s.coarse.composite = composite;
            s.coarse.backend = backend;
        })
    };
    let variable = shading(Shading::Variable).with(|s| {
        s.coarse.source = RateSource::Content;
        s.rate.force = true;
    });
    let visibility = Geometry::Visibility;
    let mut all = vec![
        base.clone(),
        coarse(Composite::Light, CoarseBackend::Stencil),
        coarse(Composite::Smooth, CoarseBackend::Compute),
        coarse(Composite::Paper, CoarseBackend::Stencil),
        variable.clone(),
        base.clone().with(|s| s.geometry.path = visibility),
        variable.with(|s| {
            s.geometry.path = visibility;
            s.rate.stage = RateStage::Both;
        }),
    ];
    let views = [
        DebugView::Instances,
        DebugView::Depth,
        DebugView::Motion,
        DebugView::Normals,
    ];
    all.extend(views.map(|view| base.clone().with(|s| s.picture.view = view)));
    all
}

#[test]
fn multiview_equals_two_passes() {
    if !on_swiftshader("stereo::tests::multiview::multiview_equals_two_passes") {
        return;
    }
    let base = two_eyes(151, 101);
    for scene in [
        generate::cornell(),
        generate::alpha(),
        generate::materials_grid(),
    ] {
        let camera = scene.cameras.first().cloned();
        let camera = camera.unwrap_or_else(|| scene.overview_camera());
        for settings in pipelines(&base) {
            let expected = halves(&scene, &camera, &of(&settings, Stereo::TwoPass));
            let seen = halves(&scene, &camera, &of(&settings, Stereo::Multiview));
            for eye in 0..2 {
                let (differing, by) = difference(&expected[eye], &seen[eye]);
                let what = format!("{}, eye {eye}: {differing} by {by}", scene.name);
                // The right eye's half of a wide target is rounded otherwise than a layer: normals
                // of normal maps in the scene `alpha` differ in their last bit, and one pixel lies
                // on an edge.
                let rounded = usize::from(eye == 1 && scene.name == "alpha");
                assert!(differing <= rounded * expected[eye].len() / 100, "{what}");
                let pairs = expected[eye].iter().zip(&seen[eye]);
                let far = pairs.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2));
                assert!(far.count() <= 2 * rounded, "{what}");
            }
        }
    }
}

#[test]
fn layers_of_two_eyes_in_one_place_are_one_eyes_picture_to_the_bit() {
    if !on_swiftshader(
        "stereo::tests::multiview::layers_of_two_eyes_in_one_place_are_one_eyes_picture_to_the_bit",
    ) {
        return;
    }
    // No multiple of a block.
    for mono in pipelines(&small(150, 101)) {
        if mono.shading.mode == Shading::Coarse && mono.coarse.composite == Composite::Smooth {
            // Its patches are fitted in positions of the target: rounding decides over a few of
            // them.
            continue;
        }
        for scene in [generate::cornell(), generate::alpha()] {
            let camera = &scene.cameras[0];
            let one: Vec<[u8; 4]> =
                bytemuck::pod_collect_to_vec(&picture(&rendered(&scene, camera, &mono)));
            let both = of(&mono, Stereo::Multiview).with(|s| {
                s.stereo.ipd_m = 0.0;
                // Another gaze has its own picture, though nothing looks at the gaze here.
                s.stereo.gaze_shift = [0.0, f32::MIN_POSITIVE];
                s.stereo.output = Output::SideBySide;
            });
            for half in halves(&scene, camera, &both) {
                assert_eq!(difference(&one, &half), (0, 0), "{}", scene.name);
            }
        }
    }
}

#[test]
fn multiview_that_a_driver_draws_wrong_is_refused() {
    // Here on the default device, and there on another.
    if std::path::Path::new(DRIVER).exists() {
        on_swiftshader("stereo::tests::multiview::multiview_that_a_driver_draws_wrong_is_refused");
    }
    let gpu = gpu();
    let settings = of(&two_eyes(64, 48), Stereo::Multiview);
    let made = pollster::block_on(Renderer::new(
        gpu,
        &settings,
        crate::RendererOptions::default(),
    ));
    let right = gpu.has_multiview() && {
        let verdict = pollster::block_on(Trials::default().of(gpu, Submission::Multiview, None));
        verdict.expect("a trial").is_right()
    };
    assert_eq!(made.is_ok(), right);
    let driver = gpu.adapter_stats().driver;
    if driver.contains("Mesa 22.3") && gpu.has_multiview() {
        let error = made.err().map_or(String::new(), |error| error.to_string());
        assert!(error.contains("the driver draws it wrong"), "'{error}'");
    } else if std::env::var_os(CHILD).is_some() {
        assert!(right, "{driver} is right");
    }
}

#[test]
fn auto_takes_a_way_that_is_right_and_says_why() {
    fn clock() -> u64 {
        static START: OnceLock<Instant> = OnceLock::new();
        START.get_or_init(Instant::now).elapsed().as_nanos() as u64
    }
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    for (clock, said) in [
        (Some(clock as crate::Clock), "fastest in a trial"),
        (None, "right in a trial"),
    ] {
        pollster::block_on(async {
            let settings = of(&two_eyes(64, 48), Stereo::Auto);
            let mut renderer = Renderer::new(gpu(), &settings, crate::RendererOptions { clock })
                .await
                .expect("fits");
            renderer.set_scene(&scene).await.expect("fits");
            let stereo = renderer.redraw(camera).stereo.expect("two eyes");
            assert!(stereo.reason.contains(said), "{stereo:?}");
            let way = match stereo.mode.as_str() {
                "multiview" => Submission::Multiview,
                "two-pass" => Submission::TwoPass { clips: false },
                mode => Submission::Instanced {
                    clips: mode == "instanced-clip",
                },
            };
            let verdict = Trials::default().of(gpu(), way, None).await;
            assert!(verdict.expect("a trial").is_right(), "{stereo:?}");
        });
    }
}
