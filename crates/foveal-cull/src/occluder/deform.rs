//! Other positions for a mesh that stays as it is otherwise.
//!
//! Clusters, quads and adjacency are those of the positions that were baked. What follows from
//! positions is made anew: bounds, cones and fills. A quad need neither stay flat nor convex: every
//! view looks at both.

use super::cluster::Shape;
use super::mesh::{OccluderMesh, hash_words};
use super::vertices::Vertices;
use super::weld::By;
use crate::error::{CullError, Quantity};
use glam::{DVec3, Vec3};

impl OccluderMesh {
    /// Gives a mesh that was baked [`deformable`](crate::BakeOptions::deformable) another shape:
    /// all positions, in mesh space (metres), in the order of those that were baked.
    ///
    /// About 45 nanoseconds per triangle, a tenth of the time of baking. Clusters stay as they were baked:
    /// bake again where a shape becomes so different that triangles that lay together are far
    /// apart, which costs time and hides less, but is never wrong. The shape depends on the
    /// positions alone, and not on those before.
    ///
    /// ```
    /// use foveal_cull::{BakeOptions, OccluderMesh};
    ///
    /// // A sail that fills with wind.
    /// let mut positions = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 5.0, 0.0]];
    /// let options = BakeOptions::default().with_two_sided(true).with_deformable(true);
    /// let mut sail = OccluderMesh::bake(&positions, &[0, 1, 2], options)?;
    /// positions[2][2] = 1.5;
    /// sail.set_positions(&positions)?;
    /// assert!(sail.bounds().max[2] >= 1.5);
    /// # Ok::<(), foveal_cull::CullError>(())
    /// ```
    ///
    /// # Errors
    /// [`CullError::NotDeformable`], [`CullError::LengthMismatch`] for another number of positions,
    /// or [`CullError::NotFinite`] for a position in use. Then the mesh keeps its shape.
    pub fn set_positions<P: Copy + Into<[f32; 3]>>(
        &mut self,
        positions: &[P],
    ) -> Result<(), CullError> {
        self.check_positions(positions)?;
        let position = |i: u32| Vec3::from(positions[i as usize].into()) + Vec3::ZERO;
        move_to(&mut self.vertices, position);
        move_to(&mut self.one_rings.vertices, position);
        self.reshape();
        self.finish();
        Ok(())
    }

    /// Whether the mesh can have these positions.
    pub(super) fn check_positions<P: Copy + Into<[f32; 3]>>(
        &self,
        positions: &[P],
    ) -> Result<(), CullError> {
        let expected = self.positions.ok_or(CullError::NotDeformable)?;
        CullError::check_length(expected, positions.len())?;
        // One-rings have no others.
        let finite = |&i: &u32| Vec3::from(positions[i as usize].into()).is_finite();
        if self.vertices.sources.iter().all(finite) {
            Ok(())
        } else {
            Err(CullError::NotFinite(Quantity::Position))
        }
    }

    /// What becomes one vertex of this mesh.
    pub(super) fn welded_by(&self) -> By {
        if self.positions.is_some() {
            By::Index
        } else {
            By::Position
        }
    }

    /// Sets the centre, and what of each cluster follows from its vertices.
    pub(super) fn reshape(&mut self) {
        let corners = (0..self.vertices.sources.len()).map(|i| self.vertices.at(i));
        let (lo, hi) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| {
            (lo.min(p), hi.max(p))
        });
        self.center = if self.clusters.is_empty() {
            DVec3::ZERO
        } else {
            (lo.as_dvec3() + hi.as_dvec3()) * 0.5
        };
        for cluster in &mut self.clusters {
            let first = cluster.first_vertex as usize;
            let groups = &self.quads[cluster.first_group as usize..];
            let quads = (0..usize::from(cluster.quad_count)).map(|q| {
                let group = &groups[q / 8];
                [0, 1, 2, 3].map(|corner| group[corner][q % 8])
            });
            let vertices = &self.vertices;
            let corners = (quads.clone()).map(|q| q.map(|v| vertices.at(first + usize::from(v))));
            let shape = Shape::of(self.center, corners);
            let points = first..first + usize::from(cluster.vertex_count);
            let bits = points.flat_map(|i| vertices.at(i).to_array().map(f32::to_bits));
            cluster.hash = hash_words(
                u32::from(cluster.quad_count),
                bits.chain(quads.map(u32::from_le_bytes)),
            );
            cluster.center = shape.center;
            cluster.half = shape.half;
            cluster.cone_axis = shape.cone_axis;
            cluster.cone_sin = shape.cone_sin;
            cluster.cone_cos = shape.cone_cos;
            cluster.fill = shape.fill;
        }
    }
}

/// Takes each vertex to where `position` has its source.
fn move_to(vertices: &mut Vertices, mut position: impl FnMut(u32) -> Vec3) {
    for i in 0..vertices.sources.len() {
        let p = position(vertices.sources[i]);
        vertices.set(i, p);
    }
}
