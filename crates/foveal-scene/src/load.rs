//! The doors to the glTF importer: from a path, or from bytes where there are no files.
//!
//! File access happens in [`load`] alone; [`load_bytes`] asks a resolver for what lies outside
//! the bytes, so that a browser can load a `.glb` that it has fetched.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Limit, amount};
use crate::{Clip, Code, Scene, SceneError, TextureCompression, gltf};

/// What to do with a primitive that brings no normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum MissingNormals {
    /// One normal per triangle, as the glTF specification says.
    #[default]
    Flat,
    /// Area-weighted means over the triangles that share a vertex.
    Smooth,
}

/// How a scene is loaded. The limits keep broken or hostile files from taking the machine.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadOptions {
    /// Time in seconds at which an animated scene is posed after loading.
    pub time_s: f32,
    /// Which animation plays; see [`Scene::play`].
    pub clip: Clip,
    /// Which of the file's variants of materials is shown (KHR_materials_variants), by name or by
    /// number from 0; `None`: the materials as they are without.
    pub variant: Option<String>,
    /// Which of a glTF file's scenes is shown, by name or by number from 0; `None`: the one that the
    /// file names, else its first.
    pub file_scene: Option<String>,
    /// Use the threads of the current rayon pool; without, everything happens on the caller's
    /// thread.
    pub parallel: bool,
    /// How normals are made where the file gives none.
    pub missing_normals: MissingNormals,
    /// Allow external files outside the scene's own folder, by path (`../textures/wood.png`,
    /// `/textures/wood.png`) or by a symbolic link that leads there.
    pub outside_files: bool,
    /// Read what nothing shown uses, too, meshes and pictures, and warn of what is wrong with it. It
    /// is freed again.
    pub check_unused: bool,
    /// Whether textures are kept in blocks that graphics devices read as they are: a quarter to an
    /// eighth of the memory, not quite the same, and loading takes longer. KTX2 pictures become BC7
    /// without going through texels, unless they are reduced, lack mip levels that are wanted, or are
    /// alpha masks with mip levels. Textures whose sides are no multiples of 4 stay as they are. What
    /// materials read decides, as the file gives them. On WebAssembly nothing is done.
    pub texture_compression: TextureCompression,
    /// Most bytes of the file and all files that it names, together.
    pub max_file_bytes: u64,
    /// Largest width and height of a texture in texels; larger pictures are halved until they fit.
    pub max_texture_size: u32,
    /// Most bytes that textures may take while they are loaded: decoded pictures, their mip levels,
    /// and what the decoders that run at one time need beside them. The largest pictures are halved
    /// until all fit; a picture that cannot even be decoded within it is an error.
    pub max_texture_bytes: u64,
    /// Most vertices of all meshes together, morph targets included.
    pub max_vertices: u64,
    /// Most [`Instance`](crate::Instance)s: primitives times nodes times instancing elements.
    pub max_instances: u64,
    /// Most triangles, lines and points, each counted once per instance.
    pub max_triangles: u64,
    /// Bytes of memory that a file may ask for per byte of its own and of the files that it names,
    /// beyond 160 MiB that any file may have. Scenes stay far below the default; a file that goes beyond it was made to fill the
    /// memory.
    pub max_expansion: u64,
}

impl Default for LoadOptions {
    /// At time 0 of the first clip, no variant, the file's own scene, parallel, flat normals, own folder only, only what
    /// is shown, textures as texels; 4 GiB of files, 8192-texel textures, 4 GiB of them, 64 Mi
    /// vertices, 4 Mi instances, 4 Gi triangles, 256 bytes per byte.
    fn default() -> Self {
        Self {
            time_s: 0.0,
            clip: Clip::default(),
            variant: None,
            file_scene: None,
            parallel: true,
            missing_normals: MissingNormals::Flat,
            outside_files: false,
            check_unused: false,
            texture_compression: TextureCompression::Off,
            max_file_bytes: 4 << 30,
            max_texture_size: 8192,
            max_texture_bytes: 4 << 30,
            max_vertices: 64 << 20,
            max_instances: 4 << 20,
            max_triangles: 4 << 30,
            max_expansion: 256,
        }
    }
}

