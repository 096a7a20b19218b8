//! The camera: a checked view, reduced to one centre, one frustum and one radius.

use crate::error::{CullError, Quantity, ViewError};
use crate::transform::Affine;
use crate::view::{Eye, Projection, View};
use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};

/// Least radius around two eyes that differ, as a part of the near distance. Any radius makes
/// results hold at every point of the picture. This one shifts things at the near plane by some
/// thousandths of a sample, and is more than the rounding of the joined frustum.
const LEAST_RADIUS: f64 = 1e-6;

/// A checked view, reduced to one centre, one frustum and one radius.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    pub(crate) eye: DVec3,
    /// Rows X, Y, Z, W of clip space in *sample units*: `X / W` in `0..4 * width`, `Y / W`
    /// downwards, `Z / W` the depth (1 at near). They multiply `(world - eye, 1)`.
    pub(crate) rows: [DVec4; 4],
    pub(crate) orthographic: bool,
    /// View direction, world.
    pub(crate) forward: DVec3,
    /// Depth of the far plane; 0 if it is infinite.
    pub(crate) far_depth: f64,
    /// Radius around `eye` that the results hold for, metres.
    pub(crate) radius: f64,
    /// A box that is nowhere nearer than this depth may be cut at the edges of the buffer: no eye
    /// within the radius can see what lies beyond them.
    pub(crate) clamp_depth: f64,
    /// Shift of a point at depth 1 for one metre of eye movement, samples.
    pub(crate) shift_per_metre: f64,
    /// Largest shift of a point at depth 1 within the view region along x and y, samples.
    pub(crate) shift: [f64; 2],
    /// Tangent of half the vertical field of view, or half the height of an orthographic view.
    pub(crate) tan_half_fov_y: f64,
    pub(crate) near: f64,
    /// Distance from `eye` within which the near rectangles of all eyes of the view region lie,
    /// metres.
    pub(crate) near_reach: f64,
}

impl Camera {
    /// Checks a view and reduces it; `width` and `height` in samples.
    pub(crate) fn new(view: &View, width: f64, height: f64) -> Result<Self, CullError> {
        let (eye, to_eye) = center_of(view)?;
        let radius = radius_of(view, &eye, to_eye);
        let (projection, clamp_depth) = if radius > 0.0 {
            widen(eye.projection, radius)
        } else {
            (eye.projection, f64::INFINITY)
        };
        let orthographic = projection.is_orthographic();
        let lens = Lens::new(&eye, &projection, [width, height]);
        let terms = if orthographic {
            lens.orthographic_terms()
        } else {
            lens.perspective_terms(to_eye, view.validity_radius_m)
        };
        // The view's own, not that of the widened frustum: thresholds of size go by it.
        let [_, _, bottom, top] = eye.projection.extents();
        Ok(Self {
            eye: eye.position().into(),
            rows: terms.rows,
            orthographic,
            forward: lens.forward,
            far_depth: terms.far_depth,
            radius,
            clamp_depth,
            shift_per_metre: terms.shift_per_metre,
            shift: terms.shift,
            tan_half_fov_y: (top - bottom) * 0.5,
            near: lens.near,
            near_reach: terms.near_corner.length() + radius,
        })
    }

    /// Clip rows in the space of an object placed by `world_from_object`, for points relative to
    /// `center` (object space).
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

    /// Clip rows in the space of an object placed by `world_from_object`, in `f64`.
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

/// A frustum with its axes in the world, and what is asked of it more than once.
struct Lens {
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Left, right, bottom and top: tangents, or metres if orthographic.
    extents: [f64; 4],
    /// Largest of the extents along x and along y.
    widest: [f64; 2],
    /// Samples per unit of the extents along x and along y.
    samples: [f64; 2],
    near: f64,
    far: f64,
}

/// What depends on whether a frustum is perspective or orthographic; see [`Camera`].
struct ProjectionTerms {
    rows: [DVec4; 4],
    far_depth: f64,
    shift_per_metre: f64,
    shift: [f64; 2],
    /// The corner of the near rectangle that is farthest from the eye, in the eye's axes, metres.
    near_corner: DVec3,
}

impl Lens {
    fn new(eye: &Eye, projection: &Projection, [width, height]: [f64; 2]) -> Self {
        let extents = projection.extents();
        let [l, r, b, t] = extents;
        let [near, far] = projection.near_far_m();
        let m = eye.pose().matrix3;
        Self {
            right: m.x_axis,
            up: m.y_axis,
            forward: -m.z_axis,
            extents,
            widest: widest(extents),
            // Screen x in 0..width; perspective: ((x/d) - l) / (r - l) * width.
            samples: [width / (r - l), height / (t - b)],
            near,
            far,
        }
    }

