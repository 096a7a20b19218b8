//! How the clusters of an instance face the eye, and the view region they are drawn for.

/// How an instance is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    /// The transform mirrors, so that winding is reversed.
    pub(crate) mirrored: bool,
    pub(crate) two_sided: bool,
    /// Number of the cluster in its mesh.
    pub(crate) cluster: usize,
    /// The view region, if there is one.
    pub(crate) radius: Option<ValidityRadius>,
}

/// The radius of a view region, in the units of set-up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ValidityRadius {
    /// Shift of a point at depth 1, samples.
    pub(crate) shift: f32,
    /// The same along x and y.
    pub(crate) shifts: [f32; 2],
    /// The radius as a part of the near distance.
    pub(crate) per_depth: f32,
}
