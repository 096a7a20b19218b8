//! Views: where the eye is and what it sees.
//!
//! Right-handed, y up, the eye looks along its own -z (as glTF cameras do). Poses and frusta are `f64`;
//! the rasterizer gets `f32` matrices that are relative to each object, so that positions thousands of
//! kilometres from the origin lose nothing. Depth inside the crate is `near / distance` for perspective
//! views and linear for orthographic ones: both are 1 at the near plane, fall with distance, and are
//! affine over the screen, which is what interpolation needs.

use crate::CullError;
use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};

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

    fn check(&self) -> Result<(), CullError> {
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

    fn check(&self) -> Result<(), CullError> {
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

/// A checked view, reduced to what the kernels need: one centre, one frustum, one radius.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    pub(crate) eye: DVec3,
    /// Rows X, Y, Z, W of clip space in *sample units*: `X / W` in `0..4 * width`, `Y / W` downwards,
    /// `Z / W` the depth (1 at near). Relative to `eye`: columns multiply (world - eye, 1).
    pub(crate) rows: [DVec4; 4],
    pub(crate) orthographic: bool,
    /// Direction that the eye looks along, world.
    pub(crate) forward: DVec3,
    /// Depth of the far plane (0 when infinite).
    pub(crate) far_depth: f64,
    /// Radius around `eye` for which the result must hold, metres.
    pub(crate) radius: f64,
    /// A box that is nowhere nearer than this depth may be cut at the borders of the buffer: what lies
    /// beyond them no eye within the radius can see.
    pub(crate) clamp_depth: f64,
    /// Samples per unit of `1 / distance` and metre: how far a point at depth 1 shifts for one metre of eye
    /// movement, samples.
    pub(crate) shift_per_metre: f64,
    /// By how much a point at depth 1 can shift along x and y within the radius, or from eye to eye, samples.
    pub(crate) shift: [f64; 2],
    /// Tangent of half the vertical field of view, or half the height for orthographic views.
    pub(crate) tan_half_fov_y: f64,
    pub(crate) near: f64,
}

impl Camera {
    /// `width` and `height` are samples.
    pub(crate) fn new(view: &View, width: f64, height: f64) -> Result<Self, CullError> {
        view.eye.check()?;
        if !(view.validity_radius_m.is_finite() && view.validity_radius_m >= 0.0) {
            return Err(CullError::NotFinite);
        }
        let (eye, to_eye) = match view.second_eye {
            None => (view.eye, DVec3::ZERO),
            Some(second) => {
                second.check()?;
                join_eyes(&view.eye, &second)?
            }
        };
        let radius = to_eye.length() + view.validity_radius_m;
        let (projection, clamp_depth) = if radius > 0.0 {
            widen(eye.projection, radius)
        } else {
            (eye.projection, f64::INFINITY)
        };
        let [l, r, b, t] = projection.extents();
        let [near, far] = projection.near_far();
        let m = eye.world_from_eye.matrix3;
        let (right, up, forward) = (m.x_axis, m.y_axis, -m.z_axis);
        // Screen x in 0..width: perspective ((x/d) - l) / (r - l) * width.
        let (sx, sy) = (width / (r - l), height / (t - b));
        let (rows, far_depth) = if projection.is_orthographic() {
            let k = 1.0 / (far - near);
            (
                [
                    (right * sx).extend(-l * sx),
                    (-up * sy).extend(t * sy),
                    (forward * -k).extend(far * k),
                    DVec4::new(0.0, 0.0, 0.0, 1.0),
                ],
                0.0,
            )
        } else {
            (
                [
                    (right * sx - forward * (l * sx)).extend(0.0),
                    (-up * sy + forward * (t * sy)).extend(0.0),
                    DVec4::new(0.0, 0.0, 0.0, near),
                    forward.extend(0.0),
                ],
                if far.is_finite() { near / far } else { 0.0 },
            )
        };
        Ok(Self {
            eye: eye.world_from_eye.translation,
            rows,
            orthographic: projection.is_orthographic(),
            forward,
            far_depth,
            radius,
            // Moving sideways by e shifts a point at tangent x and distance z against infinity by e / z, moving
            // forward by e x / z; together at most e / z * sqrt(1 + x² + y²).
            shift_per_metre: if projection.is_orthographic() {
                0.0
            } else {
                let (x, y) = (l.abs().max(r.abs()), b.abs().max(t.abs()));
                sx.max(sy) * (1.0 + x * x + y * y).sqrt() / near
            },
            shift: if projection.is_orthographic() {
                [0.0; 2]
            } else {
                // The same along each axis: a step (sx, sy, sz) of the eye shifts a point at tangent x and distance z by
                // (sx - x sz) / z.
                let along = forward.dot(to_eye).abs();
                let axis = |scale: f64, side: DVec3, reach: f64| {
                    let step = side.dot(to_eye).abs() + reach * along;
                    let around = view.validity_radius_m * (1.0 + reach * reach).sqrt();
                    scale * (step + around) / near
                };
                [
                    axis(sx, right, l.abs().max(r.abs())),
                    axis(sy, up, b.abs().max(t.abs())),
                ]
            },
            clamp_depth,
            tan_half_fov_y: (t - b) * 0.5,
            near,
        })
    }

    /// Clip rows in the space of an object placed by `world_from_object`, with the object's points given
    /// relative to `center` (object space).
    pub(crate) fn object_rows(&self, world_from_object: &DAffine3, center: DVec3) -> [[f32; 4]; 4] {
        let m = DMat4::from(*world_from_object);
        let c = world_from_object.transform_point3(center) - self.eye;
        self.rows.map(|row| {
            let v = DVec3::new(
                row.truncate().dot(m.x_axis.truncate()),
                row.truncate().dot(m.y_axis.truncate()),
                row.truncate().dot(m.z_axis.truncate()),
            );
            let w = row.truncate().dot(c) + row.w;
            [v.x as f32, v.y as f32, v.z as f32, w as f32]
        })
    }

    /// Clip rows in the space of an object placed by `world_from_object`, not rounded.
    pub(crate) fn exact_rows(&self, world_from_object: &DAffine3) -> [[f64; 4]; 4] {
        let m = world_from_object.matrix3;
        let origin = world_from_object.translation - self.eye;
        self.rows.map(|row| {
            let r = row.truncate();
            [
                r.dot(m.x_axis),
                r.dot(m.y_axis),
                r.dot(m.z_axis),
                r.dot(origin) + row.w,
            ]
        })
    }
}

/// One eye in the middle that sees at least what both see, and the way from there to the second (to the first it is the
/// opposite).
fn join_eyes(a: &Eye, b: &Eye) -> Result<(Eye, DVec3), CullError> {
    if a.projection.is_orthographic() || b.projection.is_orthographic() {
        return Err(CullError::BadProjection);
    }
    let position = (a.position() + b.position()) * 0.5;
    let to_second = (b.position() - a.position()) * 0.5;
    // Middle orientation: the mean of the axes, made orthonormal again (eyes of a headset are canted by
    // some degrees at most).
    let (ma, mb) = (a.world_from_eye.matrix3, b.world_from_eye.matrix3);
    let back = (ma.z_axis + mb.z_axis)
        .try_normalize()
        .ok_or(CullError::BadProjection)?;
    let right = (ma.y_axis + mb.y_axis)
        .cross(back)
        .try_normalize()
        .ok_or(CullError::BadProjection)?;
    let rotation = DMat3::from_cols(right, back.cross(right), back);
    let mut extents = [
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ];
    let (mut near, mut far) = (0.0f64, 0.0f64);
    for eye in [a, b] {
        let [l, r, bottom, top] = eye.projection.extents();
        let [n, f] = eye.projection.near_far();
        for (x, y) in [(l, bottom), (r, bottom), (l, top), (r, top)] {
            let ray = rotation.transpose() * (eye.world_from_eye.matrix3 * DVec3::new(x, y, -1.0));
            if ray.z > -0.05 {
                return Err(CullError::BadProjection);
            }
            let (tx, ty) = (ray.x / -ray.z, ray.y / -ray.z);
            extents = [
                extents[0].min(tx),
                extents[1].max(tx),
                extents[2].min(ty),
                extents[3].max(ty),
            ];
            // Beyond every eye's near plane, and no nearer than any far plane, along the middle axis.
            near = near.max(n * -ray.z).max(n);
            far = far.max(f * -ray.z).max(f);
        }
    }
    let projection = Projection::Perspective {
        left: extents[0],
        right: extents[1],
        bottom: extents[2],
        top: extents[3],
        near,
        far,
    };
    Ok((
        Eye {
            world_from_eye: DAffine3::from_mat3_translation(rotation, position),
            projection,
        },
        to_second,
    ))
}

/// The frustum of the middle for all eyes within `radius`: somewhat wider, and with a near plane beyond every
/// eye's own (an occluder that one eye's near plane cuts must not count). Second, the depth up to which the
/// wider borders hold.
fn widen(projection: Projection, radius: f64) -> (Projection, f64) {
    /// Tangents.
    const MARGIN: f64 = 0.04;
    match projection {
        Projection::Perspective {
            left,
            right,
            bottom,
            top,
            near,
            far,
        } => {
            let (x, y) = (left.abs().max(right.abs()), bottom.abs().max(top.abs()));
            let tilt = (1.0 + x * x + y * y).sqrt();
            let near = near + radius;
            let holds_from = radius * tilt / MARGIN + radius;
            (
                Projection::Perspective {
                    left: left - MARGIN,
                    right: right + MARGIN,
                    bottom: bottom - MARGIN,
                    top: top + MARGIN,
                    near,
                    far: f64::INFINITY.min(far + radius),
                },
                near / holds_from,
            )
        }
        Projection::Orthographic {
            left,
            right,
            bottom,
            top,
            near,
            far,
        } => (
            Projection::Orthographic {
                left: left - radius,
                right: right + radius,
                bottom: bottom - radius,
                top: top + radius,
                near: near + radius,
                far: far + 2.0 * radius,
            },
            f64::INFINITY,
        ),
    }
}

/// The six planes of one eye's frustum, pushed outwards by `radius` (and by the rounding of boxes): a box that
/// is wholly behind one of them is outside. World space relative to `origin`: `n . p + d >= 0` is inside.
pub(crate) fn frustum_planes(eye: &Eye, radius: f64, origin: DVec3) -> [[f32; 4]; 6] {
    let [l, r, b, t] = eye.projection.extents();
    let [near, far] = eye.projection.near_far();
    let m = eye.world_from_eye.matrix3;
    let (right, up, forward) = (m.x_axis, m.y_axis, -m.z_axis);
    let far_plane = if far.is_finite() {
        (-forward, far)
    } else {
        (DVec3::ZERO, 1.0)
    };
    let planes = if eye.projection.is_orthographic() {
        [
            (right, -l),
            (-right, r),
            (up, -b),
            (-up, t),
            (forward, -near),
            far_plane,
        ]
    } else {
        [
            (right - forward * l, 0.0),
            (forward * r - right, 0.0),
            (up - forward * b, 0.0),
            (forward * t - up, 0.0),
            (forward, -near),
            far_plane,
        ]
    };
    planes.map(|(n, d)| {
        let from_eye = origin - eye.position();
        let push = n.length() * (radius + 1e-6 * from_eye.length());
        let d = d + n.dot(from_eye) + push;
        [
            n.x as f32,
            n.y as f32,
            n.z as f32,
            (d + d.abs() * 1e-6) as f32,
        ]
    })
}
