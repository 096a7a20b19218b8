//! `foveal bench stereo`: two eyes by each way of submission, and one eye, in turn.
//!
//! Each way is drawn twice: the geometry alone (a view of the base colour), as the technique's
//! source measured it, and the whole frame with all deferred stages.

use foveal::{
    AdapterStats, Culling, DebugView, EyeClipping, Frame, FrameStats, Gpu, Renderer, Settings,
    Stereo, Timing,
};
use foveal_measure::{Comparison, median, turn};
use foveal_scene::{Camera, Scene};
use pollster::block_on;
use serde::Serialize;

use super::figures::FigureArgs;
use super::subject::{timed_renderer, warn};
use super::table::{number_text, passes_ms, text};
use foveal_host::camera::{CameraArgs, Viewpoint};
use foveal_host::import_args::ImportArgs;
use foveal_host::{scene_source, values};

/// Version of the JSON's shape.
const SCHEMA_VERSION: u32 = 2;

/// The source's scenes: each object is a draw of its own there, and nothing is culled.
const SOURCE_SCENES: [&str; 2] = ["materials", "materials2"];

/// What is measured without more: those, and one that is culled.
const SCENES: [&str; 3] = ["materials", "materials2", "demo"];

/// Two passes against instanced in the original method: scene, its draws, CPU, GPU.
pub(crate) const SOURCE_RATIOS: [(&str, &str, f64, f64); 2] = [
    ("materials", "20", 1.0 / 1.114, 1.0 / 1.107),
    ("materials2", "2,000", 1.0 / 0.805, 1.0 / 1.146),
];

/// A way, by its name in the table.
type Named = (&'static str, Stereo, EyeClipping);

/// The ways: one eye, the reference, and what is compared with it.
const WAYS: [Named; 5] = [
    ("mono", Stereo::Off, EyeClipping::Auto),
    ("two-pass", Stereo::TwoPass, EyeClipping::Auto),
    ("instanced + clip", Stereo::Instanced, EyeClipping::Clip),
    (
        "instanced + discard",
        Stereo::Instanced,
        EyeClipping::Discard,
    ),
    ("multiview", Stereo::Multiview, EyeClipping::Auto),
];
const REFERENCE: usize = 1;

/// Frames of each way that do not count.
const WARM_UP: u32 = 2;

/// Arguments of `foveal bench stereo`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// glTF 2.0, OBJ or PLY files, or generated scenes [default: materials materials2 demo]. All
    /// but the first two are culled by occlusion, and their equal draws are merged
    scenes: Vec<String>,

    /// Width and height of one eye's picture in pixels
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "640x480")]
    size: (u32, u32),

    #[command(flatten)]
    camera: CameraArgs,

    /// Frames of each way, after two that warm up; figures are their medians
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,

    #[command(flatten)]
    figures: FigureArgs,

    #[command(flatten)]
    import: ImportArgs,
}

/// All figures of a run; docs/program.md describes the fields.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    schema_version: u32,
    adapter: AdapterStats,
    width: u32,
    height: u32,
    rounds: u32,
    rows: Vec<Row>,
    /// Ways that this device cannot be measured by.
    skipped: Vec<Skipped>,
}

/// A way that cannot be used here.
#[derive(Debug, Serialize)]
struct Skipped {
    mode: &'static str,
    cause: String,
}

/// One way's figures; times are medians in milliseconds, ratios the reference's time by this way's:
/// above 1 this is faster.
#[derive(Debug, Serialize)]
struct Row {
    scene: String,
    /// `geometry` alone, or the whole `frame`.
    stages: &'static str,
    mode: &'static str,
    draws: u64,
    triangles: u64,
    encode_ms: f64,
    submit_ms: f64,
    /// The geometry pass, or all passes; `null`, as its ratio, without timestamps.
    gpu_ms: Option<f64>,
    frame_ms: f64,
    /// Two passes / this, the whole frame; with its interval where there are rounds enough.
    ratio_frame: f64,
    ratio_frame_low: Option<f64>,
    ratio_frame_high: Option<f64>,
    /// Two passes / this: encode and submit, then the GPU.
    ratio_cpu: Option<f64>,
    ratio_gpu: Option<f64>,
    /// One eye's frame / this.
    ratio_mono: Option<f64>,
    /// The source's figures for instancing.
    source_ratio_cpu: Option<f64>,
    source_ratio_gpu: Option<f64>,
}

/// One way while it is measured.
struct Way {
    name: &'static str,
    renderer: Renderer,
    rounds: Vec<Times>,
    last: FrameStats,
}

