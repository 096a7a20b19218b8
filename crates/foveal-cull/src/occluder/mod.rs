//! Occluders: baked meshes, and the set of placed ones.
//!
//! `weld`, `quads`, `neighbors` and `cluster` are the steps of `bake`; `mesh`, `vertices` and
//! `one_ring` hold its result; `set` places meshes in the world.

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
