//! Coarse frames on the device against full ones, against their twins, and against each other.

use foveal_generate as generate;
use foveal_scene::Scene;

use super::block::sample_texel;
use crate::testing::{gpu, picture, rate_cells, rendered, small, texels};
use crate::{
    CoarseBackend, CoarseSample, Composite, Frame, MinPyramid, RateImage, RateSource, RefineEdges,
    Renderer, Settings, Shading,
};

/// Odd sizes, one smaller than a block of the coarsest level.
const SIZES: [(u32, u32); 3] = [(301, 187), (130, 300), (1, 1)];

const ALL_COMPOSITES: [Composite; 4] = [
    Composite::Light,
    Composite::Smooth,
    Composite::Paper,
    Composite::Nearest,
];

fn scene() -> Scene {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 20, 5);
    scene
}

fn nearest(size: (u32, u32)) -> Settings {
    small(size.0, size.1).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.composite = Composite::Nearest;
        s.coarse.source = RateSource::Radii;
        s.coarse.fovea_inner = 0.2;
        s.coarse.fovea_outer = 0.6;
        s.eye.gaze = [0.3, 0.6];
    })
}

fn draw(settings: &Settings) -> Renderer {
    let scene = scene();
    rendered(&scene, &scene.cameras[0], settings)
}

fn draw_with_image(settings: &Settings, image: RateImage) -> Renderer {
    let scene = scene();
    pollster::block_on(async {
        let mut renderer = Renderer::new(gpu(), settings, crate::RendererOptions::default())
            .await
            .unwrap();
        renderer.set_rate_image(image).unwrap();
        renderer.set_scene(&scene).await.unwrap();
        let frame = Frame::new(&scene.cameras[0]);
        renderer.render(&frame).await.unwrap();
        renderer
    })
}

fn radiance(renderer: &Renderer) -> Vec<[u16; 4]> {
    texels(&renderer.targets().radiance_view)
}

/// The tiling that the device's requested levels, which are those of 2 x 2 pixels, give on the CPU.
fn twin(renderer: &Renderer) -> MinPyramid {
    let s = renderer.settings();
    let rate = &renderer.targets().coarse.as_ref().unwrap().rate;
    let quads = rate_cells(&rate.pyramid, 1);
    let across = s.picture.width.div_ceil(2);
    let requests: Vec<u8> = (0..s.picture.width * s.picture.height)
        .map(|i| quads[(i / s.picture.width / 2 * across + i % s.picture.width / 2) as usize])
        .collect();
    MinPyramid::new(
        s.picture.width,
        &requests,
        s.coarse.coarsest_level,
        s.coarse.balance,
    )
}

fn noise_image(side: u32, seed: u32) -> RateImage {
    let luma = (0..side * side)
        .map(|i| ((i + seed).wrapping_mul(0x9e37_79b1) >> 24) as u8)
        .collect();
    RateImage::new(side, side, luma).unwrap()
}

#[test]
fn the_rate_map_equals_its_twin_byte_for_byte() {
    for size in SIZES {
        for (balance, image_side) in [(false, 3), (true, 7), (false, 40)] {
            let settings = nearest(size).with(|s| {
                s.coarse.source = RateSource::Image;
                s.coarse.balance = balance;
            });
            let renderer = draw_with_image(&settings, noise_image(image_side, 1));
            let rate = &renderer.targets().coarse.as_ref().unwrap().rate;
            let twin = twin(&renderer);
            for level in 1..=8u8 {
                assert_eq!(
                    rate_cells(&rate.pyramid, level.into()),
                    twin.cells(level),
                    "{size:?}, level {level}"
                );
            }
            let owners = rate_cells(&rate.owner, 1);
            for (i, owner) in (0..size.0 * size.1).map(|i| {
                let quad = i / size.0 / 2 * size.0.div_ceil(2) + i % size.0 / 2;
                (i, owners[quad as usize])
            }) {
                let (x, y) = (i % size.0, i / size.0);
                let level = twin.owner_level(x, y);
                assert_eq!(owner & 15, level);
                let (width, _) = twin.size(level);
                let cell = twin.cells(level)[((y >> level) * width + (x >> level)) as usize];
                assert_eq!(owner & 128, cell & 128);
            }
        }
    }
}

#[test]
fn requested_levels_equal_their_twin() {
    for rate in [RateSource::Foveated, RateSource::Radii, RateSource::Image] {
        let settings = (nearest(SIZES[0])).with(|s| {
            s.coarse.source = rate;
            s.coarse.refine_edges = RefineEdges::Off;
        });
        let image = noise_image(5, 9);
        let renderer = draw_with_image(&settings, image.clone());
        let rate = &renderer.targets().coarse.as_ref().unwrap().rate;
        let eyes = crate::stereo::eyes(&settings, &scene().cameras[0]).unwrap();
        let uniform = crate::rate::RequestUniform::new(&settings, &eyes, None);
        let quads = rate_cells(&rate.pyramid, 1);
        let level = |x: u32, y: u32| {
            let (x, y) = (x.min(SIZES[0].0 - 1), y.min(SIZES[0].1 - 1));
            uniform.level(&settings, x, y, Some(&image))
        };
        let differing = (0..)
            .zip(quads)
            .filter(|&(i, request)| {
                let across = settings.picture.width.div_ceil(2);
                let (x, y) = (i % across * 2, i / across * 2);
                let finest = level(x, y)
                    .min(level(x + 1, y))
                    .min(level(x, y + 1))
                    .min(level(x + 1, y + 1));
                finest != request
            })
            .count();
        // A squared distance may round to either side of a radius.
        assert!(differing <= 2, "{differing} requests differ");
    }
}

