//! Light history: light is kept at each pixel from frame to frame, reprojected by motion, and
//! reshaded step by step.
//!
//! Each pixel keeps light as a sample of coarse shading holds it (`shading/coarse/light.wgsl`), so
//! that its own surface and the eye's position shape the picture in each frame. Per frame,
//! [`passes::HistoryPasses`] finds the pixel's place in the frame before by its motion, takes what
//! was kept there if instance and distance agree, and chooses which pixels are reshaded: a share of
//! each block, larger where samples differed from what was expected. Pixels without history take
//! the light of the samples around them, as the composite of light does.
//!
//! While camera, lights and scene rest, pixels are reshaded in turn, [`lit::ROUND`] frames a round.
//! After a round the picture is full shading's to the bit, and nothing more is shaded.

mod changed;
#[cfg(test)]
mod first_tests;
mod gather;
#[cfg(test)]
mod gaze_tests;
mod lit;
#[cfg(test)]
mod moving_tests;
mod passes;
mod stage;
mod targets;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;
#[cfg(test)]
mod view_tests;

pub(crate) use targets::HistoryTargets;

#[cfg(test)]
pub(crate) use passes::HistoryParameters;
pub(crate) use stage::HistoryStage;
