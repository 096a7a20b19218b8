//! `foveal bench diff`: what became slower between two reports.
//!
//! A time counts as slower when its median grew by more than a twentieth *and* the new passes all
//! lie above the old ones: where the passes of both overlap, the machine's noise explains the
//! difference.

mod page;
mod pairs;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use serde_json::Value;

use crate::table::text;
use foveal_host::{atomic_file, console};
use pairs::{Change, pairs};

/// Arguments of `foveal bench diff`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The earlier report.json
    old: PathBuf,
    /// The later report.json
    new: PathBuf,
    /// Exit with code 1 if anything became slower
    #[arg(long)]
    fail: bool,
    /// Write the comparison as a page: first what changed, then each bench
    #[arg(long, value_name = "FILE.html")]
    page: Option<PathBuf>,
}

/// Prints what changed.
pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let (old, new) = (read(&args.old)?, read(&args.new)?);
    for key in ["scene", "width", "height", "quick"] {
        if old[key] != new[key] {
            bail!(
                "the reports cannot be compared: '{key}' is {} in '{}' and {} in '{}'",
                old[key],
                args.old.display(),
                new[key],
                args.new.display()
            );
        }
    }
    if let Some(file) = &args.page {
        atomic_file::check_writable(file)?;
    }
    let pairs = pairs(&old, &new);
    if pairs.is_empty() {
        bail!("the reports have no row in common");
    }
    let slower = pairs.iter().filter(|p| p.change == Change::Slower).count();
    let faster = pairs.iter().filter(|p| p.change == Change::Faster).count();
    let mut lines = vec![
        [
            "bench",
            "row",
            "figure",
            "old ms",
            "new ms",
            "old / new",
            "",
        ]
        .map(str::to_owned)
        .to_vec(),
    ];
    for pair in pairs.iter().filter(|p| p.change != Change::Same) {
        lines.push(vec![
            pair.bench.clone(),
            pair.row.clone(),
            pair.figure.clone(),
            format!("{:.3}", pair.old_ms),
            format!("{:.3}", pair.new_ms),
            format!("{:.3}", pair.old_ms / pair.new_ms),
            format!("{:?}", pair.change).to_lowercase(),
        ]);
    }
    let mut said = if lines.len() > 1 {
        text(&lines)
    } else {
        String::new()
    };
    said += &format!(
        "{} times compared: {slower} slower, {faster} faster, {} within the noise\n",
        pairs.len(),
        pairs.len() - slower - faster
    );
    if let Some(file) = &args.page {
        atomic_file::write(
            file,
            console::printable_lines(&page::of(&old, &new, &pairs)).as_bytes(),
        )?;
    }
    console::print_result(&said)?;
    if args.fail && slower > 0 {
        bail!("{slower} times became slower");
    }
    Ok(())
}

fn read(path: &Path) -> anyhow::Result<Value> {
    let read = || -> anyhow::Result<Value> {
        let report: Value = serde_json::from_str(&foveal_host::text_file::read(path)?)?;
        if report["schema"] != "foveal-report" {
            bail!("it is no report of 'foveal bench all'");
        }
        Ok(report)
    };
    read().with_context(|| format!("cannot read the report '{}'", path.display()))
}
