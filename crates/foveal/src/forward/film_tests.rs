//! Thin films: the closed form against the sum over the spectrum, and what is drawn of films that are
//! none.

use std::f32::consts::{PI, TAU};

use foveal_scene::{Clearcoat, ColorSpace, Iridescence, Material};
use glam::{Vec3, Vec4};

use super::film_twin::{Film, to_srgb};
use crate::testing::{one_texel, rendered, slot, small, texels};

/// CIE 1931's sensitivities over the wave number per nanometre, as normal distributions: X, Y, Z.
fn sensitivities(wave_number: f32) -> Vec3 {
    let one = |amplitude: f32, position: f32, variance: f32| {
        let deviation = (2.0 * variance).sqrt();
        let x = (wave_number - position) / deviation;
        amplitude * (-0.5 * x * x).exp() / (deviation * TAU.sqrt())
    };
    Vec3::new(
        one(0.846_59, 1.681e-3, 4.3278e-9) + one(0.153_868, 2.2399e-3, 4.5282e-9),
        one(1.000_222, 1.7953e-3, 9.3046e-9),
        one(1.001_122, 2.2084e-3, 6.6121e-9),
    )
}

#[test]
fn a_film_reflects_what_light_that_goes_to_and_fro_adds_up_to() {
    for ior in [1.3f32, 1.6, 2.0] {
        for thickness_nm in [0.0f32, 120.0, 250.0, 400.0, 700.0] {
            for base_f0 in [0.01f32, 0.04, 0.3] {
                for cosine in [0.4f32, 0.7, 1.0] {
                    let film = Film {
                        strength: 1.0,
                        ior,
                        thickness_nm,
                    };
                    let found = film.reflectance(Vec3::splat(base_f0), cosine);
                    let schlick = |f0: f32, cosine: f32| f0 + (1.0 - f0) * (1.0 - cosine).powi(5);
                    let within = (1.0 - (1.0 - cosine * cosine) / (ior * ior)).sqrt();
                    let base_ior = (1.0 + base_f0.sqrt()) / (1.0 - base_f0.sqrt());
                    let upper = schlick(((ior - 1.0) / (ior + 1.0)).powi(2), cosine);
                    let lower_f0 = ((base_ior - ior) / (base_ior + ior)).powi(2);
                    let lower = schlick(lower_f0, within);
                    let turn = TAU * 2.0 * ior * thickness_nm * within;
                    let phase = if base_ior < ior { TAU } else { PI };
                    // Airy's sum of all that returns, at a wave number.
                    let reflected = |wave_number: f32| {
                        let wave =
                            2.0 * (upper * lower).sqrt() * (turn * wave_number + phase).cos();
                        let both = 1.0 + upper * lower;
                        (upper + lower - wave) / (both - wave)
                    };
                    let round = upper * lower;
                    let mean = upper + (1.0 - upper).powi(2) * lower / (1.0 - round);
                    let count = 4000;
                    let xyz: Vec3 = (0..count)
                        .map(|i| {
                            let wave_number = 1e-3 + 2e-3 * (i as f32 + 0.5) / count as f32;
                            sensitivities(wave_number) * (reflected(wave_number) - mean)
                        })
                        .sum();
                    let expected = mean + to_srgb() * xyz * (2e-3 / count as f32);
                    let expected = expected.clamp(Vec3::ZERO, Vec3::ONE);
                    // The closed form has two terms of a series.
                    assert!(
                        found.abs_diff_eq(expected, 0.02),
                        "index {ior}, {thickness_nm} nm, f0 {base_f0}, cosine {cosine}: \
                         {found}, {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn thick_films_have_no_colour_and_thin_ones_have() {
    let chroma = |thickness_nm: f32| {
        let film = Film {
            strength: 1.0,
            ior: 1.8,
            thickness_nm,
        };
        let found = film.reflectance(Vec3::splat(0.04), 0.9);
        found.max_element() - found.min_element()
    };
    assert!(chroma(400.0) > 0.05, "{}", chroma(400.0));
    assert!(chroma(20_000.0) < 1e-3, "{}", chroma(20_000.0));
}

fn film() -> Iridescence {
    Iridescence {
        factor: 1.0,
        texture: None,
        ior: 1.8,
        thickness_min_nm: 0.0,
        thickness_max_nm: 400.0,
        thickness_texture: None,
    }
}

/// Half-precision texels of a square of half metal that is drawn forward, with a film.
fn drawn(iridescence: Option<Iridescence>) -> Vec<[u16; 4]> {
    let material = Material {
        base_color: Vec4::new(0.6, 0.4, 0.2, 1.0),
        metallic: 0.5,
        roughness: 0.4,
        // Drawn forward with and without a film.
        clearcoat: Some(Clearcoat {
            factor: 0.0,
            texture: None,
            roughness: 0.5,
            roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
        }),
        iridescence,
        ..Material::default()
    };
    let mut scene = super::twin::quads(vec![material], &[0.0]);
    scene.textures = [[51, 7, 7, 7], [9, 102, 9, 9], [0; 4]]
        .map(|texel| one_texel(ColorSpace::Linear, texel))
        .to_vec();
    scene.light_by_default();
    let renderer = rendered(&scene, &super::twin::front(), &small(31, 31));
    texels(&renderer.targets().radiance_view)
}

#[test]
fn a_film_of_no_strength_or_thickness_is_the_surface_without() {
    let without = drawn(None);
    assert_ne!(without, drawn(Some(film())));
    for none in [
        Iridescence {
            factor: 0.0,
            ..film()
        },
        Iridescence {
            thickness_max_nm: 0.0,
            ..film()
        },
        Iridescence {
            texture: slot(2),
            ..film()
        },
        Iridescence {
            thickness_texture: slot(2),
            ..film()
        },
    ] {
        assert_eq!(without, drawn(Some(none)), "{none:?}");
    }
}

#[test]
fn textures_of_films_are_read_where_their_places_say() {
    let by_textures = Iridescence {
        texture: slot(0),
        thickness_min_nm: 100.0,
        thickness_max_nm: 600.0,
        thickness_texture: slot(1),
        ..film()
    };
    let by_factors = Iridescence {
        factor: 0.2,
        thickness_max_nm: 300.0,
        ..film()
    };
    let value = crate::testing::f32_of_half;
    let [a, b] = [by_textures, by_factors].map(|film| drawn(Some(film)));
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        assert!((value(*a) - value(*b)).abs() < 2e-3, "{a}, {b}");
    }
    let thicker = Iridescence {
        thickness_max_nm: 420.0,
        ..by_factors
    };
    assert_ne!(b, drawn(Some(thicker)));
}
