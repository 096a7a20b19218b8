//! The page says nothing that the JSON does not.

use serde_json::{Value, json};

use maud::html;

use super::html::rounded;
use super::{csv, markdown, merge, page, pictures, plan, published};
use crate::stereo::SOURCE_RATIOS;

/// A report with figures that occur nowhere else.
fn report() -> Value {
    let benches: Vec<Value> = plan::BENCHES
        .iter()
        .enumerate()
        .map(|(i, bench)| {
            let row = |step: f64| {
                let mut row = serde_json::Map::new();
                for (j, key) in bench.label.iter().enumerate() {
                    row.insert((*key).to_owned(), format!("{key}{j}").into());
                }
                for (j, column) in bench.columns.iter().enumerate() {
                    let figure = 1234.5678 * (i + 1) as f64 + 7.125 * j as f64 + step;
                    row.insert(column.key.to_owned(), figure.into());
                }
                if let Some(load) = &bench.load {
                    row.insert(load.x.to_owned(), (100.0 + 20.0 * step).into());
                    if let Some((key, text)) = load.only {
                        row.insert(key.to_owned(), text.into());
                    }
                }
                Value::from(row)
            };
            let passes = [0.0, 1.5].map(|later| vec![row(later), row(later + 40.0)]);
            // One of them stands for those that could not be run.
            let measured = bench.name != "stereo";
            json!({
                "name": bench.name,
                "title": bench.title,
                "about": bench.about,
                "commands": ["foveal bench <x> --size 480x270"],
                "published": published::of(bench.name),
                "status": if measured { "measured" } else { "skipped" },
                "cause": if measured { Value::Null } else { "no such adapter".into() },
                "rows": if measured { merge::passes(bench, &passes) } else { json!([]) },
                "pictures": [{
                    "title": "a & b", "before_flags": "--aa none", "after_flags": "--aa msaa", "flip_mean": 0.01234, "jod": 9.876,
                    "compare": "foveal compare",
                    "before": "data:,1", "after": "data:,2", "difference": "data:,3",
                }],
            })
        })
        .collect();
    json!({
        "schema": "foveal-report", "scene": "cornell", "width": 480, "height": 270, "passes": 2, "minutes": 2.75,
        "machine": { "processor": "CPU <7>", "threads": 2, "system": "linux" },
        "adapter": { "name": "llvmpipe", "backend": "vulkan", "driver": "Mesa 22" },
        "program_version": "0.1.0", "benches": benches,
    })
}

/// As the page spells a text.
fn escaped(text: &str) -> String {
    html! { (text) }.into_string()
}

/// All texts of the JSON, as the page spells them.
fn texts(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::String(text) => found.push(escaped(text)),
        Value::Array(items) => items.iter().for_each(|item| texts(item, found)),
        Value::Object(items) => items.values().for_each(|item| texts(item, found)),
        _ => {}
    }
}

/// The page's texts, each with the attributes of the tag before it.
fn nodes(page: &str) -> Vec<(String, String)> {
    let body = page.split_once("</style>").unwrap().1;
    let body = body.split_once("<script>").unwrap().0;
    let mut nodes = Vec::new();
    for part in body.split('<').skip(1) {
        let (tag, text) = part.split_once('>').unwrap();
        if !text.trim().is_empty() {
            nodes.push((tag.to_owned(), text.to_owned()));
        }
    }
    nodes
}

fn attribute<'t>(tag: &'t str, name: &str) -> Option<&'t str> {
    let start = tag.split_once(&format!("{name}=\""))?.1;
    start.split('"').next()
}

#[test]
fn every_number_of_the_page_is_in_the_json() {
    let report = report();
    let page = page::of(&report);
    let mut known = Vec::new();
    let mut figures = report.clone();
    pictures::strip(&mut figures);
    texts(&figures, &mut known);
    let mut looked_up = 0;
    for (tag, text) in nodes(&page) {
        if let Some(pointer) = attribute(&tag, "data-json") {
            let factor: f64 = attribute(&tag, "data-factor").unwrap().parse().unwrap();
            let digits: usize = attribute(&tag, "data-digits").unwrap().parse().unwrap();
            let expected = match figures.pointer(pointer) {
                Some(Value::Number(number)) => rounded(number.as_f64().unwrap() * factor, digits),
                Some(Value::String(text)) => escaped(text),
                other => panic!("{pointer}: {other:?}"),
            };
            assert_eq!(text, expected, "{pointer}");
            looked_up += 1;
        } else if attribute(&tag, "class").is_some_and(|class| class.contains("tick")) {
            // An axis has round numbers of its own.
            assert!(tag.starts_with("text "), "{tag}");
        } else {
            // What has digits besides comes from a text of the JSON's, whole.
            let mut rest = text.clone();
            known.sort_by_key(|t| std::cmp::Reverse(t.len()));
            for text in known.iter().filter(|t| !t.is_empty()) {
                rest = rest.replace(text.as_str(), "");
            }
            assert!(
                !rest.contains(|c: char| c.is_ascii_digit()),
                "{text:?}: {rest:?}"
            );
        }
    }
    assert!(looked_up > 60, "{looked_up}");
}

