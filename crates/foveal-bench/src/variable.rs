//! `foveal bench variable`: shading at a rate that the content decides, against full shading, frame
//! by frame in turn while the camera sways.

use foveal::{
    AdapterStats, Frame, FrameStats, Geometry, Gpu, RateSource, RateStage, Renderer, Settings,
    Shading,
};
use foveal_measure::{Comparison, Finding, median, turn};
use foveal_scene::{Camera, ProceduralLayers, Scene};
use pollster::block_on;
use serde::Serialize;

use super::subject::{SubjectArgs, lit, timed_renderer, warn};
use super::table::{jod_text, name_of, number_text, passes_ms, ratio_text, text};
use foveal_host::difference::Nearness;
use foveal_host::picture::Picture;
use foveal_host::values;

/// Version of the JSON's shape.
const SCHEMA_VERSION: u32 = 2;

/// What the original method reports, in milliseconds: mask, reprojection, saved, net.
const SOURCE_MS: [&str; 4] = ["0.08", "0.02", "0.06", "-0.04"];

/// Frames that compile shaders and fill the history.
const WARM_UP: u32 = 2;

/// Arguments of `foveal bench variable`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,

    /// Width and height in pixels
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "960x540")]
    size: (u32, u32),

    /// Number of coloured point lights to add to the scene; may be given several times
    #[arg(long, value_name = "N", default_values_t = [32, 128], value_parser = values::point_lights)]
    point_lights: Vec<u32>,

    /// Contrast thresholds; may be given several times
    #[arg(long, value_name = "X", default_values_t = [0.04])]
    contrast_threshold: Vec<f32>,

    /// Sideways movement of the camera per frame in metres
    #[arg(long, value_name = "M", default_value_t = 0.01, value_parser = values::finite)]
    step: f32,

    /// Measured frames, after those that warm up; figures are their medians
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,
}

/// All figures of a run.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    schema_version: u32,
    adapter: AdapterStats,
    rounds: u32,
    rows: Vec<Row>,
}

/// One measurement; times are medians in milliseconds.
#[derive(Debug, Serialize)]
struct Row {
    scene: String,
    width: u32,
    height: u32,
    stage: RateStage,
    material_cost: &'static str,
    lights: u64,
    contrast_threshold: f32,
    /// `null`, as all times of passes, without timestamps.
    mask_ms: Option<f64>,
    reproject_ms: Option<f64>,
    binning_ms: Option<f64>,
    full_frame_ms: f64,
    variable_frame_ms: f64,
    /// Full / variable, whole frames: above 1 variable is faster; with its interval where there are
    /// rounds enough.
    frame_ratio: f64,
    frame_ratio_low: Option<f64>,
    frame_ratio_high: Option<f64>,
    finding: Finding,
    full_ms: Option<f64>,
    variable_ms: Option<f64>,
    saved_ms: Option<f64>,
    net_ms: Option<f64>,
    /// Median of the ratios of `full_ms` to `variable_ms` within each frame.
    ratio: Option<f64>,
    shaded_fraction: f64,
    /// Of the last frame.
    flip_mean: f64,
    /// Of the last frame, at 60 degrees across, gaze in the centre: 10 is no visible difference.
    jod: Option<f32>,
}

/// What is made of the scene's materials: their factors alone, as they are, factors and eight
/// layers of noise.
const COSTS: [&str; 3] = ["plain", "textured", "procedural"];

/// Runs the benchmark.
pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let gpu = args.subject.begin()?;
    // Once: standard input has it only once.
    let own = args.subject.load()?;
    warn(&own);
    let mut rows = Vec::new();
    for &lights in &args.point_lights {
        for cost in COSTS {
            let mut scene = lit(own.clone(), lights);
            if cost != "textured" {
                strip_textures(&mut scene);
            }
            if cost == "procedural" {
                add_layers(&mut scene);
            }
            let camera = args.subject.viewpoint(&scene)?.at(&scene, 0.0);
            for stage in [RateStage::Lighting, RateStage::Material, RateStage::Both] {
                for &threshold in &args.contrast_threshold {
                    let row = measure(args, &gpu, &scene, &camera, stage, cost, threshold)?;
                    foveal_host::console::note(&text(&[line(&row)]));
                    rows.push(row);
                }
            }
        }
    }
    let report = Report {
        schema: "foveal-bench-variable",
        schema_version: SCHEMA_VERSION,
        adapter: gpu.adapter_stats(),
        rounds: args.rounds,
        rows,
    };
    args.subject.give(&report, &summary(&report))
}

