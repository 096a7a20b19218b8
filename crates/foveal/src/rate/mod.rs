//! The rate map: how finely each place of the picture is shaded.
//!
//! A *request* per pixel (level l: one sample per 2^l x 2^l pixels) is not yet a partition. The
//! minimum of the requested levels over each block of a quadtree makes one: a block is *allowed* at
//! its level l where that minimum is at least l, and a pixel's *owner* is the coarsest allowed
//! block that holds it. A block's parent holds the block's pixels and more, so allowed blocks are
//! nested and each pixel has exactly one owner.
//!
//! Passes: request (`request.wgsl`), pyramid (`pyramid.wgsl`), owner (`owner.wgsl`); [`MinPyramid`]
//! is their twin on the CPU. On the device the pyramid begins with the requested levels of 2 x 2
//! pixels: finer is only the pixel itself.

mod acuity;
#[cfg(test)]
mod bumps;
mod finest;
mod image;
mod map;
mod pyramid;
mod request;
mod targets;

pub use image::RateImage;
pub use pyramid::MinPyramid;

pub(crate) use finest::FinestRate;
pub(crate) use map::RateMapPass;
pub(crate) use request::RequestUniform;
pub(crate) use targets::RateTargets;
