//! The triangles' own normals.

use crate::{Antialiasing, EdgeTest, Settings};

/// What the geometry pass writes besides the surfaces as they are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FaceNormals {
    Omitted,
    /// The triangles' own normals, for telling planes apart.
    Written,
}

impl FaceNormals {
    /// What these settings need.
    pub(crate) fn wanted_by(settings: &Settings) -> Self {
        match (settings.antialiasing.mode, settings.antialiasing.edge_test) {
            // Triangles are asked for theirs where they matter.
            _ if crate::antialias::by_triangles(settings) => Self::Omitted,
            (Antialiasing::Msaa, EdgeTest::Surface) => Self::Written,
            _ => Self::Omitted,
        }
    }
}
