//! `foveal bench coarse`: frames in pairs, full and coarse in turn, medians of both.
//!
//! Timed is lighting with composite: all passes but geometry, light assignment, forward, tone map and the counting
//! of tiles for the statistics; the rate map is part of it.

use std::path::PathBuf;

use foveal::{
    Backend, Composite, Frame, FrameStats, Gpu, LightAssignment, Renderer, Settings, Shading,
};
use foveal_scene::{Camera, Scene};
use pollster::block_on;
use serde::Serialize;

use crate::compare::flip::ErrorMap;
use crate::median::median;
use crate::picture::Picture;
use crate::render::clock::now_ms;
use crate::{atomic_file, gpu, scene_source, values};

/// Arguments of `foveal bench coarse`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A glTF 2.0 file or a generated scene
    #[arg(default_value = scene_source::DEFAULT_SCENE)]
    scene: String,

    /// Width and height; may be given several times [default: 1000x1500 and 1920x1080]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Vec<(u32, u32)>,

    /// Point lights in place of the scene's lights; may be given several times
    #[arg(long, value_name = "N", default_values_t = [200])]
    lights: Vec<u32>,

    /// Radius where every pixel is shaded, by the picture's height; may be given several times
    #[arg(long, value_name = "R", default_values_t = [0.125])]
    fovea_inner: Vec<f32>,

    /// Pairs of frames that are measured, after one that warms up
    #[arg(long, value_name = "N", default_value_t = 3)]
    pairs: u32,

    /// The graphics adapter: part of its name, or its number in `foveal adapters`
    #[arg(long, value_name = "NAME|NUMBER")]
    adapter: Option<String>,

    /// Write the rows as JSON
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,
}

/// One measurement; docs/coarse-notes.md describes the fields.
#[derive(Debug, Serialize)]
struct Row {
    scene: String,
    width: u32,
    height: u32,
    lights: u32,
    fovea_inner: f32,
    backend: Backend,
    composite: Composite,
    levels: u32,
    shaded_fraction: f64,
    full_ms: f64,
    coarse_ms: f64,
    ratio: f64,
    full_frame_ms: f64,
    coarse_frame_ms: f64,
    flip_mean: f64,
    /// Share of pixels in the fovea's disc that differ: 0 where it is shaded as in full.
    fovea_differing: f64,
    /// `null` for equal pictures.
    psnr: Option<f64>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    if let Some(file) = &args.json {
        atomic_file::check_writable(file)?;
    }
    let sizes = match args.size.as_slice() {
        [] => &[(1000, 1500), (1920, 1080)][..],
        given => given,
    };
    let gpu = gpu::open(args.adapter.as_deref())?;
    let mut rows = Vec::new();
    for &lights in &args.lights {
        let mut scene = scene_source::load(&args.scene)?;
        scene.lights.clear();
        scene_source::add_point_lights(&mut scene, lights, 1);
        for &size in sizes {
            for &inner in &args.fovea_inner {
                for composite in [Composite::Nearest, Composite::Paper, Composite::Smooth] {
                    for backend in [Backend::Stencil, Backend::Compute] {
                        let settings = Settings {
                            width: size.0,
                            height: size.1,
                            lights: LightAssignment::Brute,
                            shading: Shading::Coarse,
                            fovea_inner: inner,
                            backend,
                            composite,
                            ..Settings::default()
                        };
                        let row = measure(args, &gpu, &scene, &settings, lights)?;
                        print(&row);
                        rows.push(row);
                    }
                }
            }
        }
    }
    if let Some(file) = &args.json {
        let json = serde_json::to_string_pretty(&rows)? + "\n";
        atomic_file::write(file, json.as_bytes())?;
    }
    Ok(())
}

fn measure(
    args: &Args,
    gpu: &Gpu,
    scene: &Scene,
    settings: &Settings,
    lights: u32,
) -> anyhow::Result<Row> {
    let camera = match scene.cameras.first() {
        Some(camera) => camera.clone(),
        None => scene.overview_camera(),
    };
    let full_settings = Settings {
        shading: Shading::Full,
        ..settings.clone()
    };
    let mut full = Side::new(gpu, scene, &camera, &full_settings)?;
    let mut coarse = Side::new(gpu, scene, &camera, settings)?;
    for _ in 0..args.pairs.max(1) {
        full.draw()?;
        coarse.draw()?;
    }
    let (a, b) = (full.picture()?, coarse.picture()?);
    let (full_ms, coarse_ms) = (median(&full.lighting_ms), median(&coarse.lighting_ms));
    Ok(Row {
        scene: args.scene.clone(),
        width: settings.width,
        height: settings.height,
        lights,
        fovea_inner: settings.fovea_inner,
        backend: settings.backend,
        composite: settings.composite,
        levels: u32::from(settings.coarsest_level) + 1,
        shaded_fraction: coarse.shaded_fraction,
        full_ms,
        coarse_ms,
        ratio: full_ms / coarse_ms,
        full_frame_ms: median(&full.frame_ms),
        coarse_frame_ms: median(&coarse.frame_ms),
        flip_mean: ErrorMap::between(&a, &b).mean(),
        fovea_differing: fovea_differing(&a, &b, settings),
        psnr: psnr(&a, &b),
    })
}

