//! The times that two reports have in common, and which of them changed.

use serde_json::Value;

use crate::table::number_text;

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

impl Pair {
    /// Old by new; a dash where either has no such time.
    pub(super) fn ratio(&self, digits: usize) -> String {
        let are_there = self.old_ms > 0.0 && self.new_ms > 0.0;
        number_text(are_there.then(|| self.old_ms / self.new_ms), digits)
    }
}

pub(super) fn benches(report: &Value) -> impl Iterator<Item = &Value> {
    report["benches"].as_array().into_iter().flatten()
}

pub(super) fn rows(bench: &Value) -> impl Iterator<Item = &Value> {
    bench["rows"].as_array().into_iter().flatten()
}

/// The bench of the same name.
pub(super) fn same_bench<'r>(report: &'r Value, bench: &Value) -> Option<&'r Value> {
    benches(report).find(|other| other["name"] == bench["name"])
}

/// The row of this bench that measures the same: by its label and, where it has them, its flags.
pub(super) fn same_row<'r>(bench: &'r Value, row: &Value) -> Option<&'r Value> {
    let is_same = |other: &&Value| ["label", "flags"].iter().all(|&key| other[key] == row[key]);
    rows(bench).find(is_same)
}

pub(super) fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// All times that both reports have.
pub(super) fn pairs(old: &Value, new: &Value) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for bench in benches(new) {
        let Some(before) = same_bench(old, bench) else {
            continue;
        };
        for row in rows(bench) {
            let Some(old_row) = same_row(before, row) else {
                continue;
            };
            for key in row.as_object().into_iter().flatten().map(|(key, _)| key) {
                if !is_time(key) {
                    continue;
                }
                if let (Some(old_ms), Some(new_ms)) = (old_row[key].as_f64(), row[key].as_f64())
                    // Neither report has the stage.
                    && (old_ms > 0.0 || new_ms > 0.0)
                {
                    pairs.push(Pair {
                        bench: text(&bench["name"]).to_owned(),
                        row: text(&row["label"]).to_owned(),
                        figure: key.clone(),
                        old_ms,
                        new_ms,
                        change: change([old_ms, new_ms], bounds([old_row, row], key)),
                    });
                }
            }
        }
    }
    pairs
}

/// Whether a figure is a time of which less is better. What is saved is none, nor are percentiles,
/// which a few frames decide.
fn is_time(key: &str) -> bool {
    let is_gain = matches!(key, "saved_ms" | "net_ms");
    let is_percentile = key.ends_with("_low_ms") || key.ends_with("_high_ms");
    (key == "ms" || key.ends_with("_ms")) && !is_gain && !is_percentile
}

/// Between what a time lies in each of two rows: the least and the largest of the passes. Where
/// there was one pass: the interval of the time by the plain frame's, which was drawn in turn with it.
/// `None` where the rows have neither.
fn bounds(rows: [&Value; 2], key: &str) -> Option<[[f64; 2]; 2]> {
    let of_passes = |row: &Value| {
        let spread = &row["spread"][key];
        Some([spread[0].as_f64()?, spread[1].as_f64()?])
    };
    // What is equal in all passes has no spread, where another time of the row has one.
    let of_equal_passes = |row: &Value| {
        let several = row["spread"].as_object().is_some_and(|s| !s.is_empty());
        let ms = row[key].as_f64().filter(|_| several)?;
        of_passes(row).or(Some([ms, ms]))
    };
    let of_ratio = |row: &Value| {
        let [low, high] = match key {
            "chosen_ms" => ["low", "high"],
            "frame_ms" => ["frame_ratio_low", "frame_ratio_high"],
            _ => return None,
        };
        // The ratio is the plain time by this one.
        Some([1.0 / row[high].as_f64()?, 1.0 / row[low].as_f64()?])
    };
    let both = |of: &dyn Fn(&Value) -> Option<[f64; 2]>| Some([of(rows[0])?, of(rows[1])?]);
    both(&of_passes)
        .or_else(|| both(&of_ratio))
        .or_else(|| both(&of_equal_passes))
}

