//! Maps against integrals.

use std::f32::consts::PI;

use foveal_generate as generate;
use glam::{Vec3, Vec4};

use super::EnvironmentMap;
use super::cube::{Cube, SIDES, direction_of, place_of, relative_solid_angle};
use super::irradiance::irradiance_of;
use super::picture::Equirectangular;
use super::prefilter::{Levels, prefilter};
use super::twin::Around;
use crate::shading::dielectric::PLAIN_DIELECTRIC;
use crate::shading::twin::{Surface, ggx_lobe, squared_alpha};
use crate::testing::f32_of_half;
use crate::{Error, Settings};

/// Directions all around, none of them along an axis.
fn directions(count: u32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
        let across = (1.0 - y * y).sqrt();
        Vec3::new(across * cos, y, across * sin)
    })
}

/// The sum over a cube's texels of radiance times what `weight` says of their directions, over the
/// sum of the weights.
fn mean(cube: &Cube, weight: impl Fn(Vec3) -> f32) -> Vec3 {
    let (mut sum, mut weights) = (glam::DVec3::ZERO, 0.0);
    for face in 0..SIDES {
        for i in 0..cube.side * cube.side {
            let (x, y) = (i % cube.side, i / cube.side);
            let place = cube.center(x, y);
            let w = weight(direction_of(face, place).normalize()) * relative_solid_angle(place);
            sum += f64::from(w) * Vec3::from(cube.texel(face, x, y)).as_dvec3();
            weights += f64::from(w);
        }
    }
    (sum / weights).as_vec3()
}

#[test]
fn directions_and_places_of_a_cube_are_inverse() {
    for d in directions(1000) {
        let (side, place) = place_of(d);
        assert!(place.abs().max_element() <= 1.0, "{d}");
        assert!((direction_of(side, place).normalize() - d).length() < 1e-6);
    }
}

#[test]
fn a_cube_is_continuous_across_its_edges() {
    let cube = Cube::from_texels(16, |face, x, y| {
        let place = super::cube::texel_center(16, x, y);
        direction_of(face, place).normalize().into()
    });
    for d in directions(20_000) {
        let sampled = Vec3::from(cube.sample(d));
        assert!((sampled - d).length() < 0.02, "{d}: {sampled}");
    }
}

#[test]
fn a_picture_shows_the_right_way_round() {
    // Red from the left edge, which is -x, to the middle, +x; green on the right, +z; blue above.
    let rgb: Vec<[f32; 3]> = (0..64 * 32)
        .map(|i| {
            let (x, y) = (i % 64, i / 64);
            [
                f32::from(u8::from(x < 32)),
                f32::from(u8::from((40..56).contains(&x))),
                f32::from(u8::from(y < 16)),
            ]
        })
        .collect();
    let picture = Equirectangular::new(64, 32, &rgb).unwrap();
    for (direction, expected) in [
        (Vec3::new(0.0, 0.5, -1.0), [1.0, 0.0, 1.0]),
        (Vec3::new(0.0, -0.5, 1.0), [0.0, 1.0, 0.0]),
        (Vec3::new(1.0, 0.5, 0.2), [0.0, 0.0, 1.0]),
        (Vec3::new(-1.0, -0.5, -0.2), [1.0, 0.0, 0.0]),
    ] {
        let found = Vec3::from(picture.sample(direction.normalize()));
        assert!(
            (found - Vec3::from(expected)).length() < 1e-5,
            "{direction}: {found}"
        );
    }
}

#[test]
fn pictures_that_are_no_environments_are_refused() {
    let texels = vec![[1.0; 3]; 16];
    for (width, height, cause) in [
        (4, 4, "twice as wide as high"),
        (0, 0, "twice as wide as high"),
        (8, 4, "it has 16 texels"),
    ] {
        let error = EnvironmentMap::new(width, height, &texels).unwrap_err();
        assert!(matches!(error, Error::Environment { .. }));
        assert!(error.to_string().contains(cause), "{error}");
    }
    let error = EnvironmentMap::new(60_000, 30_000, &texels).unwrap_err();
    assert!(matches!(error, Error::Limit { .. }), "{error}");
}

