//! Culling: which objects are seen at all, decided on the CPU before anything is drawn.
//!
//! Takes a scene's boxes and occluders (`scene.rs`), and the cells of its instances that may
//! receive shadows (`cells.rs`), world space in metres; gives a `Visibility` for each (`stage.rs`).

mod cells;
mod found_for;
mod pace;
mod scene;
mod stage;
mod surface;
#[cfg(test)]
mod tests;
mod workers;

pub(crate) use pace::has_receivers;
pub(crate) use scene::{CullingScene, affine};
pub use stage::CullingStats;
pub(crate) use stage::{CullingStage, ObjectStats, has_cells};