fn change([old, new]: [f64; 2], bounds: Option<[[f64; 2]; 2]>) -> Change {
    let Some([old_bounds, new_bounds]) = bounds else {
        return Change::Same;
    };
    if new > old * (1.0 + LEAST_CHANGE) && new_bounds[0] > old_bounds[1] {
        Change::Slower
    } else if new < old / (1.0 + LEAST_CHANGE) && new_bounds[1] < old_bounds[0] {
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

    /// Two reports with one row each.
    fn reports(rows: [Value; 2]) -> [Value; 2] {
        rows.map(|mut row| {
            row["label"] = "r".into();
            json!({ "benches": [{ "name": "a", "rows": [row] }] })
        })
    }

    #[test]
    fn rows_of_one_label_are_compared_where_they_have_the_same_flags() {
        let row = |flags: &str| json!({ "flags": flags, "chosen_ms": 10.0 });
        let [old, new] = reports([row("--a 1"), row("--a 1 --b 2")]);
        assert!(pairs(&old, &new).is_empty());
        assert_eq!(pairs(&old, &old).len(), 1);
    }

    #[test]
    fn what_is_saved_is_no_time() {
        let row = |ms: f64| {
            let spread = [ms - 1.0, ms + 1.0];
            json!({
                "net_ms": ms, "saved_ms": ms, "spread": { "net_ms": spread, "saved_ms": spread },
            })
        };
        let [old, new] = reports([row(10.0), row(20.0)]);
        assert!(pairs(&old, &new).is_empty());
    }

    #[test]
    fn one_pass_without_an_interval_tells_no_change() {
        let row = |ms: f64| json!({ "frame_ms": ms, "chosen_high_ms": 2.0 * ms, "spread": {} });
        let [old, new] = reports([row(10.0), row(10.6)]);
        assert_eq!(only(&old, &new), Change::Same);
    }

    #[test]
    fn one_pass_tells_a_change_by_the_interval_of_its_ratio() {
        let eye = |ms: f64, low: f64, high: f64| json!({ "frame_ms": ms, "frame_ratio_low": low, "frame_ratio_high": high, "spread": {} });
        let verdict = |ms: f64, low: f64, high: f64| json!({ "chosen_ms": ms, "low": low, "high": high, "spread": {} });
        for row in [&eye as &dyn Fn(f64, f64, f64) -> Value, &verdict] {
            let before = || row(10.0, 1.9, 2.1);
            // (milliseconds, least and largest ratio)
            for (after, expected) in [
                (row(12.0, 1.5, 1.8), Change::Slower),
                (row(8.0, 2.2, 2.6), Change::Faster),
                (row(12.0, 1.7, 2.0), Change::Same),
                // The plain frame became faster, or the whole machine slower.
                (row(10.0, 1.5, 1.8), Change::Same),
                (row(20.0, 1.9, 2.1), Change::Same),
            ] {
                let [old, new] = reports([before(), after]);
                assert_eq!(only(&old, &new), expected, "{new}");
            }
        }
    }

    #[test]
    fn overlapping_passes_and_small_changes_are_noise() {
        let old = report(10.0, [9.0, 11.8]);
        assert_eq!(only(&old, &report(12.0, [11.5, 13.0])), Change::Same);
        let old = report(10.0, [10.0, 10.0]);
        assert_eq!(only(&old, &report(10.4, [10.4, 10.4])), Change::Same);
    }

    #[test]
    fn a_time_that_is_equal_in_all_passes_may_have_changed() {
        let row = |ms: f64| json!({ "reproject_ms": ms, "frame_ms": 9.0, "spread": { "frame_ms": [8.0, 10.0] } });
        let [old, new] = reports([row(0.0), row(5.0)]);
        let found = pairs(&old, &new);
        let of = |figure: &str| found.iter().find(|p| p.figure == figure).unwrap();
        assert_eq!(of("reproject_ms").change, Change::Slower);
        assert_eq!(of("reproject_ms").ratio(2), "-");
        assert_eq!(of("frame_ms").change, Change::Same);
        let [old, new] = reports([row(0.0), row(0.0)]);
        assert_eq!(
            pairs(&old, &new).len(),
            1,
            "what neither has is not compared"
        );
    }
}
