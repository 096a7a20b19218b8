//! The rasterizer: clusters in, proven depth out.
//!
//! `setup` transforms a cluster and sets up eight quads at once; `polygon` walks the blocks of one convex
//! polygon; `block` computes coverage and merges it; `clip` is the slow path for what crosses the near plane
//! or leaves the guard band; `sheet` finds what a result around the eye must leave open; `select` chooses and orders clusters; `frame` draws them.

pub(crate) mod block;
pub(crate) mod clip;
pub(crate) mod frame;
mod layers;
pub(crate) mod polygon;
pub(crate) mod select;
pub(crate) mod setup;
pub(crate) mod sheet;
