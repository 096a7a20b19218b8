//! `foveal bench diff`: what became slower between two reports.
//!
//! A time counts as slower when its median grew by more than a twentieth *and* the new passes all
//! lie above the old ones: where the passes of both overlap, the machine's noise explains the
//! difference. Where a bench makes one pass, the intervals of its ratios to the plain frame take
//! the passes' place.

mod notes;
mod page;
mod pairs;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use serde_json::Value;

use super::SCHEMA_VERSION;
use crate::table::text;
use foveal_host::failure::usage;
use foveal_host::{atomic_file, console};
use notes::{failures, notes};
use pairs::{Change, Pair, pairs};

/// Arguments of `foveal bench diff`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The earlier report.json
    old: PathBuf,
    /// The later report.json
    new: PathBuf,
    /// Exit with code 1 if anything became slower, or a bench fails that did not fail before
    #[arg(long)]
    fail: bool,
    /// Write the comparison as a page: first what changed, then each bench
    #[arg(long, value_name = "FILE.html")]
    page: Option<PathBuf>,
}

/// Prints what changed.
pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    if let Some(file) = &args.page {
        let replaces = |report: &Path| atomic_file::any_twice([file.as_path(), report]);
        if replaces(&args.old) || replaces(&args.new) {
            return usage("--page names a report that is compared");
        }
        atomic_file::check_writable(file)?;
    }
    let (old, new) = (read(&args.old)?, read(&args.new)?);
    let names = [&args.old, &args.new].map(|path| path.display().to_string());
    let difference = Difference::of(&old, &new, [&names[0], &names[1]])?;
    if let Some(file) = &args.page {
        atomic_file::write(file, difference.page.as_bytes())?;
    }
    console::print_result(&difference.said)?;
    match (difference.slower, difference.failed) {
        (0, 0) => Ok(()),
        _ if !args.fail => Ok(()),
        (slower, 0) => bail!("{slower} times became slower"),
        (slower, failed) => bail!("{slower} times became slower, {failed} benches failed"),
    }
}

/// What changed between the texts of two reports: as text, and as a page.
///
/// # Errors
/// Where one of them is no report, and where they cannot be compared.
pub fn diff_of_texts(old: &str, new: &str) -> anyhow::Result<[String; 2]> {
    let difference = Difference::of(&parse(old)?, &parse(new)?, ["old", "new"])?;
    Ok([difference.said, difference.page])
}

/// What changed between two reports.
struct Difference {
    said: String,
    page: String,
    slower: usize,
    /// Benches that did not fail before.
    failed: usize,
}

impl Difference {
    fn of(old: &Value, new: &Value, names: [&str; 2]) -> anyhow::Result<Self> {
        for key in ["scene", "width", "height", "quick"] {
            if old[key] != new[key] {
                bail!(
                    "the reports cannot be compared: '{key}' is {} in '{}' and {} in '{}'",
                    old[key],
                    names[0],
                    new[key],
                    names[1]
                );
            }
        }
        let pairs = pairs(old, new);
        let quoted = names.map(|name| format!("'{name}'"));
        let notes = notes([old, new], [&quoted[0], &quoted[1]]);
        if pairs.is_empty() && notes.is_empty() {
            bail!("the reports have no row in common");
        }
        let count = |change| pairs.iter().filter(|p| p.change == change).count();
        let (slower, faster) = (count(Change::Slower), count(Change::Faster));
        let [before, after] = [old, new].map(|report| &report["adapter"]["name"]);
        let mut said = String::new();
        if before != after {
            said = format!(
                "other adapters: {before} in '{}', {after} in '{}'\n",
                names[0], names[1]
            );
        }
        said += &table(&pairs);
        for note in notes {
            said += &format!("{note}\n");
        }
        let failed = failures(old, new);
        said += &format!(
            "{} times compared: {slower} slower, {faster} faster, {} within the noise",
            pairs.len(),
            pairs.len() - slower - faster
        );
        said += &match failed {
            0 => "\n".to_owned(),
            _ => format!("; {failed} benches failed that did not before\n"),
        };
        Ok(Self {
            said,
            page: console::printable_lines(&page::of(old, new, &pairs)),
            slower,
            failed,
        })
    }
}

