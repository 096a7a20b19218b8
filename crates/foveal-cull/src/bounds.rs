//! Axis-aligned boxes: what occludees are tested as and what occluders are bounded by.
//!
//! Coordinates are metres in `f32`, relative to an origin that the owner of the boxes names in
//! `f64` (a world far from zero loses nothing that way).

use glam::Vec3;

/// An axis-aligned box, `min` to `max` inclusive.
///
/// A box with a NaN or with `min > max` in some axis is *not a volume*: queries report it as
/// visible, because nothing can be proved about it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Aabb {
    /// Smallest corner, metres.
    pub min: Vec3,
    /// Largest corner, metres.
    pub max: Vec3,
}

impl Aabb {
    /// The box that contains nothing; the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// A box from its smallest and largest corner.
    #[must_use]
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The smallest box around `points`; [`Aabb::EMPTY`] when there are none.
    #[must_use]
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self {
            min: b.min.min(p),
            max: b.max.max(p),
        })
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The centre, metres.
    #[must_use]
    pub fn center(self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Half the extent along each axis, metres.
    #[must_use]
    pub fn half_extent(self) -> Vec3 {
        self.max * 0.5 - self.min * 0.5
    }

    /// Whether this is a volume (or a flat or point-like one): finite and `min <= max` everywhere.
    #[must_use]
    pub fn is_valid(self) -> bool {
        self.min.is_finite() && self.max.is_finite() && self.min.cmple(self.max).all()
    }

    /// Half the surface area, square metres; the measure that hierarchies are split by.
    #[must_use]
    pub fn half_area(self) -> f32 {
        let e = (self.max - self.min).max(Vec3::ZERO);
        e.x * e.y + e.y * e.z + e.z * e.x
    }
}
