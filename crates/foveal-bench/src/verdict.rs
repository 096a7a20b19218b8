//! `foveal bench verdict`: which settings make this scene faster on this machine, and at what
//! error.
//!
//! Each candidate draws the same frames as the plain settings, in turn with all others, in an order
//! that is drawn by lot. Those that are faster and near enough are then put together and compared
//! once more, as one.

mod candidates;
mod decision;
mod sides;

use foveal::Settings;
use foveal_host::difference::BENCH_DISPLAY;
use foveal_host::settings::flags;
use foveal_host::values;
use foveal_measure::{Comparison, Finding, Spread};
use serde::Serialize;

use super::shared::SharedArgs;
use super::subject::{Header, SubjectArgs};
use super::table::{jod_text, name_of, number_text, text};
use candidates::{Aim, Candidate, candidates_of, together};
use decision::{Decision, Measured, decide};
use sides::measure;

/// Version of the JSON's shape.
const SCHEMA_VERSION: u32 = 2;

/// The row of all that is adopted, as one.
pub(crate) const TOGETHER: &str = "These together";

/// Arguments of `foveal bench verdict`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,

    #[command(flatten)]
    shared: SharedArgs,

    /// Width and height in pixels
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "1280x720")]
    size: (u32, u32),

    /// Number of coloured point lights to add to the scene
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::point_lights)]
    point_lights: u32,

    /// Measured frames of each candidate, after sixteen that warm up; below 10 there is no verdict
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
    /// Settings that all share, `NAME=VALUE` each.
    set: Vec<String>,
    rows: Vec<Row>,
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
    /// `null`, as `jod`, where a technique turned itself off.
    flip_mean: Option<f64>,
    /// At 60 degrees across, gaze in the centre: 10 is no visible difference.
    jod: Option<f32>,
    /// The flags that differ from the plain settings.
    flags: String,
    /// The command that draws it.
    command: String,
    /// The commands that draw the plain picture and this one, and compare both.
    made_by: [String; 3],
}

/// Runs the benchmark.
pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let subject = args.subject.open(args.point_lights)?;
    let plain = args.shared.plain(args.size)?;
    let candidates = candidates_of(&plain, |pass| pass.resolved(&subject.gpu))?;
    let chosen: Vec<&Settings> = candidates.iter().map(|(_, settings)| settings).collect();
    let measured = measure(&subject, &plain, &chosen, args.rounds)?;
    let mut rows: Vec<Row> = candidates
        .iter()
        .zip(measured)
        .map(|((candidate, settings), measured)| {
            let name = (candidate.name, candidate.aim);
            row(args, name, (&plain, settings), measured)
        })
        .collect();
    let adopted: Vec<(&Candidate, f64)> = candidates
        .iter()
        .zip(&rows)
        .filter(|(_, row)| row.decision == Decision::Adopt)
        .map(|((candidate, _), row)| (*candidate, row.ratio.unwrap_or(1.0)))
        .collect();
    if let Some(settings) = together(&plain, &adopted)? {
        let mut measured = measure(&subject, &plain, &[&settings], args.rounds)?;
        if let Some(measured) = measured.pop() {
            let name = (TOGETHER, Aim::Faster);
            let row = row(args, name, (&plain, &settings), measured);
            rows.push(row);
        }
    }
    let report = Report {
        header: subject.header("foveal-bench-verdict", SCHEMA_VERSION),
        width: args.size.0,
        height: args.size.1,
        rounds: args.rounds,
        set: args.shared.spelled(),
        rows,
    };
    args.subject.give(&report, &summary(&report))
}

fn row(
    args: &Args,
    (name, aim): (&'static str, Aim),
    (plain, settings): (&Settings, &Settings),
    measured: Measured,
) -> Row {
    let shared = flags(plain);
    let all = flags(settings);
    // A flag's name and its value.
    let own = (all.chunks(2)).filter(|flag| !shared.chunks(2).any(|other| other == *flag));
    let own: Vec<String> = own.map(|flag| flag.join(" ")).collect();
    let command = |output: &str, flags: &[String]| {
        let words = args.subject.words(args.point_lights, output);
        format!("foveal render {words} {}", flags.join(" "))
            .trim_end()
            .to_owned()
    };
    let made_by = [
        command("plain.png", &shared),
        command("this.png", &all),
        format!("foveal compare plain.png this.png --display {BENCH_DISPLAY}"),
    ];
    let found = measured.as_ref().ok().map(|found| &found.frame);
    let work = measured.as_ref().ok().and_then(|found| found.work.as_ref());
    let nearness = (measured.as_ref().ok()).and_then(|found| found.nearness.as_ref().ok());
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
        flip_mean: nearness.map(|nearness| nearness.flip),
        jod: nearness.and_then(|nearness| nearness.jod),
        flags: own.join(" "),
        command: command("picture.png", &all),
        made_by,
    }
}

fn summary(report: &Report) -> String {
    let head = format!(
        "{} at {}x{}, {}, whole frames, medians of {} rounds, drawn in turn by lot\n",
        report.header.scene, report.width, report.height, report.header.adapter.name, report.rounds
    );
    head + &table(&report.rows)
}

/// For a human.
fn table(rows: &[Row]) -> String {
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
    for row in rows {
        lines.push(vec![
            row.name.to_owned(),
            name_of(row.decision),
            number_text(row.reference_ms, 2),
            number_text(row.chosen_ms, 2),
            row.gain.clone(),
            row.work_gain.clone().unwrap_or_default(),
            number_text(row.flip_mean, 4),
            jod_text(row.jod),
        ]);
    }
    let mut said = text(&lines);
    for row in rows {
        let more = match row.decision {
            Decision::Adopt | Decision::FasterButVisible => &row.flags,
            Decision::Impossible => &row.why,
            _ => continue,
        };
        said += &format!("{}: {more}\n", row.name);
    }
    said
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use decision::Found;
    use foveal_measure::Pair;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: Args,
    }

    #[test]
    fn a_technique_that_turned_itself_off_has_no_error() {
        let args = Line::parse_from(["verdict"]).args;
        let pair = |frame: u32| Pair {
            reference_ms: 20.0,
            chosen_ms: 10.0,
            reference_first: frame.is_multiple_of(2),
        };
        let found = Found {
            frame: Comparison::of(&(0..20).map(pair).collect::<Vec<_>>()).unwrap(),
            work: None,
            nearness: Err("coarse shading is off".to_owned()),
        };
        let plain = Settings::default();
        let row = row(&args, ("a", Aim::Faster), (&plain, &plain), Ok(found));
        assert_eq!(row.decision, Decision::Skip);
        assert_eq!((row.flip_mean, row.jod), (None, None));
    }

    #[test]
    fn the_table_has_the_names_of_the_json_and_says_why_something_is_impossible() {
        let args = Line::parse_from(["verdict"]).args;
        let plain = Settings::default();
        let impossible = |name| {
            let cause = Err("the setting samples is 3".to_owned());
            row(&args, (name, Aim::Faster), (&plain, &plain), cause)
        };
        let mut visible = impossible("a");
        visible.decision = Decision::FasterButVisible;
        let said = table(&[visible, impossible("b")]);
        assert!(said.contains("a          faster-but-visible"), "{said}");
        assert!(said.ends_with("b: the setting samples is 3\n"), "{said}");
    }
}
