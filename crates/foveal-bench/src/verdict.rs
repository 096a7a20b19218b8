//! `foveal bench verdict`: which settings make this scene faster on this machine, and at what error.
//!
//! Each candidate draws the same frames as the plain settings, in turn with all others, in an order that is drawn by lot.
//! Those that are faster and near enough are then put together and compared once more, as one.

mod candidates;

use foveal::{Frame, FrameStats, Gpu, Renderer, Settings};
use foveal_measure::{Comparison, Finding, Spread, turn};
use foveal_scene::{Camera, Scene};
use pollster::block_on;
use serde::Serialize;

use super::subject::{Header, Subject, SubjectArgs, WARM_UP};
use super::table::{jod_text, text};
use candidates::{ALL, Aim, Candidate, together};
use foveal_host::clock::now_ms;
use foveal_host::difference::{BENCH_DISPLAY, Nearness};
use foveal_host::picture::Picture;
use foveal_host::settings::flags;
use foveal_host::values;

/// Version of the JSON's shape.
const SCHEMA_VERSION: u32 = 1;

/// The mean FLIP error up to which a faster picture is taken for as good.
const MOST_FLIP: f64 = 0.05;

/// The quality from which on it is: one difference that three quarters of observers see.
const LEAST_JOD: f32 = 9.0;

/// Arguments of `foveal bench verdict`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,

    /// Width and height in pixels
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "1280x720")]
    size: (u32, u32),

    /// Add N coloured point lights to the scene
    #[arg(long, value_name = "N", default_value_t = 0)]
    point_lights: u32,

    /// Frames of each candidate that count, after eight that warm up; below 10 there is no verdict
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

/// What is to be done with a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Decision {
    /// Faster, and near enough.
    Adopt,
    /// Faster, but far from the plain picture.
    Look,
    /// No gain.
    Skip,
    /// A better picture that takes longer.
    Pay,
    /// The device cannot do it.
    Impossible,
}

/// A candidate against the plain settings; times in milliseconds.
#[derive(Debug, Serialize)]
struct Row {
    name: &'static str,
    decision: Decision,
    /// The decision in a sentence.
    why: String,
    /// Reference / candidate with its interval, in few words.
    gain: String,
    finding: Option<Finding>,
    ratio: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    pairs: usize,
    /// The same by the processor's time; `null` where a graphics card draws.
    work_gain: Option<String>,
    work_ratio: Option<f64>,
    reference_ms: Option<f64>,
    reference_low_ms: Option<f64>,
    reference_high_ms: Option<f64>,
    chosen_ms: Option<f64>,
    chosen_low_ms: Option<f64>,
    chosen_high_ms: Option<f64>,
    flip_mean: Option<f64>,
    /// At 60 degrees across, gaze in the middle: 10 is no visible difference.
    jod: Option<f32>,
    /// The flags that differ from the defaults.
    flags: String,
    /// The command that draws it.
    command: String,
    /// The commands that draw the plain picture and this one, and compare both.
    made_by: [String; 3],
}

/// One of those that are drawn in turn.
struct Side {
    renderer: Renderer,
    settings: Settings,
    frame_ms: Vec<f64>,
    work_ms: Vec<f64>,
}

/// What was found out about a candidate.
#[derive(Debug)]
struct Found {
    /// Whole frames by the clock on the wall.
    frame: Comparison,
    /// Whole frames by the processor's time, of all threads: where the processor draws, and other programs take their share
    /// of it, that is steadier.
    work: Option<Comparison>,
    nearness: Nearness,
}

impl Found {
    /// What decides, and whether it is the processor's time.
    fn deciding(&self) -> (&Comparison, bool) {
        match &self.work {
            Some(work) if !self.frame.differs() && work.differs() => (work, true),
            _ => (&self.frame, false),
        }
    }
}

/// `Err` says why a candidate cannot be drawn.
type Measured = Result<Found, String>;

