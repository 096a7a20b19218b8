//! The page: one file, no network, made from the JSON alone.

use std::fmt::Write;

use super::bench::{Bench, VERDICT};
use super::html::{Figures, SCRIPT, STYLE};
use super::plan::BENCHES;
use super::tables::{commands, table};
use super::{plots, verdict};
use serde_json::Value;

/// The whole page.
pub(super) fn of(report: &Value) -> String {
    let f = Figures(report);
    let mut body = String::new();
    head(&mut body, &f);
    verdict::show(&mut body, &f);
    navigation(&mut body, &f);
    for (index, bench) in BENCHES.iter().enumerate() {
        if bench.name == VERDICT {
            continue;
        }
        section(&mut body, &f, index, bench);
    }
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Foveal report</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n<style>{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n\
         <script>{SCRIPT}</script>\n</body>\n</html>\n"
    )
}

fn head(body: &mut String, f: &Figures<'_>) {
    let _ = write!(
        body,
        "<h1>Foveal report</h1>\n<p>The scene <b>{}</b> at {} x {} pixels, measured in {} minutes.</p>\n",
        f.text("/scene"),
        f.figure("/width", 1.0, 0),
        f.figure("/height", 1.0, 0),
        f.figure("/minutes", 1.0, 1),
    );
    let _ = writeln!(
        body,
        "<p class=\"faint\">{}, {} threads, {}; {} ({}, {}). Foveal {}. In the sections after \
         the verdict figures are medians of {} passes; small figures are the passes' range. The sources' \
         figures come from other machines: compare ratios, not times.</p>",
        f.text("/machine/processor"),
        f.figure("/machine/threads", 1.0, 0),
        f.text("/machine/system"),
        f.text("/adapter/name"),
        f.text("/adapter/backend"),
        f.text("/adapter/driver"),
        f.text("/program_version"),
        f.figure("/passes", 1.0, 0),
    );
}

fn navigation(body: &mut String, f: &Figures<'_>) {
    body.push_str("<nav>");
    for (index, bench) in BENCHES.iter().enumerate().skip(1) {
        let measured = f.text(&format!("/benches/{index}/status")) == "measured";
        let class = if measured { "" } else { " class=\"off\"" };
        let _ = write!(
            body,
            "<a href=\"#{}\"{class}>{}</a>",
            bench.name, bench.title
        );
    }
    body.push_str("</nav>\n");
}

fn section(body: &mut String, f: &Figures<'_>, index: usize, bench: &Bench) {
    let at = format!("/benches/{index}");
    let _ = write!(
        body,
        "<section id=\"{}\">\n<h2>{}</h2>\n<p>{}</p>\n",
        bench.name,
        f.text(&format!("{at}/title")),
        f.text(&format!("{at}/about")),
    );
    let status = f.text(&format!("{at}/status"));
    if status != "measured" {
        let _ = writeln!(
            body,
            "<p class=\"{}\">{status}: {}</p>",
            if status == "skipped" { "faint" } else { "bad" },
            f.text(&format!("{at}/cause"))
        );
    }
    body.push_str("<div class=\"columns\">\n");
    published(body, f, &at);
    if f.len(&format!("{at}/rows")) > 0 {
        let mut plot = |title: &str, svg: Option<String>| {
            if let Some(svg) = svg {
                let _ = writeln!(body, "<div><h3>{title}</h3>{svg}</div>");
            }
        };
        if bench.name == "baseline" {
            plot("The frame's timeline", Some(plots::timeline(f, &at)));
        } else {
            plot("Cost, ms", plots::cost(f, &at, bench));
        }
        plot("Cost against load", plots::load(f, &at, bench));
        for (part, svg) in plots::quality(f, &at, bench) {
            let comma = if part.is_empty() { "" } else { ", " };
            plot(&format!("Quality against speed{comma}{part}"), Some(svg));
        }
    }
    body.push_str("</div>\n");
    if f.len(&format!("{at}/rows")) + f.len(&format!("{at}/pictures")) > 0 {
        body.push_str("<details><summary>Figures and pictures</summary>\n");
        table(body, f, &at, bench.columns);
        pictures(body, f, &at);
        body.push_str("</details>\n");
    }
    if status != "skipped" {
        body.push_str("<h3>To measure it again</h3>\n<p>");
        commands(body, f, &at);
        body.push_str("</p>\n");
    }
    body.push_str("</section>\n");
}

fn published(body: &mut String, f: &Figures<'_>, at: &str) {
    let columns = f.len(&format!("{at}/published/columns"));
    if columns == 0 {
        return;
    }
    body.push_str("<div><h3>What the source publishes</h3>\n<div class=\"scroll\"><table><tr>");
    for column in 0..columns {
        let title = f.text(&format!("{at}/published/columns/{column}"));
        let _ = write!(body, "<th>{title}</th>");
    }
    body.push_str("</tr>");
    for row in 0..f.len(&format!("{at}/published/rows")) {
        body.push_str("<tr>");
        for column in 0..columns {
            let pointer = format!("{at}/published/rows/{row}/{column}");
            let digits = match f.number(&pointer) {
                Some(number) if number.fract() == 0.0 => 0,
                Some(number) if (number * 10.0).fract().abs() < 1e-9 => 1,
                _ => 2,
            };
            let _ = write!(body, "<td>{}</td>", f.figure(&pointer, 1.0, digits));
        }
        body.push_str("</tr>");
    }
    let _ = write!(
        body,
        "</table></div>\n<p class=\"faint\">{}; {}</p></div>\n",
        f.text(&format!("{at}/published/source")),
        f.text(&format!("{at}/published/machine")),
    );
}

fn pictures(body: &mut String, f: &Figures<'_>, at: &str) {
    for index in 0..f.len(&format!("{at}/pictures")) {
        let at = format!("{at}/pictures/{index}");
        let (before, after) = (
            f.text(&format!("{at}/before_flags")),
            f.text(&format!("{at}/after_flags")),
        );
        let _ = write!(
            body,
            "<h3>{}</h3>\n<div class=\"columns\"><figure><div class=\"compare\">\
             <img src=\"{}\" alt=\"before\"><img class=\"after\" src=\"{}\" alt=\"after\"><div class=\"line\"></div>\
             <span class=\"left\">before</span><span class=\"right\">after</span></div>\
             <input type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"how much of each\">\
             <figcaption>before <code>{before}</code><br>after <code>{after}</code></figcaption></figure>\n\
             <figure><img class=\"difference\" src=\"{}\" alt=\"difference\">\
             <figcaption>FLIP's error, black for none: mean {}; {} JOD<br><code>{}</code></figcaption></figure></div>\n",
            f.text(&format!("{at}/title")),
            f.text(&format!("{at}/before")),
            f.text(&format!("{at}/after")),
            f.text(&format!("{at}/difference")),
            f.figure(&format!("{at}/flip_mean"), 1.0, 4),
            f.figure(&format!("{at}/jod"), 1.0, 2),
            f.text(&format!("{at}/compare")),
        );
    }
}
