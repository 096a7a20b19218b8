//! Each composite of coarse shading against full shading, by perceptual difference: mean FLIP (Andersson et al. 2020).
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
    let coarse = Settings {
        width: 320,
        height: 180,
        shading: Shading::Coarse,
        ..coarse.clone()
    };
    let full = Settings {
        shading: Shading::Full,
        ..coarse.clone()
    };
    let reference = drawn(&gpu, &scene, &full, 1);
    composites.map(|composite| {
        let settings = Settings {
            composite,
            ..coarse.clone()
        };
        mean_flip(&reference, &drawn(&gpu, &scene, &settings, 1))
    })
}

#[test]
fn smooth_is_nearer_to_full_shading_than_paper_in_every_generated_scene() {
    let radii = Settings {
        rate: RateSource::Radii,
        ..Settings::default()
    };
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
    let eye = Settings {
        quality: 9.0,
        ..Settings::default()
    };
    for name in ["demo:1000", "materials", "materials-grid", "alpha"] {
        let [light, smooth] = errors(name, &eye, [Composite::Light, Composite::Smooth]);
        println!("{name}: light {light:.4}, smooth {smooth:.4}");
        assert!(light < smooth, "{name}: light {light}, smooth {smooth}");
    }
}