#[test]
fn a_skipped_bench_is_shown_with_its_cause() {
    let page = page::of(&report());
    for bench in plan::BENCHES {
        assert!(page.contains(&format!("<section id=\"{}\">", bench.name)));
    }
    assert!(page.contains("skipped: no such adapter"));
}

#[test]
fn what_was_measured_under_load_is_plotted_against_it() {
    let page = page::of(&report());
    let section = |name: &str| {
        let rest = page
            .split_once(&format!("<section id=\"{name}\">"))
            .unwrap()
            .1;
        rest.split_once("</section>").unwrap().0.to_owned()
    };
    for bench in plan::BENCHES {
        let is_there = section(bench.name).contains("<h3>Cost against load</h3>");
        // The skipped one has no rows.
        let expected = bench.load.is_some() && bench.name != "stereo";
        assert_eq!(is_there, expected, "{}", bench.name);
    }
    // A line per cost, each with a dot per load.
    let culling = section("culling-load");
    let lines = culling.matches("stroke-width=\"2\"").count();
    assert_eq!((lines, culling.matches("r=\"4\"").count()), (2, 4));
    // The plain way is one line, however many composites are compared with it.
    assert_eq!(section("coarse").matches("every pixel</text>").count(), 1);
    assert!(section("baseline").contains("The frame's timeline"));
}

#[test]
fn quality_is_a_curve_where_something_grows_along_it() {
    let mut report = report();
    let variable = plan::BENCHES
        .iter()
        .position(|bench| bench.name == "variable");
    let rows = &mut report["benches"][variable.unwrap()]["rows"];
    for (i, row) in rows.as_array_mut().unwrap().iter_mut().enumerate() {
        row["lights"] = 32.into();
        row["contrast_threshold"] = (0.02 * (i + 1) as f64).into();
    }
    let page = page::of(&report);
    let plot = |bench: &str| {
        let after = |text: &str, mark: &str| text.split_once(mark).unwrap().1.to_owned();
        let section = after(&page, &format!("<section id=\"{bench}\">"));
        let plot = after(&section, "<h3>Quality against speed");
        plot.split_once("</svg>").unwrap().0.to_owned()
    };
    let lines = |plot: &str| {
        let paths = plot.split("<path d=\"").skip(1);
        let drawn = paths.filter(|path| path.split('"').next().unwrap().contains('L'));
        drawn.count()
    };
    // Two rows, one curve: from the small dot to the larger one.
    let variable = plot("variable");
    assert!(variable.starts_with(", plain</h3>"));
    assert!(variable.contains("larger dots: a higher contrast threshold"));
    assert!(variable.contains("r=\"3\"") && variable.contains("r=\"4.5\""));
    assert_eq!(lines(&variable), 1);
    // Ways of anti-aliasing stand alone, a dot each and one in the legend.
    let antialiasing = plot("antialiasing");
    assert_eq!(lines(&antialiasing), 0);
    assert_eq!(antialiasing.matches("<circle").count(), 4);
}

#[test]
fn passes_become_their_median_and_their_spread() {
    let report = report();
    let row = &report["benches"][1]["rows"][0];
    let ms = 2.0 * 1234.5678;
    assert_eq!(row["ms"], ms + 0.75);
    assert_eq!(row["spread"]["ms"], json!([ms, ms + 1.5]));
    let csv = csv::of(&report).unwrap();
    assert!(
        csv.contains("baseline,\"unit0, stage1\",ms,2469.8856,2469.1356,2470.6356"),
        "{csv}"
    );
    assert!(csv.contains("stereo,,skipped,no such adapter,,"), "{csv}");
}

