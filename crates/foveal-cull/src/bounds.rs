//! The boxes that occludees are tested as and occluders are bounded by.
//!
//! Coordinates are metres, relative to an origin that the owner of the boxes names in `f64`, so
//! that a world far from zero loses nothing. Queries report a box that is not a volume as visible,
//! since nothing can be proved about it.

pub use foveal_bounds::Aabb;

/// Kernels read a box as six numbers in a row.
const _: () = {
    assert!(size_of::<Aabb>() == 6 * size_of::<f32>());
    assert!(core::mem::offset_of!(Aabb, min) == 0);
    assert!(core::mem::offset_of!(Aabb, max) == 3 * size_of::<f32>());
};
