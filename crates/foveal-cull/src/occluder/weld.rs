//! Welding: positions that are bit-equal become one vertex, so that neighbours are found however a
//! mesh was exported.

use super::word_hash::{WordHash, Words3};
use glam::Vec3;
use std::collections::HashMap;

/// Points, and triangles that index them.
pub(crate) struct Welded {
    /// All points that any triangle has, degenerate ones too.
    pub(crate) points: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// No number yet.
const NONE: u32 = u32::MAX;

/// `None` if a position in use is not finite.
pub(crate) fn weld(positions: &[Vec3], indices: &[u32]) -> Option<Welded> {
    let most = positions.len().min(indices.len());
    let mut unique: HashMap<Words3, u32, WordHash> =
        HashMap::with_capacity_and_hasher(most, WordHash::default());
    let mut numbers = vec![NONE; positions.len()];
    let mut points = Vec::new();
    let mut renumber = |i: u32| {
        let number = &mut numbers[i as usize];
        if *number == NONE {
            // + 0.0 makes -0.0 and 0.0 the same point.
            let p = positions[i as usize] + Vec3::ZERO;
            if !p.is_finite() {
                return None;
            }
            let key = Words3(p.to_array().map(f32::to_bits));
            *number = *unique.entry(key).or_insert_with(|| {
                points.push(p);
                (points.len() - 1) as u32
            });
        }
        Some(*number)
    };
    let mut triangles = Vec::with_capacity(indices.len() / 3);
    for t in indices.chunks_exact(3) {
        triangles.push([renumber(t[0])?, renumber(t[1])?, renumber(t[2])?]);
    }
    triangles.retain(|&[a, b, c]| {
        let [p, q, r] = [a, b, c].map(|i| points[i as usize].as_dvec3());
        (q - p).cross(r - p).length_squared() > 0.0
    });
    Some(Welded { points, triangles })
}
