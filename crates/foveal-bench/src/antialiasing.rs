//! `foveal bench antialiasing`: the original method's comparison (none, MSAA, SSAA), and ours
//! beside it.

use anyhow::Context;
use foveal::{
    Antialiasing, EdgeTest, Frame, FrameStats, Geometry, Gpu, LightAssignment, LightingModel,
    Renderer, SamplePattern, Settings,
};
use foveal_measure::{Comparison, Finding, median, turn};
use foveal_scene::{Camera, Scene};
use pollster::block_on;
use serde::Serialize;

use super::subject::{Header, Subject, SubjectArgs, timed_renderer};
use super::table::{jod_text, name_of, number_text, passes_ms, ratio_text, text};
use foveal_host::difference::Nearness;
use foveal_host::drawing::draw_with_room;
use foveal_host::picture::Picture;
use foveal_host::values;
use foveal_host::values::VariantParser;

/// Version of the JSON's shape.
const SCHEMA_VERSION: u32 = 2;

/// Frames per second that the original method reports on a GTX 960, Sponza, about 1000 x 1500:
/// none, MSAA, SSAA.
const SOURCE_FPS: [(&str, &str); 3] =
    [("none", "> 60"), ("msaa", "about 30"), ("ssaa", "about 10")];

/// Arguments of `foveal bench antialiasing`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,

    /// Width and height in pixels; by default those of the original method
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "1000x1500")]
    size: (u32, u32),

    /// Number of coloured point lights to add to the scene
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = values::point_lights)]
    point_lights: u32,

    /// Assignment of lights to samples; the original method has no clusters: brute [default:
    /// clustered]
    #[arg(long, value_name = "WHICH", value_parser = VariantParser::<LightAssignment>::new())]
    lights: Option<LightAssignment>,

    /// Model of reflection; the original method uses blinn-phong [default: ggx]
    #[arg(long, value_name = "MODEL", value_parser = VariantParser::<LightingModel>::new())]
    lighting: Option<LightingModel>,

    /// Frames of each mode, after those that warm up; figures are their medians. Below 10 there is
    /// no interval
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,

    /// Sub-samples of the SSAA picture that serves as the reference; where the device cannot draw so
    /// many at this size, the largest square number that it can. 0: no reference
    #[arg(long, value_name = "N", default_value_t = 64)]
    reference: u32,
}

/// All figures of a run.
#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    header: Header,
    point_lights: u32,
    lights: LightAssignment,
    lighting: LightingModel,
    rounds: u32,
    rows: Vec<Row>,
}

/// One mode's figures; times are medians in milliseconds.
#[derive(Debug, Serialize)]
struct Row {
    /// What tells it from the others: "msaa grid 4 surface".
    name: String,
    scene: String,
    width: u32,
    height: u32,
    geometry: Geometry,
    mode: Antialiasing,
    edge_test: EdgeTest,
    pattern: SamplePattern,
    samples: u32,
    edge_fraction: f64,
    shaded_samples: u64,
    target_bytes: u64,
    /// All from triangles to one surface per pixel; `null`, as all of passes, without timestamps.
    gbuffer_ms: Option<f64>,
    /// Shading, shading of edges, combination.
    shade_ms: Option<f64>,
    frame_ms: f64,
    /// None / this: above 1 this takes less time; with the interval of the whole frame's, where
    /// there are rounds enough.
    frame_ratio: f64,
    frame_ratio_low: Option<f64>,
    frame_ratio_high: Option<f64>,
    finding: Finding,
    shade_ratio: Option<f64>,
    /// Mean FLIP error against SSAA on a 2 x 2 grid, and against the reference.
    flip_to_ssaa: f64,
    flip_to_reference: Option<f64>,
    /// Sub-samples of the reference.
    reference_samples: Option<u32>,
    /// The same in JOD at 60 degrees across, gaze in the centre: 10 is no visible difference.
    jod_to_ssaa: Option<f32>,
    jod_to_reference: Option<f32>,
}

