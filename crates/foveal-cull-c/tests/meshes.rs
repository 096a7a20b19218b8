//! What C may ask of a mesh that is baked.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

use core::ptr::null_mut;
use foveal_cull_c::*;

/// A cube of 8 x 8 quads on each side, 768 triangles that face outwards. Each side has its own
/// corners.
fn cube() -> (Vec<[f32; 3]>, Vec<u32>) {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for side in 0..6 {
        let (axis, far) = (side / 2, side % 2);
        let first = positions.len() as u32;
        for i in 0..81 {
            let mut point = [0.0; 3];
            point[axis] = far as f32;
            point[(axis + 1) % 3] = (i % 9) as f32 / 8.0;
            point[(axis + 2) % 3] = (i / 9) as f32 / 8.0;
            positions.push(point);
        }
        for quad in 0..64 {
            let a = first + quad / 8 * 9 + quad % 8;
            let [b, c] = if far == 1 { [1, 9] } else { [9, 1] };
            indices.extend([a, a + b, a + 10, a, a + 10, a + c]);
        }
    }
    (positions, indices)
}

#[test]
fn a_closed_mesh_becomes_boxes_where_that_is_asked_for() {
    let (positions, indices) = cube();
    // SAFETY: live handles, structs as long as they say, lists as long as is said.
    let triangles = |inner_shape: u32, two_sided: u32| unsafe {
        let mut source = core::mem::zeroed::<FovealCullMeshSource>();
        let size = size_of::<FovealCullMeshSource>();
        let made = foveal_cull_mesh_source_init_sized(&mut source, size);
        assert_eq!(made, FovealCullStatus::Ok);
        assert_eq!(source.inner_shape, 0);
        source.positions = positions.as_ptr().cast();
        source.position_count = positions.len();
        source.indices = indices.as_ptr().cast();
        source.index_count = indices.len();
        (source.inner_shape, source.two_sided) = (inner_shape, two_sided);
        let mut mesh = null_mut();
        let baked = foveal_cull_mesh_bake(&source, &mut mesh);
        assert_eq!(baked, FovealCullStatus::Ok);
        let count = foveal_cull_mesh_triangle_count(mesh);
        foveal_cull_mesh_destroy(mesh);
        count
    };
    assert_eq!(triangles(0, 0), 768);
    assert_eq!(triangles(1, 0), 12);
    assert_eq!(triangles(1, 1), 768);
}
