//! What is sold and what it is kept in. Everything stands on y = 0.

use std::array::from_fn;

use glam::{Vec2, Vec3};

use super::kit::{Thing, model};
use super::materials::Materials;
use crate::build::{MeshBuilder, SceneBuilder};
use crate::hash::Rng;
use crate::trig::{pitch, roll, shift, sin_cos_turns, yaw};

/// All goods.
#[derive(Debug)]
pub(super) struct Goods {
    /// Slatted crates, 0.56 by 0.40 m, of oranges, apples, limes, aubergines.
    pub(super) fruit_crates: [Thing; 4],
    pub(super) crate_empty: Thing,
    pub(super) barrel: Thing,
    pub(super) baskets: [Thing; 3],
    /// Tall jars in clay and two glazes.
    pub(super) jars: [Thing; 3],
    pub(super) bowls: [Thing; 3],
    pub(super) rug_rolls: [Thing; 3],
    /// Hangs down 1.5 m from y = 0, facing +z.
    pub(super) hung_rugs: [Thing; 3],
    /// Open sacks of paprika, turmeric, grain, indigo.
    pub(super) sacks: [Thing; 4],
    /// Tray and pot in brass and copper.
    pub(super) trays: [Thing; 2],
    pub(super) pots: [Thing; 2],
    pub(super) bottles: Thing,
    pub(super) loaves: Thing,
    pub(super) steam: Thing,
}

impl Goods {
    pub(super) fn new(scene: &mut SceneBuilder, m: &Materials) -> Self {
        let slats = model(scene, "crate", slats);
        let fruit = model(scene, "fruit", layers_of_fruit);
        let staves = model(scene, "barrel", staves);
        let hoops = model(scene, "barrel hoops", hoops);
        let basket = model(scene, "basket", |b| {
            b.lathe(
                &[
                    (0.0, 0.0),
                    (0.19, 0.0),
                    (0.27, 0.28),
                    (0.29, 0.30),
                    (0.27, 0.31),
                    (0.25, 0.28),
                    (0.18, 0.05),
                    (0.0, 0.05),
                ],
                14,
            );
        });
        let heap = model(scene, "heap", |b| heap(b, [176, 48, 6]));
        let jar = model(scene, "jar", |b| {
            let outside = [
                (0.0, 0.0),
                (0.13, 0.0),
                (0.16, 0.03),
                (0.24, 0.25),
                (0.27, 0.42),
                (0.24, 0.56),
                (0.15, 0.68),
                (0.11, 0.74),
                (0.11, 0.78),
                (0.15, 0.82),
                (0.12, 0.82),
                (0.09, 0.75),
                (0.0, 0.72),
            ];
            b.lathe(&outside, 16);
            for s in [0.0, 0.5] {
                b.at(yaw(s));
                let handle: Vec<Vec3> = (0..=6u8)
                    .map(|i| {
                        let (sin, cos) = sin_cos_turns(f32::from(i) / 12.0 - 0.25);
                        Vec3::new(0.13 + 0.11 * cos, 0.64 + 0.10 * sin, 0.0)
                    })
                    .collect();
                b.tube(&handle, 0.018, 6);
            }
        });
        let bowl = model(scene, "bowl", |b| {
            b.lathe(
                &[
                    (0.0, 0.0),
                    (0.07, 0.0),
                    (0.08, 0.02),
                    (0.15, 0.07),
                    (0.18, 0.13),
                    (0.165, 0.13),
                    (0.13, 0.075),
                    (0.0, 0.035),
                ],
                16,
            );
        });
        let rug_roll = model(scene, "rolled rug", rolled_rug);
        let hung = model(scene, "hung rug", hung_rug);
        let sack = model(scene, "sack", |b| {
            b.lathe(
                &[
                    (0.0, 0.0),
                    (0.22, 0.0),
                    (0.28, 0.08),
                    (0.29, 0.25),
                    (0.25, 0.42),
                    (0.27, 0.46),
                    (0.31, 0.47),
                    (0.29, 0.50),
                    (0.23, 0.46),
                    (0.0, 0.42),
                ],
                14,
            );
        });
        let mound = model(scene, "spice", |b| {
            b.lathe(
                &[(0.235, 0.45), (0.14, 0.55), (0.05, 0.62), (0.0, 0.635)],
                14,
            );
        });
        let tray = model(scene, "tray", |b| {
            b.at(pitch(-0.22)).lathe(
                &[
                    (0.0, 0.0),
                    (0.20, 0.0),
                    (0.24, 0.03),
                    (0.255, 0.03),
                    (0.20, -0.01),
                    (0.0, -0.01),
                ],
                20,
            );
        });
        let pot = model(scene, "pot", |b| {
            b.lathe(
                &[
                    (0.0, 0.0),
                    (0.09, 0.0),
                    (0.10, 0.02),
                    (0.16, 0.10),
                    (0.17, 0.16),
                    (0.12, 0.25),
                    (0.05, 0.31),
                    (0.04, 0.38),
                    (0.06, 0.42),
                    (0.05, 0.42),
                    (0.03, 0.38),
                    (0.0, 0.37),
                ],
                16,
            );
        });
        let bottles = model(scene, "bottles", bottles);
        let loaves = model(scene, "loaves", loaves);
        let steam = model(scene, "steam", |b| {
            for turns in [0.0, 0.17, 0.34] {
                b.at(yaw(turns));
                let corner = Vec3::new(-0.4, 0.0, 0.0);
                b.panel_uv(corner, Vec3::X * 0.8, Vec3::Y * 1.3, Vec2::ZERO, Vec2::ONE);
            }
        });
        let goods = |name, parts: &[(u32, u32)]| Thing::new(name, "goods", parts);
        let clays = [m.terracotta, m.glazes[0], m.glazes[1]];
        let metals = [m.brass, m.copper];
        Self {
            fruit_crates: from_fn(|i| {
                goods("crate of fruit", &[(slats, m.wood), (fruit, m.fruits[i])])
            }),
            crate_empty: goods("crate", &[(slats, m.wood)]),
            barrel: goods("barrel", &[(staves, m.timber), (hoops, m.iron)]),
            baskets: [
                goods("basket", &[(basket, m.wicker)]),
                goods("basket of fruit", &[(basket, m.wicker), (heap, m.produce)]),
                goods(
                    "basket of loaves",
                    &[(basket, m.wicker), (loaves, m.produce)],
                ),
            ],
            jars: from_fn(|i| goods("jar", &[(jar, clays[i])])),
            bowls: from_fn(|i| goods("bowl", &[(bowl, clays[i])])),
            rug_rolls: from_fn(|i| goods("rolled rug", &[(rug_roll, m.rugs[i])])),
            hung_rugs: from_fn(|i| goods("hung rug", &[(hung, m.rugs[i])])),
            sacks: from_fn(|i| goods("sack", &[(sack, m.canvas), (mound, m.spices[i])])),
            trays: from_fn(|i| goods("tray", &[(tray, metals[i])])),
            pots: from_fn(|i| goods("pot", &[(pot, metals[i])])),
            bottles: goods("bottles", &[(bottles, m.bottles)]),
            loaves: goods("loaves", &[(loaves, m.produce)]),
            steam: goods("steam", &[(steam, m.steam)]),
        }
    }
}

