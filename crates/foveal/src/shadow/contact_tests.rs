//! Contact shadows: how wide their edges are, and that nothing leaks or shades itself.

use foveal_scene::{Camera, Scene};
use glam::Vec3;

use super::culling_tests::{add, bare, flat, lamp};
use super::tests::{lookup, room, shadowed};
use crate::lights::LightUniform;
use crate::shadow::twin::Lookup;
use crate::testing::{Film, picture, rendered, shifted};
use crate::{Geometry, RateSource, Settings, Shading, Shadows};

/// Height of the lamp above the floor.
const LAMP: f32 = 3.0;

pub(super) fn level(x: [f32; 2], y: f32, z: [f32; 2]) -> foveal_scene::Mesh {
    flat([
        Vec3::new(x[0], y, z[1]),
        Vec3::new(x[1], y, z[1]),
        Vec3::new(x[1], y, z[0]),
        Vec3::new(x[0], y, z[0]),
    ])
}

/// A floor below a lamp.
pub(super) fn floor(lamp_at: Vec3) -> Scene {
    let mut scene = bare();
    add(&mut scene, [level([-4.0, 4.0], 0.0, [-4.0, 4.0])]);
    scene.lights.push(lamp(lamp_at, 20.0));
    scene
}

struct Lit {
    lookup: Lookup,
    light: LightUniform,
}

impl Lit {
    /// From above and aside, so that each side of the lamp's cube is in view.
    fn new(scene: &Scene, radius: f32) -> Self {
        let camera = Camera::look_at(Vec3::new(3.0, 9.0, 7.0), Vec3::ZERO, Vec3::Y, 1.2);
        let settings: Settings = shadowed(Shadows::Contact).with(|s| {
            s.picture.width = 640;
            s.picture.height = 480;
            s.lighting.shadow_atlas = 4096;
            s.lighting.light_radius_m = radius;
        });
        let renderer = rendered(scene, &camera, &settings);
        Self {
            lookup: lookup(&renderer),
            light: renderer.lights().1[0],
        }
    }

    /// Part of the light that reaches a place of the floor.
    fn at(&self, x: f32, z: f32) -> f32 {
        let place = Vec3::new(x, 0.0, z);
        self.lookup.light_passing(0, &self.light, (place, Vec3::Y))
    }

    /// Metres over which the shadow of an edge along x = 0 fades from 90 to 10 %.
    fn width(&self) -> f32 {
        let step = 1e-3;
        let along: Vec<f32> = (-400..400)
            .map(|i| self.at(i as f32 * step, 0.31))
            .collect();
        assert!(along[0] == 0.0 && along[799] == 1.0, "{along:?}");
        for pair in along.windows(2) {
            assert!(
                pair[1] >= pair[0] - 0.05,
                "it fades to one side alone: {pair:?}"
            );
        }
        let beyond = |part: f32| along.partition_point(|&passing| passing < part) as f32 * step;
        beyond(0.9) - beyond(0.1)
    }
}

/// A card at a height, whose border lies below the lamp.
fn card(height: f32) -> Scene {
    let mut scene = floor(LAMP * Vec3::Y);
    add(&mut scene, [level([-4.0, 0.0], height, [-4.0, 4.0])]);
    scene
}

#[test]
fn edges_are_sharp_at_contact_and_fade_with_distance_and_the_lamps_size() {
    // Of the widest tile.
    let texel = 2.0 * LAMP / (512.0 - 8.0);
    let width = |height, radius| Lit::new(&card(height), radius).width();
    let sharp = width(0.05, 0.2);
    assert!(sharp < 3.0 * texel, "{sharp}, {texel}");
    let mut before = sharp;
    for height in [0.4, 0.7, 1.0] {
        // The lamp's picture through the edge; of a disc's, 80 % lie within 0.687 of its radius.
        let traced = 2.0 * 0.687 * 0.2 * height / (LAMP - height);
        let found = width(height, 0.2);
        assert!(found > before, "{height}: {found} {before}");
        assert!(
            (found / traced - 1.0).abs() < 0.35,
            "{height}: {found} {traced}"
        );
        before = found;
    }
    let widths = [0.0, 0.05, 0.1, 0.2].map(|radius| width(1.0, radius));
    assert!(widths.is_sorted() && widths[0] < 3.0 * texel, "{widths:?}");
    // A kernel has an end.
    let most = width(2.0, 2.0);
    assert!(most < 2.0 * 13.0 * texel && most > 12.0 * texel, "{most}");
}

