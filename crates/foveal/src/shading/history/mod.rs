//! Light that is carried from frame to frame: samples of coarse shading's light are kept at each pixel, moved along with what is
//! seen there, and renewed bit by bit.
//!
//! Each pixel remembers light as a coarse sample holds it (`shading/coarse/light.wgsl`), so that its own surface and the
//! eye's place shape the picture anew in each frame. Per frame, [`HistoryPasses`] finds the pixel's place in the frame before
//! by its motion, keeps what is remembered there if instance and distance agree, and chooses which pixels are shaded
//! anew: a share of each block, larger where what was expected of samples proved wrong. Pixels that remember nothing
//! take the light of the samples around them, as the composite of light does.
//!
//! While camera, lights and scene rest, pixels are shaded in turn, [`ROUND`] frames a round: then the picture is
//! full shading's to the bit, and nothing more is shaded.

mod changed;
mod lit;
mod passes;
mod stage;
mod targets;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;

pub(crate) use targets::HistoryTargets;

#[cfg(test)]
pub(crate) use passes::HistoryParameters;
pub(crate) use stage::HistoryStage;