/// Runs the benchmark.
pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let subject = args.subject.open(args.point_lights)?;
    let plain = Settings {
        width: args.size.0,
        height: args.size.1,
        ..Settings::default()
    };
    let candidates: Vec<(&Candidate, Settings)> = ALL
        .iter()
        .map(|candidate| Ok((candidate, candidate.settings(&plain)?)))
        .collect::<anyhow::Result<_>>()?;
    let chosen: Vec<&Settings> = candidates.iter().map(|(_, settings)| settings).collect();
    let measured = measure(&subject, &plain, &chosen, args.rounds)?;
    let mut rows: Vec<Row> = candidates
        .iter()
        .zip(measured)
        .map(|((candidate, settings), measured)| {
            row(args, candidate.name, candidate.aim, settings, measured)
        })
        .collect();
    let adopted: Vec<(&Candidate, f64)> = ALL
        .iter()
        .zip(&rows)
        .filter(|(_, row)| row.decision == Decision::Adopt)
        .map(|(candidate, row)| (candidate, row.ratio.unwrap_or(1.0)))
        .collect();
    if adopted.len() > 1 {
        let settings = together(&plain, &adopted)?;
        let mut measured = measure(&subject, &plain, &[&settings], args.rounds)?;
        if let Some(measured) = measured.pop() {
            let row = row(args, "These together", Aim::Faster, &settings, measured);
            rows.push(row);
        }
    }
    let report = Report {
        header: subject.header("foveal-bench-verdict", SCHEMA_VERSION),
        width: args.size.0,
        height: args.size.1,
        rounds: args.rounds,
        rows,
    };
    args.subject.give(&report, &summary(&report))
}

/// Draws the plain settings and the others in turn; what each of the others turned out to be.
fn measure(
    Subject { gpu, scene, camera }: &Subject,
    plain: &Settings,
    chosen: &[&Settings],
    rounds: u32,
) -> anyhow::Result<Vec<Measured>> {
    let mut plain = Side::new(gpu, scene, plain)?;
    let mut sides: Vec<Result<Side, String>> = Vec::new();
    for settings in chosen {
        sides.push(match Side::new(gpu, scene, settings) {
            Ok(side) => Ok(side),
            Err(error) => match error.downcast_ref() {
                Some(foveal::Error::Setting { .. }) => Err(error.to_string()),
                _ => return Err(error),
            },
        });
    }
    let count = sides.iter().flatten().count() + 1;
    // The camera sways, as a head does: what is kept from frame to frame costs nothing at rest.
    let at = |frame: u32| swayed(camera, frame);
    for frame in 1..=WARM_UP {
        plain.draw(&at(frame), &at(frame - 1))?;
        for side in sides.iter_mut().flatten() {
            side.draw(&at(frame), &at(frame - 1))?;
        }
    }
    for side in std::iter::once(&mut plain).chain(sides.iter_mut().flatten()) {
        side.frame_ms.clear();
        side.work_ms.clear();
    }
    let processor_draws = gpu.adapter_stats().kind == "cpu";
    for round in 0..rounds {
        let frame = WARM_UP + 1 + round;
        let [now, before] = [at(frame), at(frame - 1)];
        for number in turn(u64::from(round), count) {
            match number.checked_sub(1) {
                None => plain.draw(&now, &before)?,
                Some(number) => {
                    if let Some(side) = sides.iter_mut().flatten().nth(number) {
                        side.draw(&now, &before)?;
                    }
                }
            };
        }
    }
    let reference = plain.picture(camera)?;
    let mut number = 0;
    sides
        .into_iter()
        .map(|side| {
            let mut side = match side {
                Ok(side) => side,
                Err(cause) => return Ok(Err(cause)),
            };
            number += 1;
            let compared = |plain_ms: &[f64], side_ms: &[f64]| {
                Comparison::of_rounds(count, (0, plain_ms), (number, side_ms))
            };
            let Some(frame) = compared(&plain.frame_ms, &side.frame_ms) else {
                return Ok(Err("no time could be taken".to_owned()));
            };
            let work = processor_draws.then(|| compared(&plain.work_ms, &side.work_ms));
            Ok(Ok(Found {
                frame,
                work: work.flatten(),
                nearness: Nearness::of(&reference, &side.picture(camera)?),
            }))
        })
        .collect()
}

impl Side {
    fn new(gpu: &Gpu, scene: &Scene, settings: &Settings) -> anyhow::Result<Self> {
        let mut renderer = block_on(Renderer::new(gpu, settings, Some(now_ms)))?;
        block_on(renderer.set_scene(scene))?;
        Ok(Self {
            renderer,
            settings: settings.clone(),
            frame_ms: Vec::new(),
            work_ms: Vec::new(),
        })
    }

    fn draw(&mut self, camera: &Camera, before: &Camera) -> anyhow::Result<()> {
        let frame = Frame {
            camera,
            previous_camera: Some(before),
        };
        let before_ms = process_ms();
        let stats: FrameStats = block_on(self.renderer.render(&frame))?;
        self.work_ms.push(process_ms() - before_ms);
        self.frame_ms.push(stats.frame_ms);
        Ok(())
    }

