//! The square's own things: the fountain, trees in pots, benches.

use glam::{Vec2, Vec3};

use super::kit::{Thing, model};
use super::materials::Materials;
use crate::build::{MeshBuilder, SceneBuilder};
use crate::hash::Rng;
use crate::trig::{pitch, shift, sin_cos_turns, yaw};

/// Things that stand on the square and beside doors.
#[derive(Debug)]
pub(super) struct Furniture {
    pub(super) fountain: Thing,
    pub(super) tree: Thing,
    pub(super) shrub: Thing,
    pub(super) bench: Thing,
}

impl Furniture {
    pub(super) fn new(scene: &mut SceneBuilder, m: &Materials) -> Self {
        let basin = model(scene, "fountain basin", basin);
        let water = model(scene, "fountain water", water);
        let pot = model(scene, "plant pot", |b| {
            b.lathe(
                &[
                    (0.0, 0.0),
                    (0.22, 0.0),
                    (0.32, 0.42),
                    (0.36, 0.44),
                    (0.36, 0.52),
                    (0.31, 0.52),
                    (0.29, 0.45),
                    (0.0, 0.45),
                ],
                16,
            );
        });
        let trunk = model(scene, "trunk", trunk);
        let crown = model(scene, "crown", |b| {
            leaf_crown(b, Vec3::Y * 2.35, Vec3::new(0.85, 0.75, 0.85), 70, 1)
        });
        let bush = model(scene, "bush", |b| {
            leaf_crown(b, Vec3::Y * 0.78, Vec3::new(0.34, 0.32, 0.34), 26, 2)
        });
        let bench = model(scene, "bench", |b| {
            b.along_grain();
            b.bevel_box(
                Vec3::new(-0.9, 0.42, -0.22),
                Vec3::new(0.9, 0.48, 0.22),
                0.015,
            );
            for x in [-0.7, 0.6] {
                b.bevel_box(
                    Vec3::new(x, 0.0, -0.18),
                    Vec3::new(x + 0.1, 0.42, 0.18),
                    0.01,
                );
            }
        });
        let furniture = |name, parts: &[(u32, u32)]| Thing::new(name, "square", parts);
        Self {
            fountain: furniture("fountain", &[(basin, m.pale_stone), (water, m.water)]),
            tree: furniture(
                "tree",
                &[(pot, m.terracotta), (trunk, m.bark), (crown, m.leaves)],
            ),
            shrub: furniture("shrub", &[(pot, m.terracotta), (bush, m.leaves)]),
            bench: furniture("bench", &[(bench, m.wood)]),
        }
    }
}

/// Two steps, a wide basin, a baluster with two bowls.
fn basin(b: &mut MeshBuilder) {
    b.lathe(
        &[(3.5, 0.0), (3.5, 0.15), (3.1, 0.15), (3.1, 0.3), (2.6, 0.3)],
        32,
    );
    let rim = [
        (2.6, 0.3),
        (2.45, 0.38),
        (2.45, 0.72),
        (2.6, 0.78),
        (2.66, 0.84),
        (2.6, 0.9),
        (2.3, 0.9),
        (2.25, 0.84),
        (2.25, 0.35),
        (0.0, 0.35),
    ];
    b.lathe(&rim, 32);
    let baluster = [
        (0.5, 0.3),
        (0.5, 0.7),
        (0.36, 0.78),
        (0.24, 1.1),
        (0.32, 1.4),
        (0.2, 1.62),
        (0.3, 1.72),
        (1.15, 2.0),
        (1.22, 2.08),
        (1.15, 2.12),
        (1.05, 2.08),
        (0.3, 1.95),
        (0.17, 2.05),
        (0.14, 2.5),
        (0.2, 2.7),
        (0.12, 2.84),
        (0.2, 2.9),
        (0.55, 3.06),
        (0.6, 3.12),
        (0.55, 3.15),
        (0.48, 3.12),
        (0.12, 3.05),
        (0.08, 3.3),
        (0.13, 3.42),
        (0.0, 3.5),
    ];
    b.lathe(&baluster, 24);
}

/// Three surfaces and the jets that fall between them.
fn water(b: &mut MeshBuilder) {
    for (radius, y) in [(2.25, 0.76), (1.08, 2.095), (0.5, 3.128)] {
        b.lathe(&[(radius, y), (0.0, y)], 28);
    }
    // Jets arc outwards from each rim and fall into the bowl below.
    for (count, top_r, top_y, r, y) in [(10u8, 0.56, 3.13, 0.86, 2.1), (18, 1.18, 2.1, 1.75, 0.77)]
    {
        for jet in 0..count {
            let (sin, cos) = sin_cos_turns(f32::from(jet) / f32::from(count));
            let arc: Vec<Vec3> = (0..=8u8)
                .map(|i| {
                    // Out at an even pace, down at a growing one.
                    let t = f32::from(i) / 8.0;
                    let out = top_r + (r - top_r) * t;
                    Vec3::new(out * sin, top_y + (y - top_y) * t * t, out * cos)
                })
                .collect();
            b.tube(&arc, 0.022, 5);
        }
    }
}

/// A bent stem with three boughs.
fn trunk(b: &mut MeshBuilder) {
    let p = Vec3::new;
    b.tube(
        &[
            p(0.0, 0.4, 0.0),
            p(0.04, 1.0, 0.02),
            p(0.0, 1.6, -0.03),
            p(0.03, 2.3, 0.0),
        ],
        0.05,
        8,
    );
    for i in 0..3u8 {
        let (sin, cos) = sin_cos_turns(f32::from(i) / 3.0);
        let out = p(sin, 0.0, cos);
        b.tube(
            &[
                p(0.0, 1.6, -0.03),
                p(0.0, 1.95, 0.0) + out * 0.25,
                p(0.0, 2.4, 0.0) + out * 0.45,
            ],
            0.025,
            6,
        );
    }
}

/// Leaf cards on an ellipsoid, shaded as one round crown.
fn leaf_crown(b: &mut MeshBuilder, center: Vec3, radii: Vec3, cards: u32, key: u64) {
    let mut rng = Rng::new(501, key);
    for i in 0..cards {
        // Even over the sphere: equal steps in height, the golden angle around.
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / cards as f32;
        let (sin, cos) = sin_cos_turns(i as f32 * 0.381_966);
        let flat = (1.0 - y * y).sqrt();
        let out = Vec3::new(flat * sin, y, flat * cos);
        let place = center + out * radii * rng.range(0.55, 0.95);
        let turn = yaw(rng.unit()) * pitch(rng.range(-0.12, 0.12));
        let side = turn.transform_vector3(Vec3::X);
        let up = turn.transform_vector3(Vec3::Y);
        let n = side.cross(up);
        let side = if n.dot(out) < 0.0 { -side } else { side };
        let n = side.cross(up) + out;
        let half = rng.range(0.26, 0.36) * (radii.x / 0.85).max(0.6);
        let shade = (150.0 + 105.0 * rng.unit()) as u8;
        b.tint([shade, shade, shade]);
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(s, t)| {
            let p = place + (side * s + up * t) * half;
            b.vertex(p, n, Vec2::new(0.5 + 0.5 * s, 0.5 - 0.5 * t))
        });
        b.quad(corners[0], corners[1], corners[2], corners[3]);
    }
    b.at(shift(0.0, 0.0, 0.0));
}
