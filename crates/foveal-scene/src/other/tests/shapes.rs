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

/// Four corners of a square, with these properties and elements more.
fn square(properties: &str, values: &str, elements: &str, lists: &str) -> Scene {
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n{properties}\
         {elements}end_header\n0 0 {values}\n1 0 {values}\n0 1 {values}\n1 1 {values}\n{lists}\n"
    );
    load("a.ply", text.as_bytes(), &[]).unwrap()
}

#[test]
fn strips_are_triangles_of_one_side() {
    for kind in ["int", "char", "short"] {
        let element = format!("element tristrips 1\nproperty list int {kind} vertex_indices\n");
        let scene = square("", "", &element, "16 0 1 2 3 -1 2 1 3 3 0 -1 0 1 9 -1 0");
        assert_eq!(scene.triangle_count(), 3);
        let vertices = &scene.meshes[0].vertices;
        assert!(
            vertices.iter().all(|v| v.normal == [0.0, 0.0, 1.0]),
            "{vertices:?}"
        );
        let told: Vec<&str> = scene.warnings.iter().map(|w| w.text.as_str()).collect();
        let sentence =
            "1 of 4 triangles of strips name vertices that do not exist, and are left out";
        assert_eq!(told, [sentence]);
    }
}

#[test]
fn colours_of_vertices_have_two_names_and_those_of_faces_are_told() {
    let face = "element face 1\nproperty list uchar int vertex_indices\n";
    for prefix in ["", "diffuse_"] {
        let colors = ["red", "green", "blue"].map(|c| format!("property uchar {prefix}{c}\n"));
        let scene = square(&colors.concat(), "255 0 0", face, "4 0 1 3 2");
        assert_eq!(
            scene.meshes[0].vertices[0].color,
            [u16::MAX, 0, 0, u16::MAX]
        );
        assert_eq!(scene.warnings, []);
    }
    let scene = square(
        "",
        "",
        &format!("{face}property uchar red\n"),
        "4 0 1 3 2 255",
    );
    let sentence = "has colours of faces, which are not read; those of vertices are";
    assert_eq!(scene.warnings[0].text, sentence);
}
