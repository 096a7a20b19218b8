//! Twin of `bumpiness` in `rate/crease_of_surface.wgsl`, and the test that compares them.

use foveal_generate as generate;

use super::request::BUMPY_BY;
use crate::shading::twin::unit_from_octahedral;
use crate::testing::{rate_cells, rendered, small, texels};
use crate::{Composite, RateSource, RefineEdges, Shading};

const BUMP: f32 = 0.1;
const LEAST_WIDTH: f32 = 0.01;
const LEAST_METAL_WIDTH: f32 = 0.0005;
const SHARP: f32 = 16.0;

/// By how much a block of 2 x 2 pixels turns beyond what is allowed: more than 0 is bumpy, and the
/// second a sharp metal. Packed surfaces of its upper left pixel, of that to its right and of that
/// below.
fn beyond_allowed([first, right, down]: [[u32; 4]; 3]) -> [f32; 2] {
    let normal = |words: [u32; 4]| unit_from_octahedral(words[1]);
    let [metallic, roughness] = [0, 8].map(|by| (first[3] >> by & 255) as f32 / 255.0);
    let turn = 2.0 - normal(first).dot(normal(right)) - normal(first).dot(normal(down));
    let least = LEAST_WIDTH + metallic * (LEAST_METAL_WIDTH - LEAST_WIDTH);
    let allowed = BUMP * (roughness.powi(4) + least);
    [turn - allowed, turn * metallic - SHARP * allowed]
}

#[test]
fn bumpy_surfaces_request_finer_levels_as_their_twin_says() {
    const LEVEL: u8 = 5;
    let size = (321u32, 181u32);
    let settings = small(size.0, size.1).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = LEVEL;
    });
    // Even, bumpy, sharp metal.
    let mut found = [0; 3];
    for name in ["demo", "materials-grid"] {
        let scene = generate::by_name(name).expect("it is there");
        let camera = match scene.cameras.first() {
            Some(camera) => camera.clone(),
            None => scene.overview_camera(),
        };
        let quads = |settings: &crate::Settings| {
            let renderer = rendered(&scene, &camera, settings);
            let rate = &renderer.targets().coarse.as_ref().unwrap().rate;
            let surfaces: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_layers);
            (rate_cells(&rate.pyramid, 1), surfaces)
        };
        let (cells, surfaces) = quads(&settings);
        let mut differ = 0;
        for (i, &cell) in (0u32..).zip(&cells) {
            let across = size.0.div_ceil(2);
            let (x, y) = (i % across * 2, i / across * 2);
            let at = |x: u32, y: u32| {
                surfaces[(y.min(size.1 - 1) * size.0 + x.min(size.0 - 1)) as usize]
            };
            // Edges are refined by another rule, and the backdrop has no surface.
            if cell & 128 != 0 || at(x, y) == [0; 4] {
                continue;
            }
            let beyond = beyond_allowed([at(x, y), at(x + 1, y), at(x, y + 1)]);
            let bumpiness = beyond.iter().filter(|&&by| by > 0.0).count();
            found[bumpiness] += 1;
            // Cosines near 1 are rounded.
            let is_clear = beyond.iter().all(|by| by.abs() > 1e-5);
            differ += u32::from(is_clear && cell != LEVEL - BUMPY_BY * bumpiness as u8);
        }
        assert_eq!(differ, 0, "{name}");

        // Samples of colours and other ways of refining know no bumps.
        for change in [
            |s: &mut crate::Settings| s.coarse.composite = Composite::Smooth,
            |s: &mut crate::Settings| s.coarse.refine_edges = RefineEdges::Everywhere,
        ] {
            let (cells, _) = quads(&settings.clone().with(change));
            assert!(cells.iter().all(|c| c & 128 != 0 || *c == LEVEL));
        }
    }
    let [even, bumpy, sharp] = found;
    assert!(even > 1000 && bumpy > 300 && sharp > 100, "{found:?}");
}
