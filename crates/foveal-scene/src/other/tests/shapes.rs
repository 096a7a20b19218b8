//! Polygons, strips and points.

use glam::Vec3;

use super::load;
use crate::Scene;

/// The sum of the areas of all triangles.
fn area(scene: &Scene) -> f32 {
    let mesh = &scene.meshes[0];
    let at = |i: u32| Vec3::from(mesh.vertices[i as usize].position);
    let triangles = mesh.indices.as_chunks::<3>().0.iter();
    let areas = triangles.map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)).length() / 2.0);
    areas.sum()
}

#[test]
fn a_polygon_that_is_not_convex_is_not_filled_beyond_its_edges() {
    // The letter V: a fan from its first corner would cover the gap as well.
    let obj = "v 3 4 0\nv 2 1 0\nv 1 4 0\nv 2 0 0\nf 1 2 3 4\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
               property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
               3 4 0\n2 1 0\n1 4 0\n2 0 0\n4 0 1 2 3\n";
    for (name, text) in [("a.obj", obj), ("a.ply", ply)] {
        let scene = load(name, text.as_bytes(), &[]).unwrap();
        assert_eq!((scene.triangle_count(), area(&scene)), (2, 1.0), "{name}");
    }
}

#[test]
fn vertices_alone_are_points() {
    let text = "mtllib none.mtl\no scan\nv 0 0 0 1 0 0\nv 1 2 3 0 0 1\nvn 0 0 1\n";
    let scene = load("a.obj", text.as_bytes(), &[]).unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!((&mesh.points[..], scene.point_count()), (&[0, 1][..], 2));
    assert_eq!(scene.bounds().max.to_array(), [1.0, 2.0, 3.0]);
    assert_eq!(mesh.vertices[1].color, [0, 0, u16::MAX, u16::MAX]);
    // What names vertices that are not there is no cloud of points.
    let text = "v 0 0 0\nv 1 2 3\nf 1 2 9\n";
    let scene = load("a.obj", text.as_bytes(), &[]).unwrap();
    assert_eq!(scene.point_count(), 0);
}
