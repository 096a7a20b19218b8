//! One way of shading while it is measured, and how far its picture is from full shading's.

use foveal::{Frame, FrameStats, Gpu, Renderer, Settings};
use foveal_scene::{Camera, Scene};
use pollster::block_on;

use crate::subject::timed_renderer;
use foveal_host::picture::Picture;

/// One of those that are compared.
pub(super) struct Side<'a> {
    pub(super) renderer: Renderer,
    camera: &'a Camera,
    pub(super) lighting_ms: Vec<f64>,
    pub(super) material_ms: Vec<f64>,
    pub(super) frame_ms: Vec<f64>,
    pub(super) shaded_fraction: f64,
}

impl<'a> Side<'a> {
    pub(super) fn new(
        gpu: &Gpu,
        scene: &Scene,
        camera: &'a Camera,
        settings: &Settings,
    ) -> anyhow::Result<Self> {
        // What the technique itself costs: each frame shades all of its samples.
        let settings = &settings.clone().with(|s| s.coarse.history = false);
        let renderer = timed_renderer(gpu, scene, settings)?;
        let mut side = Self {
            renderer,
            camera,
            lighting_ms: Vec::new(),
            material_ms: Vec::new(),
            frame_ms: Vec::new(),
            shaded_fraction: 1.0,
        };
        // The first frame compiles.
        side.draw()?;
        side.lighting_ms.clear();
        side.material_ms.clear();
        side.frame_ms.clear();
        Ok(side)
    }

    pub(super) fn draw(&mut self) -> anyhow::Result<()> {
        let frame = Frame::new(self.camera);
        let stats = block_on(self.renderer.render(&frame))?;
        self.lighting_ms
            .push(sum_ms(&stats, |pass| !OTHER.contains(&pass)));
        self.material_ms
            .push(sum_ms(&stats, |pass| MATERIAL.contains(&pass)));
        self.frame_ms.push(stats.frame_ms);
        if let Some(coarse) = &stats.coarse {
            self.shaded_fraction = coarse.shaded_fraction;
        }
        Ok(())
    }

    pub(super) fn picture(&self) -> anyhow::Result<Picture> {
        let bytes = block_on(self.renderer.read_picture())?;
        let s = self.renderer.settings();
        Picture::from_rgba(s.picture.width, s.picture.height, bytes)
    }
}

const MATERIAL: [&str; 2] = ["binning", "material"];

/// What is not lighting.
const OTHER: [&str; 7] = [
    "geometry",
    MATERIAL[0],
    MATERIAL[1],
    "light assignment",
    "forward",
    "tone map",
    "tile counting",
];

fn sum_ms(stats: &FrameStats, counts: impl Fn(&str) -> bool) -> f64 {
    let passes = stats.gpu_ms.iter();
    let counted = passes.filter(|pass| counts(&pass.name));
    // An empty sum of floats is minus zero.
    counted.map(|pass| pass.ms).sum::<f64>() + 0.0
}

pub(super) fn fovea_differing(a: &Picture, b: &Picture, s: &Settings) -> f64 {
    let (gx, gy) = (
        s.eye.gaze[0] * a.width as f32,
        s.eye.gaze[1] * a.height as f32,
    );
    let radius = s.coarse.fovea_inner * a.height as f32;
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

pub(super) fn psnr(a: &Picture, b: &Picture) -> Option<f64> {
    let (a, b) = (a.rgb_bytes(), b.rgb_bytes());
    let squares = a
        .iter()
        .zip(&b)
        .map(|(&a, &b)| f64::from(a.abs_diff(b)).powi(2));
    let mean = squares.sum::<f64>() / a.len() as f64;
    (mean > 0.0).then(|| 10.0 * (255.0 * 255.0 / mean).log10())
}
