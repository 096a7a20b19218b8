//! Formats of meshes that are not glTF: they become a GLB in memory, which the importer then checks
//! and completes (normals, tangents, mip levels, limits) as it does any other.

mod builder;
mod libraries;
mod lines;
mod mtl;
mod numbers;
mod obj;
mod ply;
mod ply_elements;
mod ply_faces;
mod ply_header;
mod ply_text;
mod polygons;
mod smoothing;

#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::error::Limit;
use crate::gltf::{Budget, Resolver};
use crate::{LoadOptions, SceneError, Warning, srgb};

/// A format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Wavefront OBJ with MTL materials.
    Obj,
    /// The Stanford polygon format.
    Ply,
}

/// A file as a GLB in memory.
pub(crate) struct Converted {
    pub(crate) glb: Vec<u8>,
    /// What it leaves out.
    pub(crate) notes: Vec<Warning>,
    /// Of paths of pictures: where a picture may lie instead, in order.
    elsewhere: HashMap<String, Vec<String>>,
}

impl Converted {
    /// The bytes of a file that the GLB names.
    pub(crate) fn resolve(&self, path: &str, resolver: &Resolver<'_>) -> Result<Vec<u8>, String> {
        resolver(path).or_else(|cause| {
            let others = self.elsewhere.get(path).into_iter().flatten();
            let mut found = others.filter_map(|other| resolver(other).ok());
            found.next().ok_or(cause)
        })
    }
}

/// Why a file cannot be converted.
pub(crate) enum Refusal {
    /// It is not of the format.
    Broken(String),
    /// It asks for more than a limit, where it has one of the options.
    TooLarge(Option<Limit>, String),
}

impl From<String> for Refusal {
    fn from(cause: String) -> Self {
        Self::Broken(cause)
    }
}

impl Format {
    /// The format of a file by its ending, or by its first line where it is a PLY file.
    pub(crate) fn of(name: &str, bytes: &[u8]) -> Option<Self> {
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
        let is_gltf = bytes.starts_with(b"glTF") || bytes.starts_with(b"{");
        if ending.eq_ignore_ascii_case("obj") {
            Some(Self::Obj)
        } else if ending.eq_ignore_ascii_case("ply") && !is_gltf
            || bytes.starts_with(b"ply\n")
            || bytes.starts_with(b"ply\r")
        {
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

    /// The same scene as a GLB file.
    pub(crate) fn to_glb(
        self,
        bytes: &[u8],
        file: &str,
        options: &LoadOptions,
        resolver: &Resolver<'_>,
    ) -> Result<Converted, SceneError> {
        let convert = || match self {
            Self::Obj => obj::convert(bytes, file, options, resolver),
            Self::Ply => ply::convert(bytes, options),
        };
        // The decoders promise not to panic; should they, this file is broken and nothing else.
        let refusal = match catch_unwind(AssertUnwindSafe(convert)) {
            Ok(Ok(converted)) => return Ok(converted),
            Ok(Err(refusal)) => refusal,
            Err(_) => Refusal::Broken("the decoder failed".to_owned()),
        };
        let file = file.to_owned();
        Err(match refusal {
            Refusal::Broken(cause) => SceneError::NotMesh {
                file,
                format: self.name(),
                cause,
            },
            Refusal::TooLarge(limit, cause) => SceneError::TooLarge {
                file,
                place: "file".to_owned(),
                cause,
                limit,
            },
        })
    }
}

/// An error where `count` things of `each` bytes are more than a file of its size may ask for.
fn check_memory(
    what: &str,
    count: usize,
    each: u64,
    input: usize,
    options: &LoadOptions,
) -> Result<(), Refusal> {
    let wanted = each.saturating_mul(count as u64);
    Budget::new(input as u64, options)
        .take(wanted, &format!("{count} {what}"))
        .map_err(|flaw| Refusal::TooLarge(Some(Limit::Expansion), flaw.cause))
}

/// A colour's channel from 0 to 1 as displays show it, as linear light (IEC 61966-2-1).
fn linear(x: f32) -> f32 {
    let code = if x.is_finite() {
        x.clamp(0.0, 1.0)
    } else {
        0.0
    };
    srgb::decode(code.into()) as f32
}