/// One mode while it is measured.
struct Mode {
    renderer: Renderer,
    picture: Option<Picture>,
    rounds: Vec<Times>,
    last: FrameStats,
}

#[derive(Clone, Copy)]
struct Times {
    gbuffer_ms: f64,
    shade_ms: f64,
    frame_ms: f64,
}

impl Times {
    fn of(stats: &FrameStats) -> Self {
        let sum = |names: &[&str]| {
            let passes = stats.gpu_ms.iter();
            passes
                .filter(|t| names.contains(&t.name.as_str()))
                .map(|t| t.ms)
                .sum()
        };
        Self {
            gbuffer_ms: sum(&[
                "geometry",
                "merge",
                "sorting",
                "classification",
                "binning",
                "material",
            ]),
            shade_ms: sum(&["shading", "edge shading", "combination"]),
            frame_ms: stats.frame_ms,
        }
    }
}

/// The modes: the first by each geometry is what the others are compared with, the second of all
/// what FLIP is.
fn modes(base: &Settings) -> Vec<Settings> {
    use Antialiasing::{Msaa, None, Ssaa};
    use EdgeTest::{Paper, Surface};
    use Geometry::{Gbuffer, Visibility};
    use SamplePattern::{Grid, Rotated};
    [
        (Gbuffer, None, Surface, Grid, 4),
        (Gbuffer, Ssaa, Surface, Grid, 4),
        (Gbuffer, Msaa, Surface, Grid, 4),
        (Visibility, None, Surface, Grid, 4),
        (Visibility, Msaa, Surface, Grid, 4),
        (Gbuffer, Msaa, Paper, Grid, 4),
        (Gbuffer, Msaa, Surface, Rotated, 4),
        (Gbuffer, Msaa, Surface, Rotated, 8),
    ]
    .map(|(geometry, aa, edge_test, pattern, samples)| {
        base.clone().with(|s| {
            s.geometry.path = geometry;
            s.antialiasing.mode = aa;
            s.antialiasing.edge_test = edge_test;
            s.antialiasing.pattern = pattern;
            s.antialiasing.samples = samples;
        })
    })
    .to_vec()
}

/// The settings of the reference, before anything is measured: of `samples` sub-samples, or of the
/// largest square number that a device with these limits can draw. `None` for 0.
fn reference_of(
    base: &Settings,
    samples: u32,
    limits: &wgpu::Limits,
) -> Result<Option<Settings>, foveal::Error> {
    if samples == 0 {
        return Ok(None);
    }
    let of = |samples| {
        base.clone().with(|s| {
            s.antialiasing.mode = Antialiasing::Ssaa;
            s.antialiasing.samples = samples;
        })
    };
    let error = match of(samples).validate(limits) {
        Ok(()) => return Ok(Some(of(samples))),
        Err(error @ foveal::Error::Limit { .. }) => error,
        Err(error) => return Err(error),
    };
    let fewer = (2..samples.isqrt()).rev().map(|side| of(side * side));
    let mut fitting = fewer.filter(|settings| settings.validate(limits).is_ok());
    fitting.next().map(Some).ok_or(error)
}

/// What `draw` makes of the reference's settings; of fewer sub-samples where the device has no memory
/// for these. `None` for 0.
fn drawn_reference<P>(
    base: &Settings,
    mut samples: u32,
    limits: &wgpu::Limits,
    mut draw: impl FnMut(&Settings) -> anyhow::Result<P>,
) -> anyhow::Result<Option<(u32, P)>> {
    while let Some(settings) = reference_of(base, samples, limits)? {
        let tried = settings.antialiasing.samples;
        let error = match draw(&settings) {
            Ok(drawn) => return Ok(Some((tried, drawn))),
            Err(error) => error,
        };
        let side = tried.isqrt() - 1;
        match error.downcast_ref() {
            Some(foveal::Error::OutOfMemory { .. }) if side > 1 => samples = side * side,
            _ => return Err(error),
        }
    }
    Ok(None)
}

