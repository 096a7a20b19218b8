//! What can go wrong when a scene is loaded.
//!
//! Every message is one sentence that names the file, the place in its JSON where there is one
//! (`meshes[3].primitives[0].attributes.POSITION`) and the cause.

use crate::{Code, Warning};

/// The field of [`LoadOptions`](crate::LoadOptions) that a file goes beyond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limit {
    /// [`max_file_bytes`](crate::LoadOptions::max_file_bytes).
    FileBytes,
    /// [`max_texture_bytes`](crate::LoadOptions::max_texture_bytes).
    TextureBytes,
    /// [`max_vertices`](crate::LoadOptions::max_vertices).
    Vertices,
    /// [`max_instances`](crate::LoadOptions::max_instances).
    Instances,
    /// [`max_triangles`](crate::LoadOptions::max_triangles).
    Triangles,
    /// [`max_expansion`](crate::LoadOptions::max_expansion).
    Expansion,
}

/// Why a scene could not be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file is missing, not a regular file, or the system refuses to read it.
    #[error("{file} cannot be read: {cause}")]
    Read {
        /// The file as it was asked for.
        file: String,
        /// The system's reason.
        cause: String,
    },
    /// The bytes are not glTF 2.0 at all: wrong container, wrong version, not JSON.
    #[error("{file} is not a glTF 2.0 file: {cause}")]
    NotGltf {
        /// The file as it was asked for.
        file: String,
        /// What is wrong with it.
        cause: String,
    },
    /// The bytes are not the OBJ or PLY file that its name or its first line promises.
    #[error("{file} is not {format}: {cause}")]
    NotMesh {
        /// The file as it was asked for.
        file: String,
        /// The format's name.
        format: &'static str,
        /// What is wrong with it.
        cause: String,
    },
    /// A part of the document contradicts the glTF 2.0 specification so that no picture can be made
    /// from it.
    #[error("{file} is broken at {place}: {cause}")]
    Invalid {
        /// The file as it was asked for.
        file: String,
        /// What is wrong with it, for programs.
        code: Code,
        /// JSON path of the part.
        place: String,
        /// What is wrong with it.
        cause: String,
    },
    /// The file requires extensions that are not supported.
    #[error("{file} cannot be shown: {place} names {extensions}")]
    Extension {
        /// The file as it was asked for.
        file: String,
        /// JSON path of the requirement.
        place: String,
        /// The names of all of them, and how the file can be converted where that is known.
        extensions: String,
    },
    /// The file is beyond a limit of [`LoadOptions`](crate::LoadOptions).
    #[error("{file} is too large at {place}: {cause}")]
    TooLarge {
        /// The file as it was asked for.
        file: String,
        /// JSON path of the part, or `file`.
        place: String,
        /// What the file asks for, and the limit.
        cause: String,
        /// The option that allows more; `None` for limits of the importer itself.
        limit: Option<Limit>,
    },
    /// The options ask for something that the file does not have.
    #[error("{file} has no {absent}")]
    Absent {
        /// The file as it was asked for.
        file: String,
        /// What was asked for, and what there is.
        absent: String,
    },
    /// A fault of the importer itself; please report it with the file.
    #[error("{file} cannot be loaded: the importer failed with \"{cause}\"")]
    Internal {
        /// The file as it was asked for.
        file: String,
        /// The message of the failure.
        cause: String,
    },
}

impl SceneError {
    /// What it is about, by a name that stays from version to version.
    #[must_use]
    pub fn code(&self) -> Code {
        match self {
            Self::Read { .. } => Code::FileUnreadable,
            Self::NotGltf { .. } => Code::NotGltf,
            Self::NotMesh { .. } => Code::NotMesh,
            Self::Invalid { code, .. } => *code,
            Self::Extension { .. } => Code::ExtensionRequired,
            Self::TooLarge { .. } => Code::LimitExceeded,
            Self::Absent { .. } => Code::NotInFile,
            Self::Internal { .. } => Code::Importer,
        }
    }

    /// The option that would let the file load, where it is only too large.
    #[must_use]
    pub fn limit(&self) -> Option<Limit> {
        match self {
            Self::TooLarge { limit, .. } => *limit,
            _ => None,
        }
    }
}

/// What kind of fault a [`Flaw`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FlawKind {
    Invalid,
    TooLarge(Option<Limit>),
    Extension,
    Absent,
}

