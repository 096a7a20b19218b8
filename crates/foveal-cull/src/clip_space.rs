//! Eyes and views from a matrix to clip space.
//!
//! Clip space is that of the graphics APIs: visible points have `-w <= x <= w` and `-w <= y <= w`,
//! and `z / w` between the depths of the near and the far plane. The matrix is taken apart into a
//! pose and a frustum; nothing of it is approximated. A matrix whose picture is sheared, or whose
//! near plane is not perpendicular to the view direction, is refused.

use crate::error::{CullError, Quantity, ViewError};
use crate::transform::{Affine, Matrix4};
use crate::view::{Eye, Projection, View};
use glam::{DAffine3, DMat3, DVec3, DVec4};

/// The depths of the near and the far plane in clip space, `z / w`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ClipDepth {
    /// 0 at the near plane, 1 at the far plane: Vulkan, Direct3D, Metal, WebGPU.
    ZeroToOne,
    /// 1 at the near plane, 0 at the far plane or at infinity: reversed depth.
    OneToZero,
    /// -1 at the near plane, 1 at the far plane: OpenGL.
    MinusOneToOne,
}

impl ClipDepth {
    fn near_far(self) -> [f64; 2] {
        match self {
            Self::ZeroToOne => [0.0, 1.0],
            Self::OneToZero => [1.0, 0.0],
            Self::MinusOneToOne => [-1.0, 1.0],
        }
    }
}

/// Largest cosine between axes that count as perpendicular.
const PERPENDICULAR: f64 = 1e-4;

/// More than the relative rounding of matrices in `f32`.
const ROUNDING: f64 = 1e-6;

impl Eye {
    /// The eye that a matrix from the world to clip space belongs to.
    ///
    /// The matrix may be perspective or orthographic, asymmetric, with the far plane at infinity,
    /// with y up or down on the screen, and for a right- or a left-handed world. Its edges are
    /// those of the picture.
    ///
    /// What counts as the front of a triangle does not depend on the handedness: the side that
    /// `(b - a) x (c - a)` points to. That is counter-clockwise in a right-handed world, and
    /// clockwise in a left-handed one, as Direct3D and Unity have it. In a left-handed world the
    /// rows of [`Culler::read_depth`](crate::Culler::read_depth) count from the bottom.
    ///
    /// A matrix of `f32` loses what the renderer's own loses where the eye is far from the world's
    /// origin; add the way to [`world_from_eye`](Self::world_from_eye) afterwards where matrices
    /// are relative to the camera. The far plane is moved outwards by the rounding of `f32`.
    ///
    /// # Errors
    /// [`CullError::NotFinite`] for NaN or infinity. [`CullError::BadView`] with
    /// [`ViewError::NoVolume`] for a singular matrix, [`ViewError::Oblique`] for one that shears or
    /// has an oblique near plane, and the errors of [`Projection`]'s distances, for instance
    /// [`ViewError::FarNotBeyondNear`] where `depth` is not that of the matrix.
    ///
    /// ```
    /// use foveal_cull::{ClipDepth, Eye, Projection};
    ///
    /// // 90 degrees, near plane at 0.5 m, reversed depth, infinite: at the origin, along -z.
    /// let matrix = [
    ///     1.0, 0.0, 0.0, 0.0, //
    ///     0.0, 1.0, 0.0, 0.0, //
    ///     0.0, 0.0, 0.0, -1.0, //
    ///     0.0, 0.0, 0.5, 0.0_f32,
    /// ];
    /// let eye = Eye::from_clip_from_world(matrix, ClipDepth::OneToZero)?;
    /// assert_eq!(eye.projection.near_far_m(), [0.5, f64::INFINITY]);
    /// assert_eq!(eye.projection.extents(), [-1.0, 1.0, -1.0, 1.0]);
    /// # Ok::<(), foveal_cull::CullError>(())
    /// ```
    pub fn from_clip_from_world(
        clip_from_world: impl Into<Matrix4>,
        depth: ClipDepth,
    ) -> Result<Self, CullError> {
        let matrix = clip_from_world.into();
        if !matrix.is_finite() {
            return Err(CullError::NotFinite(Quantity::ClipMatrix));
        }
        let rows = matrix.rows();
        let eye = if rows[3].truncate() == DVec3::ZERO {
            orthographic(rows, depth)
        } else {
            perspective(rows, depth)
        };
        let eye = eye.map_err(CullError::BadView)?;
        eye.check()?;
        Ok(eye)
    }
}

impl View {
    /// One eye at its exact position, from a matrix from the world to clip space:
    /// [`Eye::from_clip_from_world`].
    ///
    /// # Errors
    /// Those of [`Eye::from_clip_from_world`].
    pub fn from_clip_from_world(
        clip_from_world: impl Into<Matrix4>,
        depth: ClipDepth,
    ) -> Result<Self, CullError> {
        Eye::from_clip_from_world(clip_from_world, depth).map(Self::mono)
    }
}

/// One axis of the picture: its direction in the world, its scale, and the picture's centre.
struct Axis {
    direction: DVec3,
    scale: f64,
    center: f64,
}

