//! Variable shading: materials and lighting once per 1 x 1, 2 x 1, 1 x 2, 2 x 2 or 4 x 4 pixels, as
//! the content of the frame before allows.
//!
//! After Monsho's software variable-rate shading over a visibility buffer. Passes: [`RatePasses`]
//! reprojects what is known of each quad of pixels and finds rates and samples; the list of samples
//! is lit like any other. Where the original method's mask feeds on its own picture, here contrast
//! is measured only where pixels were shaded one by one, and kept until they are again
//! (`reproject.wgsl`). So the mask of a still camera cannot change.
//!
//! While the camera or the scene moves, one quad in 16 is shaded in full each frame, in turns, and
//! so measured again ([`Probes`]). When all stands still again each quad is measured once more,
//! within four frames: from then on the mask is that of a fresh start. [`Balance`](super::Balance)
//! compares what is saved with what finding the mask costs.

#[cfg(test)]
mod eyes;
mod passes;
mod probes;
mod stage;
mod targets;
#[cfg(test)]
mod tests;
#[cfg(test)]
pub(crate) mod twin;
mod view;
#[cfg(test)]
mod walls;

#[cfg(test)]
pub(crate) use passes::RatesUniform;
pub(crate) use targets::VariableTargets;

pub(crate) use stage::VariableStage;