/// Endings of the names of files that [`load`] reads, in lower case.
#[cfg(not(target_arch = "wasm32"))]
pub const ENDINGS: &[&str] = &["gltf", "glb", "obj", "ply"];

/// Endings of the names of files that [`load`] reads, in lower case.
#[cfg(target_arch = "wasm32")]
pub const ENDINGS: &[&str] = &["gltf", "glb"];

/// Loads a glTF 2.0 scene: `.glb`, or `.gltf` with data URIs or external files beside it; or, not
/// on WebAssembly, a mesh: Wavefront `.obj` with its `.mtl`, or a Stanford `.ply`.
///
/// What the file asks for and Foveal cannot give is listed in [`Scene::warnings`]. A picture that
/// is missing or broken is such a warning, and a magenta checker board takes its place as a colour
/// (a neutral value as anything else). Nodes without geometry, lights or cameras leave no trace.
///
/// # Errors
/// When the file cannot be read, is not of the format that it should be, contradicts itself so that
/// no sensible picture can be made, requires an unsupported extension, or is beyond a limit of `options`.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    let watch = crate::timings::Stopwatch::start();
    let file = path.display().to_string();
    let allowance = AtomicU64::new(options.max_file_bytes);
    let bytes = read_limited(path, &allowance).map_err(|cause| {
        let file = file.clone();
        named_limit(SceneError::Read { file, cause })
    })?;
    let read_ms = watch.elapsed_ms();
    let folder = path.parent().unwrap_or(Path::new(""));
    let resolver = |uri: &str| resolve_beside(folder, uri, options.outside_files, &allowance);
    let mut scene = import(&bytes, &file, options, &resolver).map_err(named_limit)?;
    scene.name = path
        .file_name()
        .map_or_else(|| file.clone(), |n| n.to_string_lossy().into_owned());
    scene.timings.read_ms += read_ms;
    Ok(scene)
}

/// Loads a scene from memory; `name` is used in messages and as [`Scene::name`], and a Wavefront
/// file is known by its ending.
///
/// `resolver` is called with the percent-decoded URI of each external file and gives its
/// bytes or the reason why not; `&|_| Err("no files here".to_owned())` suits a `.glb`.
///
/// # Errors
/// As for [`load`].
pub fn load_bytes(
    bytes: &[u8],
    name: &str,
    options: &LoadOptions,
    resolver: &(dyn Fn(&str) -> Result<Vec<u8>, String> + Sync),
) -> Result<Scene, SceneError> {
    if bytes.len() as u64 > options.max_file_bytes {
        return Err(SceneError::TooLarge {
            file: name.to_owned(),
            place: "file".to_owned(),
            cause: format!(
                "has {}, the limit is {}",
                amount(bytes.len() as u64),
                amount(options.max_file_bytes)
            ),
            limit: Some(Limit::FileBytes),
        });
    }
    import(bytes, name, options, resolver)
}

/// A file of any format.
fn import(
    bytes: &[u8],
    file: &str,
    options: &LoadOptions,
    resolver: &gltf::Resolver<'_>,
) -> Result<Scene, SceneError> {
    #[cfg(not(target_arch = "wasm32"))]
    if let Some(format) = crate::other::Format::of(file, bytes) {
        let watch = crate::timings::Stopwatch::start();
        let mut converted = format.to_glb(bytes, file, options, resolver)?;
        let notes = std::mem::take(&mut converted.notes);
        let convert_ms = watch.elapsed_ms();
        let beside = |path: &str| converted.resolve(path, resolver);
        let mut scene = gltf::import(&converted.glb, file, notes, options, &beside)?;
        scene.timings.parse_ms += convert_ms;
        return Ok(scene);
    }
    gltf::import(bytes, file, Vec::new(), options, resolver)
}

/// How the cause ends where files have more bytes than [`LoadOptions::max_file_bytes`].
const BEYOND_LIMIT: &str = "that the limit on files leaves";

