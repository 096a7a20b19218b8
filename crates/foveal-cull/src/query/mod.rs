//! Queries: which boxes can be seen.

mod axis_planes;
pub(crate) mod choice;
pub(crate) mod classify;
mod coarse;
mod compaction;
mod faces;
mod fitted;
pub(crate) mod flat;
mod groups;
pub(crate) mod moving;
pub(crate) mod occludee_id;
mod plane_lanes;
pub(crate) mod rebuild;
pub(crate) mod receivers;
pub(crate) mod rect;
pub(crate) mod tree;
pub(crate) mod walk;