/// One of the two that are compared.
struct Side<'a> {
    renderer: Renderer,
    camera: &'a Camera,
    lighting_ms: Vec<f64>,
    frame_ms: Vec<f64>,
    shaded_fraction: f64,
}

impl<'a> Side<'a> {
    fn new(
        gpu: &Gpu,
        scene: &Scene,
        camera: &'a Camera,
        settings: &Settings,
    ) -> anyhow::Result<Self> {
        let mut renderer = block_on(Renderer::new(gpu, settings, Some(now_ms)))?;
        block_on(renderer.set_scene(scene))?;
        let mut side = Self {
            renderer,
            camera,
            lighting_ms: Vec::new(),
            frame_ms: Vec::new(),
            shaded_fraction: 1.0,
        };
        // The first frame compiles.
        side.draw()?;
        side.lighting_ms.clear();
        side.frame_ms.clear();
        Ok(side)
    }

    fn draw(&mut self) -> anyhow::Result<()> {
        let frame = Frame {
            camera: self.camera,
            previous_camera: None,
        };
        let stats = block_on(self.renderer.render(&frame))?;
        self.lighting_ms.push(lighting_ms(&stats));
        self.frame_ms.push(stats.frame_ms);
        if let Some(coarse) = &stats.coarse {
            self.shaded_fraction = coarse.shaded_fraction;
        }
        Ok(())
    }

    fn picture(&self) -> anyhow::Result<Picture> {
        let bytes = block_on(self.renderer.read_picture())?;
        let s = self.renderer.settings();
        Picture::from_rgba(s.width, s.height, &bytes)
    }
}

fn lighting_ms(stats: &FrameStats) -> f64 {
    const OTHER: [&str; 5] = [
        "geometry",
        "light assignment",
        "forward",
        "tone map",
        "tile counting",
    ];
    let passes = stats.gpu_ms.iter();
    passes
        .filter(|pass| !OTHER.contains(&pass.name.as_str()))
        .map(|pass| pass.ms)
        .sum()
}

fn fovea_differing(a: &Picture, b: &Picture, s: &Settings) -> f64 {
    let (gx, gy) = (s.gaze[0] * a.width as f32, s.gaze[1] * a.height as f32);
    let radius = s.fovea_inner * a.height as f32;
    let mut pixels = (0u64, 0u64);
    for (i, (a_pixel, b_pixel)) in a.pixels.iter().zip(&b.pixels).enumerate() {
        let x = (i % a.width as usize) as f32 + 0.5 - gx;
        let y = (i / a.width as usize) as f32 + 0.5 - gy;
        if x * x + y * y < radius * radius {
            pixels = (pixels.0 + 1, pixels.1 + u64::from(a_pixel != b_pixel));
        }
    }
    pixels.1 as f64 / pixels.0.max(1) as f64
}

fn psnr(a: &Picture, b: &Picture) -> Option<f64> {
    let (a, b) = (a.rgb_bytes(), b.rgb_bytes());
    let squares = a
        .iter()
        .zip(&b)
        .map(|(&a, &b)| f64::from(a.abs_diff(b)).powi(2));
    let mean = squares.sum::<f64>() / a.len() as f64;
    (mean > 0.0).then(|| 10.0 * (255.0 * 255.0 / mean).log10())
}

fn print(row: &Row) {
    eprintln!(
        "{} {}x{}, {} lights, inner {}: {:?} + {:?}, {:.2} % shaded: lighting {:.1} -> {:.1} ms ({:.1}x), frame {:.1} -> {:.1} ms, FLIP {:.4}, fovea {:.4}",
        row.scene,
        row.width,
        row.height,
        row.lights,
        row.fovea_inner,
        row.backend,
        row.composite,
        row.shaded_fraction * 100.0,
        row.full_ms,
        row.coarse_ms,
        row.ratio,
        row.full_frame_ms,
        row.coarse_frame_ms,
        row.flip_mean,
        row.fovea_differing,
    );
}
