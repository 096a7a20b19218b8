//! Composites on the device: exactness on affine radiance, and no mixing of surfaces.

use foveal_generate as generate;
use foveal_scene::{Camera, Light, LightKind, Material, Scene};
use glam::Vec3;

use crate::forward::twin::quads;
use crate::testing::{f32_of_half, gpu, rendered, small, texels};
use crate::{CoarseSample, Composite, Frame, RateImage, RateSource, Renderer, Settings, Shading};

/// A map of random patches, `side` across.
fn random_map(side: u32, seed: u32) -> RateImage {
    let luma = (0..side * side)
        .map(|i| {
            let h = (i + seed * 7919).wrapping_mul(0x9e37_79b1);
            ((h ^ h >> 15).wrapping_mul(0x2c1b_3c6d) >> 24) as u8
        })
        .collect();
    RateImage::new(side, side, luma).unwrap()
}

/// Nothing but the backdrop.
fn backdrop() -> (Scene, Camera) {
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
    (Scene::default(), camera)
}

/// The back wall of the box room, seen at a slant: it fills the picture.
fn wall() -> (Scene, Camera) {
    let eye = Vec3::new(-1.0, 2.2, -1.2);
    let camera = Camera::look_at(eye, Vec3::new(-0.5, 2.3, -2.0), Vec3::Y, 0.35);
    (generate::cornell(), camera)
}

/// The largest deviation from the affine radiance, and where.
fn affine_error(
    (scene, camera): &(Scene, Camera),
    settings: &Settings,
    map: RateImage,
) -> (f32, u32, u32) {
    let renderer = pollster::block_on(async {
        let mut renderer = Renderer::new(gpu(), settings, crate::RendererOptions::default())
            .await
            .unwrap();
        renderer.set_rate_image(map).unwrap();
        renderer.set_scene(scene).await.unwrap();
        renderer.shade_affine();
        let frame = Frame::new(camera);
        renderer.render(&frame).await.unwrap();
        renderer
    });
    let size = (settings.picture.width, settings.picture.height);
    let mut worst = (0.0, 0, 0);
    for (i, texel) in (0..).zip(texels::<[u16; 4]>(&renderer.targets().radiance_view)) {
        let (x, y) = (i % size.0, i / size.0);
        let at = (
            (x as f32 + 0.5) / size.0 as f32,
            (y as f32 + 0.5) / size.1 as f32,
        );
        let expected = [at.0, at.1, 0.5 + 0.25 * at.0 - 0.5 * at.1];
        for (channel, expected) in expected.into_iter().enumerate() {
            let error = (f32_of_half(texel[channel]) - expected).abs();
            if error > worst.0 {
                worst = (error, x, y);
            }
        }
    }
    worst
}

fn settings(size: (u32, u32), seed: u32) -> Settings {
    small(size.0, size.1).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.composite = Composite::Smooth;
        s.coarse.source = RateSource::Image;
        s.coarse.balance = seed.is_multiple_of(2);
    })
}

#[test]
fn smooth_returns_affine_radiance_for_random_maps() {
    // More than a block of the coarsest level in either direction, and no multiple of one.
    for (seed, size) in [
        (0, (601, 523)),
        (1, (601, 523)),
        (2, (900, 270)),
        (3, (270, 777)),
    ] {
        for view in [backdrop(), wall()] {
            for side in [2, 5, 11, 31] {
                let (error, x, y) =
                    affine_error(&view, &settings(size, seed), random_map(side, seed));
                assert!(
                    error <= 1.0 / 255.0,
                    "{size:?}, map of {side}, seed {seed}: {} / 255 at {x}, {y}",
                    error * 255.0
                );
            }
        }
    }
}

#[test]
fn smooth_returns_affine_radiance_for_typical_samples() {
    let settings = settings((601, 523), 1).with(|s| s.coarse.sample = CoarseSample::Typical);
    let (error, x, y) = affine_error(&wall(), &settings, random_map(7, 3));
    assert!(error <= 1.0 / 255.0, "{} / 255 at {x}, {y}", error * 255.0);
}

#[test]
fn the_sources_composite_bends_affine_radiance() {
    let settings = settings((601, 523), 1).with(|s| s.coarse.composite = Composite::Paper);
    assert!(affine_error(&backdrop(), &settings, random_map(7, 3)).0 > 8.0 / 255.0);
}

#[test]
fn patches_too_large_for_the_device_are_an_error_that_says_so() {
    let limits = wgpu::Limits::default();
    let large = Settings::default().with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.composite = Composite::Smooth;
        s.picture.width = 7680;
        s.picture.height = 4320;
    });
    let said = large.validate(&limits).unwrap_err().to_string();
    assert!(
        said.contains("patches") && said.contains("134217728"),
        "{said}"
    );
    let full_hd = large.clone().with(|s| {
        s.picture.width = 1920;
        s.picture.height = 1080;
    });
    assert!(full_hd.validate(&limits).is_ok());
    let nearest = large.with(|s| s.coarse.composite = Composite::Nearest);
    assert!(nearest.validate(&limits).is_ok());
}

#[test]
fn what_is_as_bright_as_a_half_holds_stays_bright_at_the_border() {
    let material = Material {
        metallic: 0.0,
        ..Material::default()
    };
    let mut scene = quads(vec![material], &[0.0]);
    scene.lights = vec![Light {
        kind: LightKind::Point,
        color: Vec3::ONE,
        intensity: 3e4,
        position: Vec3::new(-0.87, 0.0, 0.05),
        direction: Vec3::NEG_Z,
        range_m: Some(50.0),
        node: None,
    }];
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, Vec3::Y, 0.92);
    let settings = small(64, 64).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = 3;
        s.coarse.composite = Composite::Smooth;
        s.picture.exposure_stops = -15.0;
    });
    let drawn = rendered(&scene, &camera, &settings);
    let radiance: Vec<[u16; 4]> = texels(&drawn.targets().radiance_view);
    let at = |x: usize, y: usize| f32_of_half(radiance[y * 64 + x][0]);
    assert!(
        radiance
            .iter()
            .flatten()
            .all(|&half| f32_of_half(half).is_finite())
    );
    let lit = at(4, 32);
    assert!(lit > 20_000.0, "{lit}");
    for x in 0..4 {
        assert!(at(x, 32) >= 0.9 * lit, "{x}: {} beside {lit}", at(x, 32));
    }
}
