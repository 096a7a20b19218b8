//! From the word on the command line to a scene: the name of a generated scene, or a file's path.

use std::io::Read;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, bail};
use foveal::Timing;
use foveal_generate as generate;
use foveal_generate::{DemoOptions, GenerateError};
use foveal_scene::{Camera, Clip, LoadOptions, LoadTimings, Scene, TextureCompression};

use crate::atomic_file;
use crate::failure::usage;
use crate::import_args::{self, NoSuchScene};

/// What is drawn without SCENE.
pub const DEFAULT_SCENE: &str = "demo";

/// The name of standard input.
pub const STDIN: &str = "-";

/// A camera for every moment, in seconds.
pub type TimedCamera = Box<dyn Fn(f32) -> Camera>;

/// Loads or generates the scene called `name`, posed at time 0, and adds the time of each stage to
/// `load_ms`.
///
/// A generated scene's name wins over a file of the same name; `./demo` means the file. `-` is a
/// file on standard input that refers to no other: a .glb.
pub fn load_timed(
    name: &str,
    options: &LoadOptions,
    load_ms: &mut Vec<Timing>,
) -> anyhow::Result<Scene> {
    let start = Instant::now();
    if name == STDIN {
        return from_stdin(options, load_ms);
    }
    match generate::by_name(name) {
        Ok(mut scene) => {
            let asks_for_one = options.variant.is_some() || options.file_scene.is_some();
            if asks_for_one || !scene.play(&options.clip) {
                bail!(
                    "the generated scene '{name}' has neither clips nor variants nor further scenes"
                );
            }
            load_ms.push(timing("generate", start.elapsed().as_secs_f64() * 1e3));
            if options.texture_compression != TextureCompression::Off {
                let start = Instant::now();
                scene.compress_textures(options.texture_compression, options.parallel);
                load_ms.push(timing("compress", start.elapsed().as_secs_f64() * 1e3));
            }
            Ok(scene)
        }
        Err(GenerateError::UnknownScene { .. }) => from_file(name, options, load_ms),
        Err(error) => Err(error.into()),
    }
}

/// As [`load_timed`], for commands to which the time is all one.
pub fn load_with(name: &str, options: &LoadOptions) -> anyhow::Result<Scene> {
    load_timed(name, options, &mut Vec::new())
}

/// As [`load_with`], for commands that show several scenes: clip, variant and scene are those of files, as
/// a generated scene has none.
pub fn load_among(name: &str, options: &LoadOptions) -> anyhow::Result<Scene> {
    let base = name.split(':').next().unwrap_or(name);
    if generate::NAMES.contains(&base) {
        let options = LoadOptions {
            clip: Clip::default(),
            variant: None,
            file_scene: None,
            ..options.clone()
        };
        return load_with(name, &options);
    }
    load_with(name, options)
}

/// Refuses several scenes that are all read from standard input, which has one.
pub fn check_once(scenes: &[String]) -> anyhow::Result<()> {
    if scenes.iter().filter(|name| *name == STDIN).count() > 1 {
        return usage("standard input has one scene; name - once");
    }
    Ok(())
}

/// As [`load_with`] by the importer's default options.
pub fn load(name: &str) -> anyhow::Result<Scene> {
    load_with(name, &LoadOptions::default())
}

/// Whether a file that is to be written would replace the scene's own.
pub fn is_replaced_by(name: &str, file: &Path) -> bool {
    name != STDIN && atomic_file::replaces(file, Path::new(name))
}

fn from_file(
    name: &str,
    options: &LoadOptions,
    load_ms: &mut Vec<Timing>,
) -> anyhow::Result<Scene> {
    let path = Path::new(name);
    // One that may not be looked at is for the reader to name.
    if matches!(path.try_exists(), Ok(false)) {
        return Err(NoSuchScene {
            name: name.to_owned(),
        }
        .into());
    }
    let scene = foveal_scene::load(path, options).map_err(import_args::with_flag)?;
    add_timings(&scene, load_ms);
    Ok(scene)
}

