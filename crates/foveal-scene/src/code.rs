//! Names of faults that stay from version to version.

use std::fmt;

macro_rules! codes {
    ($($(#[doc = $doc:literal])+ $name:ident = $text:literal,)+) => {
        /// What a [`Warning`](crate::Warning) or a [`SceneError`](crate::SceneError) is about.
        ///
        /// Sentences are for people and may change; a code is for programs. A code keeps its name and
        /// its meaning; further ones may come.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Code {
            $($(#[doc = $doc])+ $name,)+
        }

        impl Code {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$name,)+];

            /// Its name, as JSON and the command line write it: `NODE_CYCLE`.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)+
                }
            }

            /// Its meaning in a sentence.
            #[must_use]
            pub fn meaning(self) -> &'static str {
                match self {
                    $(Self::$name => concat!($($doc),+).trim_ascii_start(),)+
                }
            }
        }
    };
}

codes! {
    /// A file is missing, not a regular file, or the system refuses to read it.
    FileUnreadable = "FILE_UNREADABLE",
    /// The bytes are not glTF 2.0: another container, another version of it, no JSON.
    NotGltf = "NOT_GLTF",
    /// The bytes are not the OBJ or PLY file that its name or first line promises.
    NotMesh = "NOT_MESH",
    /// The importer itself failed.
    Importer = "IMPORTER_FAILED",
    /// Bytes after the end of the GLB container are ignored.
    ContainerTail = "CONTAINER_TAIL",
    /// A chunk of the GLB container has an unknown kind and is ignored.
    ContainerChunk = "CONTAINER_CHUNK",
    /// The file is written in, or needs, another version than glTF 2.0.
    VersionUnsupported = "VERSION_UNSUPPORTED",
    /// A value that must be there is missing.
    ValueMissing = "VALUE_MISSING",
    /// A value is of another JSON type, or a list of another length, than it must be.
    ValueType = "VALUE_TYPE",
    /// A number is outside its range.
    ValueOutOfRange = "VALUE_OUT_OF_RANGE",
    /// A name or number is none of those that glTF lists there.
    ValueUnknown = "VALUE_UNKNOWN",
    /// A number names an element of a list that is shorter.
    IndexOutOfRange = "INDEX_OUT_OF_RANGE",
    /// The file has no scene; all its nodes are shown.
    SceneMissing = "SCENE_MISSING",
    /// The scene shows no triangles, lines or points.
    SceneEmpty = "SCENE_EMPTY",
    /// A node is the child of two nodes.
    NodeTwoParents = "NODE_TWO_PARENTS",
    /// A node is its own ancestor.
    NodeCycle = "NODE_CYCLE",
    /// A root of the scene has a parent.
    NodeRoot = "NODE_ROOT_WITH_PARENT",
    /// A node has a matrix beside translation, rotation or scale.
    NodeTransform = "NODE_TWO_TRANSFORMS",
    /// A node lies beyond the range of 32-bit numbers.
    NodeBeyondRange = "NODE_BEYOND_RANGE",
    /// A buffer cannot be read.
    BufferUnreadable = "BUFFER_UNREADABLE",
    /// A buffer or buffer view ends before what is read from it.
    BufferTooShort = "BUFFER_TOO_SHORT",
    /// An accessor's elements are not of the type that its use asks for.
    AccessorType = "ACCESSOR_TYPE",
    /// An accessor's elements are larger than its buffer view's stride.
    AccessorStride = "ACCESSOR_STRIDE",
    /// An accessor has fewer elements than its use asks for.
    AccessorCount = "ACCESSOR_COUNT",
    /// Draco or meshopt data are broken, or do not hold what the file promises.
    CompressedData = "COMPRESSED_DATA",
    /// Geometry is made of what is not drawn: free-form curves and surfaces of an OBJ file.
    PrimitiveMode = "PRIMITIVE_NOT_TRIANGLES",
    /// A primitive has no positions and is not drawn.
    PrimitivePositions = "PRIMITIVE_NO_POSITIONS",
    /// Triangles, lines or points name missing vertices, or vertices at no finite place, and are left out.
    TrianglesUnusable = "TRIANGLES_UNUSABLE",
    /// Normals have no direction and are made anew; points and lines without are not lit.
    Normals = "NORMALS_UNUSABLE",
    /// A material reads texture coordinates that the mesh does not have.
    TexcoordsMissing = "TEXCOORDS_MISSING",
    /// A material reads more than two sets of texture coordinates.
    TexcoordsTooMany = "TEXCOORDS_TOO_MANY",
    /// A morph target moves texture coordinates or colours that the mesh does not have.
    MorphIgnored = "MORPH_IGNORED",
    /// The weights of morph targets are not as many as the targets.
    MorphWeights = "MORPH_WEIGHTS",
    /// A skin is broken, missing, or has joints that are ignored; or a part of a mesh has no joints
    /// for it.
    Skin = "SKIN",
    /// An animation channel is broken and is not played.
    Animation = "ANIMATION",
    /// An animation moves what is not moved here.
    AnimationUnsupported = "ANIMATION_UNSUPPORTED",
    /// The pointer of an animation channel names nothing in the file; the channel is not played.
    AnimationPointer = "ANIMATION_POINTER",
    /// Two channels of an animation move the same.
    AnimationTwice = "ANIMATION_TWICE",
    /// The materials of an OBJ file cannot be read and are left out.
    MaterialUnreadable = "MATERIAL_UNREADABLE",
    /// A part of a material is not read.
    MaterialIgnored = "MATERIAL_IGNORED",
    /// A picture cannot be read or decoded; a placeholder is shown.
    ImageUnreadable = "IMAGE_UNREADABLE",
    /// A texture names no picture that can be read.
    TextureWithoutImage = "TEXTURE_WITHOUT_IMAGE",
    /// Textures are shown at a lower resolution than the file's.
    TexturesReduced = "TEXTURES_REDUCED",
    /// The file requires an extension that is not supported.
    ExtensionRequired = "EXTENSION_REQUIRED",
    /// The file uses an extension that is not supported, and is shown without it.
    ExtensionIgnored = "EXTENSION_IGNORED",
    /// The file asks for more than a limit.
    LimitExceeded = "LIMIT_EXCEEDED",
    /// The options ask for what the file does not have.
    NotInFile = "NOT_IN_FILE",
    /// There are more warnings than are listed.
    MoreWarnings = "MORE_WARNINGS",
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn names_are_different_and_of_capital_letters() {
        let names: BTreeSet<&str> = Code::ALL.iter().map(|code| code.name()).collect();
        assert_eq!(names.len(), Code::ALL.len());
        for name in names {
            let fits = |c: char| c.is_ascii_uppercase() || c == '_';
            assert!(name.chars().all(fits), "{name}");
        }
    }

    #[test]
    fn the_documentation_lists_every_code_with_its_meaning() {
        let page = include_str!("../../../docs/gltf-codes.md");
        let rows: Vec<String> = Code::ALL
            .iter()
            .map(|code| format!("| `{code}` | {} |", code.meaning()))
            .collect();
        let listed: Vec<&str> = page.lines().filter(|l| l.starts_with("| `")).collect();
        assert_eq!(listed, rows);
    }
}