/// Runs the benchmark.
pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let subject = args.subject.open(args.point_lights)?;
    let base = Settings::default().with(|s| {
        s.picture.width = args.size.0;
        s.picture.height = args.size.1;
        s.lighting.assignment = args.lights.unwrap_or_default();
        s.lighting.model = args.lighting.unwrap_or_default();
    });
    let report = Report {
        header: subject.header("foveal-bench-antialiasing", SCHEMA_VERSION),
        rows: rows(args, &subject, &base)?,
        point_lights: args.point_lights,
        lights: base.lighting.assignment,
        lighting: base.lighting.model,
        rounds: args.rounds,
    };
    args.subject.give(&report, &summary(&report))
}

fn rows(
    args: &Args,
    Subject { gpu, scene, camera }: &Subject,
    base: &Settings,
) -> anyhow::Result<Vec<Row>> {
    // First: it may take more memory than all that is measured. Only its picture stays.
    let limits = gpu.device.limits();
    let reference = drawn_reference(base, args.reference, &limits, |settings| {
        let mut mode = Mode::new(gpu, scene, settings)?;
        mode.warm_up(camera)?;
        mode.picture.context("the reference has no picture")
    })?;
    let mut modes = modes(base)
        .iter()
        .map(|settings| Mode::new(gpu, scene, settings))
        .collect::<anyhow::Result<Vec<_>>>()?;
    for mode in &mut modes {
        mode.warm_up(camera)?;
    }
    for round in 0..u64::from(args.rounds) {
        for number in turn(round, modes.len()) {
            let stats = modes[number].draw(camera)?;
            modes[number].rounds.push(Times::of(&stats));
        }
    }
    let pictures: Vec<_> = modes.iter_mut().filter_map(|m| m.picture.take()).collect();
    Ok((modes.iter().zip(&pictures).enumerate())
        .map(|(number, (mode, picture))| {
            let near = |reference: &Picture| Nearness::of(reference, picture);
            let reference = (reference.as_ref()).map(|(samples, of)| (*samples, near(of)));
            // Each is compared with none by the same geometry.
            let geometry = mode.renderer.settings().geometry.path;
            let same = |m: &Mode| m.renderer.settings().geometry.path == geometry;
            let none = modes.iter().position(same).unwrap_or(number);
            let compared = |figure: fn(&Times) -> f64| {
                let (none_ms, ms) = (modes[none].times(figure), mode.times(figure));
                Comparison::of_rounds(modes.len(), (none, &none_ms), (number, &ms))
            };
            mode.row(&scene.name, &compared, near(&pictures[1]), reference)
        })
        .collect())
}

impl Mode {
    fn new(gpu: &Gpu, scene: &Scene, settings: &Settings) -> anyhow::Result<Self> {
        let renderer = timed_renderer(gpu, scene, settings)?;
        Ok(Self {
            renderer,
            picture: None,
            rounds: Vec::new(),
            last: FrameStats::default(),
        })
    }

    /// Draws a picture that is kept, and makes room for its surfaces.
    fn warm_up(&mut self, camera: &Camera) -> anyhow::Result<()> {
        let FrameStats { width, height, .. } = draw_with_room(|| self.draw(camera))?;
        let bytes = block_on(self.renderer.read_picture())?;
        self.picture = Some(Picture::from_rgba(width, height, bytes)?);
        Ok(())
    }

    fn draw(&mut self, camera: &Camera) -> anyhow::Result<FrameStats> {
        self.last = block_on(self.renderer.render(&Frame::new(camera)))?;
        Ok(self.last.clone())
    }

    fn times(&self, figure: fn(&Times) -> f64) -> Vec<f64> {
        self.rounds.iter().map(figure).collect()
    }

