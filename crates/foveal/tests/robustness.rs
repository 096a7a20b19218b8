//! What a long run and a failing device do.
#![allow(
    clippy::print_stdout,
    reason = "a test says what it skipped and what it measured"
)]

use foveal::{Error, Frame, Gpu, Renderer, Settings};
use foveal_generate as generate;
use foveal_scene::{Light, LightKind, Scene};

fn open() -> Gpu {
    pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter")
}

fn renderer(gpu: &Gpu, settings: &Settings) -> Renderer {
    pollster::block_on(Renderer::new(
        gpu,
        settings,
        foveal::RendererOptions::default(),
    ))
    .expect("settings fit")
}

/// Resident memory of this process in bytes.
#[cfg(target_os = "linux")]
fn resident_bytes() -> u64 {
    let statm = std::fs::read_to_string("/proc/self/statm").expect("Linux tells");
    let pages: u64 = statm
        .split_whitespace()
        .nth(1)
        .and_then(|p| p.parse().ok())
        .expect("a number of pages");
    pages * 4096
}

#[cfg(target_os = "linux")]
#[test]
fn a_thousand_frames_with_a_resize_every_fifty_leave_memory_flat() {
    let gpu = open();
    let mut settings = Settings::default().with(|s| {
        s.picture.width = 96;
        s.picture.height = 54;
    });
    let mut renderer = renderer(&gpu, &settings);
    let scene = generate::cornell();
    let frame = Frame::new(&scene.cameras[0]);
    let mut at = Vec::new();
    pollster::block_on(async {
        renderer.set_scene(&scene).await.expect("scene fits");
        for i in 0..1000 {
            if i % 50 == 0 {
                // Ten sizes, each once in the first half and once in the second.
                let step = i / 50 % 10;
                settings.picture.width = 96 + 32 * step;
                settings.picture.height = 54 + 18 * step;
                renderer
                    .set_settings(&settings)
                    .await
                    .expect("settings fit");
            }
            renderer.render(&frame).await.expect("drawn");
            if i % 500 == 499 {
                at.push(resident_bytes());
            }
        }
    });
    let growth = at[1].saturating_sub(at[0]);
    println!(
        "resident after 500 frames {} KiB, after 1000 {} KiB",
        at[0] >> 10,
        at[1] >> 10
    );
    assert!(
        growth < 4 << 20,
        "memory grew by {growth} bytes over 500 frames"
    );
}

#[test]
fn a_lost_device_is_an_error_and_no_panic() {
    let gpu = open();
    let scene = generate::cornell();
    let frame = Frame::new(&scene.cameras[0]);
    let mut renderer = renderer(
        &gpu,
        &Settings::default().with(|s| {
            s.picture.width = 64;
            s.picture.height = 36;
        }),
    );
    pollster::block_on(async {
        renderer.set_scene(&scene).await.expect("scene fits");
        renderer.render(&frame).await.expect("drawn");
        gpu.device.destroy();
        let lost = renderer.render(&frame).await;
        assert!(matches!(lost, Err(Error::DeviceLost { .. })), "{lost:?}");
        let lost = renderer.read_picture().await;
        assert!(matches!(lost, Err(Error::DeviceLost { .. })), "{lost:?}");
        let lost = renderer.set_scene(&scene).await;
        assert!(matches!(lost, Err(Error::DeviceLost { .. })), "{lost:?}");
    });
}

#[test]
fn settings_that_cannot_be_met_name_the_limit() {
    let gpu = open();
    let limit = u64::from(gpu.device.limits().max_texture_dimension_2d);
    let absurd = Settings::default().with(|s| s.picture.width = 1_000_000);
    match pollster::block_on(Renderer::new(
        &gpu,
        &absurd,
        foveal::RendererOptions::default(),
    )) {
        Err(Error::Limit {
            value: 1_000_000,
            limit: l,
            ..
        }) => assert_eq!(l, limit),
        other => panic!("{other:?}"),
    }
    for bad in [
        Settings::default().with(|s| s.picture.height = 0),
        Settings::default().with(|s| s.picture.exposure_stops = f32::NAN),
        Settings::default().with(|s| s.lighting.anisotropy = 17),
    ] {
        let refused = pollster::block_on(Renderer::new(
            &gpu,
            &bad,
            foveal::RendererOptions::default(),
        ));
        assert!(matches!(refused, Err(Error::Setting { .. })), "{refused:?}");
    }
}

#[test]
fn a_scene_over_a_limit_is_refused_and_the_old_one_stays() {
    let gpu = open();
    let mut renderer = renderer(
        &gpu,
        &Settings::default().with(|s| {
            s.picture.width = 64;
            s.picture.height = 36;
        }),
    );
    let scene = generate::cornell();
    let frame = Frame::new(&scene.cameras[0]);
    pollster::block_on(async {
        renderer.set_scene(&scene).await.expect("scene fits");
        let before = renderer.render(&frame).await.expect("drawn").triangles;
        let light = Light {
            kind: LightKind::Point,
            color: glam::Vec3::ONE,
            intensity: 1.0,
            position: glam::Vec3::ZERO,
            direction: glam::Vec3::NEG_Y,
            range_m: Some(1.0),
            node: None,
        };
        let too_many = Scene {
            lights: vec![light; 20_000],
            ..generate::cornell()
        };
        let refused = renderer.set_scene(&too_many).await;
        assert!(
            matches!(refused, Err(Error::Limit { value: 20_000, .. })),
            "{refused:?}"
        );
        assert_eq!(
            renderer.render(&frame).await.expect("drawn").triangles,
            before
        );
    });
}

#[test]
fn an_unknown_adapter_lists_those_that_there_are() {
    let refused = pollster::block_on(Gpu::open(Some("no such adapter"))).map(|_| ());
    match refused {
        Err(Error::NoAdapter { wanted, available }) => {
            assert!(
                wanted.contains("no such adapter") && available.contains("0:"),
                "{wanted} {available}"
            );
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_empty_scene_shows_the_backdrop() {
    let gpu = open();
    let mut renderer = renderer(
        &gpu,
        &Settings::default().with(|s| {
            s.picture.width = 16;
            s.picture.height = 9;
        }),
    );
    let scene = Scene::default();
    let camera = scene.overview_camera();
    pollster::block_on(async {
        renderer.set_scene(&scene).await.expect("scene fits");
        let stats = renderer.render(&Frame::new(&camera)).await.expect("drawn");
        assert_eq!(
            (stats.draws, stats.triangles, stats.shaded_samples),
            (0, 0, 144)
        );
        let picture = renderer.read_picture().await.expect("read back");
        assert!(picture.chunks_exact(4).all(|p| p[2] > 60), "a sky");
    });
}
