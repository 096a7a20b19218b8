//! Culling without a renderer: a street of houses, and which of the things in it can be seen.
//!
//! `cargo run --release -p foveal-cull --example cull_only`
#![allow(clippy::print_stdout, reason = "the table is what the example is for")]

use foveal_cull::{
    Aabb, Affine, CullError, Culler, FrameOptions, OccludeeTree, OccluderMesh, OccluderSet,
    SingleThread, View, Visibility,
};
use std::sync::Arc;

fn main() -> Result<(), CullError> {
    // One mesh, placed many times.
    let house = OccluderMesh::from_box(Aabb::new([-4.0, 0.0, -3.0], [4.0, 6.0, 3.0]))?;
    let house = Arc::new(house);
    let mut occluders = OccluderSet::new();
    let mut things = Vec::new();
    for row in 0..20 {
        for column in 0..20 {
            let (x, z) = (column as f32 * 11.0 - 105.0, -10.0 - row as f32 * 10.0);
            let place = Affine::from_translation([x, 0.0, z].map(f64::from));
            occluders.add(Arc::clone(&house), place)?;
            // A cart behind every house, and one on the street.
            for side in [-4.5, 5.5] {
                let [x, y, z] = [x + side, 0.5, z - 4.5];
                let (min, max) = ([x - 0.5, y - 0.5, z - 0.5], [x + 0.5, y + 0.5, z + 0.5]);
                things.push(Aabb::new(min, max));
            }
        }
    }
    let tree = OccludeeTree::build(&things, [0.0; 3]);

    let view = View::perspective(
        [0.0, 1.7, 0.0],
        [0.0, 1.5, -10.0],
        [0.0, 1.0, 0.0],
        1.0,
        16.0 / 9.0,
        0.1,
    )
    .for_picture(1920, 1080);
    let mut culler = Culler::for_picture(1920, 1080)?;
    culler.rasterize(&view, &occluders, &FrameOptions::default(), &SingleThread)?;
    let mut results = vec![Visibility::Visible; things.len()];
    culler.query_tree(&tree, &mut results)?;
    culler.count(&results, None)?;

    let s = culler.stats();
    println!(
        "occluders  {:6} models, {:6} drawn, {:6} triangles drawn",
        s.occluder_models, s.occluder_models_rasterized, s.occluder_triangles_rasterized
    );
    println!(
        "things     {:6}, outside {:6}, hidden {:6}, visible {:6}",
        s.occludees, s.occludees_outside, s.occludees_occluded, s.occludees_visible
    );
    Ok(())
}
