//! Baking of boxes.

use super::bake::{BakeOptions, Input};
use super::chunks::Chunking;
use super::mesh::OccluderMesh;
use crate::bounds::Aabb;
use crate::error::{CullError, Quantity};
use crate::threads::SingleThread;
use glam::{DVec3, Vec3};

/// Corners of a box's faces, counter-clockwise from outside; bits of a corner's number are x, y and
/// z.
const FACES: [[u32; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];

impl OccluderMesh {
    /// Bakes a box whose faces look outwards, for instance an artist's occlusion volume. `bounds`
    /// are in mesh space (metres), with `min <= max`.
    ///
    /// # Errors
    /// [`CullError::NotFinite`] for NaN or infinity, [`CullError::InsideOut`] where `min` is above
    /// `max` in some axis: the faces would look inwards, and hide all around a camera in the box.
    pub fn from_box(bounds: Aabb) -> Result<Self, CullError> {
        if !(Vec3::from(bounds.min).is_finite() && Vec3::from(bounds.max).is_finite()) {
            return Err(CullError::NotFinite(Quantity::Position));
        }
        if !bounds.is_valid() {
            return Err(CullError::InsideOut);
        }
        Ok(Self::of_boxes(&[bounds], None, BakeOptions::default()))
    }

    /// Bakes finite boxes, mesh space, with clusters of their own, so that each is drawn by its own
    /// distance and its silhouettes cut nothing out of the others. `solid`: bounds of the mesh that
    /// they are inside.
    pub(super) fn of_boxes(boxes: &[Aabb], solid: Option<Aabb>, options: BakeOptions) -> Self {
        let all = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(*b));
        let [lo, hi] = [all.min, all.max].map(|p| Vec3::from(p).as_dvec3());
        let center = (lo + hi) * 0.5;
        let faces = FACES.iter();
        let indices: Vec<u32> = faces
            .flat_map(|q| [q[0], q[1], q[2], q[0], q[2], q[3]])
            .collect();
        let bake = |bounds: &Aabb| {
            let corner = |i: u32| {
                Vec3::from_array([0, 1, 2].map(|k| match i >> k & 1 {
                    0 => bounds.min[k],
                    _ => bounds.max[k],
                }))
            };
            let input = Input {
                positions: 8,
                position: &corner,
                indices: &indices,
                chunking: Chunking::USUAL,
            };
            input.bake_around(center, options, &SingleThread)
        };
        let mut mesh = Input {
            positions: 0,
            position: &|_| Vec3::ZERO,
            indices: &[],
            chunking: Chunking::USUAL,
        }
        .bake_around(DVec3::ZERO, options, &SingleThread);
        for bounds in boxes {
            mesh.append(bake(bounds));
        }
        mesh.solid = solid;
        mesh.finish();
        mesh
    }
}
