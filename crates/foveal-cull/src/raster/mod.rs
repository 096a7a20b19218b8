//! The rasterizer: clusters in, proven depth out.
//!
//! In the order of a frame: `select` chooses and orders clusters (`candidates`), and leaves out
//! inner shapes whose mesh a near plane may cut (`near_cut`); `draw` draws them into a thread's
//! rows of blocks, one `cluster` after the other: `points` transforms its vertices,
//! `visible_quads`, `patch` and `margin` find what a view region must leave open, `setup` sets up
//! eight quads at once (`extent`, `edges`), `polygon` walks the blocks of one polygon, `block`
//! updates one block, and `layers` does so where parts lie far apart. `clip` is the slow path for
//! what crosses the near plane or leaves the guard band.

pub(crate) mod block;
pub(crate) mod candidates;
mod clip;
mod cluster;
pub(crate) mod draw;
pub(crate) mod edges;
mod extent;
pub(crate) mod facing;
mod layers;
mod margin;
mod near_cut;
mod patch;
mod place;
mod points;
pub(crate) mod polygon;
pub(crate) mod scratch;
pub(crate) mod select;
mod setup;
mod visible_quads;
