//! The first page: what to adopt for this scene on this machine, what not, and why.

use maud::{Markup, html};

use super::bench::VERDICT;
use super::html::Figures;
use super::plan::BENCHES;
use super::plots;
use super::tables::{commands, table};
use crate::verdict::TOGETHER;

/// Decisions in the order in which the page tells them, and their headings.
const DECISIONS: [(&str, &str); 6] = [
    ("adopt", "Adopt"),
    ("faster-but-visible", "Faster, but visible"),
    ("better-as-fast", "Better, as fast"),
    ("better-but-slower", "Better, but slower"),
    ("skip", "Skip"),
    ("impossible", "Not here"),
];

/// The verdict, before all sections.
pub(super) fn show(f: &Figures<'_>) -> Markup {
    let index = BENCHES.iter().position(|bench| bench.name == VERDICT);
    let Some((index, bench)) = index.map(|index| (index, &BENCHES[index])) else {
        return html! {};
    };
    let at = format!("/benches/{index}");
    let status = f.text(&format!("{at}/status"));
    html! {
        section id=(VERDICT) {
            h2 { "For this scene, on this machine" }
            @if status != "measured" {
                p.bad { "No verdict. " (status) ": " (f.text(&format!("{at}/cause"))) }
            } @else {
                .pair {
                    div {
                        (decisions(f, &at))
                        (command(f, &at))
                    }
                    @if let Some(svg) = plots::ratios(f, &at) {
                        div {
                            h3 { "Plain frame / this, with the interval of each" }
                            (svg)
                        }
                    }
                }
                p.faint {
                    "The ratio is the plain frame's time by the other's: above one is faster. The interval holds the \
                     true ratio in all but two of a thousand cases; where it comes within two percent of one there is \
                     no difference."
                }
                details {
                    summary { "Figures" }
                    (table(f, &at, bench.columns))
                    h3 { "To measure it again" }
                    (commands(f, &format!("{at}/commands")))
                    (drawn_by(f, &at))
                }
            }
        }
    }
}

fn decisions(f: &Figures<'_>, at: &str) -> Markup {
    let of = |row: usize, key: &str| f.text(&format!("{at}/rows/{row}/{key}"));
    html! {
        .verdicts {
            @for (decision, heading) in DECISIONS {
                @for row in (0..f.len(&format!("{at}/rows"))).filter(|&row| of(row, "decision") == decision) {
                    p class=(decision) {
                        b { (heading) }
                        " "
                        span {
                            b { (of(row, "label")) }
                            ": " (of(row, "why")) "."
                            @let flags = of(row, "flags");
                            @if !(flags.is_empty() || matches!(decision, "skip" | "impossible")) {
                                br;
                                code { (flags) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// How each picture is drawn and compared again.
fn drawn_by(f: &Figures<'_>, at: &str) -> Markup {
    html! {
        h3 { "To draw the pictures again, and compare them" }
        @for row in 0..f.len(&format!("{at}/rows")) {
            p { (f.text(&format!("{at}/rows/{row}/label"))) }
            (commands(f, &format!("{at}/rows/{row}/made_by")))
        }
    }
}

/// The row whose command is there to copy: all that was adopted together, or else the fastest.
fn best(f: &Figures<'_>, at: &str) -> Option<usize> {
    let of = |row: usize, key: &str| format!("{at}/rows/{row}/{key}");
    let adopted: Vec<usize> = (0..f.len(&format!("{at}/rows")))
        .filter(|&row| f.text(&of(row, "decision")) == "adopt")
        .collect();
    let ratio = |row: usize| f.number(&of(row, "ratio")).unwrap_or(0.0);
    let together = |row: &usize| f.text(&of(*row, "name")) == TOGETHER;
    let fastest = (adopted.iter().copied()).max_by(|&a, &b| ratio(a).total_cmp(&ratio(b)));
    adopted.iter().copied().find(together).or(fastest)
}

/// Why nothing is there to copy.
fn keep(f: &Figures<'_>, at: &str) -> &'static str {
    let mut rows = 0..f.len(&format!("{at}/rows"));
    if rows.any(|row| f.text(&format!("{at}/rows/{row}/decision")) == "faster-but-visible") {
        "Nothing that makes this scene faster comes near enough to the plain picture."
    } else {
        "Nothing made this scene measurably faster."
    }
}

/// The line to copy.
fn command(f: &Figures<'_>, at: &str) -> Markup {
    html! {
        @match best(f, at) {
            None => p { (keep(f, at)) " Keep the defaults." },
            Some(row) => {
                h3 { "To draw it so" }
                p.copy {
                    code { (f.text(&format!("{at}/rows/{row}/command"))) }
                    button type="button" { "Copy" }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_line_to_copy_is_of_all_together_or_of_the_fastest() {
        let row = |name: &str, decision: &str, ratio: f64| json!({ "name": name, "decision": decision, "ratio": ratio });
        let mut rows = vec![
            row("a", "adopt", 1.2),
            row("b", "adopt", 2.5),
            row("c", "faster-but-visible", 4.0),
            row("d", "adopt", 1.1),
            row(TOGETHER, "faster-but-visible", 3.0),
        ];
        let best_of = |rows: &[serde_json::Value]| best(&Figures(&json!({ "rows": rows })), "");
        assert_eq!(best_of(&rows), Some(1));
        rows[4]["decision"] = "adopt".into();
        rows[4]["ratio"] = 2.4.into();
        assert_eq!(best_of(&rows), Some(4));
        assert_eq!(best_of(&rows[2..3]), None);
        // What is there to see but not to adopt is not denied.
        let said = |rows: &[serde_json::Value]| {
            let report = json!({ "rows": rows });
            command(&Figures(&report), "").into_string()
        };
        assert!(said(&rows[2..3]).contains("near enough"));
        assert!(said(&[row("e", "skip", 1.0)]).contains("measurably faster"));
    }
}