#[test]
fn no_light_leaks_into_a_shadow_across_the_sides_of_the_cube() {
    for radius in [0.05, 0.3] {
        let lit = Lit::new(&card(1.0), radius);
        let mut looked = 0;
        // The sides meet where x or z is 3.
        for i in 0..340 {
            for j in -50..50 {
                let (x, z) = (-0.5 - 0.01 * i as f32, 0.07 * j as f32);
                assert_eq!(lit.at(x, z), 0.0, "{radius}: {x}, {z}");
                looked += 1;
            }
        }
        assert!(looked > 30_000);
    }
}

#[test]
fn a_floor_does_not_shade_itself() {
    // The last two lamps reach to the floor and below it.
    for (height, radius) in [
        (3.0, 0.05),
        (3.0, 0.5),
        (1.0, 0.1),
        (0.4, 0.05),
        (0.4, 0.4),
        (0.3, 0.5),
    ] {
        let lit = Lit::new(&floor(height * Vec3::Y), radius);
        for i in -39..40 {
            for j in -39..40 {
                let (x, z) = (0.1 * i as f32 + 0.003, 0.1 * j as f32 + 0.002);
                let passing = lit.at(x, z);
                assert!(passing > 0.99, "{height}, {radius}: {passing} at {x}, {z}");
            }
        }
    }
}

#[test]
fn a_bare_wall_does_not_shade_itself_wherever_it_faces_a_lamp() {
    for away in [
        Vec3::NEG_Z,
        Vec3::new(1.0, 0.0, -1.0),
        Vec3::new(1.0, 1.0, -1.0),
    ] {
        let away = away.normalize();
        let [across, up] = [
            away.cross(Vec3::Y).normalize(),
            away.any_orthonormal_vector(),
        ];
        let up = up
            .reject_from(across)
            .try_normalize()
            .unwrap_or(across.cross(away));
        let at = |x: f32, y: f32| 3.0 * away + x * across + y * up;
        let mut scene = bare();
        let corners = [(-1.5, -1.5), (1.5, -1.5), (1.5, 1.5), (-1.5, 1.5)];
        add(&mut scene, [flat(corners.map(|(x, y)| at(x, y)))]);
        scene.lights.push(lamp(Vec3::ZERO, 20.0));
        let camera = Camera::look_at(-0.5 * away, at(0.0, 0.0), up, 0.9);
        for shadows in [Shadows::Hard, Shadows::Soft, Shadows::Contact] {
            let settings = shadowed(shadows).with(|s| {
                s.picture.width = 320;
                s.picture.height = 320;
            });
            let renderer = rendered(&scene, &camera, &settings);
            let (lookup, light) = (lookup(&renderer), renderer.lights().1[0]);
            for (i, j) in (-28..29).flat_map(|i| (-28..29).map(move |j| (i, j))) {
                let place = at(0.05 * i as f32 + 0.003, 0.05 * j as f32 + 0.002);
                let passing = lookup.light_passing(0, &light, (place, -away));
                assert!(passing > 0.97, "{shadows:?}, {away}: {passing} at {i}, {j}");
            }
        }
    }
}

#[test]
fn at_rest_light_that_is_kept_becomes_that_of_full_shading() {
    let scene = room();
    let there = &scene.cameras[0];
    for path in [Geometry::Gbuffer, Geometry::Visibility] {
        let full = shadowed(Shadows::Contact).with(|s| s.geometry.path = path);
        let kept = full.clone().with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.history = true;
            s.rate.force = true;
            s.coarse.source = RateSource::Radii;
            s.coarse.fovea_inner = 0.1;
            s.coarse.fovea_outer = 1.0;
        });
        let mut film = Film::new(&scene, &kept);
        for step in 0..3 {
            film.draw(&shifted(there, 0.02 * step as f32));
        }
        film.draw(there);
        let full = picture(&rendered(&scene, there, &full));
        assert_ne!(picture(&film.renderer), full);
        // A round.
        for _ in 0..16 {
            film.draw(there);
        }
        let off = picture(&film.renderer);
        let off = off.iter().zip(&full).filter(|(a, b)| a != b).count();
        // Tiles that are kept may lie elsewhere, and the rasterizer's last bit depends on where.
        assert!(off * 500 <= full.len(), "{path:?}: {off} bytes differ");
        let mut still = Film::new(&scene, &kept);
        for _ in 0..17 {
            still.draw(there);
        }
        assert!(picture(&still.renderer) == full, "{path:?}");
    }
}
