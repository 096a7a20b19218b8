//! Working memory of one thread.

use super::patch::Patch;
use super::points::Points;

/// Working memory of one thread.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    /// Vertices of a cluster.
    pub(crate) points: Points,
    /// Vertices of a clipped polygon.
    pub(crate) clipped: Points,
    /// Screen edges that vertices lie beyond, for the clipper.
    pub(crate) beyond: [u8; 256],
    /// The surface patch of a cluster, for view regions.
    pub(crate) patch: Patch,
    /// Polygons set up, for the stats.
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
            patch: Patch::default(),
            polygons: 0,
            clusters: 0,
        }
    }
}
