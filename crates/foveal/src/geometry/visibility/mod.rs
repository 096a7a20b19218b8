//! Geometry by a visibility buffer: the rasterizer says which triangle is seen at each pixel, and
//! materials are evaluated afterwards, once per pixel, whatever the overdraw.
//!
//! After Burns and Hunt 2013, 'The visibility buffer'. Passes: [`VisiblePass`] draws instance,
//! motion, triangle and depth; [`BinPass`] sorts the seen pixels by material; [`ResolvePass`]
//! resolves each material at its pixels, with analytic barycentric coordinates and derivatives
//! (`shared/attributes.wgsl`), and writes the surfaces of the ordinary G-buffer, so that every
//! later stage sees an ordinary G-buffer. There is one indirect dispatch for each family of
//! materials (`scene/families.rs`), whose bins lie side by side.

mod bins;
#[cfg(test)]
mod bins_twin;
#[cfg(test)]
mod dispatches;
mod pass;
mod raster;
mod resolve;
#[cfg(test)]
mod slivers;
mod targets;
#[cfg(test)]
mod tests;

#[cfg(test)]
pub(crate) use resolve::WindowsUniform;
#[cfg(test)]
pub(crate) use tests::level_scene;

pub(crate) use pass::VisibilityPass;
use targets::{Listed, with_mask};
pub(crate) use targets::{Rates, ResolveAt, VisibilityTargets};