/// The scene's file, or a buffer's, that was not read because of its size is too large, not
/// unreadable.
fn named_limit(error: SceneError) -> SceneError {
    let (file, place, cause) = match error {
        SceneError::Read { file, cause } if cause.ends_with(BEYOND_LIMIT) => {
            (file, "file".to_owned(), cause)
        }
        SceneError::Invalid {
            file,
            code: Code::BufferUnreadable,
            place,
            cause,
        } if cause.ends_with(BEYOND_LIMIT) => (file, place, cause),
        other => return other,
    };
    SceneError::TooLarge {
        file,
        place,
        cause,
        limit: Some(Limit::FileBytes),
    }
}

/// Reads a regular file, as long as `allowance` bytes suffice, and takes its size from them.
fn read_limited(path: &Path, allowance: &AtomicU64) -> Result<Vec<u8>, String> {
    let file = open_regular(path)?;
    let size = file.metadata().map_err(|e| e.to_string())?.len();
    let rest = |left: u64| left.checked_sub(size);
    allowance
        .fetch_update(Ordering::Relaxed, Ordering::Relaxed, rest)
        .map_err(|left| {
            format!(
                "it has {}, more than the {} {BEYOND_LIMIT}",
                amount(size),
                amount(left)
            )
        })?;
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(size as usize)
        .map_err(|_| format!("there is no memory for its {}", amount(size)))?;
    // A file that grows meanwhile gives no more than was counted.
    file.take(size)
        .read_to_end(&mut bytes)
        .map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// Pipes and devices could keep us waiting, or give without end.
fn open_regular(path: &Path) -> Result<File, String> {
    let found = std::fs::metadata(path).map_err(|e| e.to_string())?;
    if found.is_dir() {
        return Err("it is a directory".to_owned());
    }
    if !found.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    File::open(path).map_err(|e| e.to_string())
}

/// Reads a file that a scene names, by a path that is absolute or relative to the scene's folder.
/// Without `outside_files` it must lie in or under that folder.
fn resolve_beside(
    folder: &Path,
    uri: &str,
    outside_files: bool,
    allowance: &AtomicU64,
) -> Result<Vec<u8>, String> {
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let path = if outside_files {
        folder.join(uri)
    } else {
        path_inside(folder, uri)?
    };
    read_limited(&path, allowance).map_err(|e| unreadable(uri, e))
}

/// The path of a file that lies in or under a folder, by its path and after all symbolic links. What
/// leads elsewhere by its path is not looked for: it may be on another machine.
fn path_inside(folder: &Path, uri: &str) -> Result<PathBuf, String> {
    let named = Path::new(uri);
    let absolute = [std::path::absolute(folder), folder.canonicalize()];
    let mut within = absolute.iter().flatten().map(|own| named.strip_prefix(own));
    let relative = within.find_map(Result::ok).unwrap_or(named);
    let mut depth = 0i32;
    for part in relative.components() {
        match part {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir => depth -= 1,
            Component::RootDir | Component::Prefix(_) => depth = -1,
        }
        if depth < 0 {
            return Err(format!("\"{uri}\" leads out of the scene's folder"));
        }
    }
    let path = folder.join(relative);
    let resolved = |path: &Path| {
        path.canonicalize()
            .map_err(|e| unreadable(uri, e.to_string()))
    };
    if resolved(&path)?.starts_with(resolved(folder)?) {
        Ok(path)
    } else {
        Err(format!(
            "\"{uri}\" is a link that leads out of the scene's folder"
        ))
    }
}

fn unreadable(uri: &str, cause: String) -> String {
    format!("\"{uri}\" cannot be read: {cause}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_and_a_missing_file_are_errors_that_name_it() {
        let directory = load(Path::new("."), &LoadOptions::default());
        assert!(directory.is_err_and(|e| e.to_string() == ". cannot be read: it is a directory"));
        let missing = load(Path::new("no/such.glb"), &LoadOptions::default());
        assert!(missing.is_err_and(|e| e.to_string().starts_with("no/such.glb cannot be read")));
    }

    #[test]
    fn files_beyond_the_limit_name_it() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("a.gltf");
        let text = r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"uri": "a.bin", "byteLength": 36}]}"#;
        std::fs::write(&scene, text).unwrap();
        std::fs::write(folder.path().join("a.bin"), [0; 36]).unwrap();
        let both = text.len() as u64 + 36;
        for (max_file_bytes, place) in [(both - 37, "file"), (both - 1, "buffers[0]")] {
            let options = LoadOptions {
                max_file_bytes,
                ..LoadOptions::default()
            };
            let error = load(&scene, &options).unwrap_err();
            assert_eq!(error.limit(), Some(Limit::FileBytes), "{error}");
            assert!(error.to_string().contains(place), "{error}");
        }
        let options = LoadOptions {
            max_file_bytes: both,
            ..LoadOptions::default()
        };
        assert!(load(&scene, &options).is_ok());
    }

    #[test]
    fn external_files_stay_in_the_scenes_folder() {
        let ask = |uri: &str| resolve_beside(Path::new("a/b"), uri, false, &AtomicU64::new(9));
        assert!(ask("../secret.bin").is_err_and(|e| e.contains("leads out")));
        assert!(ask("x/../../secret.bin").is_err_and(|e| e.contains("leads out")));
        assert!(ask("x/../own.bin").is_err_and(|e| e.contains("cannot be read")));
        assert!(ask("/etc/hosts").is_err_and(|e| e.contains("leads out")));
    }

    #[test]
    fn absolute_paths_are_taken_within_the_scenes_folder_and_elsewhere_when_allowed() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene");
        std::fs::create_dir(&scene).unwrap();
        std::fs::write(folder.path().join("other"), b"12345").unwrap();
        std::fs::write(scene.join("own"), b"1234").unwrap();
        let ask = |path: PathBuf, outside| {
            let uri = path.to_str().unwrap();
            resolve_beside(&scene, uri, outside, &AtomicU64::new(100)).map(|b| b.len())
        };
        for outside in [false, true] {
            assert_eq!(ask(scene.join("own"), outside), Ok(4));
            assert_eq!(
                ask(scene.canonicalize().unwrap().join("own"), outside),
                Ok(4)
            );
        }
        for elsewhere in [folder.path().join("other"), scene.join("../other")] {
            let text = ask(elsewhere.clone(), false).unwrap_err();
            assert!(text.contains("leads out of the scene's folder"), "{text}");
            assert_eq!(ask(elsewhere, true), Ok(5));
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_out_of_the_scenes_folder_are_followed_only_when_allowed() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene");
        std::fs::create_dir(&scene).unwrap();
        std::fs::write(folder.path().join("secret"), b"12345").unwrap();
        std::fs::write(scene.join("own"), b"1234").unwrap();
        std::os::unix::fs::symlink("../secret", scene.join("out")).unwrap();
        std::os::unix::fs::symlink("own", scene.join("in")).unwrap();
        std::os::unix::fs::symlink("..", scene.join("up")).unwrap();
        let ask = |uri: &str, outside| {
            resolve_beside(&scene, uri, outside, &AtomicU64::new(100)).map(|b| b.len())
        };
        for uri in ["out", "up/secret"] {
            let text = ask(uri, false).unwrap_err();
            assert!(
                text.contains("link that leads out of the scene's folder"),
                "{text}"
            );
            assert_eq!(ask(uri, true), Ok(5));
        }
        assert_eq!(ask("in", false), Ok(4));
        assert_eq!(ask("up/scene/own", false), Ok(4));
    }

    #[test]
    fn all_files_together_stay_below_the_limit() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a"), b"1234").unwrap();
        let left = AtomicU64::new(10);
        let ask = || resolve_beside(folder.path(), "a", false, &left);
        assert!(ask().is_ok() && ask().is_ok());
        let text = ask().unwrap_err();
        assert!(
            text.contains("4 bytes") && text.contains("2 bytes"),
            "{text}"
        );
    }
}
