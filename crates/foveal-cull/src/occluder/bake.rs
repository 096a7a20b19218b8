//! Bake

use super::mesh::OccluderMesh;
use super::neighbors::Neighbours;
use super::one_ring::Rings;
use super::vertices::Vertices;
use super::{cluster, quads, weld};
use crate::bounds::Aabb;
use crate::error::CullError;
use glam::{DVec3, Vec3};

/// How a mesh is baked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BakeOptions {
    /// Whether triangles occlude from behind as well (glTF `doubleSided`). Off, only counter-clockwise faces
    /// occlude, which is what a renderer with back-face culling draws.
    pub two_sided: bool,
    /// Whether to bake what surrounds every cluster, for results that hold around the eye
    /// ([`View::stereo`](crate::View::stereo), [`View::with_validity_radius`](crate::View::with_validity_radius)):
    /// baking takes three to four times as long and three times the memory. Without, such views hide less (every polygon shrinks by itself);
    /// others need none of it. Two-sided meshes never have it.
    pub around_the_eye: bool,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            two_sided: false,
            around_the_eye: true,
        }
    }
}

impl OccluderMesh {
    /// Bakes a triangle list. `positions` are in mesh space (metres), `indices` three per triangle,
    /// counter-clockwise from outside. Degenerate triangles are dropped.
    ///
    /// # Errors
    /// [`CullError::NotTriangles`], [`CullError::IndexOutOfRange`], [`CullError::NotFinite`] or
    /// [`CullError::TooLarge`].
    pub fn bake(
        positions: &[Vec3],
        indices: &[u32],
        options: BakeOptions,
    ) -> Result<Self, CullError> {
        if !indices.len().is_multiple_of(3) {
            return Err(CullError::NotTriangles {
                indices: indices.len(),
            });
        }
        if indices.len() / 3 > (u32::MAX / 8) as usize {
            return Err(CullError::TooLarge);
        }
        if let Some(&index) = indices.iter().find(|&&i| i as usize >= positions.len()) {
            return Err(CullError::IndexOutOfRange {
                index,
                positions: positions.len(),
            });
        }
        if indices.iter().any(|&i| !positions[i as usize].is_finite()) {
            return Err(CullError::NotFinite);
        }
        let bounds = indices
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &i| {
                let p = positions[i as usize].as_dvec3();
                (lo.min(p), hi.max(p))
            });
        let center = if indices.is_empty() {
            DVec3::ZERO
        } else {
            (bounds.0 + bounds.1) * 0.5
        };
        let welded = weld::weld(positions, indices);
        let quads = quads::pair(&welded);
        let mut mesh = Self {
            vertices: Vertices::default(),
            quads: Vec::new(),
            clusters: Vec::new(),
            rings: Rings::default(),
            bounds8: Vec::new(),
            center,
            half: Vec3::ZERO,
            two_sided: options.two_sided,
            hash: 0,
            triangles: (welded.triangles.len()) as u32,
        };
        let near = (options.around_the_eye && !options.two_sided)
            .then(|| Neighbours::new(&welded.points, &welded.triangles));
        cluster::build(&mut mesh, &welded.points, near.as_ref(), quads);
        Ok(mesh)
    }

    /// A box as an occluder (for instance an artist's occlusion volume), faces outwards.
    #[must_use]
    pub fn from_box(bounds: Aabb) -> Option<Self> {
        let (a, b) = (bounds.min, bounds.max);
        let p: [Vec3; 8] = core::array::from_fn(|i| {
            Vec3::new(
                if i & 1 == 0 { a.x } else { b.x },
                if i & 2 == 0 { a.y } else { b.y },
                if i & 4 == 0 { a.z } else { b.z },
            )
        });
        const QUADS: [[u32; 4]; 6] = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let indices: Vec<u32> = QUADS
            .iter()
            .flat_map(|q| [q[0], q[1], q[2], q[0], q[2], q[3]])
            .collect();
        Self::bake(&p, &indices, BakeOptions::default()).ok()
    }
}