#[test]
fn what_was_found_is_what_the_interval_of_all_passes_says() {
    let row = |finding: &str, low: f64, high: f64| {
        let row = json!({ "finding": finding, "frame_ratio_low": low, "frame_ratio_high": high });
        vec![row]
    };
    let passes = [
        row("no-difference", 0.9, 1.5),
        row("faster", 1.2, 1.8),
        row("faster", 1.3, 1.9),
    ];
    assert_eq!(
        merge::passes(&plan::BENCHES[4], &passes)[0]["finding"],
        "faster"
    );
    assert_eq!(
        merge::passes(&plan::BENCHES[4], &passes[..2])[0]["finding"],
        "faster"
    );
    let passes = [row("slower", 0.2, 0.3), row("no-difference", 0.3, 4.0)];
    assert_eq!(
        merge::passes(&plan::BENCHES[4], &passes)[0]["finding"],
        "no-difference"
    );
    let mut few = row("too-few", 0.0, 0.0);
    few[0]["frame_ratio_low"] = Value::Null;
    assert_eq!(
        merge::passes(&plan::BENCHES[4], &[few])[0]["finding"],
        "too-few"
    );
}

#[test]
fn the_page_has_the_ratios_of_the_source_that_the_bench_has() {
    let published = published::of("stereo");
    for (row, (_, _, cpu, gpu)) in SOURCE_RATIOS.into_iter().enumerate() {
        let [found_cpu, found_gpu] = [1, 2].map(|column| &published["rows"][row][column]);
        assert_eq!((found_cpu, found_gpu), (&cpu.into(), &gpu.into()));
    }
}

#[test]
fn the_markdown_has_a_file_per_measured_bench_and_says_what_was_measured() {
    let mut report = report();
    report["of"] = "commit abc1234, 2026-11-22".into();
    let files = markdown::of(&report);
    let file = |name: &str| {
        let found = files.iter().find(|(file, _)| file == name);
        found.map(|(_, text)| text.as_str())
    };
    // The skipped one is in the index alone.
    assert_eq!(files.len(), plan::BENCHES.len());
    assert!(file("stereo.md").is_none());
    let index = file("README.md").unwrap();
    assert!(
        index.contains("| Instanced stereo | skipped: no such adapter |"),
        "{index}"
    );
    assert!(index.contains("[Baseline](baseline.md)"), "{index}");
    let baseline = file("baseline.md").unwrap();
    assert!(baseline.contains("CPU <7>, 2 threads, linux") && baseline.contains("commit abc1234"));
    // The same median and range as in the CSV.
    assert!(
        baseline.contains("| unit0, stage1 | 2469.89 (2469.14 to 2470.64) |"),
        "{baseline}"
    );
    // Each says what it measured itself.
    assert!(baseline.contains("The scene cornell at 480 x 270 pixels, 2 passes."));
    for (name, said) in [
        (
            "verdict.md",
            "The scene cornell at 480 x 270 pixels, 1 pass.",
        ),
        (
            "eye.md",
            "The scene cornell at up to 480 x 270 pixels, 1 pass.",
        ),
        ("culling.md", "The scene cornell, 2 passes."),
        (
            "culling-load.md",
            "The scenes demo:1000, demo:3000, demo:10000 and demo:30000, 2 passes.",
        ),
    ] {
        let text = file(name).unwrap();
        assert!(text.contains(said), "{text}");
    }
    // Every row of a table has as many cells as its head.
    for (name, text) in &files {
        let mut cells = text
            .lines()
            .filter(|line| line.starts_with('|'))
            .map(|line| line.matches('|').count());
        let head = cells.next().unwrap();
        assert!(cells.all(|count| count == head), "{name}");
    }
}

#[test]
fn two_plots_of_a_bench_are_in_sight_and_commands_are_folded() {
    let page = page::of(&report());
    for section in page.split("<section id=\"").skip(2) {
        let (in_sight, folded) = section.split_once("<details>").unwrap_or((section, ""));
        assert!(in_sight.matches("<svg").count() <= 2, "{in_sight}");
        assert!(!in_sight.contains("To measure it again"), "{in_sight}");
        let is_skipped = in_sight.contains("skipped: ");
        assert_eq!(
            folded.contains("To measure it again"),
            !is_skipped,
            "{section}"
        );
    }
}

#[test]
fn the_cause_of_a_failure_is_the_error_itself() {
    for (said, expected) in [
        ("warning: slow\nerror: no memory\n", "no memory"),
        (
            "error: invalid value '8x8'\n\nFor more information, try '--help'.\n",
            "invalid value '8x8'",
        ),
        ("Killed\n\n", "Killed"),
        ("", "it ended without a word"),
    ] {
        assert_eq!(super::cause(said), expected);
    }
}