/// The times that changed; empty where none did.
fn table(pairs: &[Pair]) -> String {
    let head = [
        "bench",
        "row",
        "figure",
        "old ms",
        "new ms",
        "old / new",
        "",
    ];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    for pair in pairs.iter().filter(|p| p.change != Change::Same) {
        lines.push(vec![
            pair.bench.clone(),
            pair.row.clone(),
            pair.figure.clone(),
            format!("{:.3}", pair.old_ms),
            format!("{:.3}", pair.new_ms),
            pair.ratio(3),
            format!("{:?}", pair.change).to_lowercase(),
        ]);
    }
    if lines.len() > 1 {
        text(&lines)
    } else {
        String::new()
    }
}

fn read(path: &Path) -> anyhow::Result<Value> {
    let read = || parse(&foveal_host::text_file::read(path)?);
    read().with_context(|| format!("cannot read the report '{}'", path.display()))
}

fn parse(text: &str) -> anyhow::Result<Value> {
    let report: Value = serde_json::from_str(text)?;
    if report["schema"] != "foveal-report" {
        bail!("it is no report of 'foveal bench all'");
    }
    let version = &report["schema_version"];
    if *version != SCHEMA_VERSION {
        bail!(
            "its schema_version is {version}, and this program compares reports of {SCHEMA_VERSION}"
        );
    }
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn report(benches: &Value) -> Value {
        json!({
            "schema": "foveal-report", "schema_version": SCHEMA_VERSION, "benches": benches,
        })
    }

    #[test]
    fn reports_of_another_shape_are_refused() {
        let mut other = report(&json!([measured("a", &[("x", "")])]));
        let compared = |report: &Value| diff_of_texts(&report.to_string(), &report.to_string());
        assert!(compared(&other).is_ok());
        for version in [json!(1), json!(3), json!("2"), Value::Null] {
            other["schema_version"] = version;
            let error = compared(&other).unwrap_err().to_string();
            let named = format!("its schema_version is {}", other["schema_version"]);
            assert!(error.contains(&named), "{error}");
        }
    }

    fn measured(name: &str, rows: &[(&str, &str)]) -> Value {
        let row =
            |&(label, flags): &(&str, &str)| json!({ "label": label, "flags": flags, "ms": 5.0 });
        let rows: Vec<Value> = rows.iter().map(row).collect();
        json!({ "name": name, "status": "measured", "rows": rows })
    }

    #[test]
    fn what_only_one_report_has_and_what_failed_is_listed() {
        let failed = json!({ "name": "b", "status": "failed", "cause": "no memory", "rows": [] });
        let old = report(&json!([
            measured("a", &[("x", ""), ("together", "--p 1")]),
            measured("b", &[("y", ""), ("z", "")]),
        ]));
        let new = report(&json!([
            measured("a", &[("x", ""), ("together", "--q 1")]),
            failed,
            measured("c", &[("v", "")]),
        ]));
        let found = Difference::of(&old, &new, ["old.json", "new.json"]).unwrap();
        for line in [
            "failed in 'new.json': b: no memory\n",
            "only in 'old.json': a, together (--p 1)\n",
            "only in 'old.json': b, all 2 rows\n",
            "only in 'new.json': a, together (--q 1)\n",
            "only in 'new.json': c, v\n",
            "; 1 benches failed that did not before\n",
        ] {
            assert!(found.said.contains(line), "{line}: {}", found.said);
        }
        assert!(found.page.contains("a, together (--p 1)"), "{}", found.page);
        assert_eq!((found.slower, found.failed), (0, 1));
        // Where nothing else is left, too; a cause of several lines is one of the list.
        let failed = json!({ "name": "a", "status": "failed", "cause": "no\nmemory", "rows": [] });
        let old = report(&json!([measured("a", &[("x", "")])]));
        let found = Difference::of(&old, &report(&json!([failed])), ["old.json", "new.json"]);
        let found = found.unwrap();
        assert_eq!(
            found.said,
            "failed in 'new.json': a: no memory\nonly in 'old.json': a, x\n\
             0 times compared: 0 slower, 0 faster, 0 within the noise; \
             1 benches failed that did not before\n"
        );
        assert!(found.page.contains("a: no memory"), "{}", found.page);
        let nothing = report(&json!([]));
        assert!(Difference::of(&nothing, &nothing, ["old.json", "new.json"]).is_err());
        // What failed before as well is no change.
        let found = Difference::of(&new, &new, ["old.json", "new.json"]).unwrap();
        assert_eq!(found.failed, 0);
        assert!(!found.said.contains("only in"), "{}", found.said);
    }
}
