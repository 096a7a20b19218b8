//! Views: where the eyes are and what they see.
//!
//! Coordinates are right-handed with y up, and an eye looks along its own -z, as glTF cameras do.
//! Poses and frusta are `f64`; the rasterizer gets matrices relative to each object, so that
//! positions thousands of kilometres from the origin lose nothing. Depth inside the crate is `near
//! / distance` for perspective views and linear for orthographic ones. Both are 1 at the near
//! plane, fall with distance, and are affine over the screen, so that they can be interpolated.

use crate::error::{CullError, Quantity, ViewError};
use crate::transform::Affine;
use glam::{DAffine3, DMat3, DVec3};

/// The frustum of one eye, in its own space (x right, y up, -z forward).
///
/// `left < right` and `bottom < top`; frusta need not be symmetric. A headset's four tangents go in
/// as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Projection {
    /// Rays that meet in the eye. Extents are tangents: metres at a distance of one metre.
    Perspective {
        /// Tangent of the left edge.
        left: f64,
        /// Tangent of the right edge.
        right: f64,
        /// Tangent of the bottom edge.
        bottom: f64,
        /// Tangent of the top edge.
        top: f64,
        /// Near distance, metres, above zero.
        near_m: f64,
        /// Far distance, metres; may be infinite.
        far_m: f64,
    },
    /// Parallel rays. Extents are metres.
    Orthographic {
        /// Left edge.
        left: f64,
        /// Right edge.
        right: f64,
        /// Bottom edge.
        bottom: f64,
        /// Top edge.
        top: f64,
        /// Near distance along the view direction, metres; may be negative.
        near_m: f64,
        /// Far distance, metres, finite.
        far_m: f64,
    },
}

impl Projection {
    /// A symmetric perspective projection: vertical field of view in radians, width over height,
    /// and the near and far distances in metres (far may be infinite).
    ///
    /// The angle is above 0 and below pi, the others are above 0. Nothing is checked here:
    /// [`Culler::rasterize`](crate::Culler::rasterize) refuses extents that are empty and a near
    /// distance that is not above 0. Some angles in degrees, 45 for instance, give extents that are
    /// not empty, and so are not noticed.
    #[must_use]
    pub fn perspective(fov_y_rad: f64, aspect: f64, near_m: f64, far_m: f64) -> Self {
        let top = (fov_y_rad * 0.5).tan();
        let right = top * aspect;
        Self::Perspective {
            left: -right,
            right,
            bottom: -top,
            top,
            near_m,
            far_m,
        }
    }

    /// A symmetric orthographic projection that shows `height_m` metres from bottom to top, with
    /// width over height and the near and far distances in metres.
    #[must_use]
    pub fn orthographic(height_m: f64, aspect: f64, near_m: f64, far_m: f64) -> Self {
        let (top, right) = (height_m * 0.5, height_m * 0.5 * aspect);
        Self::Orthographic {
            left: -right,
            right,
            bottom: -top,
            top,
            near_m,
            far_m,
        }
    }

    /// Left, right, bottom and top: tangents, or metres if orthographic.
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
    pub fn near_far_m(&self) -> [f64; 2] {
        match *self {
            Self::Perspective { near_m, far_m, .. } | Self::Orthographic { near_m, far_m, .. } => {
                [near_m, far_m]
            }
        }
    }

    /// Whether rays are parallel.
    #[must_use]
    pub fn is_orthographic(&self) -> bool {
        matches!(self, Self::Orthographic { .. })
    }

    /// Wider to the right and downwards, to whole buffer pixels of a picture of so many pixels.
    fn for_picture(mut self, width_px: u32, height_px: u32) -> Self {
        let beyond = |px: u32| {
            let rest = (PICTURE_PX - px % PICTURE_PX) % PICTURE_PX;
            f64::from(rest) / f64::from(px)
        };
        let (Self::Perspective {
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
        }) = &mut self;
        *right += (*right - *left) * beyond(width_px);
        *bottom -= (*top - *bottom) * beyond(height_px);
        self
    }