/// An open crate of slats.
fn slats(b: &mut MeshBuilder) {
    b.along_grain();
    let (x, z, h) = (0.28, 0.20, 0.20);
    b.block(Vec3::new(-x, 0.01, -z), Vec3::new(x, 0.025, z));
    for y in [0.02, 0.115] {
        for s in [-z, z - 0.014] {
            b.block(Vec3::new(-x, y, s), Vec3::new(x, y + 0.075, s + 0.014));
        }
        for s in [-x, x - 0.014] {
            b.block(Vec3::new(s, y, -z), Vec3::new(s + 0.014, y + 0.075, z));
        }
    }
    for (sx, sz) in [(-1.0f32, -1.0f32), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let c = Vec3::new(sx * (x - 0.028), 0.0, sz * (z - 0.028));
        b.block(
            c - Vec3::new(0.014, 0.0, 0.014),
            c + Vec3::new(0.014, h, 0.014),
        );
    }
}

/// A colour a little lighter or darker.
fn vary(color: [u8; 3], rng: &mut Rng) -> [u8; 3] {
    let by = rng.range(0.7, 1.25);
    color.map(|c| (f32::from(c) * by) as u8)
}

/// Round fruit that fills a crate in two layers.
fn layers_of_fruit(b: &mut MeshBuilder) {
    let mut rng = Rng::new(301, 0);
    for layer in 0..2u8 {
        let (columns, rows) = if layer == 0 { (5u8, 4u8) } else { (4, 3) };
        for i in 0..columns * rows {
            let step = |i: u8, n: u8, pitch: f32| (f32::from(i) - 0.5 * f32::from(n - 1)) * pitch;
            let place = Vec3::new(
                step(i % columns, columns, 0.102) + rng.range(-0.012, 0.012),
                0.12 + 0.066 * f32::from(layer) + rng.range(0.0, 0.015),
                step(i / columns, rows, 0.094) + rng.range(-0.012, 0.012),
            );
            let r = rng.range(0.044, 0.052);
            let tint = vary([205; 3], &mut rng);
            b.tint(tint)
                .ellipsoid(place, Vec3::new(r, r * 0.94, r), 7, 5);
        }
    }
}

