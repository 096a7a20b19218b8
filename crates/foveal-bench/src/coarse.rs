//! `foveal bench coarse`: full shading and coarse shading by each backend and composite, in turn,
//! medians of all.
//!
//! Timed is lighting with composite: all passes but geometry, light assignment, forward, tone map
//! and the counting of tiles for the statistics; the rate map is part of it. Materials that are
//! evaluated after the rasterizer are timed besides.

mod side;

use foveal::{
    CoarseBackend, Composite, Geometry, Gpu, LightAssignment, LightingModel, RateSource, RateStage,
    RefineEdges, Settings, Shading,
};
use foveal_measure::{Comparison, Finding, median, turn};
use foveal_scene::{Camera, Scene};
use serde::Serialize;
use side::{Side, fovea_differing, psnr};

use super::subject::{Header, SubjectArgs, warn};
use super::table::{jod_text, number_text, passes_ms, ratio_text, text};
use foveal_host::difference::Nearness;
use foveal_host::values::VariantParser;
use foveal_host::{scene_source, values};

/// Version of the JSON's shape.
const SCHEMA_VERSION: u32 = 2;

/// Frames per second that the original method reports (Radeon RX 560, 200 point lights, nine
/// levels): each pixel, the interpolating composite, the nearest one.
const SOURCE_FPS: [(&str, f64); 3] = [("full", 36.4), ("interpolated", 60.1), ("nearest", 68.6)];

/// Arguments of `foveal bench coarse`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,

    /// Width and height; may be given several times [default: 1000x1500 and 1920x1080]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Vec<(u32, u32)>,

    /// Point lights in place of the scene's lights; may be given several times
    #[arg(long, value_name = "N", default_values_t = [200], value_parser = values::point_lights)]
    lights: Vec<u32>,

    /// Range of each point light in metres; 0: no range, as in the original method [default:
    /// shorter with more lights]
    #[arg(long, value_name = "M", value_parser = values::non_negative)]
    light_range: Option<f32>,

    /// Model of reflection; the original method uses blinn-phong [default: ggx]
    #[arg(long, value_name = "MODEL", value_parser = VariantParser::<LightingModel>::new())]
    lighting: Option<LightingModel>,

    /// Radius around the gaze in which every pixel is shaded, as a fraction of the picture's
    /// height; may be given several times
    #[arg(long, value_name = "R", default_values_t = [0.125])]
    fovea_inner: Vec<f32>,

    /// Finer shading at geometric edges [default: graded]
    #[arg(long, value_name = "WHERE", value_parser = VariantParser::<RefineEdges>::new())]
    refine_edges: Option<RefineEdges>,

    /// Way in which the G-buffer is filled [default: gbuffer]
    #[arg(long, value_name = "HOW", value_parser = VariantParser::<Geometry>::new())]
    geometry: Option<Geometry>,

    /// Stage that runs once per sample; may be given several times [default: auto]
    #[arg(long, value_name = "STAGE", value_parser = VariantParser::<RateStage>::new())]
    rate_stage: Vec<RateStage>,

    /// Backends of coarse shading; may be given several times [default: stencil and compute]
    #[arg(long, value_name = "HOW", value_parser = VariantParser::<CoarseBackend>::new())]
    backend: Vec<CoarseBackend>,

    /// Add rows over 10 to 2,000 lights and over fovea radii, at the last size with the last
    /// backend
    #[arg(long)]
    sweep: bool,

    /// Measured rounds, after one that warms up; below 10 the ratio has no interval
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pairs: u32,
}

/// All figures of a run; docs/program.md describes the fields.
#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    header: Header,
    rows: Vec<Row>,
}

/// One measurement.
#[derive(Debug, Serialize)]
struct Row {
    scene: String,
    width: u32,
    height: u32,
    lights: u32,
    light_range_m: Option<f32>,
    lighting: LightingModel,
    fovea_inner: f32,
    refine_edges: RefineEdges,
    geometry: Geometry,
    rate_stage: RateStage,
    backend: CoarseBackend,
    composite: Composite,
    levels: u32,
    shaded_fraction: f64,
    /// Full / coarse, whole frames: above 1 coarse is faster; with its interval where there are
    /// pairs enough.
    frame_ratio: f64,
    frame_ratio_low: Option<f64>,
    frame_ratio_high: Option<f64>,
    finding: Finding,
    /// `null`, as all times of passes, without timestamps.
    full_ms: Option<f64>,
    coarse_ms: Option<f64>,
    /// Full / coarse, lighting alone.
    ratio: Option<f64>,
    /// Binning and evaluation of materials after the rasterizer; 0 where it does that itself.
    full_material_ms: Option<f64>,
    coarse_material_ms: Option<f64>,
    full_frame_ms: f64,
    coarse_frame_ms: f64,
    flip_mean: f64,
    /// At 60 degrees across, gaze in the centre: 10 is no visible difference.
    jod: Option<f32>,
    /// Share of pixels in the fovea's disc that differ: 0 where it is shaded as in full.
    fovea_differing: f64,
    /// `null` for equal pictures.
    psnr: Option<f64>,
}

