//! Two reports beside each other as one page, without network.

use maud::{Markup, html};
use serde_json::Value;

use super::notes::notes;
use super::pairs::{Change, Pair};
use crate::report::html;

/// Colours of what changed.
const STYLE: &str = "td.faster { color: var(--good); } td.slower { color: var(--bad); }\n";

/// The page.
pub(super) fn of(old: &Value, new: &Value, pairs: &[Pair]) -> String {
    let text = |report: &Value, pointer: &str| {
        let text = report.pointer(pointer).and_then(Value::as_str);
        text.unwrap_or_default().to_owned()
    };
    let changed: Vec<&Pair> = pairs.iter().filter(|p| p.change != Change::Same).collect();
    let mut benches: Vec<&str> = pairs.iter().map(|pair| pair.bench.as_str()).collect();
    benches.dedup();
    let of_bench =
        |bench: &str| -> Vec<&Pair> { pairs.iter().filter(|pair| pair.bench == bench).collect() };
    let notes = notes([old, new], ["the old report", "the new report"]);
    let body = html! {
        h1 { "Two reports" }
        p {
            "The scene " b { (text(new, "/scene")) } " at " (new["width"]) " x " (new["height"])
            " pixels. Ratios are the old time by the new one: above 1 it became faster. A change is one of more than a \
             twentieth whose passes do not overlap; where there is one pass, the \
             intervals of its ratio to the plain frame."
        }
        @for (name, report) in [("Old", old), ("New", new)] {
            p.faint {
                (name) ": Foveal " (text(report, "/program_version")) ", " (text(report, "/machine/processor")) ", "
                (text(report, "/adapter/name"))
            }
        }
        section {
            h2 { "What changed" }
            @if pairs.is_empty() {
                p { "No time can be compared." }
            } @else if changed.is_empty() {
                p { "No time changed beyond the noise." }
            } @else {
                (table(&changed))
            }
        }
        @if !notes.is_empty() {
            section {
                h2 { "What cannot be compared" }
                @for note in notes {
                    p { (note) }
                }
            }
        }
        @for bench in benches {
            @let own = of_bench(bench);
            details {
                summary { (bench) ": " (own.len()) " times" }
                (table(&own))
            }
        }
    };
    html::page("Two Foveal reports", STYLE, &body, None)
}

fn table(pairs: &[&Pair]) -> Markup {
    html! {
        .scroll {
            table {
                tr {
                    @for title in ["row", "figure", "old ms", "new ms", "old / new", ""] {
                        th { (title) }
                    }
                }
                @for pair in pairs {
                    @let change = word(pair.change);
                    tr {
                        td { (pair.bench) ", " (pair.row) }
                        td { (pair.figure) }
                        td { (format!("{:.3}", pair.old_ms)) }
                        td { (format!("{:.3}", pair.new_ms)) }
                        td { (pair.ratio(2)) }
                        td class=(change) { (change) }
                    }
                }
            }
        }
    }
}

fn word(change: Change) -> &'static str {
    match change {
        Change::Slower => "slower",
        Change::Faster => "faster",
        Change::Same => "no difference",
    }
}
