//! Baking: any triangle mesh becomes clusters that can be culled as a whole.
//!
//! Baking welds equal positions, joins neighbouring triangles to nearly flat quads (half the set-up
//! work), and groups them into clusters of up to 64 quads with a bounding box and a normal cone.
//! Positions stay as they are. Bounds are relative to the mesh's own centre, so that large local
//! coordinates keep their precision.

use super::half_edges::HalfEdges;
use super::mesh::OccluderMesh;
use super::neighbors::Neighbors;
use super::one_ring::OneRings;
use super::vertices::Vertices;
use super::{cluster, quads, weld};
use crate::bounds::Aabb;
use crate::error::{CullError, Quantity};
use crate::threads::{SingleThread, Threads};
use glam::{DVec3, Vec3};

/// Options of baking.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BakeOptions {
    /// Whether triangles occlude from behind as well (glTF `doubleSided`); `false` by default.
    /// Otherwise only counter-clockwise faces occlude, which is what a renderer with back-face
    /// culling draws.
    pub two_sided: bool,
    /// Whether to bake the adjacency of every cluster, for view regions
    /// ([`View::stereo`](crate::View::stereo),
    /// [`View::with_validity_radius`](crate::View::with_validity_radius)); `true` by default.
    /// Baking then takes up to twice as long, and the mesh three times the memory. Without
    /// it view regions are just as safe but hide less, since every polygon shrinks by itself. Views
    /// of one exact eye do not need it. Two-sided meshes never have it.
    pub adjacency: bool,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            two_sided: false,
            adjacency: true,
        }
    }
}

impl BakeOptions {
    /// Sets [`two_sided`](Self::two_sided).
    #[must_use]
    pub fn with_two_sided(mut self, two_sided: bool) -> Self {
        self.two_sided = two_sided;
        self
    }

    /// Sets [`adjacency`](Self::adjacency).
    #[must_use]
    pub fn with_adjacency(mut self, adjacency: bool) -> Self {
        self.adjacency = adjacency;
        self
    }
}

/// Most triangles of a mesh: offsets of clusters, vertices and adjacency are 32 bits.
pub(super) const MAX_TRIANGLES: usize = (u32::MAX / 8) as usize;

impl OccluderMesh {
    /// Bakes a triangle list: `positions` in mesh space (metres) and `indices`, three per triangle,
    /// counter-clockwise from outside.
    ///
    /// Baking welds positions that are bit-equal, drops degenerate triangles, joins neighbouring
    /// triangles to nearly flat quads, and groups quads into clusters of up to 64 by the
    /// surface-area heuristic over position and normal. Equal input gives an equal mesh.
    ///
    /// O(n log n): about 0.8 microseconds per triangle on one core, 1.3 with adjacency. Bake when a
    /// level loads, not per frame, or once for all by [`to_bytes`](Self::to_bytes).
    ///
    /// # Errors
    /// [`CullError::NotTriangles`], [`CullError::IndexOutOfRange`], [`CullError::NotFinite`] for a
    /// position in use, or [`CullError::TooManyTriangles`] for more than 2^29 - 1.
    pub fn bake<P: Copy + Into<[f32; 3]>>(
        positions: &[P],
        indices: &[u32],
        options: BakeOptions,
    ) -> Result<Self, CullError> {
        Self::bake_on(positions, indices, options, &SingleThread)
    }

    /// [`bake`](Self::bake) on several threads. The mesh is the same.
    ///
    /// # Errors
    /// As [`bake`](Self::bake).
    pub fn bake_on<P: Copy + Into<[f32; 3]>>(
        positions: &[P],
        indices: &[u32],
        options: BakeOptions,
        threads: &dyn Threads,
    ) -> Result<Self, CullError> {
        let positions: Vec<Vec3> = positions.iter().map(|&p| p.into().into()).collect();
        Self::bake_list(&positions, indices, options, threads)
    }

    fn bake_list(
        positions: &[Vec3],
        indices: &[u32],
        options: BakeOptions,
        threads: &dyn Threads,
    ) -> Result<Self, CullError> {
        if !indices.len().is_multiple_of(3) {
            return Err(CullError::NotTriangles {
                indices: indices.len(),
            });
        }
        if indices.len() / 3 > MAX_TRIANGLES {
            return Err(CullError::TooManyTriangles {
                triangles: indices.len() / 3,
                most: MAX_TRIANGLES,
            });
        }
        if let Some(&index) = indices.iter().find(|&&i| i as usize >= positions.len()) {
            return Err(CullError::IndexOutOfRange {
                index,
                positions: positions.len(),
            });
        }
        let Some(welded) = weld::weld(positions, indices) else {
            return Err(CullError::NotFinite(Quantity::Position));
        };
        let corners = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let bounds = welded.points.iter().fold(corners, |(lo, hi), p| {
            let p = p.as_dvec3();
            (lo.min(p), hi.max(p))
        });
        let center = if indices.is_empty() {
            DVec3::ZERO
        } else {
            (bounds.0 + bounds.1) * 0.5
        };
        let edges = HalfEdges::new(welded.points.len(), &welded.triangles);
        let quads = quads::pair(&welded, &edges, threads);
        let mut mesh = Self {
            vertices: Vertices::default(),
            quads: Vec::new(),
            clusters: Vec::new(),
            one_rings: OneRings::default(),
            bounds8: Vec::new(),
            center,
            half: Vec3::ZERO,
            two_sided: options.two_sided,
            hash: 0,
            triangles: (welded.triangles.len()) as u32,
        };
        if options.adjacency && !options.two_sided {
            let near = Neighbors::new(&welded.points, &welded.triangles, &edges);
            cluster::build(&mut mesh, &welded.points, Some(&near), quads, threads);
        } else {
            // Most of the memory by then.
            drop((edges, welded.triangles));
            cluster::build(&mut mesh, &welded.points, None, quads, threads);
        }
        mesh.one_rings.keep_below(u32::MAX as usize);
        Ok(mesh)
    }

    /// Bakes a box whose faces look outwards, for instance an artist's occlusion volume. `bounds`
    /// are in mesh space (metres), with `min <= max`.
    ///
    /// # Errors
    /// [`CullError::NotFinite`] for NaN or infinity.
    pub fn from_box(bounds: Aabb) -> Result<Self, CullError> {
        let (a, b) = (Vec3::from(bounds.min), Vec3::from(bounds.max));
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
        Self::bake_list(&p, &indices, BakeOptions::default(), &SingleThread)
    }
}
