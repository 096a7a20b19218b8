//! Formats of meshes that are not glTF: they become a GLB in memory, which the importer then checks
//! and completes (normals, tangents, mip levels, limits) as it does any other.

mod builder;
mod obj;
mod ply;

#[cfg(test)]
mod tests;

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::gltf::Resolver;
use crate::{SceneError, Warning};

/// A format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Wavefront OBJ with MTL materials.
    Obj,
    /// The Stanford polygon format.
    Ply,
}

impl Format {
    /// The format of a file by its ending, or by its first line where it is a PLY file.
    pub(crate) fn of(name: &str, bytes: &[u8]) -> Option<Self> {
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
        if ending.eq_ignore_ascii_case("obj") {
            Some(Self::Obj)
        } else if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            Some(Self::Ply)
        } else {
            None
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
        }
    }

    /// The same scene as a GLB file, and what it leaves out.
    pub(crate) fn to_glb(
        self,
        bytes: &[u8],
        file: &str,
        resolver: &Resolver<'_>,
    ) -> Result<(Vec<u8>, Vec<Warning>), SceneError> {
        let convert = || match self {
            Self::Obj => obj::convert(bytes, resolver),
            Self::Ply => ply::convert(bytes),
        };
        // The decoders promise not to panic; should they, this file is broken and nothing else.
        catch_unwind(AssertUnwindSafe(convert))
            .unwrap_or_else(|_| Err("the decoder failed".to_owned()))
            .map_err(|cause| SceneError::NotMesh {
                file: file.to_owned(),
                format: self.name(),
                cause,
            })
    }
}
