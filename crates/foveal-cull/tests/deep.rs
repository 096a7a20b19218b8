//! Surfaces over many depths that cross each other.
#![allow(clippy::unwrap_used, reason = "tests")]

use foveal_cull::*;
use glam::{DAffine3, DVec3, Vec3};
use std::sync::Arc;

const SIZE: u32 = 64;
const NEAR: f32 = 0.1;
/// Sides of the surfaces as they would be at 1 m; beyond the screen.
const SIDE: f32 = 0.7;

/// Distances of a surface at its left and its right side.
type Ends = [f32; 2];

/// Near / distance of a surface at `x` (at 1 m). It is a straight line on the screen.
fn depth(ends: Ends, x: f32) -> f32 {
    let t = (x + SIDE) / (2.0 * SIDE);
    NEAR * ((1.0 - t) / ends[0] + t / ends[1])
}

/// A point of the screen from a place along the slope and one across it, and whether this turns
/// triangles over.
type Turn = (fn(f32, f32) -> (f32, f32), bool);

/// Directions in which depth grows: to the right, the left, up, down.
const TURNS: [Turn; 4] = [
    (|s, t| (s, t), false),
    (|s, t| (-s, t), true),
    (|s, t| (t, s), true),
    (|s, t| (-t, -s), true),
];

/// A surface in two parts, one beside the other, which meet within a row of blocks.
fn surface(ends: Ends, (turn, over): Turn) -> OccluderMesh {
    let point = |s: f32, t: f32| {
        let (x, y) = turn(s, t);
        Vec3::new(x, y, -1.0) * ends[usize::from(s > 0.0)]
    };
    let positions: Vec<Vec3> = [(-SIDE, 0.05), (0.05, SIDE)]
        .into_iter()
        .flat_map(|(y0, y1)| [(-SIDE, y0), (SIDE, y0), (SIDE, y1), (-SIDE, y1)])
        .map(|(x, y)| point(x, y))
        .collect();
    let mut indices = [0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7];
    if over {
        indices.reverse();
    }
    OccluderMesh::bake(&positions, &indices, BakeOptions::default()).unwrap()
}

#[test]
fn every_pixel_has_the_nearer_of_two_deep_surfaces() {
    for turn in TURNS {
        check(turn);
    }
}

fn check(turn: Turn) {
    // The one that begins nearer is drawn first.
    let surfaces: [Ends; 2] = [[5.0, 50.0], [60.0, 6.0]];
    let mut occluders = OccluderSet::new();
    for ends in surfaces {
        let mesh = Arc::new(surface(ends, turn));
        occluders.add(mesh, DAffine3::IDENTITY).unwrap();
    }
    let view = View::perspective(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 1.0, 1.0, NEAR.into());
    let half = 0.5f32.tan();
    for set in InstructionSet::available() {
        let mut culler = Culler::new(SIZE, SIZE).unwrap();
        culler.set_instruction_set(set);
        let options = FrameOptions::default();
        culler
            .rasterize(&view, &occluders, &options, &SingleThread)
            .unwrap();
        let mut found = vec![0.0; (SIZE * SIZE) as usize];
        culler.read_depth(&mut found).unwrap();
        for (i, &found) in (0..SIZE * SIZE).zip(&found) {
            let place = |i: u32| ((i as f32 + 0.5) * 2.0 / SIZE as f32 - 1.0) * half;
            // Each turn is its own inverse.
            let (x, _) = turn.0(place(i % SIZE), -place(i / SIZE));
            let pixel = 2.0 * half / SIZE as f32;
            let at = |x: f32| {
                surfaces
                    .map(|ends| depth(ends, x))
                    .into_iter()
                    .reduce(f32::max)
            };
            let here = at(x).unwrap();
            // Depths hold for whole pixels, and are rounded away from the eye.
            let least = surfaces
                .map(|ends| depth(ends, x - pixel).min(depth(ends, x + pixel)))
                .into_iter()
                .fold(0.0, f32::max);
            assert!(
                (least * 0.999..=here * 1.0001).contains(&found),
                "{set:?}, pixel {i}: {found}, expected {least} to {here}"
            );
        }
    }
}
