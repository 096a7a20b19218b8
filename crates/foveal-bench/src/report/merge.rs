//! Several passes of a bench become one table: medians, and how far the passes lay apart.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::bench::Bench;
use foveal_measure::{Finding, median};

/// A row per row of the first pass. Numbers that the passes disagree about become their median;
/// `spread` holds the least and the largest of each. What was found is what the medians of the
/// interval's ends say.
pub(super) fn passes(bench: &Bench, passes: &[Vec<Value>]) -> Value {
    let Some(first) = passes.first() else {
        return json!([]);
    };
    let mut labels: Vec<String> = Vec::new();
    let rows = first.iter().enumerate().map(|(i, row)| {
        let Some(columns) = row.as_object() else {
            return row.clone();
        };
        let mut merged = Map::new();
        let plain = label(bench, columns);
        // A bench that has come to tell its rows apart by more than is known here shall not confuse
        // anybody.
        let same = labels.iter().filter(|label| **label == plain).count();
        labels.push(plain.clone());
        let label = match same {
            0 => plain,
            _ => format!("{plain}, row {}", i + 1),
        };
        merged.insert("label".to_owned(), label.into());
        let mut spread = Map::new();
        for (key, value) in columns {
            let all: Vec<f64> = passes
                .iter()
                .filter_map(|rows| rows.get(i)?.get(key)?.as_f64())
                .collect();
            let differ = all.iter().any(|&v| v != all[0]);
            if value.is_number() && differ && all.len() == passes.len() {
                let least = all.iter().copied().fold(f64::INFINITY, f64::min);
                let most = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                merged.insert(key.clone(), median(&all).into());
                spread.insert(key.clone(), json!([least, most]));
            } else {
                merged.insert(key.clone(), value.clone());
            }
        }
        merged.insert("spread".to_owned(), spread.into());
        if let (Some(finding), Some([low, high])) = (merged.get("finding"), interval(&merged)) {
            let of_all = Finding::of(low.as_f64().zip(high.as_f64()).map(<[f64; 2]>::from));
            let of_all = serde_json::to_value(of_all).unwrap_or_else(|_| finding.clone());
            merged.insert("finding".to_owned(), of_all);
        }
        merged.into()
    });
    rows.collect::<Vec<Value>>().into()
}

/// The ends of a ratio's interval, which a finding is of.
fn interval(row: &Map<String, Value>) -> Option<[&Value; 2]> {
    Some([row.get("frame_ratio_low")?, row.get("frame_ratio_high")?])
}

/// «smooth, compute»
fn label(bench: &Bench, row: &Map<String, Value>) -> String {
    let mut parts = Vec::new();
    let has_size = bench.label.contains(&"width") && row.contains_key("width");
    for key in bench.label {
        match (row.get(*key), *key) {
            (Some(width), "width") if has_size => {
                parts.push(format!(
                    "{width}x{}",
                    row.get("height").unwrap_or(&Value::Null)
                ));
            }
            (_, "height") if has_size => {}
            (Some(count), "threads" | "lights" | "occluder_triangles") => {
                parts.push(format!("{count} {}", key.replace('_', " ")));
            }
            // A scene's file without its folders, which have no end.
            (Some(Value::String(file)), "scene") => {
                let name = Path::new(file).file_name();
                parts.push(name.map_or(file.clone(), |name| name.to_string_lossy().into_owned()));
            }
            (Some(Value::String(text)), _) => parts.push(text.clone()),
            (Some(value), _) => parts.push(value.to_string()),
            (None, _) => {}
        }
    }
    parts.join(", ")
}
