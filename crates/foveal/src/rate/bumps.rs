//! Twin of `is_bumpy` in `rate/crease_of_surface.wgsl`, and the test that compares them.

use foveal_generate as generate;

use super::request::BUMPY_BY;
use crate::shading::twin::unit_from_octahedral;
use crate::testing::{rate_cells, rendered, small, texels};
use crate::{Composite, RateSource, RefineEdges, Shading};

const BUMP: f32 = 0.1;
const LEAST_WIDTH: f32 = 0.01;

/// By how much a block of 2 x 2 pixels turns beyond what is allowed; a block with more than 0 is
/// bumpy. Packed surfaces of its upper left pixel, of that to its right and of that below.
fn beyond_allowed([first, right, down]: [[u32; 4]; 3]) -> f32 {
    let normal = |words: [u32; 4]| unit_from_octahedral(words[1]);
    let roughness = (first[3] >> 8 & 255) as f32 / 255.0;
    let turn = 2.0 - normal(first).dot(normal(right)) - normal(first).dot(normal(down));
    turn - BUMP * (roughness.powi(4) + LEAST_WIDTH)
}

#[test]
fn bumpy_surfaces_request_finer_levels_as_their_twin_says() {
    const LEVEL: u8 = 3;
    let scene = generate::by_name("demo").expect("it is there");
    let size = (321u32, 181u32);
    let settings = small(size.0, size.1).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = LEVEL;
    });
    let quads = |settings: &crate::Settings| {
        let renderer = rendered(&scene, &scene.cameras[0], settings);
        let rate = &renderer.targets().coarse.as_ref().unwrap().rate;
        let surfaces: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_layers);
        (rate_cells(&rate.pyramid, 1), surfaces)
    };
    let (cells, surfaces) = quads(&settings);
    let (mut bumpy, mut even, mut differ) = (0, 0, 0);
    for (i, &cell) in (0u32..).zip(&cells) {
        let across = size.0.div_ceil(2);
        let (x, y) = (i % across * 2, i / across * 2);
        let at =
            |x: u32, y: u32| surfaces[(y.min(size.1 - 1) * size.0 + x.min(size.0 - 1)) as usize];
        // Edges are refined by another rule, and the backdrop has no surface.
        if cell & 128 != 0 || at(x, y) == [0; 4] {
            continue;
        }
        let beyond = beyond_allowed([at(x, y), at(x + 1, y), at(x, y + 1)]);
        bumpy += u32::from(beyond > 0.0);
        even += u32::from(beyond <= 0.0);
        let expected = if beyond > 0.0 {
            LEVEL - BUMPY_BY
        } else {
            LEVEL
        };
        // Cosines near 1 are rounded.
        differ += u32::from(beyond.abs() > 1e-5 && cell != expected);
    }
    assert!(bumpy > 300 && even > 1000, "{bumpy} bumpy, {even} even");
    assert_eq!(differ, 0);

    // Samples of colours and other ways of refining know no bumps.
    for change in [
        |s: &mut crate::Settings| s.coarse.composite = Composite::Smooth,
        |s: &mut crate::Settings| s.coarse.refine_edges = RefineEdges::Everywhere,
    ] {
        let (cells, _) = quads(&settings.clone().with(change));
        assert!(cells.iter().all(|c| c & 128 != 0 || *c == LEVEL));
    }
}