    pub(crate) fn check(&self) -> Result<(), CullError> {
        let [l, r, b, t] = self.extents();
        let [near, far] = self.near_far_m();
        if ![l, r, b, t, near].iter().all(|v| v.is_finite()) || far.is_nan() {
            return Err(CullError::NotFinite(Quantity::Projection));
        }
        let cause = if !(l < r && b < t) {
            ViewError::EmptyExtents
        } else if self.is_orthographic() && !far.is_finite() {
            ViewError::FarNotFinite
        } else if !self.is_orthographic() && near <= 0.0 {
            ViewError::NearNotPositive
        } else if near >= far {
            ViewError::FarNotBeyondNear
        } else {
            return Ok(());
        };
        Err(CullError::BadView(cause))
    }
}

/// Pixels of a picture along each side of a buffer's pixel: the samples there.
pub(crate) const PICTURE_PX: u32 = 4;

/// Sine of the angle between `up` and the view direction up to which they count as parallel. The
/// axes of a pose are perpendicular to some 1e-16 over the sine.
const LEAST_SINE: f64 = 1e-8;

/// One eye: a rigid pose and a projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Pose: the columns are the eye's right, up and backward axes and its position (world,
    /// metres). It must be rigid, a rotation and a translation only.
    pub world_from_eye: Affine,
    /// Frustum.
    pub projection: Projection,
}

impl Eye {
    /// An eye by its pose (rigid) and its frustum.
    #[must_use]
    pub fn new(world_from_eye: impl Into<Affine>, projection: Projection) -> Self {
        Self {
            world_from_eye: world_from_eye.into(),
            projection,
        }
    }

    /// An eye at `position` that looks at `target`, both world metres; along -z if they are equal.
    /// `up` need not be perpendicular to the view direction; if it is parallel to it, within
    /// rounding, another axis is taken. A pose that is not finite is refused when it is used
    /// ([`CullError::NotFinite`](crate::CullError::NotFinite)).
    #[must_use]
    pub fn look_at(
        position: impl Into<[f64; 3]>,
        target: impl Into<[f64; 3]>,
        up: impl Into<[f64; 3]>,
        projection: Projection,
    ) -> Self {
        let [position, target, up] = [position.into(), target.into(), up.into()].map(DVec3::from);
        // Scaled first: squares of far targets would overflow. What is not finite stays so, and is
        // refused as a pose.
        let way = position - target;
        let way = way / way.abs().max_element().max(f64::MIN_POSITIVE);
        let back = if way.is_finite() && up.is_finite() {
            way.try_normalize().unwrap_or(DVec3::Z)
        } else {
            DVec3::NAN
        };
        let right = up.cross(back);
        // The product of parallel vectors is rounding alone.
        let is_known = right.length_squared() > LEAST_SINE * LEAST_SINE * up.length_squared();
        let right = right
            .try_normalize()
            .filter(|r| is_known && r.is_finite())
            .unwrap_or_else(|| back.any_orthonormal_vector());
        let rotation = DMat3::from_cols(right, back.cross(right), back);
        Self {
            world_from_eye: Affine::of(&DAffine3::from_mat3_translation(rotation, position)),
            projection,
        }
    }

    /// Position, world metres.
    #[must_use]
    pub fn position(&self) -> [f64; 3] {
        self.world_from_eye.translation
    }

    pub(crate) fn pose(&self) -> DAffine3 {
        self.world_from_eye.to_glam()
    }

    pub(crate) fn check(&self) -> Result<(), CullError> {
        self.projection.check()?;
        let pose = self.pose();
        if !pose.is_finite() {
            return Err(CullError::NotFinite(Quantity::Pose));
        }
        let m = pose.matrix3;
        let off = (m.transpose() * m) - DMat3::IDENTITY;
        let rigid = off.to_cols_array().iter().all(|v| v.abs() < 1e-4) && m.determinant() > 0.0;
        if rigid {
            Ok(())
        } else {
            Err(CullError::BadView(ViewError::PoseNotRigid))
        }
    }
}

/// The camera view of a frame: one eye or two, and how far they may move while the results hold.
///
/// Two eyes that differ, or a validity radius above zero, make a *view region*: a box is culled
/// only if it is hidden from every eye position in the region. Such results are conservative and
/// hide less than those of one eye at its exact position. They are best with meshes baked with
/// [`BakeOptions::adjacency`](crate::BakeOptions::adjacency). Source: Wonka, Wimmer and Schmalstieg
/// 2000, *Visibility preprocessing with occluder fusion*, extended to connected surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct View {
    /// The eye, or the left one of two.
    pub eye: Eye,
    /// The other eye, if there are two. Then both must be perspective.
    pub second_eye: Option<Eye>,
    /// Distance that each eye may move while the results hold, metres; 0 for the given positions
    /// only. Rotation is not covered: the frustum test is for the given directions.
    pub validity_radius_m: f64,
}