/// What a group of rows has in common.
#[derive(Clone, Copy)]
struct Case {
    size: (u32, u32),
    lights: u32,
    fovea_inner: f32,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let sizes = match args.size.as_slice() {
        [] => &[(1000, 1500), (1920, 1080)][..],
        given => given,
    };
    let backends = match args.backend.as_slice() {
        [] => &[CoarseBackend::Stencil, CoarseBackend::Compute][..],
        given => given,
    };
    let gpu = args.subject.begin()?;
    let mut scene = args.subject.load()?;
    warn(&scene);
    let camera = args.subject.viewpoint(&scene)?.at(&scene, 0.0);
    let mut rows = Vec::new();
    let mut measure = |case: Case, backends: &[CoarseBackend]| -> anyhow::Result<()> {
        light(&mut scene, case.lights, args.light_range);
        for row in measure(args, &gpu, &scene, &camera, case, backends)? {
            print(&row);
            rows.push(row);
        }
        Ok(())
    };
    let mut last = None;
    for &lights in &args.lights {
        for &size in sizes {
            for &fovea_inner in &args.fovea_inner {
                let case = Case {
                    size,
                    lights,
                    fovea_inner,
                };
                measure(case, backends)?;
                last = Some(case);
            }
        }
    }
    if let (true, Some(case), Some(&backend)) = (args.sweep, last, backends.last()) {
        for lights in [10, 50, 500, 1000, 2000] {
            measure(Case { lights, ..case }, &[backend])?;
        }
        for fovea_inner in [0.0, 0.0625, 0.25, 0.5] {
            let case = Case {
                fovea_inner,
                ..case
            };
            measure(case, &[backend])?;
        }
    }
    let report = Report {
        header: Header::new(
            ("foveal-bench-coarse", SCHEMA_VERSION),
            &gpu,
            &scene,
            &camera,
        ),
        rows,
    };
    args.subject.give(&report, &beside_the_source(&report.rows))
}

/// Puts `count` point lights in place of the scene's.
fn light(scene: &mut Scene, count: u32, range_m: Option<f32>) {
    scene.lights.clear();
    scene_source::add_point_lights(scene, count, 1);
    if let Some(range_m) = range_m {
        for light in &mut scene.lights {
            light.range_m = (range_m > 0.0).then_some(range_m);
        }
    }
}

/// Rows for each backend and composite, nearest first.
fn measure(
    args: &Args,
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    case: Case,
    backends: &[CoarseBackend],
) -> anyhow::Result<Vec<Row>> {
    let full_settings = Settings::default().with(|s| {
        s.picture.width = case.size.0;
        s.picture.height = case.size.1;
        s.lighting.assignment = LightAssignment::Brute;
        s.lighting.model = args.lighting.unwrap_or_default();
        s.coarse.refine_edges = args.refine_edges.unwrap_or_default();
        // The map of the original method.
        s.coarse.source = RateSource::Radii;
        s.coarse.fovea_inner = case.fovea_inner;
        s.geometry.path = args.geometry.unwrap_or_default();
    });
    let mut full = Side::new(gpu, scene, camera, &full_settings)?;
    let mut sides = Vec::new();
    let rate_stages = match args.rate_stage.as_slice() {
        [] => &[RateStage::Auto][..],
        given => given,
    };
    for &rate_stage in rate_stages {
        for &backend in backends {
            for composite in [Composite::Nearest, Composite::Paper, Composite::Smooth] {
                let settings = full_settings.clone().with(|s| {
                    s.shading.mode = Shading::Coarse;
                    s.coarse.backend = backend;
                    s.rate.force = true;
                    s.coarse.composite = composite;
                    s.rate.stage = rate_stage;
                });
                sides.push(Side::new(gpu, scene, camera, &settings)?);
            }
        }
    }
    let count = sides.len() + 1;
    for round in 0..u64::from(args.pairs) {
        for number in turn(round, count) {
            match number.checked_sub(1) {
                None => full.draw()?,
                Some(number) => sides[number].draw()?,
            }
        }
    }
    let reference = full.picture()?;
    (1..)
        .zip(&sides)
        .map(|(number, coarse)| {
            let picture = coarse.picture()?;
            let nearness = Nearness::of(&reference, &picture);
            let settings = coarse.renderer.settings();
            let of_full = (0, full.frame_ms.as_slice());
            let frame = Comparison::of_rounds(count, of_full, (number, &coarse.frame_ms));
            let interval = frame.as_ref().and_then(|frame| frame.interval);
            let full_ms = passes_ms(&full.lighting_ms);
            let coarse_ms = passes_ms(&coarse.lighting_ms);
            let material_ms = |side: &Side<'_>| full_ms.map(|_| median(&side.material_ms));
            Ok(Row {
                scene: args.subject.scene.clone(),
                width: settings.picture.width,
                height: settings.picture.height,
                lights: case.lights,
                light_range_m: args.light_range,
                lighting: settings.lighting.model,
                fovea_inner: settings.coarse.fovea_inner,
                refine_edges: settings.coarse.refine_edges,
                geometry: settings.geometry.path,
                rate_stage: settings.rate.stage,
                backend: settings.coarse.backend,
                composite: settings.coarse.composite,
                levels: u32::from(settings.coarse.coarsest_level) + 1,
                shaded_fraction: coarse.shaded_fraction,
                frame_ratio: frame.as_ref().map_or(1.0, |frame| frame.ratio),
                frame_ratio_low: interval.map(|ends| ends[0]),
                frame_ratio_high: interval.map(|ends| ends[1]),
                finding: frame.map_or(Finding::TooFew, |frame| frame.finding),
                full_ms,
                coarse_ms,
                ratio: full_ms.zip(coarse_ms).map(|(full, coarse)| full / coarse),
                full_material_ms: material_ms(&full),
                coarse_material_ms: material_ms(coarse),
                full_frame_ms: median(&full.frame_ms),
                coarse_frame_ms: median(&coarse.frame_ms),
                flip_mean: nearness.flip,
                jod: nearness.jod,
                fovea_differing: fovea_differing(&reference, &picture, settings),
                psnr: psnr(&reference, &picture),
            })
        })
        .collect()
}

