//! The rasterizer: clusters in, proven depth out.
//!
//! `setup` transforms a cluster and sets up eight quads at once; `polygon` walks the blocks of one convex
//! polygon; `block` computes coverage and merges it, `layers` where parts lie far apart; `clip` is the slow path for what crosses the near plane
//! or leaves the guard band; `open`, `sheet` and `border` find what a result around the eye must leave open; `band` is what
//! a thread draws into, and `pool` where its partly covered pixels wait for the rest; `select` chooses and orders
//! clusters; `frame` draws them.

mod block;
pub(crate) mod candidates;
mod clip;
mod cluster;
pub(crate) mod draw;
mod edges;
mod extent;
pub(crate) mod facing;
mod layers;
mod margin;
mod open;
mod patch;
mod points;
mod polygon;
pub(crate) mod scratch;
pub(crate) mod select;
mod setup;
