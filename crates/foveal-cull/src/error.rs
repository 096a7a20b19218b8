//! Errors: what is wrong with an input, and why.

use core::fmt;

/// The reason why a call was refused.
///
/// This crate does not panic on input. A call that fails leaves the object as it was, except for
/// [`Culler::rasterize`](crate::Culler::rasterize), after which everything counts as visible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CullError {
    /// A buffer side of 0 pixels, or of more than [`MAX_SIDE_PX`](crate::MAX_SIDE_PX).
    #[non_exhaustive]
    BadSize {
        /// Requested width, pixels.
        width_px: u32,
        /// Requested height, pixels.
        height_px: u32,
    },
    /// A shadow map of 0 texels per side, or of more than four times
    /// [`MAX_SIDE_PX`](crate::MAX_SIDE_PX).
    #[non_exhaustive]
    BadShadowMap {
        /// Requested side, texels.
        side_px: u32,
    },
    /// A reference of 0 samples per side, or of more than four times
    /// [`MAX_SIDE_PX`](crate::MAX_SIDE_PX).
    #[non_exhaustive]
    BadReference {
        /// Requested width, samples.
        width: u32,
        /// Requested height, samples.
        height: u32,
    },
    /// A number is NaN or infinite where it must be finite.
    NotFinite(Quantity),
    /// A number is zero or less where it must be above zero.
    NotPositive(Quantity),
    /// A number is less than zero where it must not be.
    Negative(Quantity),
    /// A view cannot be culled for.
    BadView(ViewError),
    /// The length of an index list is not a multiple of three.
    #[non_exhaustive]
    NotTriangles {
        /// Length of the list.
        indices: usize,
    },
    /// An index is past the end of the positions.
    #[non_exhaustive]
    IndexOutOfRange {
        /// The first such index.
        index: u32,
        /// Number of positions.
        positions: usize,
    },
    /// Two lists that belong together differ in length.
    #[non_exhaustive]
    LengthMismatch {
        /// Length that was needed.
        expected: usize,
        /// Length that was given.
        found: usize,
    },
    /// The set has no occluder with this id, for instance since it was removed.
    UnknownOccluder,
    /// The set has no occludee with this id, for instance since it was removed.
    UnknownOccludee,
    /// The smallest corner of a box to be baked is larger than its largest one in some axis.
    InsideOut,
    /// A mesh was not baked to be given new positions
    /// ([`BakeOptions::deformable`](crate::BakeOptions::deformable)).
    NotDeformable,
    /// The last row of a transform's matrix is not 0, 0, 0, 1.
    NotAffine,
    /// A mesh has too many triangles for the 32-bit offsets of a baked mesh.
    #[non_exhaustive]
    TooManyTriangles {
        /// Number of triangles.
        triangles: usize,
        /// Largest number that can be baked.
        most: usize,
    },
    /// Bytes are not a baked mesh.
    BadMeshBytes(MeshBytesError),
}

/// The reason why bytes are not a baked mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshBytesError {
    /// They do not begin as a baked mesh does.
    NotAMesh,
    /// They were written in another version of the format. Bake the mesh again.
    #[non_exhaustive]
    OtherVersion {
        /// The version that they were written in.
        found: u32,
        /// The version that this library reads.
        known: u32,
    },
    /// Some are missing, or there are too many.
    #[non_exhaustive]
    WrongLength {
        /// Number of bytes that the mesh has.
        expected: u64,
        /// Number that was given.
        found: u64,
    },
    /// The checksum says that they were changed.
    Corrupt,
    /// The checksum is right, but they do not describe a mesh. The text says why.
    Invalid(&'static str),
}

/// An input that consists of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quantity {
    /// A vertex position of a mesh, or a height.
    Position,
    /// The distance between the samples of a grid of heights.
    Spacing,
    /// The transform of an occluder.
    Transform,
    /// The pose of an eye.
    Pose,
    /// A matrix from the world to clip space.
    ClipMatrix,
    /// An extent or a distance of a projection. (A perspective far distance may be infinite.)
    Projection,
    /// The validity radius of a view.
    ValidityRadius,
}

/// The reason why a view is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ViewError {
    /// `left` is not less than `right`, or `bottom` not less than `top`.
    EmptyExtents,
    /// The near distance of a perspective projection is not above zero.
    NearNotPositive,
    /// The far distance is not larger than the near distance.
    FarNotBeyondNear,
    /// The far distance of an orthographic projection is infinite.
    FarNotFinite,
    /// A pose scales, shears or mirrors.
    PoseNotRigid,
    /// One of two eyes is orthographic.
    StereoNotPerspective,
    /// The two eyes look in directions that no common view covers.
    EyesTooFarApart,
    /// A matrix to clip space is singular, or shows no volume.
    NoVolume,
    /// A matrix to clip space shears the picture, or its near plane is not perpendicular to the
    /// view direction.
    Oblique,
}

