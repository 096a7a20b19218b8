//! Shadows: which of a light's rays reach a surface.
//!
//! An atlas of depth holds a square tile per light and side: six sides of a cube around a point
//! light, one for a spot light, a few cascades for a directional one. A frame's tiles and their
//! sizes follow from lights, view and settings alone ([`plan`]); tiles are kept from frame to frame
//! ([`kept`]) and drawn again where a thing that casts shadows has moved, or their size has
//! changed. With occlusion culling, what other casters hide from the light ([`hidden`]) and what
//! shades nothing that is seen ([`mask`]) is left out. Lighting looks into the atlas at each sample
//! (`shadow/lookup.wgsl`).

mod atlas;
#[cfg(test)]
mod bent_tests;
#[cfg(test)]
mod budget_tests;
mod changed;
#[cfg(test)]
mod changed_tests;
#[cfg(test)]
mod contact_tests;
#[cfg(test)]
mod culling_tests;
mod footprint;
mod hidden;
mod kept;
mod mask;
mod near;
mod part;
mod pass;
mod patch;
#[cfg(test)]
mod patch_tests;
mod plan;
#[cfg(test)]
mod rays;
mod receivers;
mod records;
#[cfg(test)]
mod sizes_tests;
mod stage;
#[cfg(test)]
mod strips_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;
mod volume;

pub(crate) use changed::{Place, add_place};
#[cfg(test)]
pub(crate) use pass::TileUniform;
pub(crate) use receivers::Receivers;
pub(crate) use records::LookupSettings;
pub(crate) use stage::ShadowStage;
#[cfg(test)]
pub(crate) use {tests::lookup, twin::Lookup};
