//! All rows of all benches as one table: bench, row, figure, value, least and largest of the
//! passes.

use csv::Writer;
use serde_json::Value;

pub(super) fn of(report: &Value) -> anyhow::Result<String> {
    let mut table = Writer::from_writer(Vec::new());
    table.write_record(["bench", "row", "figure", "value", "least", "largest"])?;
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    for bench in report["benches"].as_array().into_iter().flatten() {
        let name = text(&bench["name"]);
        if bench["status"] != "measured" {
            let (status, cause) = (text(&bench["status"]), text(&bench["cause"]));
            table.write_record([&name, "", &status, &cause, "", ""])?;
        }
        for row in bench["rows"].as_array().into_iter().flatten() {
            let label = text(&row["label"]);
            for (key, value) in row.as_object().into_iter().flatten() {
                if !value.is_number() {
                    continue;
                }
                let end = |i: usize| row["spread"][key].get(i).unwrap_or(value).to_string();
                table.write_record([&name, &label, key, &value.to_string(), &end(0), &end(1)])?;
            }
        }
    }
    Ok(String::from_utf8(table.into_inner()?)?)
}
