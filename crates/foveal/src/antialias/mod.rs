//! Anti-aliasing: sub-samples of the geometry, and lighting only as often as surfaces differ.
//!
//! After tatsy's compute anti-aliasing (a G-buffer at n times the resolution; lighting of all
//! sub-samples only where their depths differ), and beyond it: the sub-samples of a pixel are
//! sorted into surfaces, the largest becomes the pixel's texel in the ordinary G-buffer, so that
//! every other stage works as without anti-aliasing, and only the further surfaces are shaded
//! besides, weighted by their coverage.

mod blended;
mod choice;
mod further;
mod limits;
mod pattern;
mod pipelines;
mod stage;
mod targets;
#[cfg(test)]
mod tests;
mod triangles;
#[cfg(test)]
mod twin;

pub(crate) use choice::{adds_lobes, by_triangles, follows_rates, footprint};
pub(crate) use limits::validate;
#[cfg(test)]
pub(crate) use pattern::BandUniform;
pub(crate) use stage::{AntialiasStage, Shadings};
#[cfg(test)]
pub(crate) use targets::QueueUniform;
pub(crate) use targets::SampleTargets;