/// Reads standard input to its end, or to the limit of a file.
fn from_stdin(options: &LoadOptions, load_ms: &mut Vec<Timing>) -> anyhow::Result<Scene> {
    let mut bytes = Vec::new();
    std::io::stdin()
        .lock()
        .take(options.max_file_bytes.saturating_add(1))
        .read_to_end(&mut bytes)
        .context("cannot read the scene from standard input")?;
    let outside = |uri: &str| {
        Err(format!(
            "it names '{uri}', and beside standard input there are no files: pipe in a .glb"
        ))
    };
    let scene = foveal_scene::load_bytes(&bytes, "standard input", options, &outside)
        .map_err(import_args::with_flag)?;
    add_timings(&scene, load_ms);
    Ok(scene)
}

/// Adds the time of each stage of an import.
fn add_timings(scene: &Scene, load_ms: &mut Vec<Timing>) {
    let LoadTimings {
        read_ms,
        parse_ms,
        geometry_ms,
        decode_ms,
        bounds_ms,
    } = scene.timings;
    let stages = [
        ("read", read_ms),
        ("parse", parse_ms),
        ("geometry", geometry_ms),
        ("decode", decode_ms),
        ("bounds", bounds_ms),
    ];
    load_ms.extend(stages.map(|(name, ms)| timing(name, f64::from(ms))));
}

/// Seconds that the walk through the demo scene takes.
const DEMO_WALK_S: f32 = 30.0;

/// The camera path that belongs to a generated scene.
pub fn camera_path(name: &str) -> Option<TimedCamera> {
    let options = demo_options(name)?;
    Some(Box::new(move |time_s| {
        let mut camera = generate::demo_path(&options, (time_s / DEMO_WALK_S).clamp(0.0, 1.0));
        camera.name = "demo path".to_owned();
        camera
    }))
}

/// The options behind `demo` and `demo:INSTANCES`.
fn demo_options(name: &str) -> Option<DemoOptions> {
    let options = DemoOptions::default();
    match name.split_once(':') {
        None if name == "demo" => Some(options),
        Some(("demo", instances)) => Some(DemoOptions {
            instances: instances.parse().ok()?,
            ..options
        }),
        _ => None,
    }
}

/// Adds coloured point lights, the same ones for the same scene and seed.
pub fn add_point_lights(scene: &mut Scene, count: u32, seed: u64) {
    generate::add_point_lights(scene, count, seed);
}

fn timing(name: &str, ms: f64) -> Timing {
    Timing {
        name: name.to_owned(),
        ms,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_scene_lists_those_that_can_be_generated() {
        let error = load("castle.glb").unwrap_err().to_string();
        assert!(
            error.contains("'castle.glb'") && error.contains("cornell"),
            "{error}"
        );
    }

    #[test]
    fn a_file_that_may_not_be_looked_at_is_named_with_the_systems_reason() {
        let error = load(&"a".repeat(5000)).unwrap_err().to_string();
        assert!(error.contains("cannot be read"), "{error}");
    }

    #[test]
    fn a_generated_scene_has_no_clips_to_name() {
        let with = |clip| LoadOptions {
            clip,
            ..LoadOptions::default()
        };
        for clip in [Clip::Named("Run".to_owned()), Clip::Number(7)] {
            let error = load_with("cornell", &with(clip)).unwrap_err().to_string();
            assert!(error.contains("'cornell'"), "{error}");
        }
        assert!(load_with("cornell", &with(Clip::All)).is_ok());
        // Among others it is not what is meant.
        for name in ["cornell", "demo:1000"] {
            let scene = load_among(name, &with(Clip::Number(7)));
            assert!(scene.is_ok(), "{name}: {:?}", scene.err());
        }
    }

    #[test]
    fn only_the_demo_scene_has_a_path() {
        assert!(camera_path("demo").is_some() && camera_path("demo:2000").is_some());
        assert!(camera_path("cornell").is_none() && camera_path("demo.glb").is_none());
    }
}