    /// Of an orthographic frustum.
    fn orthographic_terms(&self) -> ProjectionTerms {
        let ([l, _, _, t], [sx, sy], [x, y]) = (self.extents, self.samples, self.widest);
        let k = 1.0 / (self.far - self.near);
        ProjectionTerms {
            rows: [
                (self.right * sx).extend(-l * sx),
                (-self.up * sy).extend(t * sy),
                (self.forward * -k).extend(self.far * k),
                DVec4::new(0.0, 0.0, 0.0, 1.0),
            ],
            far_depth: 0.0,
            shift_per_metre: 0.0,
            shift: [0.0; 2],
            near_corner: DVec3::new(x, y, self.near),
        }
    }

    /// Of a perspective frustum, whose eyes lie within `radius_m` of `to_eye` and of its opposite.
    fn perspective_terms(&self, to_eye: DVec3, radius_m: f64) -> ProjectionTerms {
        let ([l, _, _, t], [sx, sy], [x, y]) = (self.extents, self.samples, self.widest);
        let (near, far) = (self.near, self.far);
        // Moving sideways by e shifts a point at tangent x and distance z by e / z against
        // infinity, moving forward by e x / z; together at most e / z * sqrt(1 + x² + y²).
        let shift_per_metre = sx.max(sy) * (1.0 + x * x + y * y).sqrt() / near;
        // The same along each axis: a step (sx, sy, sz) of the eye shifts a point at tangent x and
        // distance z by (sx - x sz) / z.
        let along = self.forward.dot(to_eye).abs();
        let shift = |samples: f64, side: DVec3, reach: f64| {
            let step = side.dot(to_eye).abs() + reach * along;
            let around = radius_m * (1.0 + reach * reach).sqrt();
            samples * (step + around) / near
        };
        ProjectionTerms {
            rows: [
                (self.right * sx - self.forward * (l * sx)).extend(0.0),
                (-self.up * sy + self.forward * (t * sy)).extend(0.0),
                DVec4::new(0.0, 0.0, 0.0, near),
                self.forward.extend(0.0),
            ],
            far_depth: if far.is_finite() { near / far } else { 0.0 },
            shift_per_metre,
            shift: [shift(sx, self.right, x), shift(sy, self.up, y)],
            near_corner: DVec3::new(x, y, 1.0) * near,
        }
    }
}

/// Largest extent along x and along y.
fn widest([left, right, bottom, top]: [f64; 4]) -> [f64; 2] {
    [left.abs().max(right.abs()), bottom.abs().max(top.abs())]
}

/// The centre eye of a checked view, and the way from it to the second eye.
fn center_of(view: &View) -> Result<(Eye, DVec3), CullError> {
    view.eye.check()?;
    if !view.validity_radius_m.is_finite() {
        return Err(CullError::NotFinite(Quantity::ValidityRadius));
    }
    if view.validity_radius_m < 0.0 {
        return Err(CullError::Negative(Quantity::ValidityRadius));
    }
    match view.second_eye {
        None => Ok((view.eye, DVec3::ZERO)),
        Some(second) => {
            second.check()?;
            join_eyes(&view.eye, &second)
        }
    }
}

/// The radius around the centre eye within which all eyes of a view may be.
fn radius_of(view: &View, center: &Eye, to_eye: DVec3) -> f64 {
    let radius = to_eye.length() + view.validity_radius_m;
    match view.second_eye {
        // Samples of the joined frustum are neither eye's own, so that results must hold between
        // them.
        Some(second) if second != view.eye => {
            radius.max(LEAST_RADIUS * center.projection.near_far_m()[0])
        }
        _ => radius,
    }
}

/// The centre eye, which sees at least what both eyes see, and the way from it to the second eye.
/// The way to the first is the opposite.
fn join_eyes(a: &Eye, b: &Eye) -> Result<(Eye, DVec3), CullError> {
    if a.projection.is_orthographic() || b.projection.is_orthographic() {
        return Err(CullError::BadView(ViewError::StereoNotPerspective));
    }
    let too_far_apart = CullError::BadView(ViewError::EyesTooFarApart);
    let (from, to) = (DVec3::from(a.position()), DVec3::from(b.position()));
    let position = (from + to) * 0.5;
    let to_second = (to - from) * 0.5;
    // The orientation is the mean of both, made orthonormal again. (The eyes of a headset are
    // canted by some degrees at most.)
    let (ma, mb) = (a.pose().matrix3, b.pose().matrix3);
    let back = (ma.z_axis + mb.z_axis)
        .try_normalize()
        .ok_or(too_far_apart)?;
    let right = (ma.y_axis + mb.y_axis)
        .cross(back)
        .try_normalize()
        .ok_or(too_far_apart)?;
    let rotation = DMat3::from_cols(right, back.cross(right), back);
    let mut extents = [
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ];
    let (mut near, mut far) = (0.0f64, 0.0f64);
    for (eye, m) in [(a, ma), (b, mb)] {
        let [l, r, bottom, top] = eye.projection.extents();
        let [n, f] = eye.projection.near_far_m();
        for (x, y) in [(l, bottom), (r, bottom), (l, top), (r, top)] {
            let ray = rotation.transpose() * (m * DVec3::new(x, y, -1.0));
            if ray.z > -0.05 {
                return Err(too_far_apart);
            }
            let (tx, ty) = (ray.x / -ray.z, ray.y / -ray.z);
            extents = [
                extents[0].min(tx),
                extents[1].max(tx),
                extents[2].min(ty),
                extents[3].max(ty),
            ];
            // Beyond every eye's near plane, and no nearer than any far plane, along the centre
            // eye's axis.
            near = near.max(n * -ray.z).max(n);
            far = far.max(f * -ray.z).max(f);
        }
    }
    let projection = Projection::Perspective {
        left: extents[0],
        right: extents[1],
        bottom: extents[2],
        top: extents[3],
        near_m: near,
        far_m: far,
    };
    Ok((
        Eye {
            world_from_eye: Affine::of(&DAffine3::from_mat3_translation(rotation, position)),
            projection,
        },
        to_second,
    ))
}

/// The centre eye's frustum for all eyes within `radius`, and the depth up to which it holds. It is
/// somewhat wider, and its near plane lies beyond every eye's own, since an occluder that one eye's
/// near plane cuts must not count.
fn widen(projection: Projection, radius: f64) -> (Projection, f64) {
    /// Growth on each side, as a tangent.
    const MARGIN: f64 = 0.04;
    match projection {
        Projection::Perspective {
            left,
            right,
            bottom,
            top,
            near_m: near,
            far_m: far,
        } => {
            let [x, y] = widest([left, right, bottom, top]);
            let tilt = (1.0 + x * x + y * y).sqrt();
            let near = near + radius;
            let holds_from = radius * tilt / MARGIN + radius;
            (
                Projection::Perspective {
                    left: left - MARGIN,
                    right: right + MARGIN,
                    bottom: bottom - MARGIN,
                    top: top + MARGIN,
                    near_m: near,
                    far_m: f64::INFINITY.min(far + radius),
                },
                near / holds_from,
            )
        }
        Projection::Orthographic {
            left,
            right,
            bottom,
            top,
            near_m: near,
            far_m: far,
        } => (
            Projection::Orthographic {
                left: left - radius,
                right: right + radius,
                bottom: bottom - radius,
                top: top + radius,
                near_m: near + radius,
                far_m: far + 2.0 * radius,
            },
            f64::INFINITY,
        ),
    }
}

/// The six frustum planes of one eye, relative to `origin` (world), pushed outwards by `radius` and
/// by the rounding of boxes. `n . p + d >= 0` is inside; a box wholly behind one of them is
/// outside.
pub(crate) fn frustum_planes(eye: &Eye, radius: f64, origin: DVec3) -> [[f32; 4]; 6] {
    let [l, r, b, t] = eye.projection.extents();
    let [near, far] = eye.projection.near_far_m();
    let m = eye.pose().matrix3;
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
        let from_eye = origin - DVec3::from(eye.position());
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
