//! Several threads look at clusters in parts, which may begin and end within an occluder.
#![allow(clippy::unwrap_used, reason = "tests")]

use foveal_cull::{
    BakeOptions, CullStats, Culler, Eye, FrameOptions, OccluderMesh, OccluderSet, Projection,
    SingleThread, Threads, View, WorkerThreads,
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

#[test]
fn what_reaches_beyond_the_far_plane_is_drawn_as_by_one_thread() {
    // Strips of a floor that begins behind the eye and ends far behind the far plane.
    let strip = |i: u32| {
        let x = 0.2 * i as f32 - 1.0;
        [
            Vec3::new(x, -1.5, 3.0),
            Vec3::new(x + 0.15, -1.5, 3.0),
            Vec3::new(x + 0.15, -1.5, -80.0),
            Vec3::new(x, -1.5, -80.0),
        ]
    };
    let points: Vec<Vec3> = (0..10).flat_map(strip).collect();
    let indices = (0..10).flat_map(|i| [0, 1, 2, 0, 2, 3].map(|k| 4 * i + k));
    let indices: Vec<u32> = indices.collect();
    let mesh = OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap();
    let mut set = OccluderSet::new();
    set.add(Arc::new(mesh), DAffine3::IDENTITY).unwrap();
    let options = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    for far_m in [2.5, 8.0, 20.0] {
        let lens = Projection::perspective(1.2, 1.0, 0.2, far_m);
        let eye = Eye::look_at(DVec3::ZERO, DVec3::new(0.0, -0.2, -1.0), DVec3::Y, lens);
        let depth = |threads: &dyn Threads| {
            let mut culler = Culler::new(64, 256).unwrap();
            let view = View::mono(eye);
            culler.rasterize(&view, &set, &options, threads).unwrap();
            let mut depth = vec![0.0; 64 * 256];
            culler.read_depth(&mut depth).unwrap();
            depth
        };
        let one = depth(&SingleThread);
        assert!(one.iter().filter(|d| **d > 0.0).count() > 500);
        for threads in [2, 3, 8] {
            assert!(
                depth(&WorkerThreads::new(threads)) == one,
                "{far_m} m, {threads} threads"
            );
        }
    }
}
