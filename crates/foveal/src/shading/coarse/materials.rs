//! Coarse frames over a visibility buffer, materials being evaluated where tiles are sampled and
//! nowhere else.

use foveal_generate as generate;
use foveal_scene::{Camera, Projection, Scene};
use glam::UVec2;

use super::block::sample_texel;
use crate::shading::twin::{normal_of_depth, unit_from_octahedral};
use crate::testing::{gpu, picture, rate_cells, rendered, small, texels};
use crate::{
    Antialiasing, CoarseSample, Composite, Error, Geometry, RateSource, RateStage, RefineEdges,
    Renderer, Settings, Shading, Stereo,
};

const SIZE: (u32, u32) = (203, 131);

fn scene() -> Scene {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 20, 5);
    scene
}

fn settings(rate_stage: RateStage) -> Settings {
    small(SIZE.0, SIZE.1).with(|s| {
        s.geometry.path = Geometry::Visibility;
        s.shading.mode = Shading::Coarse;
        s.coarse.composite = Composite::Nearest;
        s.coarse.source = RateSource::Radii;
        s.coarse.fovea_inner = 0.2;
        s.coarse.fovea_outer = 0.6;
        s.eye.gaze = [0.3, 0.6];
        s.coarse.refine_edges = RefineEdges::Off;
        s.rate.stage = rate_stage;
    })
}

/// Levels of the pixels' owners, row by row.
fn owners(renderer: &Renderer) -> Vec<u8> {
    let owner = &renderer.targets().coarse.as_ref().unwrap().rate.owner;
    let quads = rate_cells(owner, 1);
    let across = owner.blocks(1).0;
    (0..SIZE.0 * SIZE.1)
        .map(|i| quads[(i / SIZE.0 / 2 * across + i % SIZE.0 / 2) as usize] & 15)
        .collect()
}

#[test]
fn without_textures_materials_at_the_rate_give_the_same_bytes() {
    let scene = scene();
    for coarse_sample in [CoarseSample::Center, CoarseSample::Typical] {
        for stereo in [Stereo::Off, Stereo::Instanced] {
            let [lighting, both, auto] = [RateStage::Lighting, RateStage::Both, RateStage::Auto]
                .map(|stage| {
                    let settings = settings(stage).with(|s| {
                        s.coarse.sample = coarse_sample;
                        s.stereo.mode = stereo;
                    });
                    picture(&rendered(&scene, &scene.cameras[0], &settings))
                });
            assert!(lighting == both, "{coarse_sample:?} {stereo:?}");
            assert!(auto == both);
        }
    }
}

#[test]
fn surfaces_are_evaluated_where_tiles_are_sampled_and_nowhere_else() {
    let scene = generate::materials();
    let camera = &scene.cameras[0];
    for (coarse_sample, candidates) in [(CoarseSample::Center, 1), (CoarseSample::Typical, 5)] {
        let full = rendered(
            &scene,
            camera,
            &settings(RateStage::Lighting).with(|s| s.shading.mode = Shading::Full),
        );
        let full: Vec<[u32; 4]> = texels(&full.targets().gbuffer.surface_view);
        let coarse = rendered(
            &scene,
            camera,
            &settings(RateStage::Both).with(|s| s.coarse.sample = coarse_sample),
        );
        let surfaces: Vec<[u32; 4]> = texels(&coarse.targets().gbuffer.surface_view);
        let identity: Vec<[u32; 2]> = texels(&coarse.targets().gbuffer.identity_view);
        let mut fine = 0;
        let mut left_out = 0;
        for (i, level) in (0..).zip(owners(&coarse)) {
            let at = (i % SIZE.0, i / SIZE.0);
            let block = (at.0 >> level, at.1 >> level);
            let sampled = (0..candidates)
                .any(|candidate| sample_texel(block, level.into(), candidate, SIZE) == at);
            let i = i as usize;
            let seen = identity[i][0] != 0;
            // A surface with a normal and without a colour is none: unwritten texels are zero.
            assert_eq!(surfaces[i] != [0; 4], sampled && seen, "{at:?}");
            left_out += u32::from(seen && !sampled);
            if level == 0 {
                assert_eq!(surfaces[i], full[i]);
                fine += 1;
            }
        }
        assert!(fine > 1000 && left_out > 1000, "{fine} {left_out}");
    }
}

