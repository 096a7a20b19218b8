//! Files of others, where they are at hand: every sample gives a picture, every malformed file a
//! picture or an error, none a panic or a long wait.
#![allow(
    clippy::print_stdout,
    reason = "a test says what it skipped and what it measured"
)]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use foveal::{Frame, Gpu, Renderer, Settings};
use foveal_scene::LoadOptions;

/// The most that loading and drawing one file may take; debug builds on busy machines get some
/// grace.
const LONGEST: Duration = Duration::from_secs(if cfg!(debug_assertions) { 20 } else { 5 });

fn shared(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data")
        .join(folder);
    if path.is_dir() {
        return Some(path);
    }
    println!("skipped: {} is not there", path.display());
    None
}

/// All glTF files below a folder, sorted.
fn scenes_below(folder: &Path) -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

fn renderer() -> Renderer {
    let settings = Settings::default().with(|s| {
        s.picture.width = 96;
        s.picture.height = 54;
    });
    pollster::block_on(async {
        let gpu = Gpu::open(None)
            .await
            .expect("the tests need a graphics adapter");
        Renderer::new(&gpu, &settings, foveal::RendererOptions::default())
            .await
            .expect("settings fit")
    })
}

/// The file's picture from its first camera, or what is wrong with it.
fn draw(renderer: &mut Renderer, file: &Path) -> Result<Vec<u8>, String> {
    let mut scene = foveal_scene::load(file, &LoadOptions::default()).map_err(|e| e.to_string())?;
    scene.light_by_default();
    let camera = scene
        .cameras
        .first()
        .cloned()
        .unwrap_or_else(|| scene.overview_camera());
    pollster::block_on(async {
        renderer
            .set_scene(&scene)
            .await
            .map_err(|e| e.to_string())?;
        let frame = Frame::new(&camera);
        renderer.render(&frame).await.map_err(|e| e.to_string())?;
        renderer.read_picture().await.map_err(|e| e.to_string())
    })
}

#[test]
fn every_sample_gives_a_picture_with_something_in_it() {
    let Some(folder) = shared("samples") else {
        return;
    };
    let mut renderer = renderer();
    let files = scenes_below(&folder);
    for file in &files {
        let picture =
            draw(&mut renderer, file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let colors: std::collections::BTreeSet<&[u8]> = picture.chunks_exact(4).collect();
        // The backdrop alone is a gradient of few colours.
        assert!(
            colors.len() > 60,
            "{}: only {} colours",
            file.display(),
            colors.len()
        );
    }
    println!("{} samples drawn", files.len());
}

#[test]
fn every_malformed_file_gives_a_picture_or_an_error_in_time() {
    let Some(folder) = shared("malformed") else {
        return;
    };
    let mut renderer = renderer();
    let (mut pictures, mut errors) = (0, 0);
    for file in scenes_below(&folder) {
        let start = Instant::now();
        match draw(&mut renderer, &file) {
            Ok(_) => pictures += 1,
            Err(error) => {
                assert!(
                    !error.is_empty() && !error.contains("graphics API reported"),
                    "{}: {error}",
                    file.display()
                );
                errors += 1;
            }
        }
        assert!(
            start.elapsed() < LONGEST,
            "{} took {:?}",
            file.display(),
            start.elapsed()
        );
    }
    println!("{pictures} pictures, {errors} errors");
    assert!(
        pictures > 50 && errors > 20,
        "{pictures} pictures, {errors} errors"
    );
}
