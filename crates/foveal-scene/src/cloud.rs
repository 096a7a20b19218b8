//! Exact world-space boxes of transformed meshes.
//!
//! A [`Cloud`] holds the positions that a mesh's triangles, lines and points use, in blocks with boxes of their own.
//! A block whose transformed box lies within what has been found already cannot widen the result
//! and is skipped, so the answer is bit for bit that of transforming every point.

use glam::{Mat4, Vec3, Vec3A};

use crate::{Aabb, Mesh};

/// Points per block: one block's test costs about as much as two points.
const BLOCK: usize = 32;
/// Below this many points blocks do not pay.
const SMALL: usize = 128;

/// The distinct positions of a mesh that bound it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cloud {
    points: Vec<Vec3A>,
    /// Centre and half extent of each block of points; empty for small clouds.
    blocks: Vec<(Vec3A, Vec3A)>,
}

impl Cloud {
    /// The positions that `mesh`'s indices name. For many `uses` more is spent here so that each
    /// call of [`Cloud::bounds`] is faster; the thresholds are where that begins to pay.
    pub(crate) fn of(mesh: &Mesh, uses: u64) -> Self {
        let mut used = vec![false; mesh.vertices.len()];
        for i in mesh.used() {
            if let Some(used) = used.get_mut(i as usize) {
                *used = true;
            }
        }
        let points = mesh
            .vertices
            .iter()
            .zip(&used)
            .filter(|(_, used)| **used)
            .map(|(v, _)| v.position);
        if uses > 64 {
            // Hard edges and UV seams repeat positions several times over.
            let mut distinct: Vec<[u32; 3]> = points.map(|p| p.map(f32::to_bits)).collect();
            distinct.sort_unstable();
            distinct.dedup();
            let points = distinct
                .into_iter()
                .map(|bits| Vec3A::from_array(bits.map(f32::from_bits)));
            Self::of_points(points.collect())
        } else if uses > 3 {
            Self::of_points(points.map(Vec3A::from_array).collect())
        } else {
            Self {
                points: points.map(Vec3A::from_array).collect(),
                blocks: Vec::new(),
            }
        }
    }

    fn of_points(points: Vec<Vec3A>) -> Self {
        let blocks = if points.len() < SMALL {
            Vec::new()
        } else {
            points
                .chunks(BLOCK)
                .map(|block| {
                    let (min, max) = block
                        .iter()
                        .fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(min, max), &p| {
                            (min.min(p), max.max(p))
                        });
                    // Halved first: the sum of two large numbers may overflow.
                    let center = min * 0.5 + max * 0.5;
                    (center, (max - center).max(center - min))
                })
                .collect()
        };
        Self { points, blocks }
    }

    /// The smallest box around the transformed points.
    pub(crate) fn bounds(&self, to_from: Mat4) -> Aabb {
        let mut min = Vec3A::INFINITY;
        let mut max = Vec3A::NEG_INFINITY;
        let widen = |points: &[Vec3A], min: &mut Vec3A, max: &mut Vec3A| {
            for &p in points {
                let p = to_from.transform_point3a(p);
                *min = min.min(p);
                *max = max.max(p);
            }
        };
        if self.blocks.is_empty() {
            widen(&self.points, &mut min, &mut max);
        } else {
            let columns =
                [to_from.x_axis, to_from.y_axis, to_from.z_axis].map(|c| Vec3A::from_vec4(c).abs());
            let absolute = |v: Vec3A| columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
            let offset = Vec3A::from_vec4(to_from.w_axis).abs();
            for (points, &(center, half)) in self.points.chunks(BLOCK).zip(&self.blocks) {
                let at = to_from.transform_point3a(center);
                let reach = absolute(half);
                // More than the rounding of this sum and of the points' own transforms.
                let slack = (absolute(center.abs() + half) + offset) * 4e-6;
                let inside = (at - reach - slack).cmpge(min) & (at + reach + slack).cmple(max);
                if !inside.all() {
                    widen(points, &mut min, &mut max);
                }
            }
        }
        Aabb {
            min: Vec3::from(min),
            max: Vec3::from(max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vertex;
    use bytemuck::Zeroable;
    use proptest::prelude::*;

    fn mesh(points: &[[f32; 3]]) -> Mesh {
        let vertex = |&position| Vertex {
            position,
            ..Vertex::zeroed()
        };
        // The last vertex is never used.
        let used = points.len() as u32 - 1;
        Mesh {
            vertices: points.iter().map(vertex).collect(),
            indices: (0..used)
                .chain([0, 0, 0])
                .take((used as usize / 3 + 1) * 3)
                .collect(),
            ..Mesh::default()
        }
    }

    proptest! {
        #[test]
        fn boxes_equal_those_of_every_used_point_bit_for_bit(
            points in prop::collection::vec(prop::array::uniform3(-100f32..100.0), 2..600),
            matrix in prop::array::uniform12(-3f32..3.0),
            offset in -1e4f32..1e4,
        ) {
            let m = matrix;
            let to_from = Mat4::from_cols_array_2d(&[
                [m[0], m[1], m[2], 0.0],
                [m[3], m[4], m[5], 0.0],
                [m[6], m[7], m[8], 0.0],
                [m[9] + offset, m[10], m[11], 1.0],
            ]);
            let mesh = mesh(&points);
            let brute = Aabb::of_points(
                mesh.indices.iter().map(|&i| {
                    to_from.transform_point3(Vec3::from(mesh.vertices[i as usize].position))
                }),
            );
            for uses in [1, 10, 100] {
                prop_assert_eq!(Cloud::of(&mesh, uses).bounds(to_from), brute);
            }
        }
    }
}
