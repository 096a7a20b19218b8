//! Facing

/// How an instance is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    /// The transform mirrors, so winding is reversed.
    pub(crate) mirrored: bool,
    pub(crate) two_sided: bool,
    /// Number of the cluster in its mesh.
    pub(crate) cluster: usize,
    /// For a result that holds around the eye.
    pub(crate) radius: Option<Radius>,
}

/// A validity radius, in units of the set-up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Radius {
    /// Samples that a point at depth 1 shifts by.
    pub(crate) shift: f32,
    /// The same along x and y.
    pub(crate) shifts: [f32; 2],
    /// The radius as a part of the near distance.
    pub(crate) per_depth: f32,
}
