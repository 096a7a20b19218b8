//! Output: what the picture shows, as 8-bit sRGB.

mod eyes;
mod overlay;
mod present;
mod radiance;
mod tone_map;
#[cfg(test)]
mod twin;
mod upscale;
mod view;

pub(crate) use crate::formats::PICTURE_FORMAT;
pub(crate) use eyes::EyesPass;
#[cfg(test)]
pub(crate) use eyes::ShownUniform;
pub(crate) use overlay::OverlayPass;
pub(crate) use present::PresentPass;
pub use present::Target;
pub use radiance::RadianceImage;
pub(crate) use tone_map::ToneMapPass;
pub(crate) use upscale::Upscale;
pub(crate) use view::ViewPass;