/// A fault within a document, before it is known which file it belongs to.
///
/// The place is built from the inside out, by [`Flaw::under`], only when something fails.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Flaw {
    pub(crate) kind: FlawKind,
    pub(crate) code: Code,
    pub(crate) place: String,
    pub(crate) cause: String,
}

impl Flaw {
    /// A fault at the place that the callers name.
    pub(crate) fn new(code: Code, cause: impl Into<String>) -> Self {
        Self {
            kind: FlawKind::Invalid,
            code,
            place: String::new(),
            cause: cause.into(),
        }
    }

    /// A limit of the importer itself that is exceeded.
    pub(crate) fn too_large(cause: impl Into<String>) -> Self {
        Self {
            kind: FlawKind::TooLarge(None),
            ..Self::new(Code::LimitExceeded, cause)
        }
    }

    /// A limit of the options that is exceeded.
    pub(crate) fn beyond(limit: Limit, cause: impl Into<String>) -> Self {
        Self {
            kind: FlawKind::TooLarge(Some(limit)),
            ..Self::new(Code::LimitExceeded, cause)
        }
    }

    /// The same fault, its place within `outer`.
    pub(crate) fn under(mut self, outer: impl std::fmt::Display) -> Self {
        self.place = match self.place.chars().next() {
            None => outer.to_string(),
            Some('[') => format!("{outer}{}", self.place),
            Some(_) => format!("{outer}.{}", self.place),
        };
        self
    }

    /// The public error for the file of this name.
    pub(crate) fn in_file(self, file: &str) -> SceneError {
        let file = file.to_owned();
        let place = if self.place.is_empty() {
            "its top level".to_owned()
        } else {
            self.place
        };
        let (code, cause) = (self.code, self.cause);
        match self.kind {
            FlawKind::Invalid => SceneError::Invalid {
                file,
                code,
                place,
                cause,
            },
            FlawKind::TooLarge(limit) => SceneError::TooLarge {
                file,
                place,
                cause,
                limit,
            },
            FlawKind::Absent => SceneError::Absent {
                file,
                absent: cause,
            },
            FlawKind::Extension => SceneError::Extension {
                file,
                place,
                extensions: cause,
            },
        }
    }

    /// The same as a warning.
    pub(crate) fn warning(&self) -> Warning {
        Warning::new(self.code, self.sentence())
    }

    /// The same as a sentence.
    pub(crate) fn sentence(&self) -> String {
        if self.place.is_empty() {
            self.cause.clone()
        } else {
            format!("{}: {}", self.place, self.cause)
        }
    }
}

/// A number of bytes as people write it: `512 bytes`, `1.5 MB`, `10.5 GB` (powers of 1000).
pub(crate) fn amount(bytes: u64) -> String {
    let units = [
        (1_000_000_000_000, "TB"),
        (1_000_000_000, "GB"),
        (1_000_000, "MB"),
        (1_000, "KB"),
    ];
    match units.into_iter().find(|(size, _)| bytes >= *size) {
        Some((size, unit)) => {
            let value = format!("{:.1}", bytes as f64 / size as f64);
            format!("{} {unit}", value.strip_suffix(".0").unwrap_or(&value))
        }
        None => format!("{bytes} bytes"),
    }
}

/// Result of the importer's inner parts.
pub(crate) type Parsed<T> = Result<T, Flaw>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_rounded_to_what_matters() {
        for (bytes, text) in [
            (0, "0 bytes"),
            (999, "999 bytes"),
            (1_000, "1 KB"),
            (73_540, "73.5 KB"),
            (1_000_000_000, "1 GB"),
            (10_512_345_678, "10.5 GB"),
            (u64::MAX, "18446744.1 TB"),
        ] {
            assert_eq!(amount(bytes), text);
        }
    }

    #[test]
    fn places_are_joined_as_json_paths() {
        let flaw = Flaw::new(Code::IndexOutOfRange, "is 7, there are 3")
            .under("POSITION")
            .under("attributes")
            .under("primitives[0]")
            .under("meshes[3]");
        assert_eq!(flaw.place, "meshes[3].primitives[0].attributes.POSITION");
        assert_eq!(
            flaw.in_file("a.gltf").to_string(),
            "a.gltf is broken at meshes[3].primitives[0].attributes.POSITION: is 7, there are 3"
        );
    }
}
