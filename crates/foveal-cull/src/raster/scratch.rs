//! Scratch

use super::patch::Sheet;
use super::points::Points;

/// Working memory of one thread.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    /// Corners of a cluster.
    pub(crate) points: Points,
    /// Corners of a clipped polygon.
    pub(crate) clipped: Points,
    /// Screen borders that vertices lie beyond, for the clipper.
    pub(crate) beyond: [u8; 256],
    /// What belongs together, for a result that holds around the eye.
    pub(crate) sheet: Sheet,
    /// Polygons that were set up, for the statistics.
    pub(crate) polygons: u64,
    /// Clusters drawn.
    pub(crate) clusters: u64,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            points: Points::default(),
            clipped: Points::default(),
            beyond: [0; 256],
            sheet: Sheet::default(),
            polygons: 0,
            clusters: 0,
        }
    }
}
