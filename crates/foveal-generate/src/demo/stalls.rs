//! Stall parts: timber frames, awnings that sag, counters. Front faces +z, 3 m wide, 1.9 m deep.

use std::array::from_fn;

use glam::{Vec2, Vec3};

use super::kit::{Thing, model};
use super::materials::Materials;
use crate::build::{MeshBuilder, SceneBuilder};

/// Width of a stall.
pub(super) const WIDTH_M: f32 = 3.0;
/// Depth of a stall without the awning's overhang.
pub(super) const DEPTH_M: f32 = 1.9;
/// Height of the counter's top.
pub(super) const COUNTER_M: f32 = 0.86;

const FRONT_M: f32 = 2.35;
const BACK_M: f32 = 2.85;

/// All stalls: by awning's shape, then by cloth.
#[derive(Debug)]
pub(super) struct Stalls {
    pub(super) stalls: [[Thing; 7]; 3],
    pub(super) table: Thing,
    pub(super) shelf: Thing,
}

impl Stalls {
    pub(super) fn new(scene: &mut SceneBuilder, m: &Materials) -> Self {
        let lean_frame = model(scene, "stall frame", |b| frame(b, FRONT_M, BACK_M));
        let tent_frame = model(scene, "tent frame", |b| {
            frame(b, FRONT_M, FRONT_M);
            let ridge = [Vec3::new(-1.5, 3.1, 0.0), Vec3::new(1.5, 3.1, 0.0)];
            b.tube(&ridge, 0.035, 6);
        });
        let awnings = [
            model(scene, "lean-to awning", lean_to),
            model(scene, "tent awning", tent),
            model(scene, "short awning", short_awning),
        ];
        let counter = model(scene, "counter", counter);
        let cloths: [u32; 7] = from_fn(|i| m.awnings.get(i).copied().unwrap_or(m.canvas));
        let frames = [lean_frame, tent_frame, lean_frame];
        let table = model(scene, "table", table);
        let shelf = model(scene, "shelf", shelf);
        Self {
            stalls: from_fn(|shape| {
                from_fn(|cloth| {
                    let parts = [
                        (frames[shape], m.timber),
                        (awnings[shape], cloths[cloth]),
                        (counter, m.wood),
                    ];
                    Thing::new("stall", "stalls", &parts)
                })
            }),
            table: Thing::new("table", "stalls", &[(table, m.wood)]),
            shelf: Thing::new("shelf", "stalls", &[(shelf, m.timber)]),
        }
    }
}

/// Four posts, beams along and across, braces at the front.
fn frame(b: &mut MeshBuilder, front: f32, back: f32) {
    b.along_grain();
    let (x, z) = (0.5 * WIDTH_M - 0.06, 0.5 * DEPTH_M - 0.06);
    let post = Vec3::new(0.05, 0.0, 0.05);
    for (px, pz, top) in [(-x, z, front), (x, z, front), (-x, -z, back), (x, -z, back)] {
        let foot = Vec3::new(px, 0.0, pz);
        b.bevel_box(foot - post, foot + post + Vec3::Y * top, 0.012);
    }
    for (pz, top) in [(z, front), (-z, back)] {
        b.bevel_box(
            Vec3::new(-x - 0.2, top - 0.1, pz - 0.04),
            Vec3::new(x + 0.2, top, pz + 0.04),
            0.012,
        );
    }
    for s in [-x, x] {
        b.tube(
            &[Vec3::new(s, front - 0.05, z), Vec3::new(s, back - 0.05, -z)],
            0.04,
            6,
        );
        let inwards = s - s.signum() * 0.45;
        b.tube(
            &[
                Vec3::new(s, front - 0.5, z),
                Vec3::new(inwards, front - 0.06, z),
            ],
            0.03,
            6,
        );
    }
}

/// A parabola that is 0 at both ends of [0, 1] and 1 in the middle.
fn bow(t: f32) -> f32 {
    4.0 * t * (1.0 - t)
}

/// A scalloped strip hanging from `edge(s)`, facing +z for an edge that runs along +x.
fn valance(b: &mut MeshBuilder, scallops: u32, depth: f32, edge: impl Fn(f32) -> Vec3 + Copy) {
    let columns = scallops * 4;
    b.sheet(
        columns,
        1,
        |s, t| {
            let lobe = (s * scallops as f32).rem_euclid(1.0);
            let length = depth * (0.55 + 0.45 * bow(lobe));
            edge(s) - Vec3::Y * (1.0 - t) * length + Vec3::Z * 0.02 * (1.0 - t)
        },
        |s, t| Vec2::new(s * edge(0.0).distance(edge(1.0)), (1.0 - t) * depth),
    );
}

