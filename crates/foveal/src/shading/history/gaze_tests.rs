//! Where the eye looks, and other rates, while all is at rest.

use foveal_generate as generate;
use foveal_scene::Scene;

use super::lit::ROUND;
use super::tests::{differing, kept, scene, seen};
use crate::testing::{Film, rate_cells, rendered};
use crate::{Antialiasing, RateSource, Settings, ShadowSizes, Shadows};

/// The levels of blocks of the last frame's rate map.
fn levels(film: &Film) -> Vec<u8> {
    let coarse = film.renderer.targets().coarse.as_ref();
    rate_cells(&coarse.expect("coarse shading").rate.owner, 1)
}

#[test]
fn another_image_of_rates_counts_at_rest() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    let settings = kept().with(|s| {
        s.coarse.source = RateSource::Image;
        s.antialiasing.mode = Antialiasing::Msaa;
    });
    let image = |luma| crate::RateImage::new(1, 1, vec![luma]).expect("a pixel");
    let mut film = Film::new(&scene, &settings);
    let mut found = Vec::new();
    for luma in [255, 0] {
        film.renderer.set_rate_image(image(luma)).expect("it fits");
        film.draw(camera);
        film.draw(camera);
        found.push(levels(&film));
    }
    assert!(found[0] != found[1]);
}

/// A film whose eye has looked at one place for a whole round and then looks at another.
fn looked_aside(settings: &Settings, scene: &Scene, frames: u32) -> Film {
    let looks = |x: f32| settings.clone().with(|s| s.eye.gaze = [x, 0.5]);
    let mut film = Film::new(scene, &looks(0.1));
    for _ in 0..=ROUND {
        film.draw(&scene.cameras[0]);
    }
    pollster::block_on(film.renderer.set_settings(&looks(0.9))).expect("a gaze is only a setting");
    for _ in 0..frames {
        film.draw(&scene.cameras[0]);
    }
    film
}

#[test]
fn edges_are_smoothed_where_the_eye_looks_after_a_whole_round() {
    let scene = scene();
    let settings = kept().with(|s| s.antialiasing.mode = Antialiasing::Ssaa);
    let film = looked_aside(&settings, &scene, 1);
    let fresh = rendered(&scene, &scene.cameras[0], film.renderer.settings());
    let fresh = Film {
        renderer: fresh,
        last: None,
    };
    assert!(levels(&film) == levels(&fresh));
}

#[test]
fn shadows_as_coarse_as_samples_are_fine_where_the_eye_looks_after_a_whole_round() {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 12, 3);
    for light in &mut scene.lights {
        light.range_m = light.range_m.map(|range| 0.4 * range);
    }
    let settings = kept().with(|s| {
        s.picture.width = 300;
        s.picture.height = 200;
        s.lighting.shadows = Shadows::Hard;
        s.lighting.shadow_atlas = 2048;
        s.lighting.shadow_sizes = ShadowSizes::Rate;
        s.coarse.source = RateSource::Foveated;
        s.eye.quality_jod = 8.0;
        s.eye.display = "120".parse().expect("degrees");
    });
    let aside = looked_aside(&settings, &scene, 1 + ROUND);
    let mut fresh = Film::new(&scene, aside.renderer.settings());
    for _ in 0..=ROUND {
        fresh.draw(&scene.cameras[0]);
    }
    let (a, b) = (seen(&aside.renderer), seen(&fresh.renderer));
    let old = looked_aside(&settings, &scene, 0);
    assert!(differing(&seen(&old.renderer), &b) > 50, "sizes matter");
    assert_eq!(differing(&a, &b), 0);
}
