//! The report as Markdown: a file of tables per bench, and an index. Made from the report's JSON
//! alone.

use serde_json::Value;

use super::bench::{Bench, Column};
use super::html::rounded;
use super::plan::BENCHES;

/// The index.
const INDEX: &str = "README.md";

fn file_of(bench: &Bench) -> String {
    format!("{}.md", bench.name)
}

/// Names of all files that may be written.
pub(super) fn names() -> impl Iterator<Item = String> {
    BENCHES.iter().map(file_of).chain([INDEX.to_owned()])
}

/// File names and their texts.
pub(super) fn of(report: &Value) -> Vec<(String, String)> {
    let mut index = format!(
        "# Benchmarks\n{} Each page says which scenes it measured.\n\nMade by `foveal bench all --markdown`; nothing here is written by hand.\n\n| bench | |\n|---|---|\n",
        measured_on(report)
    );
    let mut files = Vec::new();
    for (number, bench) in BENCHES.iter().enumerate() {
        let found = &report["benches"][number];
        if found["status"] == "measured" {
            let name = file_of(bench);
            index += &format!("| [{}]({name}) | {} |\n", bench.title, cell(bench.about));
            files.push((name, page(report, bench, found)));
        } else {
            let cause = found["cause"].as_str().unwrap_or_default();
            index += &format!(
                "| {} | {}: {} |\n",
                bench.title,
                text(&found["status"]),
                cell(cause)
            );
        }
    }
    files.push((INDEX.to_owned(), index));
    files
}

/// The machine and the program's state, in two sentences.
fn measured_on(report: &Value) -> String {
    format!(
        "Measured on {}, {} threads, {}; {} ({}, {}). Foveal {}, {}.",
        text(&report["machine"]["processor"]),
        report["machine"]["threads"],
        text(&report["machine"]["system"]),
        text(&report["adapter"]["name"]),
        text(&report["adapter"]["backend"]),
        text(&report["adapter"]["driver"]),
        text(&report["program_version"]),
        report["of"].as_str().unwrap_or("commit not named"),
    )
}

/// What a bench measured, as a sentence.
fn measured(report: &Value, bench: &Bench) -> String {
    let is_quick = report["quick"] == true;
    let scenes = bench.scenes(text(&report["scene"]), is_quick);
    let scenes = match scenes.as_slice() {
        [one] => format!("scene {one}"),
        [most @ .., last] => format!("scenes {} and {last}", most.join(", ")),
        [] => String::new(),
    };
    let size = format!("{} x {} pixels", report["width"], report["height"]);
    let size = match bench.name {
        _ if !bench.sized => String::new(),
        // Displays with fewer pixels are drawn whole.
        "eye" => format!(" at up to {size}"),
        _ => format!(" at {size}"),
    };
    let passes = report["passes"].as_u64().unwrap_or_default() as usize;
    let passes = match bench.passes(passes) {
        1 => "1 pass".to_owned(),
        several => format!("{several} passes"),
    };
    let quick = if is_quick { ", few repetitions" } else { "" };
    format!("The {scenes}{size}, {passes}{quick}.")
}

fn page(report: &Value, bench: &Bench, found: &Value) -> String {
    let mut page = format!(
        "# {}\n{}\n\n{} {}\n\n",
        bench.title,
        bench.about,
        measured_on(report),
        measured(report, bench)
    );
    page += "Figures are medians; the range of the passes follows where they differ.\n\n";
    let titles: Vec<&str> = bench.columns.iter().map(|column| column.title).collect();
    page += &format!(
        "| | {} |\n|---|{}\n",
        titles.join(" | "),
        "--:|".repeat(titles.len())
    );
    for row in found["rows"].as_array().into_iter().flatten() {
        let figures: Vec<String> = bench
            .columns
            .iter()
            .map(|column| figure(row, column))
            .collect();
        page += &format!(
            "| {} | {} |\n",
            cell(text(&row["label"])),
            figures.join(" | ")
        );
    }
    page += "\nTo measure it again:\n\n";
    for command in found["commands"].as_array().into_iter().flatten() {
        page += &format!("    {}\n", text(command));
    }
    page
}

/// A figure and its range, as the column shows it.
fn figure(row: &Value, column: &Column) -> String {
    let shown = |value: &Value| {
        value
            .as_f64()
            .map(|v| rounded(v * column.factor, column.digits))
    };
    let spread = &row["spread"][column.key];
    match (
        shown(&row[column.key]),
        shown(&spread[0]),
        shown(&spread[1]),
    ) {
        (Some(figure), Some(least), Some(most)) => format!("{figure} ({least} to {most})"),
        (Some(figure), ..) => figure,
        (None, ..) => match row[column.key].as_str() {
            Some(text) => cell(text),
            None => "\u{2013}".to_owned(),
        },
    }
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// A text in a table's cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
