//! `foveal bench all`: every bench in turn, and one page: what to adopt for this scene, then each
//! technique beside the original method.
//!
//! Each bench runs in a process of its own, several passes over, so that one that fails takes
//! nothing else down and the passes tell how steady the figures are. All figures go into one JSON
//! value; page and CSV are made from it and from nothing else.

mod bench;
mod csv;
pub(crate) mod diff;
mod html;
mod markdown;
mod merge;
mod page;
mod pictures;
mod plan;
mod plots;
mod published;
mod tables;
#[cfg(test)]
mod tests;
mod verdict;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, bail};
use clap::builder::PossibleValuesParser;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use bench::Bench;
use foveal_host::failure::usage;
use foveal_host::import_args::ImportArgs;
use foveal_host::{atomic_file, console, scene_source, values};

/// Version of the JSON's shape.
const SCHEMA_VERSION: u32 = 2;

/// Arguments of `foveal bench all`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A glTF 2.0, OBJ or PLY file, or a generated scene
    #[arg(default_value = scene_source::DEFAULT_SCENE)]
    scene: String,

    /// Folder for report.html, report.json and report.csv; created if missing
    #[arg(long, value_name = "DIR")]
    report: PathBuf,

    /// Write the figures as Markdown tables too: a file per bench, and README.md
    #[arg(long, value_name = "DIR")]
    markdown: Option<PathBuf>,

    /// The state that is measured, as the tables name it: commit and date
    #[arg(long, value_name = "TEXT", requires = "markdown")]
    of: Option<String>,

    /// Small pictures and few repetitions: about five minutes on a machine without a graphics card
    #[arg(long)]
    quick: bool,

    /// Width and height in pixels [default: 1280x720; with --quick 480x270]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,

    /// Benches to run; the report lists all others as skipped [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    #[arg(value_parser = PossibleValuesParser::new(plan::BENCHES.iter().map(|bench| bench.name)))]
    only: Vec<String>,

    /// Graphics adapter: part of its name, or its number in `foveal adapters`
    #[arg(long, value_name = "NAME|NUMBER")]
    adapter: Option<String>,

    /// Show no progress
    #[arg(short, long)]
    quiet: bool,

    #[command(flatten)]
    import: ImportArgs,
}

/// Runs everything and writes the report, anew after each bench.
pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    if args.scene == scene_source::STDIN {
        return usage("a report reads its scene many times, standard input only once; name a file");
    }
    // Nothing of an earlier report is lost where there is nothing to measure.
    scene_source::load_with(&args.scene, &args.import.options())?;
    for folder in std::iter::once(&args.report).chain(&args.markdown) {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder '{}'", folder.display()))?;
    }
    for name in ["report.html", "report.json", "report.csv"] {
        atomic_file::check_writable(&args.report.join(name))?;
    }
    if let Some(folder) = &args.markdown {
        for name in markdown::names() {
            atomic_file::check_writable(&folder.join(name))?;
        }
    }
    let size = args
        .size
        .unwrap_or(if args.quick { (480, 270) } else { (1280, 720) });
    let start = Instant::now();
    let passes = if args.quick { 2 } else { 3 };
    let steps: usize = plan::BENCHES.iter().map(|b| b.passes(passes) + 1).sum();
    let progress = progress(args.quiet, steps as u64);
    let adapter = match foveal_host::gpu::open(args.adapter.as_deref()) {
        Ok(gpu) => serde_json::to_value(gpu.adapter_stats())?,
        Err(error) => json!({ "name": format!("{error:#}") }),
    };
    let mut report = json!({
        "schema": "foveal-report",
        "schema_version": SCHEMA_VERSION,
        "program_version": env!("CARGO_PKG_VERSION"),
        "scene": args.scene,
        "quick": args.quick,
        "width": size.0,
        "height": size.1,
        "passes": passes,
        "minutes": 0.0,
        "machine": machine(),
        "adapter": adapter,
        "benches": [],
    });
    let mut benches = Vec::new();
    let mut failures = Vec::new();
    for bench in plan::BENCHES {
        progress.set_message(bench.title);
        let measured = measure(args, bench, size, bench.passes(passes), &progress);
        if let (Some("failed"), Some(cause)) =
            (measured["status"].as_str(), measured["cause"].as_str())
        {
            failures.push(format!("{}: {cause}", bench.name));
        }
        let was_skipped = measured["status"] == "skipped";
        benches.push(measured);
        // The report of so far stays where this is interrupted.
        if !was_skipped || benches.len() == plan::BENCHES.len() {
            report["minutes"] = (start.elapsed().as_secs_f64() / 60.0).into();
            report["benches"] = with_rest(args, size, &benches).into();
            write(&args.report, &report)?;
        }
    }
    progress.finish_and_clear();
    if let Some(folder) = &args.markdown {
        if let Some(of) = &args.of {
            report["of"] = of.as_str().into();
        }
        for (name, text) in markdown::of(&report) {
            atomic_file::write(&folder.join(name), text.as_bytes())?;
        }
    }
    console::print_result(&format!("{}\n", args.report.join("report.html").display()))?;
    if failures.is_empty() {
        Ok(())
    } else {
        bail!(
            "the report is written, but not every bench ran: {}",
            failures.join("; ")
        )
    }
}

