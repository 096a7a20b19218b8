//! The stats of one frame.

/// Stats of the last frame, with the counts that Intel's occlusion culling sample shows.
///
/// [`Culler::rasterize`](crate::Culler::rasterize) resets all of them and fills those of occluders;
/// [`Culler::count`](crate::Culler::count) adds those of occludees. Times are not among them: this
/// crate reads no clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct CullStats {
    /// Enabled occluders in the set.
    pub occluder_models: u64,
    /// Occluders of which at least one cluster was drawn.
    pub occluder_models_rasterized: u64,
    /// Triangles of all enabled occluders.
    pub occluder_triangles: u64,
    /// Triangles of the clusters that were drawn.
    pub occluder_triangles_rasterized: u64,
    /// Convex polygons that survived set-up. One that lies in the bands of several threads counts
    /// once for each.
    pub polygons_rasterized: u64,
    /// Clusters of all enabled occluders.
    pub clusters: u64,
    /// Clusters that were drawn.
    pub clusters_rasterized: u64,
    /// Clusters left out because the time budget was spent.
    pub clusters_over_budget: u64,
    /// Clusters left out because they hid nothing in the frames before
    /// ([`OccluderUsefulness`](crate::OccluderUsefulness)).
    pub clusters_not_useful: u64,
    /// Occludees counted since the frame began.
    pub occludees: u64,
    /// Of these, visible.
    pub occludees_visible: u64,
    /// Of these, outside the frustum.
    pub occludees_outside: u64,
    /// Of these, below the size threshold.
    pub occludees_small: u64,
    /// Of these, hidden by occluders.
    pub occludees_occluded: u64,
    /// Triangles of the occludees counted, where the caller gave them.
    pub occludee_triangles: u64,
    /// Of these, triangles of visible occludees.
    pub occludee_triangles_visible: u64,
}

impl CullStats {
    /// Occludees that are not visible, for whatever reason.
    #[must_use]
    pub fn occludees_culled(&self) -> u64 {
        self.occludees - self.occludees_visible
    }

    /// Triangles of occludees that are not visible.
    #[must_use]
    pub fn occludee_triangles_culled(&self) -> u64 {
        self.occludee_triangles - self.occludee_triangles_visible
    }
}
