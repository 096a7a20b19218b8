//! Lanterns, ropes and bulbs: a light's mesh has its flame at the origin.

use std::array::from_fn;

use glam::{Vec2, Vec3};

use super::kit::{Thing, model};
use super::materials::Materials;
use crate::build::{MeshBuilder, SceneBuilder};
use crate::trig::sin_cos_turns;

/// Span of the ropes across the main alley.
pub(super) const ROPE_M: f32 = 9.0;
/// How far a rope's middle hangs below its ends.
pub(super) const SAG_M: f32 = 0.75;

/// All sources of light, and what they hang from.
#[derive(Debug)]
pub(super) struct Lanterns {
    /// Iron and glass, hangs on a short chain.
    pub(super) iron: Thing,
    /// The same on a long one.
    pub(super) long_iron: Thing,
    /// Round paper lanterns in amber, red, teal, magenta.
    pub(super) papers: [Thing; 4],
    /// Tall paper lanterns of the same colours.
    pub(super) tall_papers: [Thing; 4],
    /// An iron arm that reaches 0.55 m out along +z; a lantern's chain hangs from its end.
    pub(super) arm: Thing,
    /// Spans x = ±4.5 m.
    pub(super) rope: Thing,
    /// The same with bulbs.
    pub(super) bulb_rope: Thing,
    /// The same with pennants.
    pub(super) pennants: [Thing; 3],
    /// An iron post 3.4 m high with a lantern on top, flame 3.1 m up.
    pub(super) post: Thing,
}

/// Height above the flame where an iron lantern's chain ends.
pub(super) const CHAIN_M: f32 = 0.45;
/// The same for a long-chained lantern.
pub(super) const LONG_CHAIN_M: f32 = 1.35;

impl Lanterns {
    pub(super) fn new(scene: &mut SceneBuilder, m: &Materials) -> Self {
        let cage = model(scene, "lantern cage", |b| {
            cage_bars(b);
            b.tube(&[Vec3::Y * 0.28, Vec3::Y * CHAIN_M], 0.008, 4);
        });
        let long_cage = model(scene, "long-chained cage", |b| {
            cage_bars(b);
            b.tube(&[Vec3::Y * 0.28, Vec3::Y * LONG_CHAIN_M], 0.008, 4);
        });
        let glass = model(scene, "lantern glass", |b| {
            b.lathe(&[(0.085, -0.14), (0.125, 0.13)], 6);
        });
        let flame = model(scene, "flame", |b| {
            b.ellipsoid(Vec3::Y * -0.01, Vec3::new(0.032, 0.07, 0.032), 8, 7);
        });
        let paper = model(scene, "paper lantern", |b| {
            ribbed(b, 0.21, 0.19);
        });
        let tall = model(scene, "tall paper lantern", |b| {
            ribbed(b, 0.15, 0.27);
        });
        let arm = model(scene, "lantern arm", arm);
        let rope = model(scene, "rope", |b| {
            b.tube(&catenary(), 0.012, 5);
        });
        let bulbs = model(scene, "bulbs", |b| {
            for i in 1..18u8 {
                let place = rope_point(f32::from(i) / 18.0) - Vec3::Y * 0.07;
                b.ellipsoid(place, Vec3::new(0.05, 0.065, 0.05), 7, 5);
            }
        });
        let pennants = model(scene, "pennants", pennants);
        let post = model(scene, "lantern post", |b| {
            b.lathe(
                &[
                    (0.0, 0.0),
                    (0.22, 0.0),
                    (0.22, 0.1),
                    (0.13, 0.2),
                    (0.09, 0.5),
                    (0.11, 0.54),
                    (0.07, 0.6),
                    (0.05, 1.6),
                    (0.045, 2.86),
                    (0.09, 2.92),
                    (0.0, 2.95),
                ],
                12,
            );
            b.at(crate::trig::shift(0.0, 3.1, 0.0));
            cage_bars(b);
        });
        let post_light = model(scene, "post light", |b| {
            b.ellipsoid(Vec3::Y * 3.1, Vec3::new(0.07, 0.11, 0.07), 10, 8);
        });
        let lantern = |name, parts: &[(u32, u32)]| Thing::new(name, "lanterns", parts);
        Self {
            iron: lantern(
                "lantern",
                &[(cage, m.iron), (glass, m.glass), (flame, m.flame)],
            ),
            long_iron: lantern(
                "lantern",
                &[(long_cage, m.iron), (glass, m.glass), (flame, m.flame)],
            ),
            papers: from_fn(|i| lantern("paper lantern", &[(paper, m.papers[i])])),
            tall_papers: from_fn(|i| lantern("paper lantern", &[(tall, m.papers[i])])),
            arm: lantern("lantern arm", &[(arm, m.iron)]),
            rope: lantern("rope", &[(rope, m.rope)]),
            bulb_rope: lantern("string of bulbs", &[(rope, m.rope), (bulbs, m.bulb)]),
            pennants: from_fn(|i| {
                let cloth = [m.awnings[0], m.awnings[1], m.awnings[2]][i];
                lantern("pennants", &[(rope, m.rope), (pennants, cloth)])
            }),
            post: lantern("lantern post", &[(post, m.iron), (post_light, m.bulb)]),
        }
    }
}