/// The benches that ran, and behind them those of the plan that have not.
fn with_rest(args: &Args, size: (u32, u32), benches: &[Value]) -> Vec<Value> {
    let rest = plan::BENCHES.iter().skip(benches.len());
    let rest = rest.map(|bench| skipped(entry(args, bench, size).0, "not yet run"));
    benches.iter().cloned().chain(rest).collect()
}

/// Writes the three files.
fn write(folder: &Path, report: &Value) -> anyhow::Result<()> {
    let write = |name: &str, text: &str| atomic_file::write(&folder.join(name), text.as_bytes());
    // The pictures are in the page; the JSON names them.
    let mut figures = report.clone();
    pictures::strip(&mut figures);
    write(
        "report.json",
        &(serde_json::to_string_pretty(&figures)? + "\n"),
    )?;
    write("report.csv", &csv::of(&figures)?)?;
    write("report.html", &console::printable_lines(&page::of(report)))
}

/// On a terminal only.
fn progress(quiet: bool, steps: u64) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::stderr());
    match ProgressStyle::with_template("{wide_bar} {pos}/{len} {msg}, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// The words of all commands that a report of this scene runs, so that the program can hold them to
/// its own arguments.
#[must_use]
pub fn planned_commands(scene: &str) -> Vec<Vec<String>> {
    let place = Path::new("figures");
    let import = ["--clip", "0", "--outside-files"].map(str::to_owned);
    let words = |bench: &Bench| {
        let mut command = Command::new("foveal");
        command.args(bench.words(scene, (480, 270), true, Some("0"), &import));
        bench.output(&mut command, place, &place.join("figures.json"));
        let words = command.get_args().map(|word| word.to_string_lossy());
        words.map(std::borrow::Cow::into_owned).collect()
    };
    plan::BENCHES.iter().map(words).collect()
}

/// A bench as the JSON shows it before it has run, and the words of its command.
fn entry(args: &Args, bench: &Bench, size: (u32, u32)) -> (Value, Vec<String>) {
    let (adapter, import) = (args.adapter.as_deref(), args.import.flags());
    let words = bench.words(&args.scene, size, args.quick, adapter, &import);
    let entry = json!({
        "name": bench.name,
        "title": bench.title,
        "about": bench.about,
        "commands": [bench.command_line(&words)],
        "published": published::of(bench.name),
        "status": "measured",
        "cause": null,
        "rows": [],
        "pictures": [],
    });
    (entry, words)
}

fn skipped(mut entry: Value, cause: &str) -> Value {
    entry["status"] = "skipped".into();
    entry["cause"] = cause.into();
    entry
}

/// One bench as the JSON shows it, whatever became of it.
fn measure(
    args: &Args,
    bench: &Bench,
    size: (u32, u32),
    passes: usize,
    progress: &ProgressBar,
) -> Value {
    let start = Instant::now();
    let (mut result, words) = entry(args, bench, size);
    if !args.only.is_empty() && !args.only.iter().any(|name| name == bench.name) {
        progress.inc(passes as u64 + 1);
        return skipped(result, "not asked for");
    }
    let mut all = Vec::new();
    for _ in 0..passes {
        match pass(bench, &words) {
            Ok(rows) => all.push(rows),
            Err(error) => {
                result["status"] = "failed".into();
                result["cause"] = format!("{error:#}").into();
            }
        }
        progress.inc(1);
        if result["status"] == "failed" {
            progress.inc((passes - all.len()) as u64);
            return result;
        }
    }
    result["rows"] = merge::passes(bench, &all);
    if !bench.pairs.is_empty() {
        match pictures::draw(
            bench,
            (&args.scene, &args.import),
            size,
            args.adapter.as_deref(),
        ) {
            Ok(pictures) => result["pictures"] = pictures.into(),
            Err(error) => {
                result["status"] = "failed".into();
                result["cause"] = format!("its pictures: {error:#}").into();
            }
        }
    }
    progress.inc(1);
    result["seconds"] = start.elapsed().as_secs_f64().into();
    result
}

/// One pass: runs the bench in a process of its own; the rows it wrote.
fn pass(bench: &Bench, words: &[String]) -> anyhow::Result<Vec<Value>> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("figures.json");
    let mut command = Command::new(std::env::current_exe()?);
    command.args(words);
    bench.output(&mut command, folder.path(), &file);
    let output = command.stdin(Stdio::null()).output()?;
    if !output.status.success() {
        bail!("{}", cause(&String::from_utf8_lossy(&output.stderr)));
    }
    rows(bench, &file)
}

/// The cause of a failure, of what a command said: wrong usage has lines behind it that say nothing of
/// it.
fn cause(said: &str) -> &str {
    let mut lines = said.lines().rev();
    let error = lines.clone().find_map(|line| line.strip_prefix("error: "));
    let last = || lines.find(|line| !line.trim().is_empty());
    error.or_else(last).unwrap_or("it ended without a word")
}

fn rows(bench: &Bench, file: &Path) -> anyhow::Result<Vec<Value>> {
    let text = std::fs::read_to_string(file).context("it wrote no figures")?;
    let figures: Value = serde_json::from_str(&text).context("its figures are no JSON")?;
    let rows = match (bench.rows)(&figures) {
        Some(rows) if !rows.is_empty() => rows,
        _ => bail!("its figures have no rows"),
    };
    Ok(rows)
}

/// What the figures were measured on.
fn machine() -> Value {
    let processor = std::fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        });
    json!({
        "processor": processor.unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
        "threads": std::thread::available_parallelism().map_or(1, usize::from),
        "system": std::env::consts::OS,
    })
}
