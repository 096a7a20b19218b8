//! `foveal bench culling-frames`: whole frames by each way of culling, in turn while the camera
//! sways.

use foveal::{Culling, Frame, FrameStats, Renderer, Settings};
use foveal_host::values;
use foveal_measure::{Comparison, Finding, median, turn};
use foveal_scene::Camera;
use pollster::block_on;
use serde::Serialize;

use super::subject::{Header, Subject, SubjectArgs, WARM_UP, swayed, timed_renderer};
use super::table::{name_of, ratio_text, text};

/// Version of the JSON's shape.
const SCHEMA_VERSION: u32 = 1;

/// The reference, then what is compared with it.
const WAYS: [Culling; 4] = [
    Culling::Off,
    Culling::Frustum,
    Culling::Occlusion,
    Culling::Auto,
];

/// Arguments of `foveal bench culling-frames`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,

    /// Width and height in pixels
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "1280x720")]
    size: (u32, u32),

    /// Measured frames of each way, after eight that warm up; figures are their medians. Below 10
    /// there is no interval
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::value_parser!(u32).range(1..=200))]
    rounds: u32,
}

/// All figures of a run; docs/program.md describes the fields.
#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    header: Header,
    width: u32,
    height: u32,
    rounds: u32,
    rows: Vec<Row>,
}

/// One way's figures.
#[derive(Debug, Serialize)]
struct Row {
    culling: Culling,
    /// Of the last frame.
    objects_visible: u64,
    draws: u64,
    triangles: u64,
    frame_ms: f64,
    /// All objects / this: above 1 this takes less time; with its interval where there are rounds
    /// enough.
    frame_ratio: f64,
    frame_ratio_low: Option<f64>,
    frame_ratio_high: Option<f64>,
    finding: Finding,
}

/// One way while it is measured.
struct Side {
    culling: Culling,
    renderer: Renderer,
    frame_ms: Vec<f64>,
    last: FrameStats,
}

/// Runs the benchmark.
pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let subject = args.subject.open(0)?;
    let sides = measure(args, &subject)?;
    let report = Report {
        header: subject.header("foveal-bench-culling-frames", SCHEMA_VERSION),
        width: args.size.0,
        height: args.size.1,
        rounds: args.rounds,
        rows: (0..sides.len()).map(|number| row(&sides, number)).collect(),
    };
    args.subject.give(&report, &summary(&report))
}

fn measure(args: &Args, Subject { gpu, scene, camera }: &Subject) -> anyhow::Result<Vec<Side>> {
    let side = |culling| {
        let settings = Settings::default().with(|s| {
            s.picture.width = args.size.0;
            s.picture.height = args.size.1;
            s.culling.mode = culling;
        });
        anyhow::Ok(Side {
            culling,
            renderer: timed_renderer(gpu, scene, &settings)?,
            frame_ms: Vec::new(),
            last: FrameStats::default(),
        })
    };
    let mut sides = WAYS.into_iter().map(side).collect::<Result<Vec<_>, _>>()?;
    for frame in 1..=WARM_UP + args.rounds {
        let [now, before] = [frame, frame - 1].map(|frame| swayed(camera, frame));
        let round = frame.checked_sub(WARM_UP + 1);
        for number in turn(u64::from(round.unwrap_or(0)), WAYS.len()) {
            sides[number].draw(&now, &before, round.is_some())?;
        }
    }
    Ok(sides)
}

impl Side {
    fn draw(&mut self, now: &Camera, before: &Camera, counts: bool) -> anyhow::Result<()> {
        let frame = Frame::new(now).with_previous(before);
        self.last = block_on(self.renderer.render(&frame))?;
        if counts {
            self.frame_ms.push(self.last.frame_ms);
        }
        Ok(())
    }
}

fn row(sides: &[Side], number: usize) -> Row {
    let side = &sides[number];
    let all_ms = sides[0].frame_ms.as_slice();
    let found = Comparison::of_rounds(sides.len(), (0, all_ms), (number, &side.frame_ms));
    let interval = found.as_ref().and_then(|found| found.interval);
    Row {
        culling: side.culling,
        objects_visible: side.last.objects_visible,
        draws: side.last.draws,
        triangles: side.last.triangles,
        frame_ms: median(&side.frame_ms),
        frame_ratio: found.as_ref().map_or(1.0, |found| found.ratio),
        frame_ratio_low: interval.map(|ends| ends[0]),
        frame_ratio_high: interval.map(|ends| ends[1]),
        finding: found.map_or(Finding::TooFew, |found| found.finding),
    }
}

fn summary(report: &Report) -> String {
    let head = [
        "culling",
        "objects",
        "draws",
        "triangles",
        "frame ms",
        "off / this",
    ];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    for row in &report.rows {
        lines.push(vec![
            name_of(row.culling),
            row.objects_visible.to_string(),
            row.draws.to_string(),
            row.triangles.to_string(),
            format!("{:.1}", row.frame_ms),
            ratio_text(row.frame_ratio, row.finding, 2),
        ]);
    }
    format!(
        "{} at {}x{}, {}, whole frames, medians of {} rounds, drawn in turn by lot\n",
        report.header.scene, report.width, report.height, report.header.adapter.name, report.rounds
    ) + &text(&lines)
}
