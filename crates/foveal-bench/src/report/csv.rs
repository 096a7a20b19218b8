//! All rows of all benches as one table: bench, row, figure, value, least and largest of the passes.

use std::fmt::Write;

use serde_json::Value;

pub(super) fn of(report: &Value) -> String {
    let mut text = "bench,row,figure,value,least,largest\n".to_owned();
    for bench in report["benches"].as_array().into_iter().flatten() {
        let name = bench["name"].as_str().unwrap_or_default();
        if bench["status"] != "measured" {
            let cause = bench["cause"].as_str().unwrap_or_default();
            let status = bench["status"].as_str().unwrap_or_default();
            let _ = writeln!(text, "{name},,{status},{},,", cell(cause));
        }
        for row in bench["rows"].as_array().into_iter().flatten() {
            let label = cell(row["label"].as_str().unwrap_or_default());
            for (key, value) in row.as_object().into_iter().flatten() {
                if !value.is_number() {
                    continue;
                }
                let spread = &row["spread"][key];
                let end = |i: usize| spread.get(i).map_or(value, |end| end);
                let _ = writeln!(text, "{name},{label},{key},{value},{},{}", end(0), end(1));
            }
        }
    }
    text
}

/// A field that may hold commas and quotes.
fn cell(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
