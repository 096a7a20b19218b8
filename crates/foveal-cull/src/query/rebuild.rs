//! Hierarchies that are built while their objects go on moving.

use super::occludee_id::OccludeeId;
use super::tree::OccludeeTree;
use crate::bounds::Aabb;
use glam::DVec3;

/// The objects of an [`OccludeeSet`](crate::OccludeeSet) at one moment.
#[derive(Clone, Debug)]
pub struct OccludeeSnapshot {
    pub(super) boxes: Vec<Aabb>,
    /// In the order of slots.
    pub(super) ids: Vec<OccludeeId>,
    pub(super) origin: DVec3,
}

/// A hierarchy over the objects of a snapshot.
#[derive(Clone, Debug)]
pub struct OccludeeRebuild {
    pub(super) tree: OccludeeTree,
    pub(super) ids: Vec<OccludeeId>,
}

impl OccludeeSnapshot {
    /// Builds the hierarchy. O(n log n); on any thread.
    #[must_use]
    pub fn build(self) -> OccludeeRebuild {
        OccludeeRebuild {
            tree: OccludeeTree::build_from(&self.boxes, self.origin),
            ids: self.ids,
        }
    }
}
