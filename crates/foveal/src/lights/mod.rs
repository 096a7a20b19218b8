//! Lights on the device, and which of them reach which cluster (froxel) of the view.
//!
//! The grid has square tiles on the screen and slices that grow geometrically with the distance
//! (Olsson, Billeter, Assarsson 2012, 'Clustered Deferred and Forward Shading'). A cluster holds
//! one bit per light that shines from a point: nothing overflows, and lights come out in ascending
//! order. Directional ones light everything, and come first.

mod clusters;
mod grid;
mod on_cpu;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;
mod upload;

pub(crate) use clusters::{LightAssigner, SceneLights};
pub(crate) use grid::ClusterGrid;
pub(crate) use on_cpu::cluster_bits;
pub(crate) use upload::{LightUniform, LightsHeader, MAX_LIGHTS};
