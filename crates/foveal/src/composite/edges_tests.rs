//! Where the samples around a pixel disagree, it is shaded by itself.

use foveal_generate as generate;

use crate::testing::{Film, picture, rendered, small};
use crate::{RateSource, Settings, Shading, Shadows};

const WIDTH: u32 = 240;
const HEIGHT: u32 = 150;

fn settings(shadows: Shadows, history: bool) -> Settings {
    small(WIDTH, HEIGHT).with(|s| {
        s.lighting.shadows = shadows;
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = 2;
        s.coarse.history = history;
    })
}

#[test]
fn the_edges_of_shadows_are_nearly_those_of_full_shading() {
    let scene = generate::by_name("cornell").expect("it is generated");
    let camera = scene.cameras[0].clone();
    // Interpolated alone: 269 and 90 pixels.
    for (shadows, most) in [(Shadows::Hard, 110), (Shadows::Soft, 65)] {
        let full = settings(shadows, false).with(|s| s.shading.mode = Shading::Full);
        let full = picture(&rendered(&scene, &camera, &full));
        for history in [false, true] {
            let mut film = Film::new(&scene, &settings(shadows, history));
            let stats = film.draw(&camera);
            let coarse = picture(&film.renderer);
            let wrong = full.chunks(4).zip(coarse.chunks(4)).filter(|(a, b)| {
                let apart = a.iter().zip(*b).map(|(a, b)| a.abs_diff(*b)).max();
                apart.is_some_and(|apart| apart > 24)
            });
            let wrong = wrong.count();
            let lit = stats.coarse.map_or(1.0, |c| c.shaded_fraction);
            assert!(wrong < most, "{shadows:?}, {history}: {wrong} pixels");
            assert!(lit < 0.25, "{shadows:?}, {history}: {lit}");
        }
    }
}