#[test]
fn both_backends_give_the_same_bytes() {
    for size in SIZES {
        for (coarse_sample, composite) in [
            (CoarseSample::Center, Composite::Nearest),
            (CoarseSample::Typical, Composite::Nearest),
            (CoarseSample::Center, Composite::Light),
            (CoarseSample::Typical, Composite::Light),
        ] {
            let [stencil, compute] =
                [CoarseBackend::Stencil, CoarseBackend::Compute].map(|backend| {
                    draw(&nearest(size).with(|s| {
                        s.coarse.backend = backend;
                        s.coarse.sample = coarse_sample;
                        s.coarse.composite = composite;
                    }))
                });
            assert_eq!(radiance(&stencil), radiance(&compute));
            assert_eq!(picture(&stencil), picture(&compute));
        }
    }
}

#[test]
fn level_zero_everywhere_is_full_shading() {
    for size in SIZES {
        for composite in ALL_COMPOSITES {
            let full = draw(&small(size.0, size.1));
            for backend in [CoarseBackend::Stencil, CoarseBackend::Compute] {
                let coarse = draw(&nearest(size).with(|s| {
                    s.coarse.source = RateSource::Constant;
                    s.coarse.constant_level = 0;
                    s.coarse.backend = backend;
                    s.coarse.composite = composite;
                }));
                assert!(picture(&coarse) == picture(&full), "{size:?} {composite:?}");
                assert!(radiance(&coarse) == radiance(&full));
            }
        }
    }
}

#[test]
fn each_pixel_shows_its_tiles_sample_and_level_zero_is_full_shading() {
    let size = SIZES[0];
    let full = radiance(&draw(&small(size.0, size.1)));
    let coarse = draw(&nearest(size));
    let twin = twin(&coarse);
    let mut levels = [0; 9];
    for (i, pixel) in (0..).zip(radiance(&coarse)) {
        let (x, y) = (i % size.0, i / size.0);
        let level = twin.owner_level(x, y);
        levels[usize::from(level)] += 1;
        let (sx, sy) = sample_texel((x >> level, y >> level), level.into(), 0, size);
        assert_eq!(pixel[..3], full[(sy * size.0 + sx) as usize][..3]);
    }
    assert!(levels.iter().filter(|&&n| n > 0).count() >= 5, "{levels:?}");
}

#[test]
fn the_fovea_of_every_composite_is_full_shading() {
    let size = SIZES[0];
    let full = radiance(&draw(&small(size.0, size.1)));
    for composite in ALL_COMPOSITES {
        let coarse = draw(&nearest(size).with(|s| s.coarse.composite = composite));
        let twin = twin(&coarse);
        let mut fine = 0;
        for (i, pixel) in (0..).zip(radiance(&coarse)) {
            if twin.owner_level(i % size.0, i / size.0) == 0 {
                assert_eq!(pixel, full[i as usize], "{composite:?}");
                fine += 1;
            }
        }
        assert!(fine > 1000);
    }
}

#[test]
fn shaded_samples_are_the_tiles() {
    let scene = scene();
    for backend in [CoarseBackend::Stencil, CoarseBackend::Compute] {
        let settings = (nearest(SIZES[0])).with(|s| s.coarse.backend = backend);
        let mut renderer = draw(&settings);
        let frame = Frame::new(&scene.cameras[0]);
        let stats = pollster::block_on(renderer.render(&frame)).unwrap();
        let tiles = twin(&renderer).tiles();
        assert_eq!(stats.shaded_samples, tiles.iter().sum::<u64>());
        assert_eq!(stats.coarse.unwrap().samples_per_level, tiles);
    }
}

#[test]
fn the_automatic_backend_settles_and_says_why() {
    let scene = scene();
    let mut renderer = draw(&nearest(SIZES[0]));
    let frame = Frame::new(&scene.cameras[0]);
    let reasons: Vec<String> = (0..8)
        .map(|_| pollster::block_on(renderer.render(&frame)).unwrap())
        .map(|stats| stats.coarse.unwrap().backend_reason)
        .collect();
    assert_ne!(reasons[7], "measuring");
}

#[test]
fn resizing_keeps_the_choice_and_draws_the_same_as_a_fresh_renderer() {
    let scene = scene();
    let frame = Frame::new(&scene.cameras[0]);
    let mut renderer = draw(&nearest(SIZES[1]));
    let settings = nearest(SIZES[0]);
    pollster::block_on(async {
        renderer.set_settings(&settings).await.unwrap();
        renderer.render(&frame).await.unwrap();
    });
    assert!(picture(&renderer) == picture(&draw(&settings)));
}
