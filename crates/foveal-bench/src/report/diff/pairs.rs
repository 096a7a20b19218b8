//! The times that two reports have in common, and which of them changed.

use serde_json::Value;

/// By what part a median must differ.
const LEAST_CHANGE: f64 = 0.05;

/// How a time changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    Slower,
    Faster,
    Same,
}

/// One time of one row, in both reports.
#[derive(Debug)]
pub(super) struct Pair {
    pub(super) bench: String,
    pub(super) row: String,
    pub(super) figure: String,
    pub(super) old_ms: f64,
    pub(super) new_ms: f64,
    pub(super) change: Change,
}

/// All times that both reports have.
pub(super) fn pairs(old: &Value, new: &Value) -> Vec<Pair> {
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
fn spread(row: &Value, key: &str, median: f64) -> [f64; 2] {
    let end = |i: usize| row["spread"][key][i].as_f64().unwrap_or(median);
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
