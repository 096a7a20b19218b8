//! Each composite of coarse shading against full shading, by perceptual difference: mean FLIP
//! (Andersson et al. 2020).
#![allow(clippy::print_stdout, reason = "a test says what it measured")]

mod common;

use common::{drawn, mean_flip};
use foveal::{Composite, Gpu, RateSource, Settings, Shading};
use foveal_generate as generate;

/// Mean FLIP of composites to full shading.
fn errors<const N: usize>(scene: &str, coarse: &Settings, composites: [Composite; N]) -> [f32; N] {
    let gpu = pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    let mut scene = generate::by_name(scene).expect("a generated scene");
    generate::add_point_lights(&mut scene, 20, 3);
    let coarse = coarse.clone().with(|s| {
        s.picture.width = 320;
        s.picture.height = 180;
        s.shading.mode = Shading::Coarse;
    });
    let full = coarse.clone().with(|s| s.shading.mode = Shading::Full);
    let reference = drawn(&gpu, &scene, &full, 1);
    composites.map(|composite| {
        let settings = coarse.clone().with(|s| s.coarse.composite = composite);
        mean_flip(&reference, &drawn(&gpu, &scene, &settings, 1))
    })
}

#[test]
fn smooth_is_nearer_to_full_shading_than_paper_in_every_generated_scene() {
    let radii = Settings::default().with(|s| s.coarse.source = RateSource::Radii);
    for name in [
        "demo:1000",
        "cornell",
        "materials",
        "materials-grid",
        "alpha",
    ] {
        let [paper, smooth] = errors(name, &radii, [Composite::Paper, Composite::Smooth]);
        println!("{name}: paper {paper:.4}, smooth {smooth:.4}");
        assert!(smooth < paper, "{name}: smooth {smooth}, paper {paper}");
    }
}

#[test]
fn light_is_nearer_to_full_shading_than_colours_where_surfaces_differ_within_a_block() {
    let eye = Settings::default().with(|s| s.eye.quality_jod = 9.0);
    for name in ["demo:1000", "materials", "materials-grid", "alpha"] {
        let [light, smooth] = errors(name, &eye, [Composite::Light, Composite::Smooth]);
        println!("{name}: light {light:.4}, smooth {smooth:.4}");
        assert!(light < smooth, "{name}: light {light}, smooth {smooth}");
    }
}
