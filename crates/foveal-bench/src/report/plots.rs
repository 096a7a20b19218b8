//! Plots as inline SVG. Their figures are the JSON's; ticks of an axis stand at round numbers and
//! are marked as such.

mod cost;
mod load;
mod quality;
mod ratios;
mod timeline;

pub(super) use cost::cost;
pub(super) use load::load;
pub(super) use quality::quality;
pub(super) use ratios::ratios;
pub(super) use timeline::timeline;
