//! Queries: which boxes can be seen.

pub(crate) mod near;
pub(crate) mod project;
pub(crate) mod test;