impl CullError {
    /// Checks that a list has the length that another one, or an object, asks for.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if `found` is not `expected`.
    pub const fn check_length(expected: usize, found: usize) -> Result<(), Self> {
        if found == expected {
            Ok(())
        } else {
            Err(Self::LengthMismatch { expected, found })
        }
    }
}

impl fmt::Display for CullError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::BadSize {
                width_px,
                height_px,
            } => write!(
                f,
                "occlusion buffer of {width_px} x {height_px} pixels: each side must be 1 to {} pixels",
                crate::limits::MAX_SIDE_PX
            ),
            Self::BadShadowMap { side_px } => write!(
                f,
                "shadow map of {side_px} texels per side: must be 1 to {}",
                4 * crate::limits::MAX_SIDE_PX
            ),
            Self::BadReference { width, height } => write!(
                f,
                "reference of {width} x {height} samples: each side must be 1 to {} samples",
                4 * crate::limits::MAX_SIDE_PX
            ),
            Self::NotFinite(quantity) => write!(f, "{quantity} must be finite"),
            Self::NotPositive(quantity) => write!(f, "{quantity} must be above zero"),
            Self::Negative(quantity) => write!(f, "{quantity} must not be negative"),
            Self::BadView(_) => f.write_str("the view cannot be culled for"),
            Self::NotTriangles { indices } => {
                write!(f, "{indices} indices are not a whole number of triangles")
            }
            Self::IndexOutOfRange { index, positions } => {
                write!(f, "index {index} is past the end of {positions} positions")
            }
            Self::LengthMismatch { expected, found } => {
                write!(f, "a list has length {found} where {expected} is needed")
            }
            Self::UnknownOccluder => f.write_str("the set has no occluder with this id"),
            Self::UnknownOccludee => f.write_str("the set has no occludee with this id"),
            Self::InsideOut => f.write_str("a box has a min above its max"),
            Self::NotDeformable => f.write_str("the mesh was not baked to be deformed"),
            Self::NotAffine => f.write_str("the last row of a transform must be 0, 0, 0, 1"),
            Self::TooManyTriangles { triangles, most } => {
                write!(
                    f,
                    "a mesh of {triangles} triangles: at most {most} can be baked"
                )
            }
            Self::BadMeshBytes(_) => f.write_str("the bytes are not a baked mesh"),
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "a vertex position",
            Self::Spacing => "the spacing of heights",
            Self::Transform => "the transform of an occluder",
            Self::Pose => "the pose of an eye",
            Self::ClipMatrix => "a matrix from the world to clip space",
            Self::Projection => "a projection's extents and distances",
            Self::ValidityRadius => "the validity radius",
        })
    }
}

impl fmt::Display for ViewError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::EmptyExtents => "left must be less than right, and bottom less than top",
            Self::NearNotPositive => {
                "the near distance of a perspective projection must be above zero"
            }
            Self::FarNotBeyondNear => "the far distance must be larger than the near distance",
            Self::FarNotFinite => "the far distance of an orthographic projection must be finite",
            Self::PoseNotRigid => "the pose must be a rotation and a translation only",
            Self::StereoNotPerspective => "both of two eyes must have perspective projections",
            Self::EyesTooFarApart => "two eyes look in directions that no common view covers",
            Self::NoVolume => "the matrix to clip space is singular or shows no volume",
            Self::Oblique => {
                "the matrix to clip space must not shear, and its near plane must be \
                 perpendicular to the view direction"
            }
        })
    }
}

impl fmt::Display for MeshBytesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotAMesh => f.write_str("they do not begin as a baked mesh does"),
            Self::OtherVersion { found, known } => write!(
                f,
                "they have version {found} of the format, and this library reads version {known}: \
                 bake the mesh again"
            ),
            Self::WrongLength { expected, found } => {
                write!(f, "there are {found} of them where {expected} are needed")
            }
            Self::Corrupt => f.write_str("their checksum is wrong, so they were changed"),
            Self::Invalid(what) => f.write_str(what),
        }
    }
}

impl core::error::Error for MeshBytesError {}

impl core::error::Error for ViewError {}

impl core::error::Error for CullError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::BadView(cause) => Some(cause),
            Self::BadMeshBytes(cause) => Some(cause),
            _ => None,
        }
    }
}