#[test]
fn broken_texels_do_not_spread() {
    let mut rgb = vec![[0.5; 3]; 64 * 32];
    rgb[100] = [f32::NAN; 3];
    rgb[500] = [-3.0, f32::NEG_INFINITY, 0.5];
    rgb[900] = [f32::INFINITY, f32::MAX, 0.5];
    let map = EnvironmentMap::new(64, 32, &rgb).unwrap();
    for level in 0..=map.levels().last as u32 {
        let mut found = map.texels(level).iter().flatten();
        assert!(found.all(|&v| (0.0..=65504.0).contains(&f32_of_half(v))));
    }
    assert!(map.irradiance().iter().all(|c| c.is_finite()));
}

#[test]
fn a_small_sun_keeps_its_energy() {
    let (width, height) = (1024, 512);
    let at = Vec3::new(0.3, 0.6, -0.7).normalize();
    let direction = |i: usize| {
        let u = (i % width) as f32 + 0.5;
        let v = (i / width) as f32 + 0.5;
        let (sin, cos) = ((u / width as f32 - 0.5) * 2.0 * PI).sin_cos();
        let (down, y) = (v / height as f32 * PI).sin_cos();
        (Vec3::new(down * cos, y, down * sin), down)
    };
    // Three texels wide.
    let is_sun = |d: Vec3| d.dot(at) > (0.01f32).cos();
    let rgb: Vec<[f32; 3]> = (0..width * height)
        .map(|i| [f32::from(u8::from(is_sun(direction(i).0))) * 20_000.0; 3])
        .collect();
    let texel = 2.0 * PI * PI / (width * height) as f32;
    let sun: f32 = (0..width * height)
        .map(direction)
        .filter(|&(d, _)| is_sun(d))
        .map(|(d, down)| 20_000.0 * texel * down * d.dot(at))
        .sum();
    let map = EnvironmentMap::new(width as u32, height as u32, &rgb).unwrap();
    let around = Around::new(&map, &Settings::default());
    // Facing a small source, order 2 gives 1.0625 times its irradiance.
    let found = around.irradiance(at).x * PI / 1.0625;
    assert!((found / sun - 1.0).abs() < 0.02, "{found}, {sun}");
    // Rough mirrors spread it evenly: neighbouring directions differ little.
    for roughness in [0.5, 0.7, 1.0] {
        let aside = Vec3::Y.cross(at).normalize();
        let seen: Vec<f32> = (0..60)
            .map(|i| (at + aside * (i as f32 * 0.01)).normalize())
            .map(|d| around.environment(d, roughness).x)
            .collect();
        for pair in seen.windows(2) {
            assert!(pair[1] <= pair[0] * 1.03, "{roughness}: {seen:?}");
            assert!(pair[1] >= pair[0] * 0.85, "{roughness}: {seen:?}");
        }
    }
}

#[test]
fn a_sun_of_one_texel_lights_and_is_mirrored_wherever_it_stands() {
    for width in [256_usize, 1024, 2048] {
        let height = width / 2;
        for elevation_deg in [0.0f32, 45.0, 75.0, 85.0, 88.0, 89.7] {
            let row = ((90.0 - elevation_deg) / 180.0 * height as f32) as usize;
            let column = width / 3 + 7;
            let mut rgb = vec![[0.0; 3]; width * height];
            rgb[row * width + column] = [1e4; 3];
            let (sine, y) = ((row as f32 + 0.5) / height as f32 * PI).sin_cos();
            let turn = ((column as f32 + 0.5) / width as f32 - 0.5) * 2.0 * PI;
            let at = Vec3::new(sine * turn.cos(), y, sine * turn.sin());
            let power = 1e4 * 2.0 * PI * PI / (width * height) as f32 * sine;
            let map = EnvironmentMap::new(width as u32, height as u32, &rgb).unwrap();
            let around = Around::new(&map, &Settings::default());
            // Facing a small source, order 2 gives 1.0625 times its irradiance.
            let found = around.irradiance(at).x * PI / 1.0625 / power;
            assert!(
                (found - 1.0).abs() < 0.01,
                "{width}, {elevation_deg}: {found}"
            );
            let cube = map.texels(0).iter().map(|t| f32_of_half(t[0]));
            let side = map.side() as usize;
            let mirrored: f32 = (cube.enumerate())
                .map(|(i, radiance)| {
                    let (x, y) = (i % side, i / side % side);
                    let place = super::cube::texel_center(side, x, y);
                    radiance * relative_solid_angle(place)
                })
                .sum();
            let found = mirrored * 4.0 / (side * side) as f32 / power;
            // A few lookups a texel of the cube.
            let expected = 0.5..1.6;
            assert!(
                expected.contains(&found),
                "{width}, {elevation_deg}: mirrored {found}"
            );
        }
    }
}

