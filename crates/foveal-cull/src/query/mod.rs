//! Queries: which boxes can be seen.

pub(crate) mod answer;
pub(crate) mod faces;
pub(crate) mod flat;
pub(crate) mod list;
pub(crate) mod near;
pub(crate) mod planes;
pub(crate) mod points;
pub(crate) mod project;
pub(crate) mod sift;
pub(crate) mod test;
pub(crate) mod tree;
pub(crate) mod walk;
