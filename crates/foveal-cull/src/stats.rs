//! The figures of one frame, as Intel's occlusion culling sample shows them.

/// Counts of the last frame. Times are not among them: the caller measures around the calls (and may lend a
/// clock for budgets).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CullStats {
    /// Occluder models in the set.
    pub occluder_models: u64,
    /// Models of which at least one cluster was drawn.
    pub occluder_models_rasterized: u64,
    /// Triangles of all occluder models.
    pub occluder_triangles: u64,
    /// Triangles of the clusters that were drawn.
    pub occluder_triangles_rasterized: u64,
    /// Convex polygons that survived set-up.
    pub polygons_rasterized: u64,
    /// Clusters of all models that were looked at.
    pub clusters: u64,
    /// Clusters drawn.
    pub clusters_rasterized: u64,
    /// Occluders left out because the time budget was spent.
    pub clusters_over_budget: u64,
    /// Occludees asked about since the frame began.
    pub occludees: u64,
    /// Of these, visible.
    pub occludees_visible: u64,
    /// Outside the frustum.
    pub occludees_outside: u64,
    /// Below the size threshold.
    pub occludees_small: u64,
    /// Hidden by occluders.
    pub occludees_occluded: u64,
    /// Triangles of the occludees asked about (where the caller gave counts).
    pub occludee_triangles: u64,
    /// Of these, in visible occludees.
    pub occludee_triangles_visible: u64,
}

impl CullStats {
    /// Occludees culled for whatever reason.
    #[must_use]
    pub fn occludees_culled(&self) -> u64 {
        self.occludees - self.occludees_visible
    }

    /// Triangles of culled occludees.
    #[must_use]
    pub fn occludee_triangles_culled(&self) -> u64 {
        self.occludee_triangles - self.occludee_triangles_visible
    }
}