/// Leaves each material its factors alone.
fn strip_textures(scene: &mut Scene) {
    for material in &mut scene.materials {
        material.base_color_texture = None;
        material.metallic_roughness_texture = None;
        material.specular_texture = None;
        material.specular_color_texture = None;
        material.normal_texture = None;
        material.occlusion_texture = None;
        material.emissive_texture = None;
    }
}

/// Gives each material layers of noise of its own.
fn add_layers(scene: &mut Scene) {
    for (seed, material) in (0..).zip(&mut scene.materials) {
        material.procedural = Some(ProceduralLayers {
            seed,
            frequency: 1.0,
        });
    }
}

/// A renderer on its way along the path.
struct Film {
    renderer: Renderer,
    last: Option<Camera>,
}

impl Film {
    fn new(gpu: &Gpu, scene: &Scene, settings: &Settings) -> anyhow::Result<Self> {
        let renderer = timed_renderer(gpu, scene, settings)?;
        Ok(Self {
            renderer,
            last: None,
        })
    }

    fn draw(&mut self, camera: &Camera) -> anyhow::Result<FrameStats> {
        let frame = Frame::new(camera).with_previous(self.last.as_ref());
        let stats = block_on(self.renderer.render(&frame))?;
        self.last = Some(camera.clone());
        Ok(stats)
    }

    fn picture(&self) -> anyhow::Result<Picture> {
        let bytes = block_on(self.renderer.read_picture())?;
        let s = self.renderer.settings();
        Picture::from_rgba(s.picture.width, s.picture.height, bytes)
    }
}

fn ms(stats: &FrameStats, passes: &[&str]) -> f64 {
    let timings = stats.gpu_ms.iter();
    timings
        .filter(|t| passes.contains(&t.name.as_str()))
        .map(|t| t.ms)
        // A sum of nothing is -0.
        .sum::<f64>()
        .max(0.0)
}

/// The passes that run at the rate.
fn passes(stage: RateStage) -> &'static [&'static str] {
    match stage {
        RateStage::Lighting => &["shading"],
        RateStage::Material => &["binning", "material"],
        RateStage::Both | RateStage::Auto => &["binning", "material", "shading"],
    }
}

fn measure(
    args: &Args,
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    stage: RateStage,
    material_cost: &'static str,
    contrast_threshold: f32,
) -> anyhow::Result<Row> {
    let full_settings = Settings::default().with(|s| {
        s.picture.width = args.size.0;
        s.picture.height = args.size.1;
        s.geometry.path = Geometry::Visibility;
    });
    let variable_settings = full_settings.clone().with(|s| {
        s.shading.mode = Shading::Variable;
        s.coarse.source = RateSource::Content;
        s.rate.stage = stage;
        s.variable.threshold = contrast_threshold;
        s.rate.force = true;
    });
    let mut full = Film::new(gpu, scene, &full_settings)?;
    let mut variable = Film::new(gpu, scene, &variable_settings)?;
    let (mut frames, mut fraction) = (Vec::new(), 1.0);
    let (mut full_frame_ms, mut variable_frame_ms) = (Vec::new(), Vec::new());
    let side = camera.world_from_view.x_axis.truncate();
    for round in 0..WARM_UP + args.rounds {
        let mut camera = camera.clone();
        let moved = side * (args.step * round as f32);
        camera.world_from_view.w_axis += moved.extend(0.0);
        let full_first = round < WARM_UP || turn(u64::from(round - WARM_UP), 2)[0] == 0;
        let (a, b) = if full_first {
            (full.draw(&camera)?, variable.draw(&camera)?)
        } else {
            let b = variable.draw(&camera)?;
            (full.draw(&camera)?, b)
        };
        if round >= WARM_UP {
            full_frame_ms.push(a.frame_ms);
            variable_frame_ms.push(b.frame_ms);
            let of = |stats, names| ms(stats, names);
            let (full, at_rate) = (of(&a, passes(stage)), of(&b, passes(stage)));
            let (mask, reproject) = (of(&b, &["rate mask"]), of(&b, &["reprojection"]));
            let binning = of(&b, &["binning"]);
            frames.push([full, at_rate, mask, reproject, binning]);
        }
        fraction = b.variable.map_or(1.0, |v| v.shaded_fraction);
    }
    let all = |figure: &dyn Fn(&[f64; 5]) -> f64| frames.iter().map(figure).collect::<Vec<_>>();
    let has_times = passes_ms(&all(&|f| f[0])).is_some();
    let median_of = |figure: &dyn Fn(&[f64; 5]) -> f64| has_times.then(|| median(&all(figure)));
    let frame = Comparison::of_rounds(2, (0, &full_frame_ms), (1, &variable_frame_ms));
    let interval = frame.as_ref().and_then(|frame| frame.interval);
    let nearness = Nearness::of(&full.picture()?, &variable.picture()?);
    Ok(Row {
        full_frame_ms: median(&full_frame_ms),
        variable_frame_ms: median(&variable_frame_ms),
        frame_ratio: frame.as_ref().map_or(1.0, |frame| frame.ratio),
        frame_ratio_low: interval.map(|ends| ends[0]),
        frame_ratio_high: interval.map(|ends| ends[1]),
        finding: frame.map_or(Finding::TooFew, |frame| frame.finding),
        scene: scene.name.clone(),
        width: args.size.0,
        height: args.size.1,
        stage,
        material_cost,
        lights: scene.lights.len() as u64,
        contrast_threshold,
        mask_ms: median_of(&|f| f[2]),
        reproject_ms: median_of(&|f| f[3]),
        binning_ms: median_of(&|f| f[4]),
        full_ms: median_of(&|f| f[0]),
        variable_ms: median_of(&|f| f[1]),
        saved_ms: median_of(&|f| f[0] - f[1]),
        net_ms: median_of(&|f| f[0] - f[1] - f[2] - f[3]),
        ratio: median_of(&|f| f[0] / f[1].max(1e-9)),
        shaded_fraction: fraction,
        flip_mean: f64::from(nearness.flip as f32),
        jod: nearness.jod,
    })
}

