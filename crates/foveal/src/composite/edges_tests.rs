//! Where the samples around a pixel disagree, it is shaded by itself or takes its neighbour's light.

use foveal_generate as generate;

use crate::testing::{Film, picture, rendered, small};
use crate::{RateSource, Settings, Shading, Shadows};

const WIDTH: u32 = 240;
const HEIGHT: u32 = 150;

fn settings(level: u8, shadows: Shadows, history: bool) -> Settings {
    small(WIDTH, HEIGHT).with(|s| {
        s.lighting.shadows = shadows;
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = level;
        s.coarse.history = history;
    })
}

#[test]
fn the_edges_of_shadows_are_nearly_those_of_full_shading() {
    let scene = generate::by_name("cornell").expect("it is generated");
    let camera = scene.cameras[0].clone();
    // Interpolated alone, blocks of 4 x 4: 269 and 90 pixels. In blocks of 2 x 2 each pixel is shaded
    // where samples disagree; in those of 4 x 4 it may take its neighbour's light.
    for (level, shadows, most, most_lit) in [
        (1, Shadows::Hard, 30, 0.45),
        (1, Shadows::Soft, 30, 0.45),
        (2, Shadows::Hard, 140, 0.21),
        (2, Shadows::Soft, 75, 0.21),
    ] {
        let full = settings(level, shadows, false).with(|s| s.shading.mode = Shading::Full);
        let full = picture(&rendered(&scene, &camera, &full));
        for history in [false, true] {
            let mut film = Film::new(&scene, &settings(level, shadows, history));
            let stats = film.draw(&camera);
            let coarse = picture(&film.renderer);
            let wrong = full.chunks(4).zip(coarse.chunks(4)).filter(|(a, b)| {
                let apart = a.iter().zip(*b).map(|(a, b)| a.abs_diff(*b)).max();
                apart.is_some_and(|apart| apart > 24)
            });
            let wrong = wrong.count();
            let lit = stats.coarse.map_or(1.0, |c| c.shaded_fraction);
            let case = format!("level {level}, {shadows:?}, {history}");
            assert!(wrong < most, "{case}: {wrong} pixels");
            assert!(lit < most_lit, "{case}: {lit}");
        }
    }
}