    /// The picture of the camera at rest, as the row's command makes it.
    fn picture(&mut self, camera: &Camera) -> anyhow::Result<Picture> {
        // A frame that follows none: nothing of the frames before is in it.
        let none = Camera {
            name: format!("before {}", camera.name),
            ..camera.clone()
        };
        self.draw(camera, &none)?;
        for _ in 0..WARM_UP {
            self.draw(camera, camera)?;
        }
        let bytes = block_on(self.renderer.read_picture())?;
        let (width, height) = self.settings.picture_size();
        Picture::from_rgba(width, height, &bytes)
    }
}

/// Where a camera that sways sideways is in a frame: two centimetres a frame, to and fro within half a metre.
fn swayed(camera: &Camera, frame: u32) -> Camera {
    const STEP_M: f32 = 0.02;
    const STEPS: u32 = 24;
    let turn = frame % (2 * STEPS);
    let away = turn.min(2 * STEPS - turn) as f32 * STEP_M;
    let mut camera = camera.clone();
    let right = camera.world_from_view.x_axis;
    camera.world_from_view.w_axis += right * away;
    camera
}

/// Milliseconds that this process has had of the processor, all threads together; 0 where nobody says.
fn process_ms() -> f64 {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6
    }
    #[cfg(not(unix))]
    0.0
}

fn row(args: &Args, name: &'static str, aim: Aim, settings: &Settings, measured: Measured) -> Row {
    let size = Settings {
        width: settings.width,
        height: settings.height,
        ..Settings::default()
    };
    let of_size = flags(&size).len();
    let all = flags(settings);
    let command = |output: &str, flags: &[String]| {
        let words = args.subject.words(args.point_lights, output);
        format!("foveal render {words} {}", flags.join(" "))
            .trim_end()
            .to_owned()
    };
    let made_by = [
        command("plain.png", &flags(&size)),
        command("this.png", &all),
        format!("foveal compare plain.png this.png --display {BENCH_DISPLAY}"),
    ];
    let found = measured.as_ref().ok().map(|found| &found.frame);
    let work = measured.as_ref().ok().and_then(|found| found.work.as_ref());
    let time = |side: fn(&Comparison) -> &Spread, part: fn(&Spread) -> f64| {
        found.map(|found| part(side(found)))
    };
    let (decision, why) = decide(aim, &measured);
    Row {
        name,
        decision,
        why,
        gain: found.map_or_else(String::new, Comparison::text),
        finding: found.map(|found| found.finding),
        ratio: found.map(|found| found.ratio),
        low: found.and_then(|found| Some(found.interval?[0])),
        high: found.and_then(|found| Some(found.interval?[1])),
        pairs: found.map_or(0, |found| found.pairs),
        work_gain: work.map(Comparison::text),
        work_ratio: work.map(|work| work.ratio),
        reference_ms: time(|c| &c.reference, |s| s.median),
        reference_low_ms: time(|c| &c.reference, |s| s.low),
        reference_high_ms: time(|c| &c.reference, |s| s.high),
        chosen_ms: time(|c| &c.chosen, |s| s.median),
        chosen_low_ms: time(|c| &c.chosen, |s| s.low),
        chosen_high_ms: time(|c| &c.chosen, |s| s.high),
        flip_mean: measured.as_ref().ok().map(|found| found.nearness.flip),
        jod: (measured.as_ref().ok()).and_then(|found| found.nearness.jod),
        flags: all[of_size.min(all.len())..].join(" "),
        command: command("picture.png", &all),
        made_by,
    }
}

/// Whether a picture is taken for as good as the plain one.
fn is_near(Nearness { flip, jod }: Nearness) -> bool {
    flip <= MOST_FLIP && jod.is_none_or(|jod| jod >= LEAST_JOD)
}

/// What to do, and why, in a sentence.
fn decide(aim: Aim, measured: &Measured) -> (Decision, String) {
    let measured = match measured {
        Ok(measured) => measured,
        Err(cause) => return (Decision::Impossible, cause.clone()),
    };
    let (found, is_work) = measured.deciding();
    let Nearness { flip, jod } = measured.nearness;
    let subject = if is_work {
        "whole frames by the processor's time"
    } else {
        "whole frames"
    };
    let picture = if flip == 0.0 {
        "the picture is the same".to_owned()
    } else {
        let seen = jod.map_or_else(String::new, |jod| format!("{jod:.2} JOD, "));
        format!("{seen}mean FLIP error {flip:.4}")
    };
    let gain = found.text();
    match (found.finding, aim) {
        (Finding::TooFew, _) => (
            Decision::Skip,
            "too few frames were drawn for a verdict".to_owned(),
        ),
        (Finding::Faster, _) if is_near(measured.nearness) => {
            (Decision::Adopt, format!("{subject}: {gain}; {picture}"))
        }
        (Finding::Faster, _) => (Decision::Look, format!("{subject}: {gain}; but {picture}")),
        (_, Aim::Better) => (Decision::Pay, format!("smoother edges; {subject}: {gain}")),
        (Finding::NoDifference, Aim::Faster) => (Decision::Skip, format!("{subject}: {gain}")),
        (Finding::Slower, Aim::Faster) => (Decision::Skip, format!("{subject}: {gain}")),
    }
}

