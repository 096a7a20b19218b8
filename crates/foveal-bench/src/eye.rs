//! `foveal bench eye`: what an eye sees of each way of shading, and what that costs: lit samples,
//! whole frames against full shading, and quality in JOD, in a picture and in a video, on each
//! display.
//!
//! Pictures and videos are those that `foveal render` draws; each row names the commands that draw
//! and compare them again. Times come from all ways drawn in turn, by lot.

mod args;
mod commands;
mod screen;
mod studio;
mod times;
mod ways;

use std::rc::Rc;

use foveal::Settings;
use foveal_vdp::{Gaze, Metric};
use serde::Serialize;

use super::subject::Header;
use super::table::{ratio_text, text};
pub(crate) use args::Args;
use args::OFF_GAZE;
use commands::{Commands, MadeBy};
use foveal_host::difference::{ErrorMap, pixels};
use screen::Screen;
use studio::{Shot, Studio};
use times::{Timed, Times};
use ways::{Follows, WAYS};

/// Version of the JSON's shape.
const SCHEMA_VERSION: u32 = 1;

/// All figures of a run; docs/program.md describes the fields.
#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    header: Header,
    point_lights: u32,
    path: String,
    frames: u32,
    fps: f32,
    rounds: u32,
    /// Settings that all ways share, `NAME=VALUE` each.
    set: Vec<String>,
    gaze: [f32; 2],
    off_gaze: [f32; 2],
    rows: Vec<Row>,
}

/// One way of shading on one display.
#[derive(Debug, Serialize)]
struct Row {
    display: &'static str,
    way: &'static str,
    /// Of the pictures, which show the display's centre where it has more pixels.
    width: u32,
    height: u32,
    degrees_across: f32,
    pixels_per_degree: f32,
    /// Lighting evaluations by pixels.
    lit_fraction: f64,
    /// Against full shading: 10 is no visible difference.
    jod: f32,
    flip_mean: f64,
    /// The same where the eye looks at `off_gaze`.
    off_lit_fraction: f64,
    off_jod: f32,
    off_flip_mean: f64,
    /// The same in the video, where there is one.
    video_lit_fraction: Option<f64>,
    video_jod: Option<f32>,
    video_flip_mean: Option<f64>,
    /// Change in the periphery by full shading's; `null` where there is none.
    flicker: Option<f32>,
    #[serde(flatten)]
    times: Option<Timed>,
    made_by: MadeBy,
}

/// A picture or a video beside full shading's.
struct Seen {
    lit_fraction: f64,
    jod: f32,
    flip_mean: f64,
    flicker: Option<f32>,
}

/// Runs the benchmark.
pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let screens = match args.display.as_slice() {
        [] => screen::ALL.to_vec(),
        given => given.to_vec(),
    };
    screens.iter().try_for_each(|one| one.check(args.fit()))?;
    let subject = args.subject.open(args.point_lights)?;
    let path = args.subject.camera.along_a_path(&args.subject.scene);
    let along = args.subject.along(&path, &subject.scene)?;
    let at_rest = args.subject.viewpoint(&subject.scene)?;
    let commands = Commands::new(args, &path);
    let mut studio = Studio::new(&subject, Rc::new(at_rest), Rc::new(along));
    let mut times = Times::default();
    let mut rows: Vec<Row> = Vec::new();
    for screen in &screens {
        for row in measure(args, &commands, (&mut studio, &mut times), screen)? {
            foveal_host::console::note(&text(&[line(&row)]));
            rows.push(row);
        }
    }
    let report = Report {
        header: subject.header("foveal-bench-eye", SCHEMA_VERSION),
        point_lights: args.point_lights,
        path: path.flags().pop().unwrap_or_default(),
        frames: args.frames(),
        fps: args.fps,
        rounds: args.rounds(),
        set: args.shared.spelled(),
        gaze: Settings::default().eye.gaze,
        off_gaze: OFF_GAZE,
        rows,
    };
    args.subject.give(&report, &summary(&report))
}

