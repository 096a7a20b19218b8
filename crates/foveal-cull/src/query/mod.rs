//! Queries: which boxes can be seen.

mod axis_planes;
pub(crate) mod classify;
mod coarse;
mod compaction;
mod faces;
pub(crate) mod flat;
mod groups;
pub(crate) mod moving;
mod plane_lanes;
mod rect;
pub(crate) mod tree;
pub(crate) mod walk;
