//! What can go wrong when a scene is loaded.
//!
//! Every message is one sentence that names the file, the place in its JSON where there is one
//! (`meshes[3].primitives[0].attributes.POSITION`) and the cause.

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
    /// A part of the document contradicts the glTF 2.0 specification so that no picture can be made from it.
    #[error("{file} is broken at {place}: {cause}")]
    Invalid {
        /// The file as it was asked for.
        file: String,
        /// JSON path of the part.
        place: String,
        /// What is wrong with it.
        cause: String,
    },
    /// The file requires an extension that is not supported.
    #[error("{file} cannot be shown: {place} names {extension}, which is not supported")]
    Extension {
        /// The file as it was asked for.
        file: String,
        /// JSON path of the requirement.
        place: String,
        /// The extension's name.
        extension: String,
    },
    /// The file is beyond a limit of [`LoadOptions`](crate::LoadOptions).
    #[error("{file} is too large at {place}: {cause}")]
    TooLarge {
        /// The file as it was asked for.
        file: String,
        /// JSON path of the part, or `file`.
        place: String,
        /// The limit and by how much it is exceeded.
        cause: String,
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

/// What kind of fault a [`Flaw`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FlawKind {
    Invalid,
    TooLarge,
    Extension,
}

/// A fault within a document, before it is known which file it belongs to.
///
/// The place is built from the inside out, by [`Flaw::under`], only when something fails.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Flaw {
    pub(crate) kind: FlawKind,
    pub(crate) place: String,
    pub(crate) cause: String,
}

impl Flaw {
    /// A fault at the place that the callers name.
    pub(crate) fn new(cause: impl Into<String>) -> Self {
        Self {
            kind: FlawKind::Invalid,
            place: String::new(),
            cause: cause.into(),
        }
    }

    /// A limit that is exceeded.
    pub(crate) fn too_large(cause: impl Into<String>) -> Self {
        Self {
            kind: FlawKind::TooLarge,
            ..Self::new(cause)
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
        let cause = self.cause;
        match self.kind {
            FlawKind::Invalid => SceneError::Invalid { file, place, cause },
            FlawKind::TooLarge => SceneError::TooLarge { file, place, cause },
            FlawKind::Extension => SceneError::Extension {
                file,
                place,
                extension: cause,
            },
        }
    }

    /// The same as a sentence, for a warning.
    pub(crate) fn sentence(&self) -> String {
        if self.place.is_empty() {
            self.cause.clone()
        } else {
            format!("{}: {}", self.place, self.cause)
        }
    }
}

/// Result of the importer's inner parts.
pub(crate) type Parsed<T> = Result<T, Flaw>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_joined_as_json_paths() {
        let flaw = Flaw::new("is 7, there are 3")
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
