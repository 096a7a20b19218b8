//! Pixels that several surfaces share.
#![allow(clippy::unwrap_used, reason = "tests")]

use foveal_cull::*;
use glam::{DAffine3, DVec3, Vec3};
use std::sync::Arc;

/// An upright rectangle at a distance, from `x0` to `x1` as they would be at 1 m.
fn quad(distance: f32, x0: f32, x1: f32) -> [Vec3; 4] {
    [(x0, -1.0), (x1, -1.0), (x1, 1.0), (x0, 1.0)].map(|(x, y)| Vec3::new(x, y, -1.0) * distance)
}

/// Depth of every pixel of the central row.
fn depths(quads: &[[Vec3; 4]], set: InstructionSet) -> Vec<f32> {
    let positions = quads.concat();
    let indices: Vec<u32> = (0..quads.len() as u32)
        .flat_map(|q| [0, 1, 2, 0, 2, 3].map(|i| 4 * q + i))
        .collect();
    let mesh = OccluderMesh::bake(&positions, &indices, BakeOptions::default()).unwrap();
    let mut occluders = OccluderSet::new();
    occluders.add(Arc::new(mesh), DAffine3::IDENTITY).unwrap();
    let mut culler = Culler::new(8, 8).unwrap();
    culler.set_instruction_set(set);
    let view = View::perspective(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 1.0, 1.0, 0.1);
    let options = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    culler
        .rasterize(&view, &occluders, &options, &SingleThread)
        .unwrap();
    let mut depth = vec![0.0; 64];
    culler.read_depth(&mut depth).unwrap();
    depth[32..40].to_vec()
}

#[test]
fn near_parts_of_a_pixel_complete_each_other_whatever_lies_far_behind_and_comes_between() {
    // Pixel 4 is 0.137 wide at 1 m. The near parts meet within it, and the far one ends within it.
    let parts = [
        quad(1.0, -1.0, 0.06),
        quad(1.0, 0.06, 1.0),
        quad(10.0, -1.0, 0.11),
    ];
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        for set in InstructionSet::available() {
            let depth = depths(&order.map(|i| parts[i]), set);
            assert!(
                depth.iter().all(|d| (0.099..=0.1001).contains(d)),
                "{order:?}: {depth:?}"
            );
        }
    }
}

#[test]
fn what_completes_a_pixel_from_far_behind_says_how_far_it_is() {
    // Half of pixel 4 is near, and what is far covers the other half and some of the first.
    let parts = [quad(1.0, -1.0, 0.06), quad(10.0, 0.03, 1.0)];
    for order in [[0, 1], [1, 0]] {
        let depth = depths(&order.map(|i| parts[i]), InstructionSet::detect());
        assert!(
            (0.0099..=0.01001).contains(&depth[4]),
            "{order:?}: {depth:?}"
        );
        assert!(
            depth[..4].iter().all(|d| *d > 0.099),
            "{order:?}: {depth:?}"
        );
    }
}