fn line(row: &Row) -> Vec<String> {
    let stage = name_of(row.stage);
    let time = |ms: Option<f64>| number_text(ms, 2);
    vec![
        format!("{stage}, {}, {} lights", row.material_cost, row.lights),
        format!("{:.3}", row.contrast_threshold),
        time(row.full_ms),
        time(row.variable_ms),
        time(row.mask_ms),
        time(row.reproject_ms),
        time(row.saved_ms),
        time(row.net_ms),
        ratio_text(row.frame_ratio, row.finding, 2),
        number_text(row.ratio, 2),
        format!("{:.3}", row.shaded_fraction),
        format!("{:.4}", row.flip_mean),
        jod_text(row.jod),
    ]
}

fn summary(report: &Report) -> String {
    let head = [
        "stage",
        "threshold",
        "full ms",
        "variable ms",
        "mask ms",
        "reproject ms",
        "saved ms",
        "net ms",
        "frame ratio",
        "ratio",
        "shaded",
        "FLIP",
        "JOD",
    ];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    lines.extend(report.rows.iter().map(line));
    let [mask, reproject, saved, net] = SOURCE_MS.map(str::to_owned);
    let none = String::new;
    lines.push(vec![
        "the original method's, on its GPU".to_owned(),
        "0.020".to_owned(),
        none(),
        none(),
        mask,
        reproject,
        saved,
        net,
    ]);
    let about = report.rows.first().map_or(String::new(), |row| {
        format!(
            "{} at {}x{}, {}, medians of {} frames\n",
            row.scene, row.width, row.height, report.adapter.name, report.rounds
        )
    });
    about + &text(&lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use foveal_scene::{Material, TextureRef};

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: Args,
    }

    #[test]
    fn a_step_is_a_number() {
        let step = |text: &str| {
            let line = Line::try_parse_from(["variable", "--step", text]);
            line.ok().map(|line| line.args.step)
        };
        assert_eq!(step("0.5"), Some(0.5));
        assert_eq!([step("nan"), step("inf")], [None; 2]);
    }

    #[test]
    fn plain_materials_have_no_texture_that_rates_see() {
        let texture = Some(TextureRef {
            texture: 0,
            uv_set: 0,
            uv_transform: glam::Mat3::IDENTITY,
        });
        let mut scene = Scene {
            materials: vec![Material {
                base_color_texture: texture,
                metallic_roughness_texture: texture,
                specular_texture: texture,
                specular_color_texture: texture,
                normal_texture: texture,
                occlusion_texture: texture,
                emissive_texture: texture,
                ..Material::default()
            }],
            ..Scene::default()
        };
        strip_textures(&mut scene);
        assert_eq!(scene.materials, [Material::default()]);
    }
}