#[test]
fn irradiance_is_that_of_the_integral() {
    let (width, height, rgb) = generate::surroundings(256);
    // Without the sun, which order 2 does not hold.
    let rgb: Vec<_> = rgb.iter().map(|t| t.map(|v| v.min(3.0))).collect();
    let picture = Equirectangular::new(width, height, &rgb).unwrap();
    let cube = Cube::from_texels(64, |face, x, y| {
        let place = super::cube::texel_center(64, x, y);
        picture.sample(direction_of(face, place).normalize())
    });
    let map = EnvironmentMap::from_radiance(64, 1, |d| picture.sample(d));
    assert_eq!(irradiance_of(&cube), *map.irradiance());
    let around = Around::new(&map, &Settings::default());
    // Ramamoorthi and Hanrahan: 1 % on average, 9 % at most.
    let (mut sum, mut brightest) = (0.0, 0.0f32);
    for normal in directions(60) {
        let truth = mean(&cube, |d| d.dot(normal).max(0.0));
        let found = around.irradiance(normal);
        let error = (found - truth).abs().max_element();
        assert!(
            error < 0.09 * truth.max_element(),
            "{normal}: {found}, {truth}"
        );
        sum += error / 60.0;
        brightest = brightest.max(truth.max_element());
    }
    assert!(sum < 0.02 * brightest, "{sum} of {brightest}");
}

#[test]
fn each_level_is_the_integral_of_its_lobe() {
    let (width, height, rgb) = generate::surroundings(256);
    let rgb: Vec<_> = rgb.iter().map(|t| t.map(|v| v.min(50.0))).collect();
    let picture = Equirectangular::new(width, height, &rgb).unwrap();
    let cube = Cube::from_texels(128, |face, x, y| {
        let place = super::cube::texel_center(128, x, y);
        picture.sample(direction_of(face, place).normalize())
    });
    let levels = Levels::of(128);
    for (level, filtered) in prefilter(cube.clone()).iter().enumerate().skip(1) {
        let a2 = levels.alpha(level as u32).powi(2);
        let mut sum = 0.0;
        for axis in directions(40) {
            let truth = mean(&cube, |l| {
                let n_dot_l = l.dot(axis).max(0.0);
                let n_dot_h2 = 0.5 * (1.0 + l.dot(axis));
                let d = n_dot_h2 * (a2 - 1.0) + 1.0;
                n_dot_l / (d * d)
            });
            let found = Vec3::from(filtered.sample(axis));
            let error = ((found - truth) / (truth + 0.05)).abs().max_element();
            assert!(error < 0.4, "level {level}, {axis}: {found}, {truth}");
            sum += error / 40.0;
        }
        assert!(sum < 0.06, "level {level}: {sum}");
        println!(
            "level {level}, squared roughness {:.3}: mean error {sum:.4}",
            a2.sqrt()
        );
    }
}

