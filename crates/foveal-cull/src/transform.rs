//! Placements and matrices as plain numbers.
//!
//! Columns multiply column vectors. Names read from right to left: `world_from_mesh` takes mesh
//! space to world space.

use crate::error::{CullError, Quantity};
use glam::{DAffine3, DVec3, DVec4};

/// An affine map, for instance a placement in the world: three axes and a translation.
///
/// Twelve `f64` in a row. Made from an array of columns, from a matrix
/// ([`from_matrix`](Self::from_matrix)), or from types of glam with the feature `glam`.
///
/// ```
/// use foveal_cull::Affine;
///
/// let up = Affine::from_translation([0.0, 2.0, 0.0]);
/// let column_major = [
///     1.0, 0.0, 0.0, 0.0, //
///     0.0, 1.0, 0.0, 0.0, //
///     0.0, 0.0, 1.0, 0.0, //
///     0.0, 2.0, 0.0, 1.0_f32,
/// ];
/// assert_eq!(Affine::from_matrix(column_major)?, up);
/// # Ok::<(), foveal_cull::CullError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Affine {
    /// Image of the x axis.
    pub x_axis: [f64; 3],
    /// Image of the y axis.
    pub y_axis: [f64; 3],
    /// Image of the z axis.
    pub z_axis: [f64; 3],
    /// Image of the origin, metres.
    pub translation: [f64; 3],
}

impl Default for Affine {
    /// [`Affine::IDENTITY`].
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl From<[[f64; 3]; 4]> for Affine {
    /// The columns: three axes, then the translation.
    fn from([x_axis, y_axis, z_axis, translation]: [[f64; 3]; 4]) -> Self {
        Self {
            x_axis,
            y_axis,
            z_axis,
            translation,
        }
    }
}

impl Affine {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self {
        x_axis: [1.0, 0.0, 0.0],
        y_axis: [0.0, 1.0, 0.0],
        z_axis: [0.0, 0.0, 1.0],
        translation: [0.0; 3],
    };

    /// A translation, metres.
    #[must_use]
    pub fn from_translation(translation: impl Into<[f64; 3]>) -> Self {
        Self {
            translation: translation.into(),
            ..Self::IDENTITY
        }
    }

    /// The affine map of a 4x4 matrix.
    ///
    /// # Errors
    /// [`CullError::NotFinite`] for NaN or infinity, [`CullError::NotAffine`] if the last row is
    /// not 0, 0, 0, 1.
    pub fn from_matrix(matrix: impl Into<Matrix4>) -> Result<Self, CullError> {
        let matrix = matrix.into();
        if !matrix.is_finite() {
            return Err(CullError::NotFinite(Quantity::Transform));
        }
        let columns = matrix.columns;
        if columns.map(|c| c[3]) != [0.0, 0.0, 0.0, 1.0] {
            return Err(CullError::NotAffine);
        }
        Ok(columns.map(|[x, y, z, _]| [x, y, z]).into())
    }

    pub(crate) const fn of(map: &DAffine3) -> Self {
        Self {
            x_axis: map.matrix3.x_axis.to_array(),
            y_axis: map.matrix3.y_axis.to_array(),
            z_axis: map.matrix3.z_axis.to_array(),
            translation: map.translation.to_array(),
        }
    }

    pub(crate) const fn to_glam(self) -> DAffine3 {
        DAffine3::from_cols(
            DVec3::from_array(self.x_axis),
            DVec3::from_array(self.y_axis),
            DVec3::from_array(self.z_axis),
            DVec3::from_array(self.translation),
        )
    }
}

/// A 4x4 matrix, column by column, for instance from the world to clip space.
///
/// Made from arrays of `f32` or `f64`, flat or by columns, or from types of glam with the feature
/// `glam`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Matrix4 {
    /// The columns.
    pub columns: [[f64; 4]; 4],
}

impl Matrix4 {
    pub(crate) fn is_finite(&self) -> bool {
        self.columns.as_flattened().iter().all(|v| v.is_finite())
    }

    pub(crate) fn rows(&self) -> [DVec4; 4] {
        core::array::from_fn(|row| DVec4::from_array(self.columns.map(|c| c[row])))
    }
}

impl From<[[f64; 4]; 4]> for Matrix4 {
    fn from(columns: [[f64; 4]; 4]) -> Self {
        Self { columns }
    }
}

impl From<[[f32; 4]; 4]> for Matrix4 {
    fn from(columns: [[f32; 4]; 4]) -> Self {
        columns.map(|c| c.map(f64::from)).into()
    }
}

impl From<[f64; 16]> for Matrix4 {
    fn from(flat: [f64; 16]) -> Self {
        core::array::from_fn::<_, 4, _>(|c| core::array::from_fn::<_, 4, _>(|r| flat[4 * c + r]))
            .into()
    }
}

impl From<[f32; 16]> for Matrix4 {
    fn from(flat: [f32; 16]) -> Self {
        flat.map(f64::from).into()
    }
}

/// Conversions from and to glam's types.
#[cfg(feature = "glam")]
mod of_glam {
    use super::{Affine, Matrix4};
    use glam::{Affine3A, DAffine3, DMat4, Mat4};

    impl From<DAffine3> for Affine {
        fn from(map: DAffine3) -> Self {
            Self::of(&map)
        }
    }

    impl From<Affine3A> for Affine {
        fn from(map: Affine3A) -> Self {
            map.to_cols_array_2d().map(|c| c.map(f64::from)).into()
        }
    }

    impl From<Affine> for DAffine3 {
        fn from(map: Affine) -> Self {
            map.to_glam()
        }
    }

    impl From<DMat4> for Matrix4 {
        fn from(matrix: DMat4) -> Self {
            matrix.to_cols_array_2d().into()
        }
    }

    impl From<Mat4> for Matrix4 {
        fn from(matrix: Mat4) -> Self {
            matrix.to_cols_array_2d().into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_that_are_not_affine_are_refused() {
        let mut m = [0.0; 16];
        (m[0], m[5], m[10], m[15]) = (1.0, 1.0, 1.0, 1.0);
        m[12] = 7.0;
        let moved = Affine::from_translation([7.0, 0.0, 0.0]);
        assert_eq!(Affine::from_matrix(m), Ok(moved));
        assert_eq!(Affine::from_matrix(m.map(|v| v as f32)), Ok(moved));
        assert_eq!(Affine::of(&moved.to_glam()), moved);
        m[11] = -1.0;
        assert_eq!(Affine::from_matrix(m), Err(CullError::NotAffine));
        m[11] = f64::NAN;
        let nan = CullError::NotFinite(Quantity::Transform);
        assert_eq!(Affine::from_matrix(m), Err(nan));
    }
}
