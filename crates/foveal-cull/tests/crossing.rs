//! Occluders whose box crosses the near plane: drawn in their place in the order, and not at all
//! where they are hidden.
#![allow(clippy::unwrap_used, reason = "tests")]

use foveal_cull::{
    BakeOptions, CullStats, Culler, FrameOptions, InstructionSet, OccluderMesh, OccluderSet,
    SingleThread, View,
};
use glam::{DAffine3, DVec3, Vec3};
use std::sync::Arc;

/// One quad, counter-clockwise from the front.
fn quad(corners: [Vec3; 4]) -> Arc<OccluderMesh> {
    Arc::new(OccluderMesh::bake(&corners, &[0, 1, 2, 0, 2, 3], BakeOptions::default()).unwrap())
}

/// A floor 1.7 m below the eye, which goes on behind it.
fn floor() -> Arc<OccluderMesh> {
    quad([
        Vec3::new(-30.0, -1.7, 20.0),
        Vec3::new(30.0, -1.7, 20.0),
        Vec3::new(30.0, -1.7, -60.0),
        Vec3::new(-30.0, -1.7, -60.0),
    ])
}

/// A wall across the whole view.
fn wall(distance: f32) -> Arc<OccluderMesh> {
    let (size, z) = (4.0 * distance, -distance);
    quad([
        Vec3::new(-size, -size, z),
        Vec3::new(size, -size, z),
        Vec3::new(size, size, z),
        Vec3::new(-size, size, z),
    ])
}

/// What is drawn from the origin, looking along -z with 60 degrees in height, and how many pixels
/// are covered.
fn drawn(
    meshes: &[Arc<OccluderMesh>],
    instruction_set: InstructionSet,
) -> (CullStats, usize, Vec<f32>) {
    let mut set = OccluderSet::new();
    for mesh in meshes {
        set.add(Arc::clone(mesh), DAffine3::IDENTITY).unwrap();
    }
    let view = View::perspective(
        DVec3::ZERO,
        -DVec3::Z,
        DVec3::Y,
        60_f64.to_radians(),
        1.0,
        0.05,
    );
    let mut culler = Culler::new(128, 128).unwrap();
    culler.set_instruction_set(instruction_set);
    culler
        .rasterize(&view, &set, &FrameOptions::default(), &SingleThread)
        .unwrap();
    let mut depth = vec![0.0; 128 * 128];
    culler.read_depth(&mut depth).unwrap();
    let covered = depth.iter().filter(|d| **d > 0.0).count();
    (culler.stats(), covered, depth)
}

#[test]
fn a_floor_under_the_eye_is_hidden_by_a_wall_before_what_is_seen_of_it() {
    // 1.7 m below, the view's lower edge meets the floor after 2.94 m.
    for (distance, clusters) in [(2.0, 1), (2.9, 1), (3.0, 2), (20.0, 2)] {
        for meshes in [[wall(distance), floor()], [floor(), wall(distance)]] {
            let (stats, covered, _) = drawn(&meshes, InstructionSet::detect());
            assert_eq!(stats.clusters_rasterized, clusters, "wall at {distance} m");
            assert_eq!(covered, 128 * 128, "wall at {distance} m");
        }
    }
}

#[test]
fn a_floor_that_is_seen_is_drawn_wholly() {
    let (stats, covered, depth) = drawn(&[floor()], InstructionSet::detect());
    assert_eq!(stats.clusters_rasterized, 1);
    // To 60 m away: 1.7 / 60 of the way from the centre down to tan 30 degrees.
    let rows = 64.0 * (1.0 - 1.7 / 60.0 / 30_f64.to_radians().tan());
    let expected = rows.floor() as usize * 128;
    assert!(
        (expected - 128..=expected).contains(&covered),
        "{covered} {expected}"
    );
    for instruction_set in InstructionSet::available() {
        assert!(drawn(&[floor()], instruction_set).2 == depth);
    }
}

#[test]
fn what_is_behind_the_eye_or_beside_the_view_is_not_drawn() {
    // The box around it crosses the plane of the near rectangle, beside the view.
    let beside = quad([
        Vec3::new(2.0, -1.0, 1.0),
        Vec3::new(2.0, -1.0, -1.5),
        Vec3::new(2.1, 1.0, -1.5),
        Vec3::new(2.1, 1.0, 1.0),
    ]);
    let (stats, covered, _) = drawn(&[beside], InstructionSet::detect());
    assert_eq!((stats.clusters_rasterized, covered), (0, 0));
}
