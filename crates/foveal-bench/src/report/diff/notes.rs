//! What two reports do not have in common: benches that failed, and what only one has measured.

use serde_json::Value;

use super::pairs::{benches, rows, same_bench, same_row, text};

fn has_failed(bench: &Value) -> bool {
    bench["status"] == "failed"
}

/// How many benches failed in the new report that had not failed in the old one.
pub(super) fn failures(old: &Value, new: &Value) -> usize {
    let failed_before = |bench: &Value| same_bench(old, bench).is_some_and(has_failed);
    let failed = benches(new).filter(|bench| has_failed(bench) && !failed_before(bench));
    failed.count()
}

/// A line for each bench that failed, and for each bench or row that only one of the two reports
/// has, which go by these names.
pub(super) fn notes(reports: [&Value; 2], names: [&str; 2]) -> Vec<String> {
    let mut notes = Vec::new();
    for (report, name) in reports.into_iter().zip(names) {
        for bench in benches(report).filter(|bench| has_failed(bench)) {
            let (which, cause) = (text(&bench["name"]), text(&bench["cause"]));
            let cause = cause.lines().collect::<Vec<_>>().join(" ");
            notes.push(format!("failed in {name}: {which}: {cause}"));
        }
    }
    let [old, new] = reports;
    for (report, other, name) in [(old, new, names[0]), (new, old, names[1])] {
        let alone = benches(report).flat_map(|bench| alone(bench, same_bench(other, bench)));
        notes.extend(alone.map(|what| format!("only in {name}: {what}")));
    }
    notes
}

/// The rows of a bench that the other report's has not; as one where it has none of several.
fn alone(bench: &Value, other: Option<&Value>) -> Vec<String> {
    let name = text(&bench["name"]);
    let is_alone = |row: &&Value| other.and_then(|other| same_row(other, row)).is_none();
    let alone: Vec<&Value> = rows(bench).filter(is_alone).collect();
    if alone.len() > 1 && alone.len() == rows(bench).count() {
        return vec![format!("{name}, all {} rows", alone.len())];
    }
    let said = |row: &&Value| match (text(&row["label"]), text(&row["flags"])) {
        (label, "") => format!("{name}, {label}"),
        (label, flags) => format!("{name}, {label} ({flags})"),
    };
    alone.iter().map(said).collect()
}
