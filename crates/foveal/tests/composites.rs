//! Each composite of coarse shading against full shading, by perceptual difference: mean FLIP (Andersson et al. 2020).
#![allow(clippy::print_stdout, reason = "a test says what it measured")]

mod common;

use common::{drawn, mean_flip};
use foveal::{Composite, Gpu, RateSource, Settings, Shading};
use foveal_scene::generate;

const WIDTH: u32 = 320;
const HEIGHT: u32 = 180;

#[test]
fn light_is_nearer_to_full_shading_than_smooth_and_that_than_paper_in_every_generated_scene() {
    let gpu = pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    for name in [
        "demo:1000",
        "cornell",
        "materials",
        "materials-grid",
        "alpha",
    ] {
        let mut scene = generate::by_name(name).expect("a generated scene");
        generate::add_point_lights(&mut scene, 20, 3);
        let full = Settings {
            width: WIDTH,
            height: HEIGHT,
            ..Settings::default()
        };
        let reference = drawn(&gpu, &scene, &full, 1);
        let composites = [Composite::Paper, Composite::Smooth, Composite::Light];
        let [paper, smooth, light] = composites.map(|composite| {
            let settings = Settings {
                shading: Shading::Coarse,
                rate: RateSource::Radii,
                composite,
                ..full.clone()
            };
            mean_flip(&reference, &drawn(&gpu, &scene, &settings, 1))
        });
        println!("{name}: paper {paper:.4}, smooth {smooth:.4}, light {light:.4}");
        assert!(smooth < paper, "{name}: smooth {smooth}, paper {paper}");
        assert!(light < smooth, "{name}: light {light}, smooth {smooth}");
    }
}
