//! The baked mesh.

use super::one_ring::OneRings;
use super::room::make_room;
use super::vertices::Vertices;
use crate::bounds::Aabb;
use crate::projection::boxes::Boxes8;
use glam::{DVec3, Vec3};

/// A baked occluder mesh.
///
/// Share it between occluders by `Arc`. It stays as it is, unless it was baked
/// [`deformable`](crate::BakeOptions::deformable). [`BakeOptions`](crate::BakeOptions) decide its
/// size.
#[derive(Clone, Debug)]
pub struct OccluderMesh {
    pub(crate) vertices: Vertices,
    /// Groups of eight quads, corner by corner: vertex numbers within the cluster. A triangle
    /// repeats its third vertex.
    pub(crate) quads: Vec<[[u8; 8]; 4]>,
    pub(crate) clusters: Vec<Cluster>,
    /// Adjacency of each cluster, if it was baked.
    pub(crate) one_rings: OneRings,
    /// Boxes of the clusters, eight at a time; NaN after the last.
    pub(crate) bounds8: Vec<Boxes8>,
    /// Centre that bounds are relative to, mesh space.
    pub(crate) center: DVec3,
    /// Half extent around `center`.
    pub(crate) half: Vec3,
    pub(crate) two_sided: bool,
    pub(crate) hash: u32,
    pub(super) triangles: u32,
    /// Number of positions of a mesh that deforms.
    pub(super) positions: Option<usize>,
    /// Of an inner shape: bounds of the mesh that it is inside, mesh space. Where a near plane cuts
    /// these, what is drawn may be open, so the shape must not hide anything.
    pub(crate) solid: Option<Aabb>,
}

/// A cluster: up to 64 quads over up to 256 vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cluster {
    /// Bounds relative to the mesh's centre.
    pub(crate) center: Vec3,
    pub(crate) half: Vec3,
    /// Mean normal, and sine and cosine of the largest angle to it. `cone_cos <= 0` where the
    /// normals span a half-space or more and the cone proves nothing.
    pub(crate) cone_axis: Vec3,
    pub(crate) cone_sin: f32,
    pub(crate) cone_cos: f32,
    pub(crate) first_vertex: u32,
    pub(crate) first_group: u32,
    pub(crate) vertex_count: u16,
    pub(crate) quad_count: u8,
    pub(crate) triangle_count: u8,
    /// The part of its box's outline that its triangles can fill, 0 to 1, in the mean over all
    /// directions.
    pub(crate) fill: f32,
    /// The part of its quads' edges, by length, that is a silhouette from many directions, 0 to 1.
    pub(crate) creased: f32,
    /// Content hash. It breaks ties in the drawing order, so that results do not depend on the
    /// order of submission.
    pub(crate) hash: u32,
}

impl Cluster {
    /// Whether every triangle certainly faces away from the eye (mesh space, relative to the
    /// centre).
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
    /// Bounds in mesh space, metres: of the mesh that was baked, for inner shapes too.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        if let Some(solid) = self.solid {
            return solid;
        }
        let c = self.center;
        Aabb::new(
            (c - self.half.as_dvec3()).as_vec3(),
            (c + self.half.as_dvec3()).as_vec3(),
        )
    }

    /// Whether boxes inside the mesh were baked in its place
    /// ([`BakeOptions::inner_shape`](crate::BakeOptions::inner_shape)).
    #[must_use]
    pub fn is_inner_shape(&self) -> bool {
        self.solid.is_some()
    }

    /// Number of triangles, without degenerate ones; of an inner shape those of its boxes. In a
    /// [`deformable`](crate::BakeOptions::deformable) mesh only those with the same index twice are.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles as usize
    }

    /// Number of positions that [`set_positions`](Self::set_positions) takes; `None` for a mesh that
    /// was not baked [`deformable`](crate::BakeOptions::deformable).
    #[must_use]
    pub fn position_count(&self) -> Option<usize> {
        self.positions
    }

    /// Number of clusters.
    #[must_use]
    pub fn cluster_count(&self) -> usize {
        self.clusters.len()
    }

    /// Sets what follows from the clusters, and frees room that is left.
    pub(super) fn finish(&mut self) {
        self.vertices.shrink();
        self.quads.shrink_to_fit();
        self.clusters.shrink_to_fit();
        self.one_rings.shrink();
        let reach = |h: Vec3, c: &Cluster| h.max(c.center.abs() + c.half);
        self.half = self.clusters.iter().fold(Vec3::ZERO, reach);
        self.bounds8 = bounds8(&self.clusters);
        let hashes = self.clusters.iter().map(|c| c.hash);
        self.hash = hash_words(self.quads.len() as u32, hashes);
    }

    /// Appends the clusters of another part of the same mesh.
    pub(super) fn append(&mut self, part: Self) {
        self.triangles += part.triangles;
        if self.clusters.is_empty() {
            *self = Self {
                triangles: self.triangles,
                ..part
            };
            return;
        }
        let first_vertex = self.vertices.x.len() as u32;
        let first_group = self.quads.len() as u32;
        make_room(&mut self.clusters, part.clusters.len());
        self.clusters
            .extend(part.clusters.into_iter().map(|c| Cluster {
                first_vertex: first_vertex + c.first_vertex,
                first_group: first_group + c.first_group,
                ..c
            }));
        self.vertices.append(part.vertices);
        make_room(&mut self.quads, part.quads.len());
        self.quads.extend(part.quads);
        self.one_rings.append(part.one_rings);
    }
}

/// A position relative to the mesh's centre.
pub(super) fn relative(mesh_center: DVec3, position: Vec3) -> Vec3 {
    (position.as_dvec3() - mesh_center).as_vec3()
}

/// Centre and half extent of a cluster between two corners, relative to the mesh's centre.
pub(super) fn bounds_of(mesh_center: DVec3, lo: Vec3, hi: Vec3) -> (Vec3, Vec3) {
    let [lo, hi] = [lo, hi].map(|p| relative(mesh_center, p));
    let half = (hi - lo) * 0.5 * (1.0 + 1e-6) + (lo.abs().max(hi.abs())) * 1e-6;
    ((lo + hi) * 0.5, half)
}

/// The boxes of clusters, eight at a time.
fn bounds8(clusters: &[Cluster]) -> Vec<Boxes8> {
    let eight = |eight: &[Cluster]| {
        let mut boxes = Boxes8::NONE;
        for (i, c) in eight.iter().enumerate() {
            boxes.set(i, c.center, c.half);
        }
        boxes
    };
    clusters.chunks(8).map(eight).collect()
}

/// FNV-1a over 32-bit words, folded to 32 bits.
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
