//! Projection of boxes to the screen, and clipping: what the rasterizer and the queries share.

pub(crate) mod boxes;
pub(crate) mod clip;
pub(crate) mod near;
pub(crate) mod points;
pub(crate) mod project;
pub(crate) mod screen;
