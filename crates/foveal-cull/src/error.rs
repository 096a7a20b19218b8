//! What can be wrong with the input.

use core::fmt;

/// Everything that this crate refuses. Nothing here panics on input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CullError {
    /// A buffer size of zero or above 16,384 pixels in one axis.
    BadSize {
        /// Requested width, pixels.
        width: u32,
        /// Requested height, pixels.
        height: u32,
    },
    /// A view, transform or position holds NaN or infinity.
    NotFinite,
    /// A projection is empty or inside out, or its near plane is not in front of the eye.
    BadProjection,
    /// The length of an index list is not a multiple of three.
    NotTriangles {
        /// The length given.
        indices: usize,
    },
    /// An index is past the end of the positions.
    IndexOutOfRange {
        /// The offending index.
        index: u32,
        /// How many positions there are.
        positions: usize,
    },
    /// A slice for results is not as long as the list of things asked about.
    LengthMismatch {
        /// What was needed.
        expected: usize,
        /// What was given.
        found: usize,
    },
    /// An occluder id that this set never gave out, or that was removed.
    UnknownOccluder,
    /// A mesh has more triangles than fit into 32-bit offsets.
    TooLarge,
}

impl fmt::Display for CullError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::BadSize { width, height } => write!(
                f,
                "depth buffer of {width} x {height} pixels: each side must be 1 to 16384"
            ),
            Self::NotFinite => f.write_str("a position, transform or view holds NaN or infinity"),
            Self::BadProjection => {
                f.write_str("the projection is empty, inside out, or has no positive near distance")
            }
            Self::NotTriangles { indices } => {
                write!(f, "{indices} indices are not a whole number of triangles")
            }
            Self::IndexOutOfRange { index, positions } => {
                write!(f, "index {index} is past the end of {positions} positions")
            }
            Self::LengthMismatch { expected, found } => {
                write!(f, "result slice has length {found}, needed {expected}")
            }
            Self::UnknownOccluder => f.write_str("no occluder has this id"),
            Self::TooLarge => f.write_str("the mesh has too many triangles for 32-bit offsets"),
        }
    }
}

impl core::error::Error for CullError {}
