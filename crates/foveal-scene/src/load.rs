//! The doors to the glTF importer: from a path, or from bytes where there are no files.
//!
//! File access happens in [`load`] alone; [`load_bytes`] asks a resolver for what lies outside
//! the bytes, so that a browser can load a `.glb` that it has fetched.

use std::path::{Component, Path};

use crate::{Scene, SceneError, gltf};

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
    /// Use the threads of the current rayon pool; without, everything happens on the caller's thread.
    pub parallel: bool,
    /// How normals are made where the file gives none.
    pub missing_normals: MissingNormals,
    /// Allow external files outside the scene's own folder (`../textures/wood.png`).
    pub outside_files: bool,
    /// Largest size in bytes of the file and of each file that it names.
    pub max_file_bytes: u64,
    /// Largest width and height of a texture in texels; larger pictures are halved until they fit.
    pub max_texture_size: u32,
    /// Most bytes of all decoded pictures together, without their mip levels; beyond it the largest
    /// pictures are halved until all fit.
    pub max_texture_bytes: u64,
    /// Most vertices of all meshes together.
    pub max_vertices: u64,
    /// Most [`Instance`](crate::Instance)s: primitives times nodes times instancing elements.
    pub max_instances: u64,
    /// Most triangles, each counted once per instance.
    pub max_triangles: u64,
}

impl Default for LoadOptions {
    /// At time 0, parallel, flat normals, own folder only; 4 GiB files, 8192-texel textures, 4 GiB of
    /// them, 64 Mi vertices, 4 Mi instances, 4 Gi triangles.
    fn default() -> Self {
        Self {
            time_s: 0.0,
            parallel: true,
            missing_normals: MissingNormals::Flat,
            outside_files: false,
            max_file_bytes: 4 << 30,
            max_texture_size: 8192,
            max_texture_bytes: 4 << 30,
            max_vertices: 64 << 20,
            max_instances: 4 << 20,
            max_triangles: 4 << 30,
        }
    }
}

/// Loads a glTF 2.0 scene: `.glb`, or `.gltf` with data URIs or external files beside it.
///
/// What the file asks for and Foveal cannot give is listed in [`Scene::warnings`]. A picture that is
/// missing or broken is such a warning, and a magenta checker board takes its place as a colour (a
/// neutral value as anything else). Nodes without geometry, lights or cameras leave no trace.
///
/// # Errors
/// When the file cannot be read, is not glTF 2.0, contradicts itself so that no sensible picture can
/// be made, requires an unsupported extension, or is beyond a limit of `options`.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    let watch = crate::timings::Stopwatch::start();
    let file = path.display().to_string();
    let bytes = read_limited(path, options.max_file_bytes).map_err(|cause| SceneError::Read {
        file: file.clone(),
        cause,
    })?;
    let read_ms = watch.elapsed_ms();
    let folder = path.parent().unwrap_or(Path::new(""));
    let resolver = |uri: &str| resolve_beside(folder, uri, options);
    let mut scene = gltf::import(&bytes, &file, options, &resolver)?;
    scene.name = path
        .file_name()
        .map_or_else(|| file.clone(), |n| n.to_string_lossy().into_owned());
    scene.timings.read_ms += read_ms;
    Ok(scene)
}

/// Loads a glTF 2.0 scene from memory; `name` is used in messages and as [`Scene::name`].
///
/// `resolver` is called with the percent-decoded relative URI of each external file and gives its
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
                "{} bytes, the limit is {}",
                bytes.len(),
                options.max_file_bytes
            ),
        });
    }
    gltf::import(bytes, name, options, resolver)
}

/// Reads a regular file of bounded size.
fn read_limited(path: &Path, max_bytes: u64) -> Result<Vec<u8>, String> {
    let found = std::fs::metadata(path).map_err(|e| e.to_string())?;
    if found.is_dir() {
        return Err("it is a directory".to_owned());
    }
    // Pipes and devices could keep us waiting, or give without end.
    if !found.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    if found.len() > max_bytes {
        return Err(format!(
            "it has {} bytes, the limit is {max_bytes}",
            found.len()
        ));
    }
    std::fs::read(path).map_err(|e| e.to_string())
}

/// Reads a file that a scene names, which must lie in or under the scene's folder unless the options allow more.
fn resolve_beside(folder: &Path, uri: &str, options: &LoadOptions) -> Result<Vec<u8>, String> {
    let relative = Path::new(uri);
    let mut depth = 0i32;
    for part in relative.components() {
        match part {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir => depth -= 1,
            Component::RootDir | Component::Prefix(_) => {
                return Err(format!("\"{uri}\" is not a relative path"));
            }
        }
        if depth < 0 && !options.outside_files {
            return Err(format!("\"{uri}\" leads out of the scene's folder"));
        }
    }
    read_limited(&folder.join(relative), options.max_file_bytes)
        .map_err(|e| format!("\"{uri}\" cannot be read: {e}"))
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
    fn external_files_stay_in_the_scenes_folder() {
        let options = LoadOptions::default();
        let ask = |uri: &str| resolve_beside(Path::new("a/b"), uri, &options);
        assert!(ask("../secret.bin").is_err_and(|e| e.contains("leads out")));
        assert!(ask("x/../../secret.bin").is_err_and(|e| e.contains("leads out")));
        assert!(ask("x/../own.bin").is_err_and(|e| e.contains("cannot be read")));
        assert!(ask("/etc/hosts").is_err_and(|e| e.contains("not a relative path")));
    }
}