fn summary(report: &Report) -> String {
    let head = [
        "candidate",
        "",
        "plain ms",
        "ms",
        "plain / this",
        "by processor time",
        "FLIP",
        "JOD",
    ];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    let number = |number: Option<f64>, digits: usize| {
        number.map_or_else(|| "-".to_owned(), |n| format!("{n:.digits$}"))
    };
    for row in &report.rows {
        lines.push(vec![
            row.name.to_owned(),
            format!("{:?}", row.decision).to_lowercase(),
            number(row.reference_ms, 1),
            number(row.chosen_ms, 1),
            row.gain.clone(),
            row.work_gain.clone().unwrap_or_default(),
            number(row.flip_mean, 4),
            jod_text(row.jod),
        ]);
    }
    let mut said = format!(
        "{} at {}x{}, {}, whole frames, medians of {} pairs, drawn in turn by lot\n",
        report.header.scene, report.width, report.height, report.header.adapter.name, report.rounds
    ) + &text(&lines);
    for row in &report.rows {
        if matches!(row.decision, Decision::Adopt | Decision::Look) {
            said += &format!("{}: {}\n", row.name, row.flags);
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_measure::Pair;

    fn measured(reference_ms: f64, chosen_ms: f64, flip: f64, frames: u64) -> Measured {
        let pairs: Vec<Pair> = (0..frames)
            .map(|frame| Pair {
                reference_ms,
                chosen_ms,
                reference_first: turn(frame, 2)[0] == 0,
            })
            .collect();
        Ok(Found {
            frame: Comparison::of(&pairs).unwrap(),
            work: None,
            nearness: Nearness { flip, jod: None },
        })
    }

    #[test]
    fn the_processors_time_decides_where_the_wall_clock_cannot() {
        let both = |frame: Measured, work: Measured| {
            Ok(Found {
                work: Some(work.unwrap().frame),
                ..frame.unwrap()
            })
        };
        let less_work = || measured(20.0, 15.0, 0.0, 20);
        let decided = decide(
            Aim::Faster,
            &both(measured(20.0, 20.0, 0.0, 20), less_work()),
        );
        assert_eq!(decided.0, Decision::Adopt);
        assert!(decided.1.contains("processor"), "{}", decided.1);
        // What the wall clock says holds.
        let slower = both(measured(20.0, 30.0, 0.0, 20), less_work());
        assert_eq!(decide(Aim::Faster, &slower).0, Decision::Skip);
    }

    #[test]
    fn what_the_eye_sees_is_looked_at_first() {
        for (jod, expected) in [(9.2, Decision::Adopt), (8.9, Decision::Look)] {
            let mut found = measured(20.0, 10.0, 0.01, 20);
            found.as_mut().unwrap().nearness.jod = Some(jod);
            let (decision, why) = decide(Aim::Faster, &found);
            assert_eq!(decision, expected, "{why}");
            assert!(why.contains(&format!("{jod:.2} JOD")), "{why}");
        }
    }

    #[test]
    fn only_what_is_faster_and_near_is_adopted() {
        for (measured, aim, expected) in [
            (measured(20.0, 10.0, 0.0, 20), Aim::Faster, Decision::Adopt),
            (measured(20.0, 10.0, 0.01, 20), Aim::Better, Decision::Adopt),
            (measured(20.0, 10.0, 0.2, 20), Aim::Faster, Decision::Look),
            (measured(20.0, 20.0, 0.0, 20), Aim::Faster, Decision::Skip),
            (measured(10.0, 20.0, 0.0, 20), Aim::Faster, Decision::Skip),
            (measured(10.0, 20.0, 0.1, 20), Aim::Better, Decision::Pay),
            (measured(20.0, 10.0, 0.0, 9), Aim::Faster, Decision::Skip),
            (Err("no".to_owned()), Aim::Faster, Decision::Impossible),
        ] {
            assert_eq!(decide(aim, &measured).0, expected, "{measured:?}");
        }
    }
}
