//! Windows, shutters, balconies and doors, on a wall at z = 0 facing +z.

use glam::Vec3;

use crate::build::MeshBuilder;
use crate::trig::{shift, yaw};

/// Jambs, lintel and sill around an opening 1.0 by 1.6 m whose foot is at y = 0.
pub(super) fn window_frame(b: &mut MeshBuilder) {
    b.bevel_box(
        Vec3::new(-0.68, -0.14, -0.05),
        Vec3::new(0.68, 0.0, 0.2),
        0.02,
    );
    for x in [-0.57f32, 0.57] {
        b.bevel_box(
            Vec3::new(x - 0.07, 0.0, -0.05),
            Vec3::new(x + 0.07, 1.6, 0.1),
            0.015,
        );
    }
    b.bevel_box(
        Vec3::new(-0.68, 1.6, -0.05),
        Vec3::new(0.68, 1.78, 0.13),
        0.02,
    );
}

/// Two open leaves beside the window, a hand's breadth off the wall at their outer edges.
pub(super) fn shutters(b: &mut MeshBuilder) {
    for (s, open) in [(-1.0f32, -0.030f32), (1.0, 0.045)] {
        b.at(shift(s * 0.66, 0.0, 0.10) * yaw(-s * open.abs()));
        let (a, c) = (0.0, s * 0.54);
        b.bevel_box(
            Vec3::new(f32::min(a, c), -0.02, -0.02),
            Vec3::new(f32::max(a, c), 1.62, 0.02),
            0.008,
        );
        for y in [0.12, 0.78, 1.40] {
            b.block(
                Vec3::new(f32::min(a, c) + 0.03, y, 0.02),
                Vec3::new(f32::max(a, c) - 0.03, y + 0.09, 0.04),
            );
        }
    }
}

/// A slab on two brackets in front of a window; y = 0 is its top.
pub(super) fn balcony_slab(b: &mut MeshBuilder) {
    b.bevel_box(
        Vec3::new(-1.15, -0.14, -0.05),
        Vec3::new(1.15, 0.0, 0.9),
        0.03,
    );
    for x in [-0.85, 0.85] {
        b.bevel_box(
            Vec3::new(x - 0.1, -0.42, -0.05),
            Vec3::new(x + 0.1, -0.14, 0.45),
            0.03,
        );
    }
}

/// The iron rail of a balcony.
pub(super) fn balcony_rail(b: &mut MeshBuilder) {
    let (x, z) = (1.1, 0.85);
    let corners = [(-x, 0.0), (-x, z), (x, z), (x, 0.0)];
    for y in [0.08, 0.95] {
        let rail: Vec<Vec3> = corners.iter().map(|&(x, z)| Vec3::new(x, y, z)).collect();
        for pair in rail.windows(2) {
            b.tube(pair, if y > 0.5 { 0.025 } else { 0.014 }, 6);
        }
    }
    for i in 0..=14u8 {
        let x = 1.1 * (f32::from(i) / 7.0 - 1.0);
        b.tube(&[Vec3::new(x, 0.0, z), Vec3::new(x, 0.95, z)], 0.011, 4);
    }
    for s in [-x, x] {
        for z in [0.2, 0.42, 0.64] {
            b.tube(&[Vec3::new(s, 0.0, z), Vec3::new(s, 0.95, z)], 0.011, 4);
        }
    }
}

/// Planked double door 1.5 m wide, on the wall z = 0.
pub(super) fn door_leaf(b: &mut MeshBuilder) {
    b.along_grain();
    for i in 0..8u8 {
        let x = -0.72 + 0.18 * f32::from(i);
        b.bevel_box(
            Vec3::new(x, 0.02, 0.0),
            Vec3::new(x + 0.175, 2.3, 0.05),
            0.01,
        );
    }
    for y in [0.4, 1.8] {
        b.bevel_box(
            Vec3::new(-0.68, y, 0.05),
            Vec3::new(0.68, y + 0.14, 0.075),
            0.01,
        );
    }
}

/// Stone around the door.
pub(super) fn door_frame(b: &mut MeshBuilder) {
    for x in [-0.85f32, 0.85] {
        b.bevel_box(
            Vec3::new(x - 0.13, 0.0, -0.05),
            Vec3::new(x + 0.13, 2.32, 0.14),
            0.02,
        );
    }
    b.bevel_box(
        Vec3::new(-1.02, 2.32, -0.05),
        Vec3::new(1.02, 2.62, 0.16),
        0.02,
    );
    b.bevel_box(Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.12, 0.4), 0.02);
}