/// A heap of fruit for a basket.
fn heap(b: &mut MeshBuilder, color: [u8; 3]) {
    let mut rng = Rng::new(302, 0);
    for (ring, count) in [(0.19f32, 11u8), (0.11, 7), (0.0, 1)] {
        for i in 0..count {
            let (sin, cos) =
                sin_cos_turns((f32::from(i) + rng.range(-0.1, 0.1)) / f32::from(count));
            let place = Vec3::new(ring * sin, 0.36 - 0.45 * ring, ring * cos);
            let tint = vary(color, &mut rng);
            b.tint(tint)
                .ellipsoid(place, Vec3::splat(rng.range(0.05, 0.06)), 7, 5);
        }
    }
}

/// The wooden body of a barrel 0.9 m high.
fn staves(b: &mut MeshBuilder) {
    let body = [
        (0.0, 0.03),
        (0.24, 0.03),
        (0.25, 0.0),
        (0.27, 0.0),
        (0.32, 0.25),
        (0.335, 0.45),
        (0.32, 0.65),
        (0.27, 0.9),
        (0.25, 0.9),
        (0.24, 0.87),
        (0.0, 0.87),
    ];
    b.lathe(&body, 18);
}

/// Its iron hoops.
fn hoops(b: &mut MeshBuilder) {
    for (y, lower, upper) in [
        (0.06, 0.288, 0.300),
        (0.24, 0.324, 0.333),
        (0.60, 0.333, 0.324),
        (0.79, 0.300, 0.288),
    ] {
        b.lathe(
            &[
                (lower - 0.01, y),
                (lower, y),
                (upper, y + 0.05),
                (upper - 0.01, y + 0.05),
            ],
            18,
        );
    }
}

/// A rug rolled up, 1.5 m long, lying along x.
fn rolled_rug(b: &mut MeshBuilder) {
    b.at(shift(0.0, 0.11, 0.0) * roll(-0.25));
    let coil: Vec<(f32, f32)> = vec![(0.0, -0.75), (0.11, -0.75), (0.11, 0.75), (0.0, 0.75)];
    b.lathe(&coil, 14);
}

/// A rug that hangs with soft folds, 1.0 by 1.5 m.
fn hung_rug(b: &mut MeshBuilder) {
    b.sheet(
        10,
        10,
        |s, t| {
            let (fold, _) = sin_cos_turns(s * 2.0);
            Vec3::new(s - 0.5, -1.5 * (1.0 - t), 0.03 * fold * (1.2 - t))
        },
        |s, t| Vec2::new(s, 1.0 - t),
    );
}

/// Six bottles in two rows.
fn bottles(b: &mut MeshBuilder) {
    let mut rng = Rng::new(303, 0);
    for i in 0..6u8 {
        let place = shift(
            0.13 * (f32::from(i % 3) - 1.0),
            0.0,
            0.13 * (f32::from(i / 3) - 0.5),
        );
        let h = rng.range(0.8, 1.15);
        let tall = |r: f32, y: f32| (r, y * h);
        b.at(place).lathe(
            &[
                tall(0.0, 0.0),
                tall(0.045, 0.0),
                tall(0.05, 0.01),
                tall(0.05, 0.18),
                tall(0.018, 0.26),
                tall(0.016, 0.32),
                tall(0.0, 0.32),
            ],
            10,
        );
    }
}

/// A pile of round loaves.
fn loaves(b: &mut MeshBuilder) {
    let mut rng = Rng::new(304, 0);
    for (x, y, z) in [
        (-0.12, 0.30, 0.06),
        (0.12, 0.30, 0.05),
        (0.0, 0.30, -0.13),
        (0.02, 0.38, 0.0),
        (-0.13, 0.36, -0.05),
    ] {
        let place = Vec3::new(x, y, z);
        let tint = vary([104, 48, 14], &mut rng);
        b.tint(tint)
            .ellipsoid(place, Vec3::new(0.13, 0.065, 0.10), 10, 7);
    }
}
