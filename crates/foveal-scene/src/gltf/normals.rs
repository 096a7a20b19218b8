//! Normals where the file gives none.

use glam::Vec3;

use crate::Vertex;

/// Unit normal of a triangle's plane; up for one without area.
pub(crate) fn plane_normal(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> [f32; 3] {
    let [a, b, c] = [a, b, c].map(Vec3::from);
    (b - a)
        .cross(c - a)
        .try_normalize()
        .unwrap_or(Vec3::Y)
        .to_array()
}

/// Gives each corner a vertex of its own, in corner order, and returns each one's former vertex.
pub(crate) fn unweld(vertices: &mut Vec<Vertex>, indices: &mut [u32]) -> Vec<u32> {
    let source = indices.to_vec();
    *vertices = source.iter().map(|&i| vertices[i as usize]).collect();
    for (i, index) in indices.iter_mut().enumerate() {
        *index = i as u32;
    }
    source
}

/// Normals of the planes, for unwelded vertices.
pub(crate) fn flat(vertices: &mut [Vertex]) {
    for triangle in vertices.chunks_exact_mut(3) {
        let normal = plane_normal(
            triangle[0].position,
            triangle[1].position,
            triangle[2].position,
        );
        triangle.iter_mut().for_each(|v| v.normal = normal);
    }
}

/// Area-weighted means at shared vertices, for those that `replace` names.
pub(crate) fn smooth(vertices: &mut [Vertex], indices: &[u32], replace: impl Fn(usize) -> bool) {
    let mut sums = vec![Vec3::ZERO; vertices.len()];
    for t in indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| Vec3::from(vertices[i as usize].position));
        let normal = (b - a).cross(c - a);
        t.iter().for_each(|&i| sums[i as usize] += normal);
    }
    for (i, (vertex, sum)) in vertices.iter_mut().zip(sums).enumerate() {
        if replace(i) {
            vertex.normal = sum.try_normalize().unwrap_or(Vec3::Y).to_array();
        }
    }
}
