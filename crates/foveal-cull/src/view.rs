//! Views: where the eye is and what it sees.
//!
//! Right-handed, y up, the eye looks along its own -z (as glTF cameras do). Poses and frusta are `f64`;
//! the rasterizer gets `f32` matrices that are relative to each object, so that positions thousands of
//! kilometres from the origin lose nothing. Depth inside the crate is `near / distance` for perspective
//! views and linear for orthographic ones: both are 1 at the near plane, fall with distance, and are
//! affine over the screen, which is what interpolation needs.

use crate::error::CullError;
use glam::{DAffine3, DMat3, DVec3};

/// The shape of what one eye sees. Extents are `left < right` and `bottom < top`; asymmetric is fine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays through the eye. Extents are tangents (metres at one metre distance).
    Perspective {
        /// Tangent of the left border.
        left: f64,
        /// Tangent of the right border.
        right: f64,
        /// Tangent of the bottom border.
        bottom: f64,
        /// Tangent of the top border.
        top: f64,
        /// Near distance, metres, above zero.
        near: f64,
        /// Far distance, metres; may be infinite.
        far: f64,
    },
    /// Parallel rays. Extents are metres.
    Orthographic {
        /// Left border.
        left: f64,
        /// Right border.
        right: f64,
        /// Bottom border.
        bottom: f64,
        /// Top border.
        top: f64,
        /// Near distance along the view direction, metres; may be negative.
        near: f64,
        /// Far distance, metres, finite.
        far: f64,
    },
}

impl Projection {
    /// A symmetric perspective projection.
    #[must_use]
    pub fn perspective(fov_y_rad: f64, aspect: f64, near: f64, far: f64) -> Self {
        let top = (fov_y_rad * 0.5).tan();
        let right = top * aspect;
        Self::Perspective {
            left: -right,
            right,
            bottom: -top,
            top,
            near,
            far,
        }
    }

    /// A symmetric orthographic projection that shows `height` metres from bottom to top.
    #[must_use]
    pub fn orthographic(height: f64, aspect: f64, near: f64, far: f64) -> Self {
        let (top, right) = (height * 0.5, height * 0.5 * aspect);
        Self::Orthographic {
            left: -right,
            right,
            bottom: -top,
            top,
            near,
            far,
        }
    }

    /// Left, right, bottom, top.
    #[must_use]
    pub fn extents(&self) -> [f64; 4] {
        match *self {
            Self::Perspective {
                left,
                right,
                bottom,
                top,
                ..
            }
            | Self::Orthographic {
                left,
                right,
                bottom,
                top,
                ..
            } => [left, right, bottom, top],
        }
    }

    /// Near and far distance, metres.
    #[must_use]
    pub fn near_far(&self) -> [f64; 2] {
        match *self {
            Self::Perspective { near, far, .. } | Self::Orthographic { near, far, .. } => {
                [near, far]
            }
        }
    }

    /// Whether rays are parallel.
    #[must_use]
    pub fn is_orthographic(&self) -> bool {
        matches!(self, Self::Orthographic { .. })
    }

    pub(crate) fn check(&self) -> Result<(), CullError> {
        let [l, r, b, t] = self.extents();
        let [near, far] = self.near_far();
        if ![l, r, b, t, near].iter().all(|v| v.is_finite()) || far.is_nan() {
            return Err(CullError::NotFinite);
        }
        let near_ok = if self.is_orthographic() {
            far.is_finite()
        } else {
            near > 0.0
        };
        if l < r && b < t && near < far && near_ok {
            Ok(())
        } else {
            Err(CullError::BadProjection)
        }
    }
}

/// One eye: a rigid pose and a projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Pose: columns are the eye's right, up and backward axes and its position (world, metres). Must be
    /// rigid (rotation and translation only).
    pub world_from_eye: DAffine3,
    /// What it sees.
    pub projection: Projection,
}

impl Eye {
    /// An eye at `position` that looks at `target`; `up` need not be perpendicular, and where it is
    /// parallel to the view direction another axis is taken.
    #[must_use]
    pub fn look_at(position: DVec3, target: DVec3, up: DVec3, projection: Projection) -> Self {
        let back = (position - target).try_normalize().unwrap_or(DVec3::Z);
        let right = up
            .cross(back)
            .try_normalize()
            .filter(|r| r.is_finite())
            .unwrap_or_else(|| back.any_orthonormal_vector());
        let rotation = DMat3::from_cols(right, back.cross(right), back);
        Self {
            world_from_eye: DAffine3::from_mat3_translation(rotation, position),
            projection,
        }
    }

    /// Position, world metres.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.world_from_eye.translation
    }

    pub(crate) fn check(&self) -> Result<(), CullError> {
        self.projection.check()?;
        if !self.world_from_eye.is_finite() {
            return Err(CullError::NotFinite);
        }
        let m = self.world_from_eye.matrix3;
        let off = (m.transpose() * m) - DMat3::IDENTITY;
        let rigid = off.to_cols_array().iter().all(|v| v.abs() < 1e-4) && m.determinant() > 0.0;
        if rigid {
            Ok(())
        } else {
            Err(CullError::BadProjection)
        }
    }
}

/// What a frame is culled for: one eye or two, and for how large a movement the result shall hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The eye, or the left one of two.
    pub eye: Eye,
    /// The other eye, if there are two. Both must be perspective.
    pub second_eye: Option<Eye>,
    /// The result holds while each eye moves less than this, metres (turning is not covered: the frustum
    /// test is for the given directions). 0 for the given positions only.
    pub validity_radius_m: f64,
}

impl View {
    /// One eye, valid for its exact position.
    #[must_use]
    pub fn mono(eye: Eye) -> Self {
        Self {
            eye,
            second_eye: None,
            validity_radius_m: 0.0,
        }
    }

    /// Two eyes, one conservative result: hidden means hidden from both.
    #[must_use]
    pub fn stereo(left: Eye, right: Eye) -> Self {
        Self {
            eye: left,
            second_eye: Some(right),
            validity_radius_m: 0.0,
        }
    }

    /// The same view, whose result stays valid while each eye moves less than `radius_m` metres.
    #[must_use]
    pub fn with_validity_radius(self, radius_m: f64) -> Self {
        Self {
            validity_radius_m: radius_m,
            ..self
        }
    }

    /// Shorthand for one perspective eye.
    #[must_use]
    pub fn perspective(
        position: DVec3,
        target: DVec3,
        up: DVec3,
        fov_y_rad: f64,
        aspect: f64,
        near: f64,
    ) -> Self {
        Self::mono(Eye::look_at(
            position,
            target,
            up,
            Projection::perspective(fov_y_rad, aspect, near, f64::INFINITY),
        ))
    }
}