    /// The mode's row; `compared` compares one of its times with that of none.
    fn row(
        &self,
        scene: &str,
        compared: &dyn Fn(fn(&Times) -> f64) -> Option<Comparison>,
        to_ssaa: Nearness,
        to_reference: Option<(u32, Nearness)>,
    ) -> Row {
        let settings = self.renderer.settings();
        let frame = compared(|t| t.frame_ms);
        let interval = frame.as_ref().and_then(|frame| frame.interval);
        Row {
            name: called(settings),
            scene: scene.to_owned(),
            width: settings.picture.width,
            height: settings.picture.height,
            geometry: settings.geometry.path,
            mode: settings.antialiasing.mode,
            edge_test: settings.antialiasing.edge_test,
            pattern: settings.antialiasing.pattern,
            samples: match settings.antialiasing.mode {
                Antialiasing::None => 1,
                _ => settings.antialiasing.samples,
            },
            edge_fraction: self.last.edge_fraction,
            shaded_samples: self.last.shaded_samples,
            target_bytes: self.last.target_bytes,
            gbuffer_ms: passes_ms(&self.times(|t| t.gbuffer_ms)),
            shade_ms: passes_ms(&self.times(|t| t.shade_ms)),
            frame_ms: median(&self.times(|t| t.frame_ms)),
            frame_ratio: frame.as_ref().map_or(1.0, |frame| frame.ratio),
            frame_ratio_low: interval.map(|ends| ends[0]),
            frame_ratio_high: interval.map(|ends| ends[1]),
            finding: frame.map_or(Finding::TooFew, |frame| frame.finding),
            shade_ratio: compared(|t| t.shade_ms).map(|shade| shade.ratio),
            flip_to_ssaa: to_ssaa.flip,
            flip_to_reference: to_reference.map(|(_, near)| near.flip),
            reference_samples: to_reference.map(|(samples, _)| samples),
            jod_to_ssaa: to_ssaa.jod,
            jod_to_reference: to_reference.and_then(|(_, near)| near.jod),
        }
    }
}

/// What tells a mode from the others.
fn called(settings: &Settings) -> String {
    let (mode, pattern) = (
        name_of(settings.antialiasing.mode),
        name_of(settings.antialiasing.pattern),
    );
    match settings.antialiasing.mode {
        _ if settings.geometry.path == Geometry::Visibility => format!("{mode}, visibility"),
        Antialiasing::None => mode,
        Antialiasing::Ssaa => format!("{mode} {pattern} {}", settings.antialiasing.samples),
        Antialiasing::Msaa => {
            let test = name_of(settings.antialiasing.edge_test);
            format!("{mode} {pattern} {} {test}", settings.antialiasing.samples)
        }
    }
}

fn summary(report: &Report) -> String {
    let head = [
        "mode",
        "edges",
        "G-buffer ms",
        "shade ms",
        "frame ms",
        "none/frame",
        "none/shade",
        "FLIP to ssaa",
        "FLIP to reference",
        "JOD to reference",
        "MB",
        "source fps",
    ];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    for row in &report.rows {
        let mode = name_of(row.mode);
        let source = SOURCE_FPS.iter().find(|(m, _)| *m == mode);
        lines.push(vec![
            row.name.clone(),
            format!("{:.2} %", row.edge_fraction * 100.0),
            number_text(row.gbuffer_ms, 2),
            number_text(row.shade_ms, 2),
            format!("{:.1}", row.frame_ms),
            ratio_text(row.frame_ratio, row.finding, 3),
            number_text(row.shade_ratio, 3),
            format!("{:.4}", row.flip_to_ssaa),
            number_text(row.flip_to_reference, 4),
            jod_text(row.jod_to_reference),
            format!("{:.0}", row.target_bytes as f64 / 1e6),
            source.map_or(String::new(), |(_, fps)| (*fps).to_owned()),
        ]);
    }
    let about = report.rows.first().map_or(String::new(), |row| {
        format!(
            "{} at {}x{}, {} point lights added, {}, {}, {}, medians of {} rounds{}\n",
            report.header.scene,
            row.width,
            row.height,
            report.point_lights,
            name_of(report.lights),
            name_of(report.lighting),
            report.header.adapter.name,
            report.rounds,
            row.reference_samples
                .map_or(String::new(), |samples| format!(
                    ", reference of {samples} sub-samples"
                ))
        )
    });
    about + &text(&lines)
}

#[cfg(test)]
mod tests;
