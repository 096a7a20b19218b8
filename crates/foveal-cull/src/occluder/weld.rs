//! Welding: positions that are bit-equal become one vertex, so that neighbours are found however a
//! mesh was exported.

use glam::Vec3;
use std::collections::HashMap;

/// Points, and triangles that index them.
pub(crate) struct Welded {
    pub(crate) points: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

pub(crate) fn weld(positions: &[Vec3], indices: &[u32]) -> Welded {
    let mut unique: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    let mut points = Vec::new();
    let mut renumber = |i: u32| {
        // + 0.0 makes -0.0 and 0.0 the same point.
        let p = positions[i as usize] + Vec3::ZERO;
        *unique
            .entry(p.to_array().map(f32::to_bits))
            .or_insert_with(|| {
                points.push(p);
                (points.len() - 1) as u32
            })
    };
    let mut triangles = Vec::with_capacity(indices.len() / 3);
    for t in indices.chunks_exact(3) {
        triangles.push([renumber(t[0]), renumber(t[1]), renumber(t[2])]);
    }
    triangles.retain(|&[a, b, c]| {
        let [p, q, r] = [a, b, c].map(|i| points[i as usize].as_dvec3());
        (q - p).cross(r - p).length_squared() > 0.0
    });
    Welded { points, triangles }
}
