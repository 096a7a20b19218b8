//! `foveal-fuzz`: runs the fuzz targets on stable Rust.
//!
//! Exit code 0: nothing was found; 1: something was; 2: wrong usage; 3: an input did not end.
#![allow(clippy::print_stdout, reason = "a program's results")]

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, bail};
use clap::Parser;
use foveal_fuzz::{Campaign, Counting, Outcome, TARGETS, Target};

#[global_allocator]
static COUNTING: Counting = Counting;

/// Gives fuzz targets random changes of good inputs, and watches for panics, hangs and memory
#[derive(Debug, Parser)]
struct Args {
    /// The target, or `all`
    #[arg(default_value = "all")]
    target: String,
    /// Seconds for each target
    #[arg(long, default_value_t = 60)]
    seconds: u64,
    /// Most inputs for each target
    #[arg(long, default_value_t = u64::MAX, hide_default_value = true)]
    inputs: u64,
    /// Number of the first input: each input follows from its number and the seeds
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder with good inputs beside the target's own, in a folder of the target's name
    #[arg(long, value_name = "DIR")]
    corpus: Option<PathBuf>,
    /// Folder for inputs that fail
    #[arg(long, value_name = "DIR", default_value = "out/fuzz")]
    failures: PathBuf,
    /// Try one file as it is
    #[arg(long, value_name = "FILE", conflicts_with = "write_seeds")]
    replay: Option<PathBuf>,
    /// Write the targets' own good inputs into folders for `cargo fuzz`, and try nothing
    #[arg(long, value_name = "DIR")]
    write_seeds: Option<PathBuf>,
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("foveal-fuzz: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Whether nothing was found.
fn run(args: &Args) -> anyhow::Result<bool> {
    let chosen = |target: &&Target| args.target == "all" || args.target == target.name;
    let targets: Vec<&Target> = TARGETS.iter().filter(chosen).collect();
    if targets.is_empty() {
        let names: Vec<&str> = TARGETS.iter().map(|t| t.name).collect();
        let names = names.join(", ");
        bail!(
            "there is no target '{}'; there are {names}, all",
            args.target
        );
    }
    if let Some(folder) = &args.write_seeds {
        for target in targets {
            write_seeds(target, &folder.join(target.name))?;
        }
        return Ok(true);
    }
    if let Some(file) = &args.replay {
        let input =
            std::fs::read(file).with_context(|| format!("cannot read '{}'", file.display()))?;
        targets.iter().for_each(|target| (target.run)(&input));
        return Ok(true);
    }
    let mut good = true;
    for target in targets {
        let campaign = Campaign {
            inputs: args.inputs,
            failures: args.failures.clone(),
            more_seeds: match &args.corpus {
                Some(folder) => read_seeds(&folder.join(target.name))?,
                None => Vec::new(),
            },
            verbose: true,
            ..Campaign::new(args.seconds, args.seed)
        };
        good &= told(target, &campaign.run(target));
    }
    Ok(good)
}

/// Prints what was found; whether that is nothing.
fn told(target: &Target, outcome: &Outcome) -> bool {
    println!(
        "{}: {} inputs, at most {:.3} s and {:.1} MB each, {} failures",
        target.name,
        outcome.inputs,
        outcome.longest.as_secs_f64(),
        outcome.most_bytes as f64 / 1e6,
        outcome.failures.len()
    );
    for failure in &outcome.failures {
        println!(
            "  input {} ({}): {}",
            failure.number,
            failure.file.display(),
            failure.cause
        );
    }
    outcome.failures.is_empty()
}

fn write_seeds(target: &Target, folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)?;
    for (i, seed) in (target.seeds)().iter().enumerate() {
        std::fs::write(folder.join(format!("seed-{i}")), seed)?;
    }
    Ok(())
}

/// The files of a folder, by name; none where it is missing.
fn read_seeds(folder: &Path) -> anyhow::Result<Vec<Vec<u8>>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)?
        .map(|entry| entry.map(|e| e.path()))
        .collect::<Result<_, _>>()?;
    files.sort();
    let read = |file: &PathBuf| std::fs::read(file).with_context(|| file.display().to_string());
    files.iter().map(read).collect()
}
