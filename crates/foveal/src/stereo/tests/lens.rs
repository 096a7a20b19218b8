//! Lenses: forward and inverse, straight lines, and the rate map that follows them.

use foveal_scene::Camera;
use glam::{Vec2, Vec3};
use proptest::prelude::*;

use super::{halves, shape, two_eyes};
use crate::stereo::{LensFit, eyes};
use crate::testing::{linear_of_srgb, rate_cells, rendered};
use crate::{CoarseBackend, Composite, Output, RateSource, RefineEdges, Settings, Shading};

const NAMES: [&str; 4] = ["cardboard-v2", "cardboard-v1", "dk1", "ideal"];

fn camera() -> Camera {
    Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.5)
}

fn headset(lens: &str) -> Settings {
    two_eyes(400, 360).with(|s| {
        s.stereo.output = Output::Headset;
        s.stereo.lens = lens.parse().expect("it can be read");
        s.stereo.frusta = "-1,0.8,-0.9,0.9,-0.8,1,-0.9,0.9"
            .parse()
            .expect("it can be read");
    })
}

fn fits(settings: &Settings) -> [LensFit; 2] {
    let eyes = eyes(settings, &camera()).expect("sound eyes");
    LensFit::of(settings, &eyes)
        .expect("the lens fits")
        .expect("a headset")
}

/// What a pixel of the screen's half shows, as tangents, and the tangent that the bare screen would
/// show.
fn seen_at(fit: &LensFit, at: Vec2) -> (Vec2, Vec2) {
    let [l, r, b, t] = fit.screen;
    let p = Vec2::new(l + (r - l) * at.x, t + (b - t) * at.y);
    let radius = p.length();
    (p * (fit.lens.seen(radius) / radius.max(1e-9)), p)
}

proptest! {
    #[test]
    fn the_inverse_undoes_the_lens(
        x in 0.0f32..1.0, y in 0.0f32..1.0, name in 0usize..4,
        k in prop::array::uniform3(0.0f32..0.5), own: bool,
    ) {
        let lens = if own {
            format!("{},{},{}", k[0], k[1], k[2])
        } else {
            NAMES[name].to_owned()
        };
        let settings = headset(&lens);
        for fit in fits(&settings) {
            let (seen, p) = seen_at(&fit, Vec2::new(x, y));
            let back = fit.lens.screen(seen.length()).expect("it is shown somewhere");
            let [l, r, ..] = fit.screen;
            let off_px = (back - p.length()).abs() / (r - l) * settings.picture.width as f32;
            prop_assert!(off_px <= 0.01, "{off_px} pixels");
        }
    }
}

#[test]
fn straight_lines_come_out_straight_through_the_lens() {
    // Everything to the left of x = 0.35 as a tangent is white.
    let far = |x: f32, y: f32| Vec3::new(x, y, -1.0) * 100.0;
    let mut scene = shape(&[
        far(-9.0, -9.0),
        far(0.35, -9.0),
        far(0.35, 9.0),
        far(-9.0, 9.0),
    ]);
    let dark = &mut scene.environment;
    (dark.zenith, dark.horizon, dark.nadir) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    for name in NAMES {
        let settings = headset(name).with(|s| s.picture.tone_map = crate::ToneMap::Linear);
        let fits = fits(&settings);
        let pictures = halves(&scene, &camera(), &settings);
        for (fit, picture) in fits.iter().zip(&pictures) {
            let mut rows = 0;
            let (mut least, mut most) = (f32::MAX, f32::MIN);
            for (y, row) in picture
                .chunks_exact(settings.picture.width as usize)
                .enumerate()
            {
                let light = |x: usize| linear_of_srgb(f32::from(row[x][1]) / 255.0);
                // Where half of the light is left, unless the picture's own border takes it.
                let edge = (60..row.len() - 8).find(|&x| light(x) >= 0.5 && light(x + 1) < 0.5);
                let Some(x) = edge.filter(|&x| light(x - 4) > 0.99) else {
                    continue;
                };
                let part = (light(x) - 0.5) / (light(x) - light(x + 1));
                let at = Vec2::new(
                    (x as f32 + 0.5 + part) / settings.picture.width as f32,
                    (y as f32 + 0.5) / settings.picture.height as f32,
                );
                let (seen, _) = seen_at(fit, at);
                // In pixels of the eye's picture.
                let x = (seen.x - 0.35) / 1.8 * settings.picture.width as f32;
                (least, most) = (least.min(x), most.max(x));
                rows += 1;
            }
            assert!(rows > 200, "{name}: the edge is seen in {rows} rows");
            // Its own pixels end at most half a pixel away.
            assert!(
                least > -0.8 && most < 0.8,
                "{name}: {least} to {most} pixels"
            );
            assert!(
                most - least < 0.3,
                "{name}: bent by {} pixels",
                most - least
            );
        }
    }
}