#[derive(Clone, Copy)]
struct Times {
    encode_ms: f64,
    submit_ms: f64,
    gpu_ms: f64,
    frame_ms: f64,
}

impl Times {
    fn of(stats: &FrameStats, geometry_alone: bool) -> Self {
        let sum = |timings: &[Timing], wanted: &dyn Fn(&str) -> bool| {
            let timings = timings.iter().filter(|t| wanted(&t.name));
            timings.map(|t| t.ms).sum()
        };
        Self {
            encode_ms: sum(&stats.cpu_ms, &|name| name == "encode"),
            submit_ms: sum(&stats.cpu_ms, &|name| name == "submit"),
            gpu_ms: sum(&stats.gpu_ms, &|name| !geometry_alone || name == "geometry"),
            frame_ms: stats.frame_ms,
        }
    }

    fn cpu_ms(&self) -> f64 {
        self.encode_ms + self.submit_ms
    }
}

/// Runs the benchmark.
pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let scenes = match args.scenes.as_slice() {
        [] => SCENES.map(str::to_owned).to_vec(),
        given => given.to_vec(),
    };
    args.camera.check()?;
    scene_source::check_once(&scenes)?;
    let gpu = args.figures.begin(&scenes, &args.camera)?;
    let (ways, skipped) = usable(&gpu)?;
    let mut rows = Vec::new();
    for name in &scenes {
        let mut scene = scene_source::load_among(name, &args.import.options())?;
        warn(&scene);
        scene.light_by_default();
        let camera = Viewpoint::choose(&args.camera, &scene, name)?.at(&scene, 0.0);
        for (stages, view) in [
            ("geometry", DebugView::BaseColor),
            ("frame", DebugView::Final),
        ] {
            let subject = (name.as_str(), &scene, &camera);
            rows.extend(measure(args, &gpu, &ways, subject, stages, view)?);
        }
    }
    let report = Report {
        schema: "foveal-bench-stereo",
        schema_version: SCHEMA_VERSION,
        adapter: gpu.adapter_stats(),
        width: args.size.0,
        height: args.size.1,
        rounds: args.rounds,
        rows,
        skipped,
    };
    args.figures.give(&report, &summary(&report))
}

/// The ways that work on this device, and those that do not.
fn usable(gpu: &Gpu) -> anyhow::Result<(Vec<Named>, Vec<Skipped>)> {
    let features = gpu.device.features();
    let has_clip = features.contains(wgpu::Features::CLIP_DISTANCES) && !gpu.is_reduced();
    let (mut ways, mut skipped) = (Vec::new(), Vec::new());
    for (mode, stereo, eye_clipping) in WAYS {
        if eye_clipping == EyeClipping::Clip && !has_clip {
            // The renderer discards there.
            let cause = "the device has no clip distances".to_owned();
            skipped.push(Skipped { mode, cause });
            continue;
        }
        let settings = Settings::default().with(|s| {
            s.picture.width = 16;
            s.picture.height = 16;
            s.stereo.mode = stereo;
        });
        match block_on(Renderer::new(
            gpu,
            &settings,
            foveal::RendererOptions::default(),
        )) {
            Ok(_) => ways.push((mode, stereo, eye_clipping)),
            Err(error @ foveal::Error::Setting { .. }) => skipped.push(Skipped {
                mode,
                cause: error.to_string(),
            }),
            Err(error) => return Err(error.into()),
        }
    }
    Ok((ways, skipped))
}

fn measure(
    args: &Args,
    gpu: &Gpu,
    usable: &[Named],
    (name, scene, camera): (&str, &Scene, &Camera),
    stages: &'static str,
    view: DebugView,
) -> anyhow::Result<Vec<Row>> {
    let of_source = SOURCE_SCENES.contains(&name);
    let mut ways = Vec::new();
    for &(mode, stereo, eye_clipping) in usable {
        let settings = Settings::default().with(|s| {
            s.picture.width = args.size.0;
            s.picture.height = args.size.1;
            s.picture.view = view;
            s.stereo.mode = stereo;
            s.stereo.clipping = eye_clipping;
            s.culling.mode = if of_source {
                Culling::Off
            } else {
                Culling::Occlusion
            };
            s.geometry.merge_draws = !of_source;
        });
        let renderer = timed_renderer(gpu, scene, &settings)?;
        ways.push(Way {
            name: mode,
            renderer,
            rounds: Vec::new(),
            last: FrameStats::default(),
        });
    }
    let frame = Frame::new(camera);
    for way in &mut ways {
        for _ in 0..WARM_UP {
            block_on(way.renderer.render(&frame))?;
        }
    }
    for round in 0..u64::from(args.rounds) {
        for number in turn(round, ways.len()) {
            let way = &mut ways[number];
            way.last = block_on(way.renderer.render(&frame))?;
            let times = Times::of(&way.last, view == DebugView::BaseColor);
            way.rounds.push(times);
        }
    }
    let rows = (0..ways.len()).map(|number| row(name, stages, &ways, number));
    Ok(rows.collect())
}