/// From the high back to an overhanging front, sagging between the posts.
fn lean_to(b: &mut MeshBuilder) {
    let x = 0.5 * WIDTH_M + 0.12;
    let (z0, z1) = (0.5 * DEPTH_M + 0.55, -0.5 * DEPTH_M - 0.1);
    let point = move |s: f32, t: f32| {
        let fall = (BACK_M - FRONT_M + 0.22) * t;
        let sag = 0.10 * bow(t) * (0.5 + 0.5 * bow(s)) + 0.05 * bow(s) * (1.0 - t);
        Vec3::new(
            x * (2.0 * s - 1.0),
            FRONT_M - 0.13 + fall - sag,
            z0 + (z1 - z0) * t,
        )
    };
    b.sheet(10, 8, point, |s, t| Vec2::new(2.0 * x * s, 2.6 * (1.0 - t)));
    valance(b, 9, 0.26, move |s| point(s, 0.0));
}

/// Two slopes from a ridge along x.
fn tent(b: &mut MeshBuilder) {
    let x = 0.5 * WIDTH_M + 0.15;
    let z0 = 0.5 * DEPTH_M + 0.35;
    let point = move |s: f32, t: f32| {
        let up = 1.0 - (2.0 * t - 1.0).abs();
        let sag = 0.09 * bow(up) * (0.4 + 0.6 * bow(s)) + 0.05 * bow(s);
        Vec3::new(
            x * (2.0 * s - 1.0),
            2.28 + 0.88 * up - sag,
            z0 * (1.0 - 2.0 * t),
        )
    };
    for half in [0.0, 0.5] {
        b.sheet(
            10,
            6,
            // A hair's breadth off the ridge, where the slope has no direction.
            move |s, t| point(s, (half + 0.5 * t).clamp(half + 1e-3, half + 0.499)),
            move |s, t| {
                let t = half + 0.5 * t;
                Vec2::new(2.0 * x * s, 3.0 * (1.0 - t))
            },
        );
    }
    valance(b, 9, 0.24, move |s| point(s, 0.0));
    b.at(crate::trig::yaw(0.5));
    valance(b, 9, 0.24, move |s| point(s, 0.0));
}

/// A flat awning with deep folds between three poles.
fn short_awning(b: &mut MeshBuilder) {
    let x = 0.5 * WIDTH_M + 0.05;
    let (z0, z1) = (0.5 * DEPTH_M + 0.25, -0.5 * DEPTH_M);
    let point = move |s: f32, t: f32| {
        let fold = bow((s * 2.0).rem_euclid(1.0));
        let fall = (BACK_M - FRONT_M + 0.06) * t;
        Vec3::new(
            x * (2.0 * s - 1.0),
            FRONT_M + 0.04 + fall - 0.24 * fold * bow(0.15 + 0.7 * t),
            z0 + (z1 - z0) * t,
        )
    };
    b.sheet(16, 6, point, |s, t| Vec2::new(2.0 * x * s, 2.2 * (1.0 - t)));
    valance(b, 6, 0.30, move |s| point(s, 0.0));
}

/// A counter of planks on a boarded front.
fn counter(b: &mut MeshBuilder) {
    b.along_grain();
    let (z0, z1) = (0.12, 0.5 * DEPTH_M - 0.02);
    for i in 0..4u8 {
        let w = (z1 - z0) / 4.0;
        let z = z0 + w * f32::from(i);
        b.bevel_box(
            Vec3::new(-1.36, COUNTER_M - 0.045, z),
            Vec3::new(1.36, COUNTER_M, z + w - 0.006),
            0.008,
        );
    }
    for i in 0..9u8 {
        let x = -1.32 + 0.294 * f32::from(i);
        b.bevel_box(
            Vec3::new(x, 0.05, z1 - 0.09),
            Vec3::new(x + 0.288, COUNTER_M - 0.045, z1 - 0.06),
            0.006,
        );
    }
    for x in [-1.30, 1.22] {
        b.block(
            Vec3::new(x, 0.0, z0 + 0.02),
            Vec3::new(x + 0.08, COUNTER_M - 0.045, z1 - 0.1),
        );
    }
}

/// A low table, 1.6 by 0.8 m.
fn table(b: &mut MeshBuilder) {
    b.along_grain();
    b.bevel_box(Vec3::new(-0.8, 0.66, -0.4), Vec3::new(0.8, 0.71, 0.4), 0.01);
    for (x, z) in [(-0.7, -0.32), (0.7, -0.32), (-0.7, 0.32), (0.7, 0.32)] {
        b.bevel_box(
            Vec3::new(x - 0.04, 0.0, z - 0.04),
            Vec3::new(x + 0.04, 0.66, z + 0.04),
            0.01,
        );
    }
}

/// Three boards between two sides, 1.8 m wide, for standing at a wall.
fn shelf(b: &mut MeshBuilder) {
    b.along_grain();
    for x in [-0.9, 0.86] {
        b.bevel_box(
            Vec3::new(x, 0.0, -0.2),
            Vec3::new(x + 0.04, 1.7, 0.2),
            0.008,
        );
    }
    for y in [0.35, 0.95, 1.55] {
        b.bevel_box(
            Vec3::new(-0.86, y, -0.19),
            Vec3::new(0.86, y + 0.035, 0.19),
            0.008,
        );
    }
}