#[test]
fn the_rate_map_follows_the_lens() {
    let settings = (headset(NAMES[0])).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Lens;
        s.coarse.refine_edges = RefineEdges::Off;
        s.coarse.composite = Composite::Nearest;
        s.coarse.backend = CoarseBackend::Compute;
        s.coarse.coarsest_level = 3;
        // The eyes' lenses are fitted to frusta of their own.
        s.stereo.frusta = "-1,0.8,-0.9,0.9,-0.7,1,-0.7,0.7"
            .parse()
            .expect("it can be read");
    });
    let renderer = rendered(&shape(&[Vec3::ZERO; 3]), &camera(), &settings);
    let pyramid = &renderer
        .targets()
        .coarse
        .as_ref()
        .expect("coarse")
        .rate
        .pyramid;
    let cells = rate_cells(pyramid, 1);
    let across = pyramid.blocks(1).0;
    let frusta = [[-1.0f32, 0.8, 0.9], [-0.7, 1.0, 0.7]];
    for ((eye, fit), [left, right, top]) in (0u32..).zip(fits(&settings)).zip(frusta) {
        let radii = fit.squared_radii();
        let mut seen = [0; 4];
        for y in 0..180u32 {
            for x in 0..200u32 {
                let levels = [(0.5, 0.5), (1.5, 0.5), (0.5, 1.5), (1.5, 1.5)].map(|(dx, dy)| {
                    let px = 2.0 * x as f32 + dx;
                    let py = 2.0 * y as f32 + dy;
                    let t = Vec2::new(
                        left + (right - left) * px / 400.0,
                        top - 2.0 * top * py / 360.0,
                    );
                    // Near a border rounding decides.
                    let squared = t.length_squared();
                    let near = radii.iter().any(|r| (r - squared).abs() < 1e-4);
                    (radii.iter().filter(|&&r| squared >= r).count().min(3), near)
                });
                if levels.iter().any(|l| l.1) {
                    continue;
                }
                let least = levels.iter().map(|l| l.0).min().expect("four");
                assert_eq!(
                    usize::from(cells[(y * across + x + eye * 200) as usize] & 15),
                    least,
                    "{x}, {y}"
                );
                seen[least] += 1;
            }
        }
        assert!(seen[0] > 1000 && seen[1] > 1000, "{seen:?}");
        // Half the samples per length of the screen at most, and no more than twice as many.
        let [l, r, b, t] = fit.screen;
        let corner = l.abs().max(r.abs()).hypot(b.abs().max(t.abs()));
        for (level, radius) in (1..).zip(radii).take(2) {
            let p = fit.lens.screen(radius.sqrt()).expect("shown");
            if p > 0.999 * corner {
                // All of the screen is finer.
                continue;
            }
            let step = 1e-3;
            let slope = (fit.lens.seen(p + step) - fit.lens.seen(p - step)) / (2.0 * step);
            let density = (p / radius.sqrt() / slope).sqrt();
            let expected = 0.5f32.powf(level as f32 - 0.5);
            assert!(density <= expected * 1.01, "level {level}: {density}");
        }
    }
    let radii = fits(&settings).map(|fit| fit.squared_radii());
    assert!(radii[0] != radii[1], "the test needs eyes that differ");
}

#[test]
fn a_lens_that_shows_45_degrees_shows_each_frustum_within_its_reach() {
    // It shows 50.6 degrees at most, from where on it folds.
    let with = |lens: &str, half: f32| {
        let frustum = format!("-{half},{half},-{half},{half}");
        headset(lens).with(|s| {
            s.stereo.frusta = format!("{frustum},{frustum}")
                .parse()
                .expect("it can be read");
        })
    };
    let limits = wgpu::Limits::default();
    for (lens, half, is_shown) in [("-0.1,0,0", 0.75, true), ("-0.1,0,0", 1.15, false)] {
        let settings = with(lens, half);
        settings
            .validate(&limits)
            .expect("it grows up to 45 degrees");
        let eyes = eyes(&settings, &camera()).expect("sound eyes");
        assert_eq!(LensFit::of(&settings, &eyes).is_ok(), is_shown, "{half}");
    }
    // 44.4 degrees at most.
    let error = with("-0.1543,0,0", 0.1).validate(&limits);
    let error = error.expect_err("it folds before").to_string();
    assert!(error.contains("45 degrees"), "{error}");
}

#[test]
fn a_frustum_that_a_lens_cannot_show_is_an_error() {
    let settings = (headset("0,-0.02,0"))
        .with(|s| s.stereo.frusta = "-3,3,-3,3,-3,3,-3,3".parse().expect("it can be read"));
    let eyes = eyes(&settings, &camera()).expect("sound eyes");
    let error = LensFit::of(&settings, &eyes).expect_err("it folds");
    assert!(error.to_string().contains("whole frustum"), "{error}");
}