#[test]
fn level_zero_everywhere_is_full_shading() {
    let scene = generate::materials();
    let camera = &scene.cameras[0];
    for composite in [Composite::Nearest, Composite::Paper, Composite::Smooth] {
        let coarse = settings(RateStage::Both).with(|s| {
            s.coarse.source = RateSource::Constant;
            s.coarse.constant_level = 0;
            s.coarse.composite = composite;
        });
        let full = coarse.clone().with(|s| s.shading.mode = Shading::Full);
        let [coarse, full] = [coarse, full].map(|s| picture(&rendered(&scene, camera, &s)));
        assert!(coarse == full, "{composite:?}");
    }
}

#[test]
fn textures_are_filtered_over_the_tile() {
    // A texture of one colour per mip level: what is seen tells the level of detail.
    let (scene, camera) = crate::geometry::level_scene();
    let levels = |rate_stage| {
        let renderer = rendered(
            &scene,
            &camera,
            &settings(rate_stage).with(|s| {
                s.coarse.source = RateSource::Constant;
                s.coarse.constant_level = 2;
            }),
        );
        let surfaces: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_view);
        let at = |x: u32, y: u32| surfaces[(y * SIZE.0 + x) as usize][0] & 255;
        let samples = (0..SIZE.1 / 4).flat_map(|y| (0..SIZE.0 / 4).map(move |x| (x, y)));
        samples
            .map(|(x, y)| sample_texel((x, y), 2, 0, SIZE))
            .map(|(x, y)| at(x, y))
            .collect::<Vec<_>>()
    };
    let [pixels, tiles] = [RateStage::Lighting, RateStage::Both].map(levels);
    let coarser = pixels.iter().zip(&tiles).filter(|(p, t)| t > p).count();
    let finer = pixels.iter().zip(&tiles).filter(|(p, t)| t < p).count();
    assert!(coarser > 500 && finer == 0, "{coarser} {finer}");
}

#[test]
fn depth_tells_the_normals_of_planes() {
    let scene = scene();
    let perspective = scene.cameras[0].clone();
    let orthographic = Camera {
        projection: Projection::Orthographic {
            height_m: 2.0,
            near_m: 0.01,
            far_m: 20.0,
        },
        ..perspective.clone()
    };
    for camera in [&perspective, &orthographic] {
        let full = rendered(&scene, camera, &small(SIZE.0, SIZE.1));
        let target = &full.targets().gbuffer;
        let surfaces: Vec<[u32; 4]> = texels(&target.surface_view);
        let depths: Vec<f32> = texels(&target.depth_view);
        let size = UVec2::from(SIZE);
        let mut seen = 0;
        let (mut off, mut far_off) = (0, 0);
        for (i, &depth) in (0..).zip(&depths) {
            if depth == 0.0 {
                continue;
            }
            let at = UVec2::new(i % size.x, i / size.x);
            let found = normal_of_depth(camera, size, &depths, at);
            let normal = unit_from_octahedral(surfaces[i as usize][1]);
            seen += 1;
            off += u32::from(found.dot(normal) < 0.9999);
            far_off += u32::from(found.dot(normal) < 0.95);
        }
        // Beside an edge on both sides a texel's neighbours are other planes'.
        assert!(seen > 10_000 && off < seen / 15, "{off} of {seen}");
        assert!(far_off < seen / 100, "{far_off} of {seen}");
    }
}

#[test]
fn what_cannot_be_done_at_the_rate_is_refused() {
    let wrong = |s: Settings| {
        let error = pollster::block_on(Renderer::new(gpu(), &s, crate::RendererOptions::default()))
            .unwrap_err();
        assert!(
            matches!(
                error,
                Error::Setting {
                    name: "rate-stage",
                    ..
                }
            ),
            "{error}"
        );
    };
    wrong(settings(RateStage::Material));
    wrong(settings(RateStage::Both).with(|s| s.geometry.path = Geometry::Gbuffer));
    wrong(settings(RateStage::Both).with(|s| s.antialiasing.mode = Antialiasing::Msaa));
}
