//! Running the program, and small things to run it on.

#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

pub(crate) mod schema;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};

use tempfile::TempDir;

/// Runs `foveal` with these words in `folder`.
pub(crate) fn foveal_in(folder: &Path, words: &[&str]) -> Output {
    command(folder, words).output().unwrap()
}

/// Starts `foveal` with these words in `folder`.
pub(crate) fn spawn_in(folder: &Path, words: &[&str]) -> Child {
    command(folder, words).spawn().unwrap()
}

/// `foveal` with these words in `folder`, not started yet.
pub(crate) fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_foveal"));
    // Graphics drivers complain on stderr without a runtime folder.
    command
        .args(words)
        .current_dir(folder)
        .env("XDG_RUNTIME_DIR", std::env::temp_dir());
    command
}

/// What the program said on stderr.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// What the program said on stdout.
pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Runs `foveal` in `folder` and expects it to succeed.
pub(crate) fn succeed(folder: &Path, words: &[&str]) -> Output {
    let output = foveal_in(folder, words);
    assert_eq!(
        output.status.code(),
        Some(0),
        "foveal {}: {}",
        words.join(" "),
        stderr(&output)
    );
    output
}

/// Runs `foveal` in `folder` and expects one paragraph that names `causes`, with exit code 1.
pub(crate) fn fail(folder: &Path, words: &[&str], causes: &[&str]) {
    let output = foveal_in(folder, words);
    let said = stderr(&output);
    let line = words.join(" ");
    assert_eq!(output.status.code(), Some(1), "foveal {line}: {said}");
    assert!(
        said.starts_with("error: ") && said.trim_end().lines().count() == 1,
        "foveal {line}: {said}"
    );
    for cause in causes {
        assert!(
            said.contains(cause),
            "foveal {line}: '{cause}' is not in: {said}"
        );
    }
}

/// The names of the files in a folder, sorted.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// An empty folder that goes away with the test.
pub(crate) fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// Writes a PNG of `width` x `height` pixels.
pub(crate) fn png(
    folder: &Path,
    name: &str,
    width: u32,
    height: u32,
    pixel: impl Fn(u32, u32) -> [u8; 3],
) {
    let picture = image::RgbImage::from_fn(width, height, |x, y| image::Rgb(pixel(x, y)));
    picture.save(folder.join(name)).unwrap();
}

/// Writes a glTF file of one triangle that moves from left to right in two seconds, and its buffer.
pub(crate) fn moving_triangle(folder: &Path) -> PathBuf {
    let positions = [-1.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.5, 0.0];
    let times = [0.0f32, 2.0];
    let places = [-1.0f32, 0.0, 0.0, 1.0, 0.5, 0.0];
    let floats = positions.iter().chain(&times).chain(&places);
    let bytes: Vec<u8> = floats.flat_map(|f| f.to_le_bytes()).collect();
    std::fs::write(folder.join("triangle.bin"), bytes).unwrap();
    let json = serde_json::json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"mesh": 0, "name": "mover"},
            {"camera": 0, "name": "front", "translation": [0.0, 0.7, 4.0]}
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"doubleSided": true, "pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.4, 0.1, 1.0]}}],
        "buffers": [{"uri": "triangle.bin", "byteLength": 68}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 8},
            {"buffer": 0, "byteOffset": 44, "byteLength": 24}
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, 0, 0], "max": [1, 1.5, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [2]},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}
        ],
        "animations": [{
            "samplers": [{"input": 1, "output": 2}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]
        }]
    });
    let path = folder.join("triangle.gltf");
    std::fs::write(&path, json.to_string()).unwrap();
    path
}
