//! Coarse shading: one lighting evaluation per tile of the rate map.
//!
//! After Imagire, 'Coarse pixel shading by stencil pyramid': level l is shaded into mip l of one
//! target, and only where the rate map's tiling has a tile of that level. Two backends visit the
//! same tiles and write the same bytes: [`StencilBackend`] draws each level behind a stencil test,
//! [`ComputeBackend`] dispatches over lists of tiles. Joining the samples to a picture is the
//! composite's work.

#[cfg(test)]
mod block;
mod choice;
mod compute;
mod count;
mod levels;
mod lists;
mod stage;
mod stencil;
mod targets;

#[cfg(test)]
pub(crate) use block::sample_texel;
pub(crate) use choice::{BackendChoice, UsedBackend};
pub(crate) use compute::ComputeBackend;
pub(crate) use count::CountPass;
pub(crate) use lists::{LevelNumbers, TileListing};
pub(crate) use stencil::{StencilBackend, stencil_state};
pub(crate) use targets::CoarseTargets;

#[cfg(test)]
mod materials;
#[cfg(test)]
mod tests;

pub(crate) use crate::formats::STENCIL_FORMAT;
pub(crate) use levels::LEVELS;
use levels::by_size;
pub(crate) use stage::CoarseShading;