impl View {
    /// One eye at its exact position.
    #[must_use]
    pub fn mono(eye: Eye) -> Self {
        Self {
            eye,
            second_eye: None,
            validity_radius_m: 0.0,
        }
    }

    /// Two eyes with one conservative result: hidden means hidden from both.
    ///
    /// Rasterizing takes 0.7 to 1.4 times as long as for one eye (640x360, one thread).
    #[must_use]
    pub fn stereo(left: Eye, right: Eye) -> Self {
        Self {
            eye: left,
            second_eye: Some(right),
            validity_radius_m: 0.0,
        }
    }

    /// The same view with results that hold while each eye moves less than `radius_m` metres.
    ///
    /// Any radius above zero, a thousandth of a millimetre for instance, also makes them hold at
    /// every point of the picture, between the buffer's samples too: for pictures of several
    /// samples in a pixel, and for several frames of a temporal jitter at once. Rasterizing then
    /// takes 1.2 to 1.7 times as long from inside a level, and 4 to 18 % of the hidden boxes more
    /// are kept.
    #[must_use]
    pub fn with_validity_radius(self, radius_m: f64) -> Self {
        Self {
            validity_radius_m: radius_m,
            ..self
        }
    }

    /// The same view for a culler that was made by
    /// [`Culler::for_picture`](crate::Culler::for_picture) with the same size, in pixels of the
    /// picture. This view shows the picture and nothing beside it. Where a side of the picture is no
    /// multiple of 4, the buffer reaches beyond the picture on the right or at the bottom, and the
    /// result is wider by as much, for each eye. The buffer's samples are then the picture's pixel
    /// centres; without that, boxes may be reported hidden that show through slits narrower than a
    /// pixel.
    ///
    /// Call it once: a second call widens the view again. A [`ReceiverMask`](crate::ReceiverMask)
    /// takes the light's view as it was before this call. For a side of 0 the result has extents
    /// that are no numbers, which [`Culler::rasterize`](crate::Culler::rasterize) refuses.
    ///
    /// ```
    /// use foveal_cull::*;
    ///
    /// let mut culler = Culler::for_picture(1366, 768)?;
    /// assert_eq!(culler.size(), (342, 192));
    /// let aspect = 1366.0 / 768.0;
    /// let view = View::perspective([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], 1.0, aspect, 0.1);
    /// let view = view.for_picture(1366, 768);
    /// let options = FrameOptions::default();
    /// culler.rasterize(&view, &OccluderSet::new(), &options, &SingleThread)?;
    ///
    /// // The buffer has 4 * 342 samples side by side, two more than the picture has pixels.
    /// let [left, right, bottom, top] = view.eye.projection.extents();
    /// assert!(((right - left) / (top - bottom) - 1368.0 / 768.0).abs() < 1e-9);
    /// # Ok::<(), CullError>(())
    /// ```
    #[must_use]
    pub fn for_picture(self, width_px: u32, height_px: u32) -> Self {
        let wide = |eye: Eye| Eye {
            projection: eye.projection.for_picture(width_px, height_px),
            ..eye
        };
        Self {
            eye: wide(self.eye),
            second_eye: self.second_eye.map(wide),
            ..self
        }
    }

    /// One symmetric perspective eye without a far plane: [`Eye::look_at`] with
    /// [`Projection::perspective`]. Positions are world metres, `fov_y_rad` is the vertical field
    /// of view in radians, `aspect` width over height, and `near_m` the near distance in metres.
    #[must_use]
    pub fn perspective(
        position: impl Into<[f64; 3]>,
        target: impl Into<[f64; 3]>,
        up: impl Into<[f64; 3]>,
        fov_y_rad: f64,
        aspect: f64,
        near_m: f64,
    ) -> Self {
        Self::mono(Eye::look_at(
            position,
            target,
            up,
            Projection::perspective(fov_y_rad, aspect, near_m, f64::INFINITY),
        ))
    }
}