/// All ways on one display.
fn measure(
    args: &Args,
    commands: &Commands,
    (studio, times): (&mut Studio<'_>, &mut Times),
    screen: &Screen,
) -> anyhow::Result<Vec<Row>> {
    let shown = screen.shown(args.fit());
    let (width, height) = (shown.width as usize, shown.height as usize);
    studio.forget_other_sizes((shown.width, shown.height));
    let metric = |[x, y]: [f32; 2]| Metric::new(&shown.display, width, height, Gaze { x, y });
    let center = Settings::default().eye.gaze;
    let (at_center, at_off) = (metric(center)?, metric(OFF_GAZE)?);
    let plain = args.shared.plain((shown.width, shown.height))?;
    let full = shown.settings(&plain, &WAYS[0], center)?;
    if args.rounds() > 0 {
        let chosen = WAYS.iter().map(|way| shown.settings(&plain, way, center));
        let chosen = chosen.collect::<anyhow::Result<Vec<Settings>>>()?;
        times.measure(studio, &full, &chosen, (args.rounds(), args.fps))?;
    }
    let mut rows = Vec::new();
    for way in WAYS {
        let settings = shown.settings(&plain, way, center)?;
        let off_settings = shown.settings(&plain, way, OFF_GAZE)?;
        let reference = studio.still(&full, 0)?;
        let shot = studio.still(&settings, way.warmup)?;
        let picture = Seen::still(&at_center, &reference, &shot)?;
        let shot = studio.still(&off_settings, way.warmup)?;
        let off = Seen::still(&at_off, &reference, &shot)?;
        let video = match args.frames() {
            0 => None,
            frames => {
                let length = (frames, args.fps);
                let reference = studio.video(&full, true, length)?;
                let is_shared = way.follows != Follows::GazeAndDisplay;
                let shot = studio.video(&settings, is_shared, length)?;
                Some(Seen::moving(&at_center, &reference, &shot, args.fps)?)
            }
        };
        rows.push(Row {
            display: screen.name,
            way: way.name,
            width: shown.width,
            height: shown.height,
            degrees_across: shown.display.degrees_across(),
            pixels_per_degree: at_center.pixels_per_degree(),
            lit_fraction: picture.lit_fraction,
            jod: picture.jod,
            flip_mean: picture.flip_mean,
            off_lit_fraction: off.lit_fraction,
            off_jod: off.jod,
            off_flip_mean: off.flip_mean,
            video_lit_fraction: video.as_ref().map(|video| video.lit_fraction),
            video_jod: video.as_ref().map(|video| video.jod),
            video_flip_mean: video.as_ref().map(|video| video.flip_mean),
            flicker: video.and_then(|video| video.flicker),
            times: times.of(&settings).cloned(),
            made_by: commands.of(&shown, way, [&full, &settings, &off_settings]),
        });
    }
    Ok(rows)
}

impl Seen {
    fn still(metric: &Metric, reference: &Shot, shot: &Shot) -> anyhow::Result<Self> {
        let (a, b) = (&reference.pictures[0], &shot.pictures[0]);
        Ok(Self {
            lit_fraction: shot.lit_fraction,
            jod: metric.compare(pixels(a), pixels(b))?.jod,
            flip_mean: ErrorMap::between(a, b).mean(),
            flicker: None,
        })
    }

    fn moving(metric: &Metric, reference: &Shot, shot: &Shot, fps: f32) -> anyhow::Result<Self> {
        let mut video = metric.video(fps)?;
        let mut flip = 0.0;
        for (a, b) in reference.pictures.iter().zip(&shot.pictures) {
            video.push(pixels(a), pixels(b))?;
            flip += ErrorMap::between(a, b).mean();
        }
        let found = video.finish()?;
        Ok(Self {
            lit_fraction: shot.lit_fraction,
            jod: found.jod,
            flip_mean: flip / found.frames as f64,
            flicker: found.flicker,
        })
    }
}

fn line(row: &Row) -> Vec<String> {
    let percent = |part: f64| format!("{:.1} %", 100.0 * part);
    let jod = |number: f32| format!("{number:.2}");
    let dash = || "-".to_owned();
    let times = row.times.as_ref();
    vec![
        format!("{}, {}", row.display, row.way),
        percent(row.lit_fraction),
        jod(row.jod),
        format!("{:.4}", row.flip_mean),
        percent(row.off_lit_fraction),
        jod(row.off_jod),
        row.video_lit_fraction.map_or_else(dash, percent),
        row.video_jod.map_or_else(dash, jod),
        row.flicker.map_or_else(dash, jod),
        times.map_or_else(dash, |t| format!("{:.1}", t.frame_ms)),
        times.map_or_else(dash, |t| ratio_text(t.frame_ratio, t.finding, 2)),
    ]
}

fn summary(report: &Report) -> String {
    let head = [
        "display, way",
        "lit",
        "JOD",
        "FLIP",
        "lit, gaze off",
        "JOD, gaze off",
        "lit, video",
        "JOD, video",
        "flicker",
        "frame ms",
        "full / this",
    ];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    lines.extend(report.rows.iter().map(line));
    let mut said = format!(
        "{}, {}, whole frames: medians of {} rounds; video: {} frames along {}, {} a second\n",
        report.header.scene,
        report.header.adapter.name,
        report.rounds,
        report.frames,
        report.path,
        report.fps
    ) + &text(&lines);
    let mut before = "";
    for row in &report.rows {
        if std::mem::replace(&mut before, row.display) != row.display {
            said += &format!(
                "{}: {}x{} pixels, {:.1} degrees across, {:.1} pixels per degree\n",
                row.display, row.width, row.height, row.degrees_across, row.pixels_per_degree
            );
        }
    }
    said + "JOD: 10 is no visible difference from full shading, 9 one that three quarters of observers see. MSAA's is its difference \
            from full shading without anti-aliasing, no loss.\n"
}