fn print(row: &Row) {
    foveal_host::console::note(&format!(
        "{} {}x{}, {} lights, inner {}: {:?} + {:?}, {:.2} % shaded: frame {:.1} -> {:.1} ms ({}x), lighting {} -> {} ms ({}), materials {} -> {} ms, FLIP {:.4}, {} JOD, fovea {:.4}\n",
        row.scene,
        row.width,
        row.height,
        row.lights,
        row.fovea_inner,
        row.backend,
        row.composite,
        row.shaded_fraction * 100.0,
        row.full_frame_ms,
        row.coarse_frame_ms,
        ratio_text(row.frame_ratio, row.finding, 2),
        number_text(row.full_ms, 2),
        number_text(row.coarse_ms, 2),
        times_text(row.ratio),
        number_text(row.full_material_ms, 2),
        number_text(row.coarse_material_ms, 2),
        row.flip_mean,
        jod_text(row.jod),
        row.fovea_differing,
    ));
}

/// How many times as fast, or a dash.
fn times_text(ratio: Option<f64>) -> String {
    ratio.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.1}x"))
}

/// The source's table rebuilt: frames per second of whole frames and the gains over full shading,
/// for the first case by its last backend.
fn beside_the_source(rows: &[Row]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let of = |composite| {
        let same = |r: &&Row| {
            (r.width, r.height, r.lights, r.fovea_inner)
                == (first.width, first.height, first.lights, first.fovea_inner)
                && r.composite == composite
        };
        rows.iter().rfind(same)
    };
    let gain = |fps: f64, full: f64| format!("{:+.0} %", (fps / full - 1.0) * 100.0);
    let full_fps = 1000.0 / first.full_frame_ms;
    let source_full = SOURCE_FPS[0].1;
    let mut lines = vec![
        [
            "",
            "fps",
            "gain",
            "lighting",
            "FLIP",
            "JOD",
            "source fps",
            "gain",
        ]
        .map(str::to_owned)
        .to_vec(),
        vec![
            "full".to_owned(),
            format!("{full_fps:.2}"),
            String::new(),
            "1.0x".to_owned(),
            "0".to_owned(),
            "10".to_owned(),
            source_full.to_string(),
        ],
    ];
    for (name, composite, source) in [
        (
            "interpolated (paper)",
            Composite::Paper,
            Some(SOURCE_FPS[1].1),
        ),
        ("nearest", Composite::Nearest, Some(SOURCE_FPS[2].1)),
        ("smooth", Composite::Smooth, None),
    ] {
        let Some(row) = of(composite) else { continue };
        let fps = 1000.0 / row.coarse_frame_ms;
        lines.push(vec![
            name.to_owned(),
            format!("{fps:.2}"),
            gain(fps, full_fps),
            times_text(row.ratio),
            format!("{:.4}", row.flip_mean),
            jod_text(row.jod),
            source.map_or("-".to_owned(), |s| s.to_string()),
            source.map_or(String::new(), |s| gain(s, source_full)),
        ]);
    }
    format!(
        "{} at {}x{}, {} lights, whole frames; beside them the original method's on a Radeon RX 560\n",
        first.scene, first.width, first.height, first.lights
    ) + &text(&lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_can_be_given_a_range_or_none() {
        let mut scene = foveal_generate::cornell();
        light(&mut scene, 7, Some(2.5));
        assert!(scene.lights.len() == 7 && scene.lights.iter().all(|l| l.range_m == Some(2.5)));
        light(&mut scene, 3, Some(0.0));
        assert!(scene.lights.len() == 3 && scene.lights.iter().all(|l| l.range_m.is_none()));
    }
}
