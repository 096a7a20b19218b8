//! `foveal bench diff`: what became slower between two reports.
//!
//! A time counts as slower when its median grew by more than a twentieth *and* the new passes all lie above the old
//! ones: where the passes of both overlap, the machine's noise explains the difference.

mod page;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use serde_json::Value;

use crate::table::text;
use foveal_host::{atomic_file, console};

/// By what part a median must differ.
const LEAST_CHANGE: f64 = 0.05;

/// Arguments of `foveal bench diff`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The earlier report.json
    old: PathBuf,
    /// The later report.json
    new: PathBuf,
    /// Exit with 1 where anything became slower
    #[arg(long)]
    fail: bool,
    /// Write all of it as a page: what changed, then each bench
    #[arg(long, value_name = "FILE.html")]
    page: Option<PathBuf>,
}

/// How a time changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    Slower,
    Faster,
    Same,
}

/// One time of one row, in both reports.
#[derive(Debug)]
struct Pair {
    bench: String,
    row: String,
    figure: String,
    old_ms: f64,
    new_ms: f64,
    change: Change,
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
        atomic_file::write(file, page::of(&old, &new, &pairs).as_bytes())?;
    }
    console::print_result(&said)?;
    if args.fail && slower > 0 {
        bail!("{slower} times became slower");
    }
    Ok(())
}

fn read(path: &Path) -> anyhow::Result<Value> {
    let read = || -> anyhow::Result<Value> {
        let report: Value = serde_json::from_str(&std::fs::read_to_string(path)?)?;
        if report["schema"] != "foveal-report" {
            bail!("it is no report of 'foveal bench all'");
        }
        Ok(report)
    };
    read().with_context(|| format!("cannot read the report '{}'", path.display()))
}

/// All times that both reports have.
fn pairs(old: &Value, new: &Value) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for bench in new["benches"].as_array().into_iter().flatten() {
        let mut before = old["benches"].as_array().into_iter().flatten();
        let Some(before) = before.find(|b| b["name"] == bench["name"]) else {
            continue;
        };
        for row in bench["rows"].as_array().into_iter().flatten() {
            let mut rows = before["rows"].as_array().into_iter().flatten();
            let Some(old_row) = rows.find(|r| r["label"] == row["label"]) else {
                continue;
            };
            for key in row.as_object().into_iter().flatten().map(|(key, _)| key) {
                if !(key == "ms" || key.ends_with("_ms")) {
                    continue;
                }
                if let (Some(old_ms), Some(new_ms)) = (old_row[key].as_f64(), row[key].as_f64()) {
                    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
                    pairs.push(Pair {
                        bench: text(&bench["name"]),
                        row: text(&row["label"]),
                        figure: key.clone(),
                        old_ms,
                        new_ms,
                        change: change(
                            (old_ms, spread(old_row, key, old_ms)),
                            (new_ms, spread(row, key, new_ms)),
                        ),
                    });
                }
            }
        }
    }
    pairs
}

/// Least and largest of the passes.
fn spread(row: &Value, key: &str, middle: f64) -> [f64; 2] {
    let end = |i: usize| row["spread"][key][i].as_f64().unwrap_or(middle);
    [end(0), end(1)]
}

fn change((old, old_spread): (f64, [f64; 2]), (new, new_spread): (f64, [f64; 2])) -> Change {
    if new > old * (1.0 + LEAST_CHANGE) && new_spread[0] > old_spread[1] {
        Change::Slower
    } else if new < old / (1.0 + LEAST_CHANGE) && new_spread[1] < old_spread[0] {
        Change::Faster
    } else {
        Change::Same
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn report(ms: f64, spread: [f64; 2]) -> Value {
        json!({ "benches": [{ "name": "a", "rows": [
            { "label": "r", "frame_ms": ms, "count": 5, "spread": { "frame_ms": spread } },
        ] }] })
    }

    fn only(old: &Value, new: &Value) -> Change {
        let pairs = pairs(old, new);
        assert_eq!(pairs.len(), 1, "counts are no times");
        pairs[0].change
    }

    #[test]
    fn what_is_slower_beyond_the_passes_spread_is_slower() {
        let (old, new) = (report(10.0, [9.0, 11.0]), report(12.0, [11.5, 13.0]));
        assert_eq!(only(&old, &new), Change::Slower);
        assert_eq!(only(&new, &old), Change::Faster);
    }

    #[test]
    fn overlapping_passes_and_small_changes_are_noise() {
        let old = report(10.0, [9.0, 11.8]);
        assert_eq!(only(&old, &report(12.0, [11.5, 13.0])), Change::Same);
        let old = report(10.0, [10.0, 10.0]);
        assert_eq!(only(&old, &report(10.4, [10.4, 10.4])), Change::Same);
    }
}
