//! Baked occluders: any triangle mesh, turned into clusters that can be rejected whole.
//!
//! Baking welds equal positions, joins neighbouring triangles to nearly flat quads (half the set-up work),
//! and groups them into clusters of at most 64 quads with a bounding box and a normal cone. Positions are
//! kept as they are; bounds are relative to the mesh's own centre, so that large local coordinates keep their
//! precision.

mod cluster;
mod quads;
mod ring;
mod set;
mod weld;

pub(crate) use ring::{NUMBERS, RING, Ring, Rings, SECOND};
pub(crate) use set::Instance;
pub use set::{OccluderId, OccluderSet};

use crate::query::project::Boxes8;
use crate::{Aabb, CullError};
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

/// A mesh that can occlude, ready for the rasterizer. Immutable; share it by `Arc` between instances.
#[derive(Clone, Debug)]
pub struct OccluderMesh {
    pub(crate) vertices: Vertices,
    /// Groups of eight quads, corner by corner: vertex numbers within the cluster; a triangle repeats its
    /// third.
    pub(crate) quads: Vec<[[u8; 8]; 4]>,
    pub(crate) clusters: Vec<Cluster>,
    /// What surrounds each of them, if it was baked.
    pub(crate) rings: Rings,
    /// Their boxes, eight at a time (NaN after the last).
    pub(crate) bounds8: Vec<Boxes8>,
    /// The centre that bounds are relative to, mesh space.
    pub(crate) center: DVec3,
    /// Bounds relative to `center`.
    pub(crate) half: Vec3,
    pub(crate) two_sided: bool,
    pub(crate) hash: u32,
    triangles: u32,
}

/// Positions by coordinate, mesh space; every cluster's part is padded to a multiple of eight.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vertices {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) z: Vec<f32>,
}

/// Up to 64 quads over up to 256 vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cluster {
    /// Bounds relative to the mesh's centre.
    pub(crate) center: Vec3,
    pub(crate) half: Vec3,
    /// Mean normal, and the sine and cosine of the largest angle to it; `cone_cos <= 0` where the normals
    /// span a half-space or more and the cone proves nothing.
    pub(crate) cone_axis: Vec3,
    pub(crate) cone_sin: f32,
    pub(crate) cone_cos: f32,
    pub(crate) first_vertex: u32,
    pub(crate) first_group: u32,
    pub(crate) vertex_count: u16,
    pub(crate) quad_count: u8,
    pub(crate) triangle_count: u8,
    /// How much of its box's outline its triangles can fill, 0 to 1, in the mean over all directions.
    pub(crate) fill: f32,
    /// The part of its quads' edges, by length, that may be borders of a sheet from many sides, 0 to 1.
    pub(crate) creased: f32,
    /// Content hash: breaks ties in the drawing order, so that it never depends on submission order.
    pub(crate) hash: u32,
}

impl Cluster {
    /// Whether every triangle certainly faces away from the eye (mesh space, relative to the centre).
    #[inline(always)]
    pub(crate) fn faces_away(&self, eye: Vec3, forward: Vec3, orthographic: bool) -> bool {
        if self.cone_cos <= 0.0 {
            return false;
        }
        let (v, reach) = if orthographic {
            (forward, 0.0)
        } else {
            (self.center - eye, self.half.length())
        };
        let along = v.dot(self.cone_axis);
        let across = (v.length_squared() - along * along).max(0.0).sqrt();
        along > 0.0 && along * self.cone_cos - across * self.cone_sin > reach
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
            .then(|| ring::Neighbours::new(&welded.points, &welded.triangles));
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

    /// Bounds in mesh space, metres.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let c = self.center;
        Aabb::new(
            (c - self.half.as_dvec3()).as_vec3(),
            (c + self.half.as_dvec3()).as_vec3(),
        )
    }

    /// Triangles that were kept (all but degenerate ones).
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles as usize
    }

    /// Clusters that the mesh was split into.
    #[must_use]
    pub fn cluster_count(&self) -> usize {
        self.clusters.len()
    }
}

/// FNV-1a over 32-bit words, folded.
pub(crate) fn hash_words(seed: u32, words: impl IntoIterator<Item = u32>) -> u32 {
    let h = words
        .into_iter()
        .fold(0xcbf2_9ce4_8422_2325u64 ^ u64::from(seed), |h, w| {
            (h ^ u64::from(w))
                .wrapping_mul(0x0000_0100_0000_01b3)
                .rotate_left(23)
        });
    (h ^ (h >> 32)) as u32
}
