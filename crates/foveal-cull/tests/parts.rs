//! Several threads look at clusters in parts, which may begin and end within an occluder.
#![allow(clippy::unwrap_used, reason = "tests")]

use foveal_cull::{
    BakeOptions, CullStats, Culler, FrameOptions, OccluderMesh, OccluderSet, SingleThread, Threads,
    View, WorkerThreads,
};
use glam::{DAffine3, DVec3, Vec3};
use std::sync::Arc;

/// A bumpy floor of `n` x `n` quads, 40 m wide.
fn floor(n: u32) -> Arc<OccluderMesh> {
    let points: Vec<Vec3> = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| (i as f32, j as f32)))
        .map(|(i, j)| {
            let step = 40.0 / n as f32;
            let height = (i * 0.31).sin() + (j * 0.23).cos();
            Vec3::new(i * step - 20.0, height, j * step - 20.0)
        })
        .collect();
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let indices: Vec<u32> = (0..n)
        .flat_map(|j| (0..n).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            [a, b, c, a, c, d]
        })
        .collect();
    Arc::new(OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap())
}

fn frame(set: &OccluderSet, threads: &dyn Threads) -> (Vec<f32>, CullStats) {
    let view = View::perspective(
        DVec3::new(3.0, 12.0, 25.0),
        DVec3::new(0.0, -4.0, 0.0),
        DVec3::Y,
        1.2,
        16.0 / 9.0,
        0.1,
    );
    let options = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    let mut culler = Culler::new(320, 180).unwrap();
    culler.rasterize(&view, set, &options, threads).unwrap();
    let mut depth = vec![0.0; 320 * 180];
    culler.read_depth(&mut depth).unwrap();
    // Polygons on a cut between threads are set up on both sides.
    let mut stats = culler.stats();
    stats.polygons_rasterized = 0;
    (depth, stats)
}

#[test]
fn large_occluders_cut_into_parts_are_drawn_as_by_one_thread() {
    let (large, small) = (floor(160), floor(3));
    let place = |y: f64| DAffine3::from_translation(DVec3::new(0.3 * y, y, 0.2 * y));
    let mut set = OccluderSet::new();
    set.add(Arc::clone(&small), place(1.0)).unwrap();
    let gone = set.add(Arc::clone(&large), place(2.0)).unwrap();
    set.add(Arc::clone(&large), place(-1.0)).unwrap();
    set.add(Arc::clone(&small), place(-2.0)).unwrap();
    set.add(Arc::clone(&large), place(-3.0)).unwrap();
    set.add(Arc::clone(&large), place(-4.0)).unwrap();
    set.add(Arc::clone(&small), place(-5.0)).unwrap();
    set.remove(gone).unwrap();
    let (depth, stats) = frame(&set, &SingleThread);
    assert!(depth.iter().filter(|d| **d > 0.0).count() > 20_000);
    assert!(stats.clusters > 8 * 32 * 4, "{stats:?}");
    for threads in [2, 3, 16] {
        let (other, counted) = frame(&set, &WorkerThreads::new(threads));
        assert_eq!(counted, stats, "{threads} threads");
        assert!(other == depth, "{threads} threads");
    }
}
