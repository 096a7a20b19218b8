//! The axis-aligned box of Foveal's scenes.
//!
//! Coordinates are in whatever space and unit the owner of a box names.
//!
//! ```
//! use foveal_bounds::Aabb;
//! use foveal_bounds::glam::Vec3;
//!
//! let one = Aabb::new(Vec3::ZERO, Vec3::ONE);
//! let both = one.union(Aabb::of_points([Vec3::new(3.0, 0.5, 0.5)]));
//! assert_eq!(both.size(), Vec3::new(3.0, 1.0, 1.0));
//! ```
#![forbid(unsafe_code)]

pub use glam;

use glam::{Mat4, Vec3};

/// An axis-aligned box, `min` to `max` inclusive.
///
/// A box with a NaN or infinity, or with `min > max` in some axis is *invalid*;
/// [`is_valid`](Self::is_valid) tells. [`Aabb::EMPTY`] is one such box. The layout is six `f32` in
/// a row: `min`, then `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Default for Aabb {
    /// [`Aabb::EMPTY`].
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// The box that contains nothing: the identity of [`Aabb::union`].
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// A box from its smallest and largest corner.
    #[inline]
    #[must_use]
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The smallest box around `points`; [`Aabb::EMPTY`] when there are none.
    #[must_use]
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self {
            min: b.min.min(p),
            max: b.max.max(p),
        })
    }

    /// The smallest box around both.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Whether the box contains no point.
    #[inline]
    #[must_use]
    pub fn is_empty(self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether the box is valid, flat and point-like ones included: finite, and `min <= max` in every
    /// axis.
    #[inline]
    #[must_use]
    pub fn is_valid(self) -> bool {
        self.min.is_finite() && self.max.is_finite() && self.min.cmple(self.max).all()
    }

    /// The centre.
    #[inline]
    #[must_use]
    pub fn center(self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Half the extent along each axis.
    #[inline]
    #[must_use]
    pub fn half_extent(self) -> Vec3 {
        self.max * 0.5 - self.min * 0.5
    }

    /// Edge lengths; zero for an empty box.
    #[inline]
    #[must_use]
    pub fn size(self) -> Vec3 {
        if self.is_empty() {
            Vec3::ZERO
        } else {
            self.max - self.min
        }
    }

    /// Half the surface area; the measure that hierarchies are split by. Zero for an empty box.
    #[inline]
    #[must_use]
    pub fn half_area(self) -> f32 {
        let e = (self.max - self.min).max(Vec3::ZERO);
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// The eight corners.
    #[must_use]
    pub fn corners(self) -> [Vec3; 8] {
        let (a, b) = (self.min, self.max);
        core::array::from_fn(|i| {
            Vec3::new(
                if i & 1 == 0 { a.x } else { b.x },
                if i & 2 == 0 { a.y } else { b.y },
                if i & 4 == 0 { a.z } else { b.z },
            )
        })
    }

    /// The box around the transformed corners: an upper bound of the transformed contents. An empty
    /// box stays empty.
    #[must_use]
    pub fn transformed(self, to_from: Mat4) -> Self {
        if self.is_empty() {
            return self;
        }
        Self::of_points(self.corners().map(|c| to_from.transform_point3(c)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_empty_box_is_the_identity_of_union_and_no_volume() {
        let one = Aabb::new(Vec3::splat(-1.0), Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(one.union(Aabb::EMPTY), one);
        assert_eq!(Aabb::of_points([]), Aabb::default());
        assert!(Aabb::EMPTY.is_empty() && !Aabb::EMPTY.is_valid());
        assert_eq!(
            (Aabb::EMPTY.size(), Aabb::EMPTY.half_area()),
            (Vec3::ZERO, 0.0)
        );
        assert_eq!(Aabb::EMPTY.transformed(Mat4::IDENTITY), Aabb::EMPTY);
    }

    #[test]
    fn measures_agree_with_the_corners() {
        let one = Aabb::new(Vec3::splat(-1.0), Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(Aabb::of_points(one.corners()), one);
        assert_eq!(one.center() - one.half_extent(), one.min);
        assert_eq!(one.center() + one.half_extent(), one.max);
        assert_eq!(one.size(), Vec3::new(2.0, 3.0, 4.0));
        assert_eq!(one.half_area(), 2.0 * 3.0 + 3.0 * 4.0 + 4.0 * 2.0);
        let moved = one.transformed(Mat4::from_translation(Vec3::X));
        assert_eq!(moved, Aabb::new(one.min + Vec3::X, one.max + Vec3::X));
    }

    #[test]
    fn boxes_with_nan_or_inside_out_are_no_volumes() {
        assert!(Aabb::new(Vec3::ZERO, Vec3::ZERO).is_valid(), "a point");
        assert!(!Aabb::new(Vec3::ZERO, Vec3::NAN).is_valid());
        assert!(!Aabb::new(Vec3::NAN, Vec3::ZERO).is_valid());
        assert!(!Aabb::new(Vec3::ONE, Vec3::ZERO).is_valid());
        assert!(!Aabb::new(Vec3::ZERO, Vec3::INFINITY).is_valid());
    }
}
