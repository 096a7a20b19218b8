//! Flags for reading scene files: how much a file may ask for, and what it may reach.

use std::fmt;

use foveal_scene::{Clip, Code, Limit, LoadOptions, SceneError, TextureCompression};

use crate::values;

/// How scene files are read.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ImportArgs {
    /// Animation to play, by name or else by number from 0 (`foveal scene info` lists them); `all`:
    /// all at once, even where one has this name [default: 0]
    #[arg(long, help_heading = "Scene files", value_name = "NAME|NUMBER|all")]
    clip: Option<Clip>,

    /// Variant of materials to show, by name or by number from 0 [default: none]
    #[arg(long, help_heading = "Scene files", value_name = "NAME|NUMBER")]
    variant: Option<String>,

    /// Scene of a glTF file to show, by name or by number from 0 (`foveal scene info` lists them)
    /// [default: the one that the file names]
    #[arg(long, help_heading = "Scene files", value_name = "NAME|NUMBER")]
    file_scene: Option<String>,

    /// Keep textures in blocks on the device. `small`, also without a value: BC1, BC4 and BC5, and
    /// BC7 where alpha is read; `fine`: BC7 for BC1. Loading takes longer, and textures are not
    /// quite the same [default: off]
    #[arg(
        long,
        help_heading = "Scene files",
        value_name = "off|small|fine",
        value_parser = texture_compression,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "small"
    )]
    texture_compression: Option<TextureCompression>,

    /// Most memory for textures while they are loaded; larger pictures are reduced to fit [default:
    /// 4.3GB]
    #[arg(long, help_heading = "Scene files", value_name = "SIZE", value_parser = values::bytes)]
    max_texture_memory: Option<u64>,

    /// Largest side of a texture in texels; larger pictures are halved until they fit [default:
    /// 8192]
    #[arg(long, help_heading = "Scene files", value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_texture_size: Option<u32>,

    /// Most vertices of all meshes together, morph targets included, and six times as many indices
    /// [default: 67108864]
    #[arg(long, help_heading = "Scene files", value_name = "N")]
    max_vertices: Option<u64>,

    /// Most instances: primitives times nodes times elements of GPU instancing [default: 4194304]
    #[arg(long, help_heading = "Scene files", value_name = "N")]
    max_instances: Option<u64>,

    /// Most triangles, lines and points, each counted once per instance [default: 4294967296]
    #[arg(long, help_heading = "Scene files", value_name = "N")]
    max_triangles: Option<u64>,

    /// Most bytes of the scene file and the files that it names, together [default: 4.3GB]
    #[arg(long, help_heading = "Scene files", value_name = "SIZE", value_parser = values::bytes)]
    max_file_size: Option<u64>,

    /// Bytes of memory that a file may ask for per byte of its own, beyond 160 MiB [default: 256]
    #[arg(long, help_heading = "Scene files", value_name = "N")]
    max_expansion: Option<u64>,

    /// Read files outside the scene's own folder where the scene names them, also through symbolic
    /// links
    #[arg(long, help_heading = "Scene files")]
    outside_files: bool,
}

fn texture_compression(text: &str) -> Result<TextureCompression, String> {
    match text {
        "off" => Ok(TextureCompression::Off),
        "small" => Ok(TextureCompression::Small),
        "fine" => Ok(TextureCompression::Fine),
        _ => Err("it is off, small or fine".to_owned()),
    }
}

impl ImportArgs {
    /// The flag that keeps textures in blocks, where they are.
    #[must_use]
    pub fn texture_flag(&self) -> Option<&'static str> {
        match self.texture_compression.unwrap_or_default() {
            TextureCompression::Off => None,
            TextureCompression::Small => Some("--texture-compression=small"),
            TextureCompression::Fine => Some("--texture-compression=fine"),
        }
    }

    /// The flags that decide what of a scene is shown, as a command has them.
    pub fn shown_flags(&self) -> Vec<String> {
        let clip = self.clip.as_ref().map(ToString::to_string);
        let mut flags = Vec::new();
        for (flag, value) in [
            ("--clip", clip),
            ("--variant", self.variant.clone()),
            ("--file-scene", self.file_scene.clone()),
        ] {
            if let Some(value) = value {
                flags.extend([flag.to_owned(), value]);
            }
        }
        flags
    }

    /// The flags that say how any scene is read, as a command has them.
    pub fn reading_flags(&self) -> Vec<String> {
        let side = self.max_texture_size.map(u64::from);
        let mut flags: Vec<String> = self.texture_flag().map(str::to_owned).into_iter().collect();
        for (flag, value) in [
            ("--max-texture-memory", self.max_texture_memory),
            ("--max-texture-size", side),
            ("--max-vertices", self.max_vertices),
            ("--max-instances", self.max_instances),
            ("--max-triangles", self.max_triangles),
            ("--max-file-size", self.max_file_size),
            ("--max-expansion", self.max_expansion),
        ] {
            if let Some(value) = value {
                flags.extend([flag.to_owned(), value.to_string()]);
            }
        }
        if self.outside_files {
            flags.push("--outside-files".to_owned());
        }
        flags
    }

    /// All of them, as a command has them.
    pub fn flags(&self) -> Vec<String> {
        [self.shown_flags(), self.reading_flags()].concat()
    }

    /// The importer's options.
    pub fn options(&self) -> LoadOptions {
        let d = LoadOptions::default();
        LoadOptions {
            clip: self.clip.clone().unwrap_or_default(),
            variant: self.variant.clone(),
            file_scene: self.file_scene.clone(),
            outside_files: self.outside_files,
            texture_compression: self.texture_compression.unwrap_or_default(),
            max_file_bytes: self.max_file_size.unwrap_or(d.max_file_bytes),
            max_texture_size: self.max_texture_size.unwrap_or(d.max_texture_size),
            max_texture_bytes: self.max_texture_memory.unwrap_or(d.max_texture_bytes),
            max_vertices: self.max_vertices.unwrap_or(d.max_vertices),
            max_instances: self.max_instances.unwrap_or(d.max_instances),
            max_triangles: self.max_triangles.unwrap_or(d.max_triangles),
            max_expansion: self.max_expansion.unwrap_or(d.max_expansion),
            ..d
        }
    }
}

