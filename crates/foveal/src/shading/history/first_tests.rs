//! What is kept of a frame that finds no kept light.

use super::tests::{kept, kept_targets, scene};
use crate::testing::{Film, texels};
use crate::{RateSource, Settings};

/// A small picture with large blocks: as wide as a headset's eye.
fn settings() -> Settings {
    kept().with(|s| {
        s.coarse.source = RateSource::Foveated;
        s.eye.display = "110".parse().expect("it can be read");
        s.eye.gaze = [0.1, 0.5];
        s.eye.quality_jod = 9.1;
        s.picture.width = 320;
        s.picture.height = 200;
    })
}

#[test]
fn every_pixel_keeps_light_of_a_first_frame_and_some_their_neighbours() {
    let scene = scene();
    let mut film = Film::new(&scene, &settings());
    film.draw(&scene.cameras[0]);
    let now = usize::from(!film.renderer.history().lit.even);
    let light: Vec<[u32; 4]> = texels(&kept_targets(&film).light[now]);
    let targets = film.renderer.targets();
    let depth: Vec<f32> = texels(&targets.gbuffer.depth_view);
    let surfaces = || (0..light.len()).filter(|&i| depth[i] > 0.0);
    let dark = surfaces().filter(|&i| light[i] == [0; 4]).count();
    assert_eq!(dark, 0);
    let width = 320;
    let led = surfaces().filter(|&i| {
        let [x, y] = [i % width / 2, i / width / 2];
        let leader = (2 * y + x % 2) * width + 2 * x + y % 2;
        // All but the normal.
        let [a, b] = [light[i], light[leader]];
        leader != i && a[..3] == b[..3] && (a[3] ^ b[3]) & 0xf_ffff == 0
    });
    let led = led.count();
    assert!(led > 1000, "{led}");
}