/// A point of the hanging rope, `t` in [0, 1], ends at y = 0: the parabola near a catenary.
pub(super) fn rope_point(t: f32) -> Vec3 {
    Vec3::new(ROPE_M * (t - 0.5), -SAG_M * 4.0 * t * (1.0 - t), 0.0)
}

fn catenary() -> Vec<Vec3> {
    (0..=16u8)
        .map(|i| rope_point(f32::from(i) / 16.0))
        .collect()
}

/// Six iron posts between a floor and a roof.
fn cage_bars(b: &mut MeshBuilder) {
    b.lathe(
        &[(0.0, -0.18), (0.06, -0.17), (0.11, -0.14), (0.0, -0.14)],
        6,
    );
    b.lathe(
        &[
            (0.0, 0.13),
            (0.15, 0.12),
            (0.155, 0.14),
            (0.06, 0.22),
            (0.03, 0.25),
            (0.03, 0.28),
            (0.0, 0.29),
        ],
        6,
    );
    for i in 0..6u8 {
        let (sin, cos) = sin_cos_turns(f32::from(i) / 6.0);
        let out = Vec3::new(sin, 0.0, cos);
        b.tube(
            &[out * 0.095 - Vec3::Y * 0.15, out * 0.135 + Vec3::Y * 0.14],
            0.008,
            4,
        );
    }
}

/// A paper balloon with ribs and two dark caps (vertex colours).
fn ribbed(b: &mut MeshBuilder, radius: f32, half: f32) {
    let profile: Vec<(f32, f32)> = (0..=12u8)
        .map(|i| {
            let (sin, cos) = sin_cos_turns(f32::from(i) / 24.0 - 0.25);
            let rib = if i % 2 == 0 { 1.0 } else { 0.955 };
            let cap = if i == 0 || i == 12 {
                0.32
            } else {
                cos.max(0.34)
            };
            (radius * cap * rib, half * sin)
        })
        .collect();
    b.lathe(&profile, 14);
    let lip = 0.32 * radius;
    b.lathe(
        &[(0.0, -half - 0.03), (lip, -half - 0.03), (lip, -half)],
        10,
    );
    b.lathe(&[(lip, half), (lip, half + 0.03), (0.0, half + 0.03)], 10);
    b.tube(&[Vec3::Y * half, Vec3::Y * (half + 0.18)], 0.006, 4);
}

/// A bracket with a scroll below.
fn arm(b: &mut MeshBuilder) {
    b.tube(
        &[
            Vec3::ZERO,
            Vec3::new(0.0, 0.03, 0.3),
            Vec3::new(0.0, 0.0, 0.58),
        ],
        0.016,
        6,
    );
    let scroll: Vec<Vec3> = (0..=8u8)
        .map(|i| {
            let (sin, cos) = sin_cos_turns(f32::from(i) / 32.0);
            Vec3::new(0.0, -0.36 * cos, 0.40 * sin)
        })
        .collect();
    b.tube(&scroll, 0.012, 5);
    b.bevel_box(
        Vec3::new(-0.04, -0.42, -0.01),
        Vec3::new(0.04, 0.08, 0.02),
        0.008,
    );
}

/// Little triangular flags along the rope.
fn pennants(b: &mut MeshBuilder) {
    for i in 1..16u8 {
        let t = f32::from(i) / 16.0;
        let (l, r) = (rope_point(t - 0.024), rope_point(t + 0.024));
        let tip = (l + r) * 0.5 - Vec3::Y * 0.42 + Vec3::Z * if i % 2 == 0 { 0.05 } else { -0.04 };
        let n = (r - l).cross(Vec3::Y);
        let u = 0.4 * f32::from(i);
        let a = b.vertex(l, n, Vec2::new(u, 0.0));
        let tip = b.vertex(tip, n, Vec2::new(u + 0.2, 0.42));
        let c = b.vertex(r, n, Vec2::new(u + 0.4, 0.0));
        b.triangle(a, tip, c);
    }
}
