//! Baked occluders: any triangle mesh, turned into clusters that can be rejected whole.
//!
//! Baking welds equal positions, joins neighbouring triangles to nearly flat quads (half the set-up work),
//! and groups them into clusters of at most 64 quads with a bounding box and a normal cone. Positions are
//! kept as they are; bounds are relative to the mesh's own centre, so that large local coordinates keep their
//! precision.

mod bake;
mod cluster;
pub(crate) mod mesh;
mod neighbors;
pub(crate) mod one_ring;
mod quads;
pub(crate) mod set;
pub(crate) mod vertices;
mod weld;

pub use bake::BakeOptions;
pub use mesh::OccluderMesh;
pub use set::{OccluderId, OccluderSet};
