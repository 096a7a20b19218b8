//! The one-ring of a cluster: the triangles that touch it, and which edge joins which triangles.
//!
//! For view regions a cluster and its one-ring are one surface (see `raster::patch`). Without the
//! one-ring every cluster would end in silhouette edges all around.

use super::room::make_room;
use super::vertices::Vertices;

/// The number of no triangle: beyond an edge where the mesh ends. All numbers are below 384.
pub(crate) const NO_TRIANGLE: u16 = 383;
/// First number of the one-ring's triangles. Before them come the first triangles of the cluster's
/// quads, then the second ones.
pub(crate) const FIRST_OF_RING: usize = 128;
pub(crate) const FIRST_OF_SECOND: usize = 64;
/// A power of two above all numbers.
pub(crate) const MAX_NUMBERS: usize = 512;
/// The one-ring of one cluster.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneRing {
    /// Index in [`OneRings::vertices`]. Vertex numbers continue after the cluster's own, padded
    /// ones.
    pub(crate) first_vertex: u32,
    pub(crate) vertex_count: u16,
    /// Groups of eight triangles. The first corner is the one that is alone on its side (on the
    /// cluster, or off it).
    pub(crate) first_group: u32,
    pub(crate) triangle_count: u16,
    /// Edges with a vertex of the cluster.
    pub(crate) first_edge: u32,
    pub(crate) edges: u16,
}

/// An edge of a cluster or its one-ring.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// The triangles on either side; [`NO_TRIANGLE`] where the mesh ends.
    pub(crate) triangles: [u16; 2],
    pub(crate) vertices: [u8; 2],
}

/// The one-rings of a mesh, one per cluster.
#[derive(Clone, Debug, Default)]
pub(crate) struct OneRings {
    pub(crate) clusters: Vec<OneRing>,
    pub(crate) vertices: Vertices,
    pub(crate) triangles: Vec<[[u8; 8]; 3]>,
    pub(crate) edges: Vec<Edge>,
}

impl OneRings {
    /// Where the lists of vertices, triangles and edges end. Longer lists than `u32::MAX` are not
    /// kept ([`keep_below`](Self::keep_below)).
    pub(super) fn ends(&self) -> [u32; 3] {
        self.lengths().map(|n| u32::try_from(n).unwrap_or(u32::MAX))
    }

    fn lengths(&self) -> [usize; 3] {
        [
            self.vertices.x.len(),
            self.triangles.len(),
            self.edges.len(),
        ]
    }

    /// The number of all triangles, without what fills groups up.
    pub(super) fn triangle_count(&self) -> u64 {
        let counts = self.clusters.iter().map(|r| u64::from(r.triangle_count));
        counts.sum()
    }

    /// Drops all one-rings if a list has more than `most` elements. View regions are as safe without
    /// them.
    pub(super) fn keep_below(&mut self, most: usize) {
        if self.lengths().iter().any(|n| *n > most) {
            *self = Self::default();
        }
    }

    /// Appends the one-rings of further clusters.
    pub(super) fn append(&mut self, other: Self) {
        let [first_vertex, first_group, first_edge] = self.ends();
        make_room(&mut self.clusters, other.clusters.len());
        self.clusters
            .extend(other.clusters.into_iter().map(|c| OneRing {
                first_vertex: first_vertex.saturating_add(c.first_vertex),
                first_group: first_group.saturating_add(c.first_group),
                first_edge: first_edge.saturating_add(c.first_edge),
                ..c
            }));
        self.vertices.append(other.vertices);
        make_room(&mut self.triangles, other.triangles.len());
        self.triangles.extend(other.triangles);
        make_room(&mut self.edges, other.edges.len());
        self.edges.extend(other.edges);
    }

    pub(super) fn shrink(&mut self) {
        self.clusters.shrink_to_fit();
        self.vertices.shrink();
        self.triangles.shrink_to_fit();
        self.edges.shrink_to_fit();
    }
}

#[cfg(test)]
mod tests {
    use crate::{Aabb, OccluderMesh};

    #[test]
    fn one_rings_too_long_for_their_offsets_are_dropped() {
        let mut mesh = OccluderMesh::from_box(Aabb::new([0.0; 3], [1.0; 3])).unwrap();
        let edges = mesh.one_rings.edges.len();
        assert!(edges > 8);
        mesh.one_rings.keep_below(edges);
        assert_eq!(mesh.one_rings.edges.len(), edges);
        mesh.one_rings.keep_below(edges - 1);
        assert!(mesh.one_rings.clusters.is_empty() && mesh.one_rings.edges.is_empty());
        assert!(OccluderMesh::from_bytes(&mesh.to_bytes()).is_ok());
    }
}
