//! The boxes that occludees are tested as and occluders are bounded by.
//!
//! Coordinates are metres, relative to an origin that the owner of the boxes names in `f64`, so
//! that a world far from zero loses nothing. Queries report a box that is invalid as visible,
//! since nothing can be proved about it.

use glam::Vec3;

/// An axis-aligned box, `min` to `max` inclusive, in metres.
///
/// A box with a NaN or infinity, or with `min > max` in some axis, is *invalid*;
/// [`is_valid`](Self::is_valid) tells. [`Aabb::EMPTY`] is one such box. The layout is six `f32` in
/// a row: `min`, then `max`.
///
/// ```
/// use foveal_cull::Aabb;
///
/// let both = Aabb::new([0.0; 3], [1.0; 3]).union(Aabb::of_points([[3.0, 0.5, 0.5]]));
/// assert_eq!(both.max, [3.0, 1.0, 1.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub min: [f32; 3],
    /// The corner with the largest coordinates.
    pub max: [f32; 3],
}

/// Kernels read a box as six numbers in a row.
const _: () = {
    assert!(size_of::<Aabb>() == 6 * size_of::<f32>());
    assert!(core::mem::offset_of!(Aabb, min) == 0);
    assert!(core::mem::offset_of!(Aabb, max) == 3 * size_of::<f32>());
};

impl Default for Aabb {
    /// [`Aabb::EMPTY`].
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// The box that contains nothing: the identity of [`Aabb::union`].
    pub const EMPTY: Self = Self {
        min: [f32::INFINITY; 3],
        max: [f32::NEG_INFINITY; 3],
    };

    /// A box from its smallest and largest corner.
    #[inline]
    #[must_use]
    pub fn new(min: impl Into<[f32; 3]>, max: impl Into<[f32; 3]>) -> Self {
        Self {
            min: min.into(),
            max: max.into(),
        }
    }

    /// The smallest box around `points`; [`Aabb::EMPTY`] when there are none. With a NaN or
    /// infinity among their coordinates the box is invalid.
    #[must_use]
    pub fn of_points<P: Into<[f32; 3]>>(points: impl IntoIterator<Item = P>) -> Self {
        let (mut all, mut has_nan) = (Self::EMPTY, false);
        for p in points {
            let p = p.into();
            has_nan |= p.iter().any(|v| v.is_nan());
            all = all.around(Self { min: p, max: p });
        }
        if has_nan {
            return Self::new([f32::NAN; 3], [f32::NAN; 3]);
        }
        all
    }

    /// The smallest box around both. [`Aabb::EMPTY`] changes nothing; the union with any other
    /// invalid box is invalid too, since nothing can be proved about what it stands for.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        if self == Self::EMPTY {
            return other;
        }
        if other == Self::EMPTY {
            return self;
        }
        let both = self.around(other);
        [self, other]
            .into_iter()
            .find(|one| !one.is_valid() && both.is_valid())
            .unwrap_or(both)
    }

    /// The smallest box around the numbers of both that are not NaN.
    #[inline]
    fn around(self, other: Self) -> Self {
        Self {
            min: core::array::from_fn(|k| self.min[k].min(other.min[k])),
            max: core::array::from_fn(|k| self.max[k].max(other.max[k])),
        }
    }

    /// Whether the box is valid, flat and point-like ones included: finite, and `min <= max` in every
    /// axis.
    #[inline]
    #[must_use]
    pub fn is_valid(self) -> bool {
        let (min, max) = (Vec3::from(self.min), Vec3::from(self.max));
        min.is_finite() && max.is_finite() && min.cmple(max).all()
    }

    /// The centre.
    #[inline]
    pub(crate) fn center(self) -> Vec3 {
        Vec3::from(self.min) * 0.5 + Vec3::from(self.max) * 0.5
    }

    /// Half the extent along each axis.
    #[inline]
    pub(crate) fn half_extent(self) -> Vec3 {
        Vec3::from(self.max) * 0.5 - Vec3::from(self.min) * 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_empty_box_is_the_identity_of_union_and_no_volume() {
        let one = Aabb::new([-1.0; 3], [1.0, 2.0, 3.0]);
        assert_eq!(one.union(Aabb::EMPTY), one);
        assert_eq!(Aabb::of_points([[0.0; 3]; 0]), Aabb::default());
        assert!(!Aabb::EMPTY.is_valid());
        assert_eq!(one.center() - one.half_extent(), Vec3::from(one.min));
        assert_eq!(one.center() + one.half_extent(), Vec3::from(one.max));
    }

    #[test]
    fn boxes_with_nan_or_inside_out_are_no_volumes() {
        assert!(Aabb::new([0.0; 3], [0.0; 3]).is_valid(), "a point");
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            assert!(!Aabb::new([0.0; 3], [1.0, bad, 1.0]).is_valid(), "{bad}");
        }
        assert!(!Aabb::new([f32::NAN; 3], [0.0; 3]).is_valid());
    }

    #[test]
    fn what_cannot_be_proved_stays_so_in_unions() {
        let one = Aabb::new([-1.0; 3], [1.0, 2.0, 3.0]);
        for axis in 0..3 {
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30] {
                let (mut low, mut high) = (one, one);
                low.min[axis] = bad;
                high.max[axis] = bad;
                for wrong in [low, high].into_iter().filter(|b| !b.is_valid()) {
                    for all in [wrong.union(one), one.union(wrong), wrong.union(wrong)] {
                        assert!(!all.is_valid(), "{wrong:?}: {all:?}");
                    }
                    for all in [wrong.union(Aabb::EMPTY), Aabb::EMPTY.union(wrong)] {
                        assert_eq!(format!("{all:?}"), format!("{wrong:?}"));
                    }
                }
                let mut point = [0.5; 3];
                point[axis] = bad;
                for points in [[point, [0.0; 3]], [[0.0; 3], point], [point; 2]] {
                    let is_finite = bad.is_finite();
                    assert_eq!(Aabb::of_points(points).is_valid(), is_finite, "{points:?}");
                }
            }
        }
        assert_eq!(Aabb::EMPTY.union(Aabb::EMPTY), Aabb::EMPTY);
    }
}
