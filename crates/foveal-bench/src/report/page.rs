//! The page: one file, no network, made from the JSON alone.

use maud::{Markup, html};
use serde_json::Value;

use super::bench::{Bench, VERDICT};
use super::html::{self, Figures, SCRIPT};
use super::plan::BENCHES;
use super::tables::{commands, table};
use super::{plots, verdict};

/// Plots of a bench that stand beside what the original method publishes; more are folded.
const PLOTS_IN_SIGHT: usize = 2;

/// The whole page.
pub(super) fn of(report: &Value) -> String {
    let f = Figures(report);
    let body = html! {
        (head(&f))
        (verdict::show(&f))
        (navigation(&f))
        @for (index, bench) in BENCHES.iter().enumerate() {
            @if bench.name != VERDICT {
                (section(&f, index, bench))
            }
        }
    };
    html::page("Foveal report", "", &body, Some(SCRIPT))
}

fn head(f: &Figures<'_>) -> Markup {
    html! {
        h1 { "Foveal report" }
        p {
            "The scene " b { (f.text("/scene")) } " at " (f.figure("/width", 1.0, 0)) " x " (f.figure("/height", 1.0, 0))
            " pixels, measured in " (f.figure("/minutes", 1.0, 1)) " minutes."
        }
        p.faint {
            (f.text("/machine/processor")) ", " (f.figure("/machine/threads", 1.0, 0)) " threads, "
            (f.text("/machine/system")) "; " (f.text("/adapter/name")) " (" (f.text("/adapter/backend")) ", "
            (f.text("/adapter/driver")) "). Foveal " (f.text("/program_version"))
            ". In the sections after the verdict figures are medians of " (f.figure("/passes", 1.0, 0))
            " passes (one where the displays are compared); small figures are the passes' range. The sources' figures \
             come from other machines: compare ratios, not times."
        }
    }
}

fn navigation(f: &Figures<'_>) -> Markup {
    let is_measured = |index: usize| f.text(&format!("/benches/{index}/status")) == "measured";
    html! {
        nav {
            @for (index, bench) in BENCHES.iter().enumerate().skip(1) {
                a.off[!is_measured(index)] href={ "#" (bench.name) } { (bench.title) }
            }
        }
    }
}

fn section(f: &Figures<'_>, index: usize, bench: &Bench) -> Markup {
    let at = format!("/benches/{index}");
    let status = f.text(&format!("{at}/status"));
    let has_rows = f.len(&format!("{at}/rows")) > 0;
    let mut first = if has_rows {
        all_plots(f, &at, bench)
    } else {
        Vec::new()
    };
    let further = first.split_off(first.len().min(PLOTS_IN_SIGHT));
    html! {
        section id=(bench.name) {
            h2 { (f.text(&format!("{at}/title"))) }
            p { (f.text(&format!("{at}/about"))) }
            @if status != "measured" {
                p class=(if status == "skipped" { "faint" } else { "bad" }) {
                    (status) ": " (f.text(&format!("{at}/cause")))
                }
            }
            .columns {
                (published(f, &at))
                (titled(&first))
            }
            @if status != "skipped" {
                details {
                    summary { "Figures, pictures, commands" }
                    .columns { (titled(&further)) }
                    @if has_rows || f.len(&format!("{at}/pictures")) > 0 {
                        (table(f, &at, bench.columns))
                        (pictures(f, &at))
                    }
                    h3 { "To measure it again" }
                    (commands(f, &format!("{at}/commands")))
                }
            }
        }
    }
}

/// What a bench measured, as plots with their titles; those that say most come first.
fn all_plots(f: &Figures<'_>, at: &str, bench: &Bench) -> Vec<(String, Markup)> {
    let cost = if bench.name == "baseline" {
        Some(("The frame's timeline", plots::timeline(f, at)))
    } else {
        plots::cost(f, at, bench).map(|svg| ("Cost, ms", svg))
    };
    let load = plots::load(f, at, bench).map(|svg| ("Cost against load", svg));
    let of_cost = [cost, load].into_iter().flatten();
    let of_quality = plots::quality(f, at, bench).into_iter().map(|(part, svg)| {
        let comma = if part.is_empty() { "" } else { ", " };
        (format!("Quality against speed{comma}{part}"), svg)
    });
    of_cost
        .map(|(title, svg)| (title.to_owned(), svg))
        .chain(of_quality)
        .collect()
}

fn titled(plots: &[(String, Markup)]) -> Markup {
    html! {
        @for (title, svg) in plots {
            div { h3 { (title) } (svg) }
        }
    }
}

fn published(f: &Figures<'_>, at: &str) -> Markup {
    let columns = f.len(&format!("{at}/published/columns"));
    let cell = |row: usize, column: usize| {
        let pointer = format!("{at}/published/rows/{row}/{column}");
        let digits = match f.number(&pointer) {
            Some(number) if number.fract() == 0.0 => 0,
            Some(number) if (number * 10.0).fract().abs() < 1e-9 => 1,
            _ => 2,
        };
        f.figure(&pointer, 1.0, digits)
    };
    html! {
        @if columns > 0 {
            div {
                h3 { "What the original method publishes" }
                .scroll {
                    table {
                        tr {
                            @for column in 0..columns {
                                th { (f.text(&format!("{at}/published/columns/{column}"))) }
                            }
                        }
                        @for row in 0..f.len(&format!("{at}/published/rows")) {
                            tr {
                                @for column in 0..columns {
                                    td { (cell(row, column)) }
                                }
                            }
                        }
                    }
                }
                p.faint {
                    (f.text(&format!("{at}/published/source"))) "; " (f.text(&format!("{at}/published/machine")))
                }
            }
        }
    }
}

fn pictures(f: &Figures<'_>, at: &str) -> Markup {
    html! {
        @for index in 0..f.len(&format!("{at}/pictures")) {
            (picture(f, &format!("{at}/pictures/{index}")))
        }
    }
}

/// Before and after under a slider, and beside them their difference.
fn picture(f: &Figures<'_>, at: &str) -> Markup {
    let of = |key: &str| f.text(&format!("{at}/{key}"));
    html! {
        h3 { (of("title")) }
        .pair {
            figure {
                .compare {
                    img src=(of("before")) alt="before";
                    img.after src=(of("after")) alt="after";
                    .line {}
                    span.left { "before" }
                    span.right { "after" }
                }
                input type="range" min="0" max="100" value="50" aria-label="how much of each";
                figcaption {
                    "before " code { (of("before_flags")) }
                    br;
                    "after " code { (of("after_flags")) }
                }
            }
            figure {
                img.difference src=(of("difference")) alt="difference";
                figcaption {
                    "FLIP's error, black for none: mean " (f.figure(&format!("{at}/flip_mean"), 1.0, 4)) "; "
                    (f.figure(&format!("{at}/jod"), 1.0, 2)) " JOD"
                    br;
                    code { (of("compare")) }
                }
            }
        }
    }
}
