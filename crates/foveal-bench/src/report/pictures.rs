//! Before and after, as the page shows them.

use anyhow::Context;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use foveal::{Frame, Gpu, Renderer, Settings};
use foveal_host::command_line::quoted;
use foveal_scene::{Camera, Scene};
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};
use pollster::block_on;
use serde_json::{Value, json};

use super::bench::Bench;
use crate::changes::{Changes, changed};
use foveal_host::camera::{CameraArgs, Viewpoint};
use foveal_host::difference::{BENCH_DISPLAY, ErrorMap, jod};
use foveal_host::import_args::ImportArgs;
use foveal_host::picture::Picture;
use foveal_host::settings::flags;
use foveal_host::{gpu, scene_source};

/// Frames until a rate that follows the last picture has settled.
const FRAMES: u32 = 3;

/// How well the page's pictures keep what they show.
const JPEG_QUALITY: u8 = 88;

/// The pairs of a bench, in a scene that is read by these flags.
pub(super) fn draw(
    bench: &Bench,
    (scene_name, import): (&str, &ImportArgs),
    size: (u32, u32),
    adapter: Option<&str>,
) -> anyhow::Result<Vec<Value>> {
    let gpu = gpu::open(adapter)?;
    let mut scene = scene_source::load_with(scene_name, &import.options())?;
    scene.light_by_default();
    let camera = Viewpoint::choose(&CameraArgs::default(), &scene, scene_name)?.at(&scene, 0.0);
    let adapter = adapter.into_iter();
    let flags = adapter.flat_map(|name| ["--adapter".to_owned(), name.to_owned()]);
    let flags = flags.chain(import.flags());
    let flags: String = flags.map(|word| format!(" {}", quoted(&word))).collect();
    let mut pictures = Vec::new();
    for pair in bench.pairs {
        let (before, before_settings) = one(&gpu, &scene, &camera, size, pair.before)?;
        let (after, after_settings) = one(&gpu, &scene, &camera, size, pair.after)?;
        let map = ErrorMap::between(&before, &after);
        let shown = before_settings.picture_size();
        pictures.push(json!({
            "title": pair.title,
            "before_flags": spelled(scene_name, "before.png", &before_settings, &flags),
            "after_flags": spelled(scene_name, "after.png", &after_settings, &flags),
            "compare": format!("foveal compare before.png after.png --display {BENCH_DISPLAY}"),
            "flip_mean": map.mean(),
            "jod": jod(&before, &after),
            "before": jpeg(&before.rgb_bytes(), shown)?,
            "after": jpeg(&after.rgb_bytes(), shown)?,
            "difference": jpeg(&map.heat_rgb(), shown)?,
        }));
    }
    Ok(pictures)
}

/// Takes the pictures themselves out of a report.
pub(super) fn strip(report: &mut Value) {
    for bench in report["benches"].as_array_mut().into_iter().flatten() {
        for picture in bench["pictures"].as_array_mut().into_iter().flatten() {
            if let Some(picture) = picture.as_object_mut() {
                for key in ["before", "after", "difference"] {
                    picture.remove(key);
                }
            }
        }
    }
}

/// The command that draws it.
fn spelled(scene: &str, output: &str, settings: &Settings, more: &str) -> String {
    let (scene, flags) = (quoted(scene), flags(settings).join(" "));
    let warmup = FRAMES - 1;
    format!("foveal render {scene} --output {output} --warmup {warmup} {flags}{more}")
}

fn one(
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    size: (u32, u32),
    changes: Changes,
) -> anyhow::Result<(Picture, Settings)> {
    let settings = settings(size, changes)?;
    let mut renderer = block_on(Renderer::new(
        gpu,
        &settings,
        foveal::RendererOptions::default(),
    ))?;
    block_on(renderer.set_scene(scene))?;
    let frame = Frame::new(camera).with_previous(camera);
    for _ in 0..FRAMES {
        block_on(renderer.render(&frame))?;
    }
    let bytes = block_on(renderer.read_picture())?;
    let (width, height) = settings.picture_size();
    Ok((Picture::from_rgba(width, height, bytes)?, settings))
}

/// Settings that differ from the defaults by these.
fn settings(size: (u32, u32), changes: Changes) -> anyhow::Result<Settings> {
    let plain = Settings::default().with(|s| {
        s.picture.width = size.0;
        s.picture.height = size.1;
    });
    changed(&plain, changes)
}

/// A data URL.
fn jpeg(rgb: &[u8], (width, height): (u32, u32)) -> anyhow::Result<String> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)
        .write_image(rgb, width, height, ExtendedColorType::Rgb8)
        .context("cannot encode a picture")?;
    Ok(format!(
        "data:image/jpeg;base64,{}",
        BASE64_STANDARD.encode(&bytes)
    ))
}

#[cfg(test)]
mod tests {
    use super::super::plan::BENCHES;
    use super::settings;

    #[test]
    fn every_pair_differs_in_settings_that_are_there() {
        for pair in BENCHES.iter().flat_map(|bench| bench.pairs) {
            let [before, after] = [pair.before, pair.after].map(|changes| {
                let settings = settings((64, 48), changes).expect(pair.title);
                settings
                    .validate(&wgpu::Limits::default())
                    .expect(pair.title);
                settings
            });
            assert_ne!(before, after, "{}", pair.title);
        }
    }
}
