//! Occluders: baked meshes, and the set of placed ones.
//!
//! `chunks`, `borders`, `weld`, `half_edges`, `quads`, `sah`, `cluster` and `neighbors` are the
//! steps of `bake`; `mesh`, `vertices` and `one_ring` hold its result; `bytes` writes and reads it,
//! and `check` says whether what was read is a mesh, by `surface`; `deform` gives a mesh other
//! positions, `heights` makes one of a terrain's heights, `inner` boxes inside a closed mesh, which
//! `boxes` bakes; `set` places meshes in the world.

mod bake;
mod borders;
mod boxes;
mod bytes;
mod check;
mod chunks;
mod cluster;
mod deform;
mod half_edges;
mod heights;
mod in_parts;
mod inner;
pub(crate) mod mesh;
mod neighbors;
pub(crate) mod one_ring;
mod quads;
mod room;
mod sah;
pub(crate) mod set;
mod surface;
pub(crate) mod usefulness;
pub(crate) mod vertices;
mod weld;
mod word_hash;

pub use bake::BakeOptions;
#[cfg(feature = "testing")]
pub(crate) use bytes::{HEADER as MESH_HEADER, seal};
pub use mesh::OccluderMesh;
pub use set::{OccluderId, OccluderSet};
pub use usefulness::OccluderUsefulness;