impl Axis {
    /// `along` belongs to the view direction and is not part of the axis.
    fn new(row: DVec3, along: DVec3) -> Result<Self, ViewError> {
        let center = row.dot(along);
        let across = row - along * center;
        let scale = across.length();
        let direction = across / scale;
        let usable = scale.is_normal() && direction.is_finite() && (1.0 / scale).is_finite();
        usable
            .then_some(Self {
                direction,
                scale,
                center,
            })
            .ok_or(ViewError::NoVolume)
    }

    /// The picture's edges, at -1 and at 1.
    fn edges(&self) -> [f64; 2] {
        [-1.0, 1.0].map(|edge| (edge - self.center) / self.scale)
    }
}

/// Pose and extents. The pose is right-handed: in a left-handed world, and where y points down, the
/// picture is upside down.
fn pose(
    position: DVec3,
    x: &Axis,
    y: &Axis,
    forward: DVec3,
) -> Result<(DAffine3, [f64; 4]), ViewError> {
    let back = -forward;
    let parallel = |a: DVec3, b: DVec3| a.dot(b).abs() > PERPENDICULAR;
    if parallel(x.direction, y.direction) {
        return Err(ViewError::Oblique);
    }
    let up = back
        .cross(x.direction)
        .try_normalize()
        .ok_or(ViewError::NoVolume)?;
    let ([left, right], [low, high]) = (x.edges(), y.edges());
    let (bottom, top) = if y.direction.dot(up) > 0.0 {
        (low, high)
    } else {
        (-high, -low)
    };
    let rotation = DMat3::from_cols(up.cross(back), up, back);
    Ok((
        DAffine3::from_mat3_translation(rotation, position),
        [left, right, bottom, top],
    ))
}

/// The point at which three rows vanish.
fn common_zero(rows: [DVec4; 3]) -> Result<DVec3, ViewError> {
    let normals = DMat3::from_cols(rows[0].truncate(), rows[1].truncate(), rows[2].truncate());
    let point = normals.transpose().inverse() * -DVec3::from_array(rows.map(|r| r.w));
    point
        .is_finite()
        .then_some(point)
        .ok_or(ViewError::NoVolume)
}

fn perspective(rows: [DVec4; 4], depth: ClipDepth) -> Result<Eye, ViewError> {
    // With w as the distance along the view direction.
    let scale = 1.0 / rows[3].truncate().length();
    let [x, y, z, w] = rows.map(|r| r * scale);
    let forward = w.truncate();
    if !(scale.is_finite() && forward.is_finite()) {
        return Err(ViewError::NoVolume);
    }
    let axes = [
        Axis::new(x.truncate(), forward)?,
        Axis::new(y.truncate(), forward)?,
    ];
    let position = common_zero([x, y, w])?;
    let (world_from_eye, [left, right, bottom, top]) = pose(position, &axes[0], &axes[1], forward)?;
    // Depth is a + b / distance.
    let (a, b) = (z.truncate().dot(forward), z.truncate().dot(position) + z.w);
    if !(b.is_normal() && (1.0 / b).is_finite()) {
        return Err(ViewError::NoVolume);
    }
    let [near, far] = depth.near_far();
    // The near plane's normal, which must be the view direction.
    let normal = z.truncate() - forward * near;
    let across = normal - forward * normal.dot(forward);
    if across.length() > PERPENDICULAR * normal.length() {
        return Err(ViewError::Oblique);
    }
    let inverse_near = (near - a) / b;
    if inverse_near <= 0.0 {
        return Err(ViewError::NearNotPositive);
    }
    let inverse_far = (far - a) / b;
    let outwards = inverse_far - ROUNDING * (far.abs() + a.abs()) / b.abs();
    if inverse_far >= inverse_near {
        return Err(ViewError::FarNotBeyondNear);
    }
    Ok(Eye {
        world_from_eye: Affine::of(&world_from_eye),
        projection: Projection::Perspective {
            left,
            right,
            bottom,
            top,
            near_m: 1.0 / inverse_near,
            far_m: if outwards > 0.0 {
                1.0 / outwards
            } else {
                f64::INFINITY
            },
        },
    })
}

fn orthographic(rows: [DVec4; 4], depth: ClipDepth) -> Result<Eye, ViewError> {
    if rows[3].w <= 0.0 {
        return Err(ViewError::NoVolume);
    }
    let [x, y, z, _] = rows.map(|r| r / rows[3].w);
    let [near, far] = depth.near_far();
    let per_metre = z.truncate().length();
    let forward = z.truncate() / per_metre * (far - near).signum();
    if !forward.is_finite() || per_metre == 0.0 {
        return Err(ViewError::NoVolume);
    }
    // The eye is the centre of the near rectangle.
    let position = common_zero([x, y, DVec4::new(z.x, z.y, z.z, z.w - near)])?;
    let axes = [
        Axis::new(x.truncate(), DVec3::ZERO)?,
        Axis::new(y.truncate(), DVec3::ZERO)?,
    ];
    if axes
        .iter()
        .any(|axis| axis.direction.dot(forward).abs() > PERPENDICULAR)
    {
        return Err(ViewError::Oblique);
    }
    let (world_from_eye, [left, right, bottom, top]) = pose(position, &axes[0], &axes[1], forward)?;
    Ok(Eye {
        world_from_eye: Affine::of(&world_from_eye),
        projection: Projection::Orthographic {
            left,
            right,
            bottom,
            top,
            near_m: 0.0,
            far_m: ((far - near).abs() + ROUNDING * (1.0 + z.w.abs())) / per_metre,
        },
    })
}