#[test]
fn levels_follow_the_roughness() {
    for side in [64, 256, 512, 1024] {
        let levels = Levels::of(side);
        let last = levels.last as u32;
        assert_eq!(side >> last, 8);
        for level in 1..=last {
            let roughness = levels.alpha(level).sqrt();
            let found = levels.level(roughness);
            assert!(
                (found - level as f32).abs() < 1e-3,
                "{side}, {level}: {found}"
            );
        }
        assert!((levels.alpha(last) - 1.0).abs() < 1e-6);
        assert!(levels.level(0.0) < 1e-3);
        let steps: Vec<f32> = (0..=100).map(|i| levels.level(i as f32 / 100.0)).collect();
        assert!(steps.is_sorted(), "{steps:?}");
    }
}

/// In light of 1 from everywhere a white surface shows what the lights' own reflection model leaves
/// of it.
#[test]
fn a_white_furnace_shows_what_the_reflection_model_says() {
    let map = EnvironmentMap::from_radiance(64, 1, |_| Vec3::ONE.into());
    let around = Around::new(&map, &Settings::default());
    let tinted = Vec4::new(0.3, 0.1, 0.02, 0.5);
    let dielectrics = [PLAIN_DIELECTRIC, Vec4::ZERO, tinted];
    for (metallic, dielectric) in [0.0, 0.5, 1.0]
        .into_iter()
        .flat_map(|m| dielectrics.map(|d| (m, d)))
    {
        // A lobe of 0 is too narrow to be integrated so.
        for step in 1..=10 {
            for cosine in [0.1f32, 0.4, 0.7, 1.0] {
                let s = Surface {
                    position: Vec3::ZERO,
                    normal: Vec3::Z,
                    vertex_normal: Vec3::Z,
                    base_color: Vec3::ONE,
                    metallic,
                    roughness: step as f32 / 10.0,
                    occlusion: 1.0,
                    emissive: Vec3::ZERO,
                    dielectric,
                };
                let v = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
                let found = around.ambient(&s, v);
                let integral = reflected_part(&s, v, 4000) + scattered_part(&s, v);
                let error = (found - integral).abs().max_element();
                assert!(
                    error < 0.03,
                    "metallic {metallic}, roughness {}, cosine {cosine}: {found}, {integral}",
                    s.roughness
                );
            }
        }
    }
}

/// Part of light from everywhere that the lights' own model scatters.
fn scattered_part(s: &Surface, v: Vec3) -> Vec3 {
    let above = directions(8000).filter(|l| l.z > 0.0);
    let sum: f32 = above
        .map(|l| {
            let v_dot_h = v.dot((v + l).normalize());
            s.left_for_scattering((1.0 - v_dot_h).powi(5)) * l.z
        })
        .sum();
    // Of the sphere's solid angle, 4 pi, over pi.
    (1.0 - s.metallic) * s.base_color * sum * (4.0 / 8000.0)
}

/// Part of light from everywhere that the lights' own GGX reflects.
pub(super) fn reflected_part(s: &Surface, v: Vec3, count: u32) -> Vec3 {
    let a2 = squared_alpha(s);
    let (f0, f90) = (s.reflectance_at_normal(), s.reflectance_at_grazing());
    let mut sum = Vec3::ZERO;
    for i in 0..count {
        let u = (i as f32 + 0.5) / count as f32;
        let (sin_phi, cos_phi) = (i as f32 * 2.399_963).sin_cos();
        let cos2 = (1.0 - u) / (1.0 + (a2 - 1.0) * u);
        let (cos, sin) = (cos2.sqrt(), (1.0 - cos2).sqrt());
        let h = Vec3::new(sin * cos_phi, sin * sin_phi, cos);
        let v_dot_h = v.dot(h);
        let l = 2.0 * v_dot_h * h - v;
        if l.z <= 0.0 || v_dot_h <= 0.0 {
            continue;
        }
        let d = cos2 * (a2 - 1.0) + 1.0;
        let density = a2 / (PI * d * d) * cos / (4.0 * v_dot_h);
        let fresnel = f0 + (f90 - f0) * (1.0 - v_dot_h).powi(5);
        sum += fresnel * ggx_lobe(s.normal, v, l, l.z, a2) * l.z / density;
    }
    sum / count as f32
}
