//! The rasterizer: clusters in, proven depth out.
//!
//! `setup` transforms a cluster and sets up eight quads at once; `polygon` walks the blocks of one convex
//! polygon; `block` computes coverage and merges it, `layers` where parts lie far apart; `clip` is the slow path for what crosses the near plane
//! or leaves the guard band; `open`, `sheet` and `border` find what a result around the eye must leave open; `band` is what
//! a thread draws into, and `pool` where its partly covered pixels wait for the rest; `select` chooses and orders
//! clusters; `frame` draws them.

pub(crate) mod band;
pub(crate) mod block;
mod border;
pub(crate) mod clip;
pub(crate) mod frame;
mod layers;
mod open;
pub(crate) mod polygon;
pub(crate) mod pool;
pub(crate) mod select;
pub(crate) mod setup;
pub(crate) mod sheet;