fn row(scene: &str, stages: &'static str, ways: &[Way], number: usize) -> Row {
    let way = &ways[number];
    let times = |number: usize, figure: fn(&Times) -> f64| -> Vec<f64> {
        ways[number].rounds.iter().map(figure).collect()
    };
    let median_of = |figure: fn(&Times) -> f64| median(&times(number, figure));
    let compared = |to: usize, figure: fn(&Times) -> f64| {
        let (reference, ms) = (times(to, figure), times(number, figure));
        Comparison::of_rounds(ways.len(), (to, &reference), (number, &ms))
    };
    let ratio = |to, figure| compared(to, figure).map(|found| found.ratio);
    let frame = compared(REFERENCE, |t| t.frame_ms);
    let interval = frame.as_ref().and_then(|frame| frame.interval);
    let source = SOURCE_RATIOS
        .iter()
        .find(|s| s.0 == scene && way.name.starts_with("instanced"));
    Row {
        scene: scene.to_owned(),
        stages,
        mode: way.name,
        draws: way.last.draws,
        triangles: way.last.triangles,
        encode_ms: median_of(|t| t.encode_ms),
        submit_ms: median_of(|t| t.submit_ms),
        gpu_ms: passes_ms(&times(number, |t| t.gpu_ms)),
        frame_ms: median_of(|t| t.frame_ms),
        ratio_frame: frame.as_ref().map_or(1.0, |frame| frame.ratio),
        ratio_frame_low: interval.map(|ends| ends[0]),
        ratio_frame_high: interval.map(|ends| ends[1]),
        ratio_cpu: ratio(REFERENCE, Times::cpu_ms),
        ratio_gpu: ratio(REFERENCE, |t| t.gpu_ms),
        ratio_mono: ratio(0, |t| t.frame_ms),
        source_ratio_cpu: source.map(|s| s.2),
        source_ratio_gpu: source.map(|s| s.3),
    }
}

fn summary(report: &Report) -> String {
    let head = [
        "scene",
        "stages",
        "mode",
        "draws",
        "encode ms",
        "submit ms",
        "GPU ms",
        "frame ms",
        "two-pass/frame",
        "two-pass/CPU",
        "(source)",
        "two-pass/GPU",
        "(source)",
        "mono/frame",
    ];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    let optional = |ratio: Option<f64>| ratio.map_or(String::new(), |r| format!("{r:.3}"));
    for row in &report.rows {
        lines.push(vec![
            row.scene.clone(),
            row.stages.to_owned(),
            row.mode.to_owned(),
            row.draws.to_string(),
            format!("{:.3}", row.encode_ms),
            format!("{:.3}", row.submit_ms),
            number_text(row.gpu_ms, 2),
            format!("{:.1}", row.frame_ms),
            format!("{:.3}", row.ratio_frame),
            number_text(row.ratio_cpu, 3),
            optional(row.source_ratio_cpu),
            number_text(row.ratio_gpu, 3),
            optional(row.source_ratio_gpu),
            number_text(row.ratio_mono, 3),
        ]);
    }
    let notes: Vec<String> = report
        .skipped
        .iter()
        .map(|skipped| format!("{} is left out: {}\n", skipped.mode, skipped.cause))
        .collect();
    format!(
        "{}x{} per eye, {}, medians of {} rounds\n",
        report.width, report.height, report.adapter.name, report.rounds
    ) + &text(&lines)
        + &notes.concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_without_clip_distances_is_not_measured_with_them() {
        let instance = wgpu::Instance::default();
        let adapter = block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
        let descriptor = wgpu::DeviceDescriptor {
            required_limits: Gpu::required_limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = block_on(adapter.unwrap().request_device(&descriptor)).unwrap();
        let (ways, skipped) = usable(&Gpu::from_device(device, queue)).unwrap();
        let names: Vec<&str> = ways.iter().map(|way| way.0).collect();
        assert_eq!(names, ["mono", "two-pass", "instanced + discard"]);
        let named: Vec<&str> = skipped.iter().map(|way| way.mode).collect();
        assert_eq!(named, ["instanced + clip", "multiview"]);
        assert!(skipped.iter().all(|way| !way.cause.is_empty()));
    }
}