/// The importer's error, with the flag that allows more where a limit is exceeded.
pub fn with_flag(error: SceneError) -> anyhow::Error {
    let flag = match error.limit() {
        Some(Limit::FileBytes) => "--max-file-size",
        Some(Limit::TextureBytes) => "--max-texture-memory",
        Some(Limit::Vertices) => "--max-vertices",
        Some(Limit::Instances) => "--max-instances",
        Some(Limit::Triangles) => "--max-triangles",
        Some(Limit::Expansion) => "--max-expansion",
        _ => return error.into(),
    };
    Limited { error, flag }.into()
}

/// A file beyond a limit, and the flag that allows more.
#[derive(Debug)]
struct Limited {
    error: SceneError,
    flag: &'static str,
}

impl fmt::Display for Limited {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.error, self.flag)
    }
}

impl std::error::Error for Limited {}

/// A word that is neither a file nor a generated scene's name.
#[derive(Debug)]
pub(crate) struct NoSuchScene {
    pub(crate) name: String,
}

impl fmt::Display for NoSuchScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "there is no scene '{}': neither a file of that name nor a generated scene; generated are {}",
            self.name,
            foveal_generate::NAMES.join(", ")
        )
    }
}

impl std::error::Error for NoSuchScene {}

/// The code of an error, where it is about a scene's file.
#[must_use]
pub fn code_of(error: &anyhow::Error) -> Option<Code> {
    if error.is::<NoSuchScene>() {
        return Some(Code::FileUnreadable);
    }
    let limited = error
        .downcast_ref::<Limited>()
        .map(|limited| &limited.error);
    limited
        .or_else(|| error.downcast_ref::<SceneError>())
        .map(SceneError::code)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        import: ImportArgs,
    }

    #[test]
    fn flags_change_the_limits_and_nothing_else() {
        let none = Line::try_parse_from(["foveal"]).unwrap().import.options();
        assert_eq!(none, LoadOptions::default());
        let words = [
            "foveal",
            "--max-texture-memory",
            "1.5GB",
            "--max-vertices",
            "7",
            "--outside-files",
            "--texture-compression",
            "--clip",
            "Run",
            "--variant",
            "red",
            "--file-scene",
            "1",
        ];
        let some = Line::try_parse_from(words).unwrap().import.options();
        let expected = LoadOptions {
            max_texture_bytes: 1_500_000_000,
            max_vertices: 7,
            outside_files: true,
            texture_compression: TextureCompression::Small,
            clip: Clip::Named("Run".to_owned()),
            variant: Some("red".to_owned()),
            file_scene: Some("1".to_owned()),
            ..LoadOptions::default()
        };
        assert_eq!(some, expected);
    }

    #[test]
    fn flags_are_written_as_they_are_read() {
        let words = "foveal --clip Run --variant red --file-scene 1 --texture-compression=fine --max-texture-memory 1.5GB \
                     --max-texture-size 64 --max-vertices 7 --max-instances 8 --max-triangles 9 \
                     --max-file-size 2GiB --max-expansion 10 --outside-files";
        for words in [words, "foveal", "foveal --max-texture-size 64"] {
            let line = Line::try_parse_from(words.split(' ')).unwrap().import;
            let again = Line::try_parse_from(["foveal".to_owned()].into_iter().chain(line.flags()));
            assert_eq!(again.unwrap().import.options(), line.options(), "{words}");
        }
    }

    #[test]
    fn the_flag_of_textures_is_read_as_it_is_written() {
        for flag in ["--texture-compression=small", "--texture-compression=fine"] {
            let line = Line::try_parse_from(["foveal", flag]).unwrap();
            assert_eq!(line.import.texture_flag(), Some(flag));
        }
        for words in [&["foveal"][..], &["foveal", "--texture-compression=off"]] {
            let line = Line::try_parse_from(words).unwrap();
            assert_eq!(line.import.texture_flag(), None);
        }
        let wrong = Line::try_parse_from(["foveal", "--texture-compression=bc9"]);
        assert!(wrong.is_err());
    }

    #[test]
    fn every_flag_that_an_error_names_exists() {
        let error = |limit| SceneError::TooLarge {
            file: "a.glb".to_owned(),
            place: "images[0]".to_owned(),
            cause: "wants 10.5 GB for textures; the limit is 1 GB".to_owned(),
            limit: Some(limit),
        };
        for limit in [
            Limit::FileBytes,
            Limit::TextureBytes,
            Limit::Vertices,
            Limit::Instances,
            Limit::Triangles,
            Limit::Expansion,
        ] {
            let text = with_flag(error(limit)).to_string();
            let (_, flag) = text.rsplit_once(": ").unwrap();
            assert!(
                Line::try_parse_from(["foveal", flag, "1"]).is_ok(),
                "{text}"
            );
        }
    }
}
