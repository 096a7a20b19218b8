//! Around every cluster: the triangles that touch it, and which edges join which triangles.
//!
//! Results that hold around the eye treat a cluster and its ring as one sheet (see [`crate::raster::sheet`]): the
//! sheet's border must stay clear of what it hides, and without the ring every cluster would end in a border.

use super::vertices::Vertices;

/// No triangle: beyond an edge that ends a mesh. Numbers are less than 384.
pub(crate) const NONE: u16 = 383;
/// Where a ring's numbers begin; before it come the first triangles of the cluster's quads, then their second ones.
pub(crate) const RING: usize = 128;
pub(crate) const SECOND: usize = 64;
/// A power of two above all numbers.
pub(crate) const NUMBERS: usize = 512;
/// What surrounds one cluster.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ring {
    /// In [`Rings::vertices`]; the numbers go on after the cluster's own, padded ones.
    pub(crate) first_vertex: u32,
    pub(crate) vertex_count: u16,
    /// Groups of eight triangles; the first corner is the one alone on its side (on the cluster, or off it).
    pub(crate) first_group: u32,
    pub(crate) triangle_count: u16,
    /// Edges with a vertex of the cluster.
    pub(crate) first_edge: u32,
    pub(crate) edges: u16,
}

/// An edge of a cluster or its ring.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// On either side; [`NONE`] where there is no triangle.
    pub(crate) triangles: [u16; 2],
    pub(crate) vertices: [u8; 2],
}

/// The rings of a mesh, one per cluster.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rings {
    pub(crate) rings: Vec<Ring>,
    pub(crate) vertices: Vertices,
    pub(crate) triangles: Vec<[[u8; 8]; 3]>,
    pub(crate) edges: Vec<Edge>,
}
