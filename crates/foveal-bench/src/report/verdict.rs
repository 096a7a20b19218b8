//! The first page: what to adopt for this scene on this machine, what not, and why.

use std::fmt::Write;

use super::bench::VERDICT;
use super::html::Figures;
use super::plan::BENCHES;
use super::plots;
use super::tables::{commands, table};

/// Decisions in the order in which the page tells them, and their headings.
const DECISIONS: [(&str, &str); 5] = [
    ("adopt", "Adopt"),
    ("look", "Look first"),
    ("pay", "Pay for"),
    ("skip", "Skip"),
    ("impossible", "Not here"),
];

/// The verdict, before all sections.
pub(super) fn show(body: &mut String, f: &Figures<'_>) {
    let Some(index) = BENCHES.iter().position(|bench| bench.name == VERDICT) else {
        return;
    };
    let (bench, at) = (&BENCHES[index], format!("/benches/{index}"));
    let _ = write!(
        body,
        "<section id=\"{VERDICT}\">\n<h2>For this scene, on this machine</h2>\n"
    );
    let status = f.text(&format!("{at}/status"));
    if status != "measured" {
        let cause = f.text(&format!("{at}/cause"));
        let _ = writeln!(
            body,
            "<p class=\"bad\">No verdict. {status}: {cause}</p></section>"
        );
        return;
    }
    let rows = f.len(&format!("{at}/rows"));
    body.push_str("<div class=\"verdicts\">\n");
    for (decision, heading) in DECISIONS {
        for row in 0..rows {
            let of = |key: &str| f.text(&format!("{at}/rows/{row}/{key}"));
            if of("decision") != decision {
                continue;
            }
            let flags = match of("flags") {
                flags if flags.is_empty() || matches!(decision, "skip" | "impossible") => {
                    String::new()
                }
                flags => format!("<br><code>{flags}</code>"),
            };
            let _ = writeln!(
                body,
                "<p class=\"{decision}\"><b>{heading}</b> <span><b>{}</b>: {}.{flags}</span></p>",
                of("label"),
                of("why"),
            );
        }
    }
    body.push_str("</div>\n");
    command(body, f, &at, rows);
    if let Some(svg) = plots::ratios(f, &at) {
        let _ = writeln!(
            body,
            "<h3>Plain frame / this, with the interval of each</h3>\n{svg}"
        );
    }
    let _ = write!(
        body,
        "<p class=\"faint\">The ratio is the plain frame's time by the other's: above one is faster. The interval holds the \
         true ratio in all but two of a thousand cases; where it comes within two percent of one there is no difference.</p>\n\
         <details><summary>Figures</summary>\n",
    );
    table(body, f, &at, bench.columns);
    body.push_str("<h3>To measure it again</h3>\n<p>");
    commands(body, f, &at);
    body.push_str("</p>\n");
    drawn_by(body, f, &at, rows);
    body.push_str("</details>\n</section>\n");
}

/// How each picture is drawn and compared again.
fn drawn_by(body: &mut String, f: &Figures<'_>, at: &str, rows: usize) {
    body.push_str("<h3>To draw the pictures again, and compare them</h3>\n");
    for row in 0..rows {
        let at = format!("{at}/rows/{row}");
        let label = f.text(&format!("{at}/label"));
        let _ = write!(body, "<p>{label}<br>");
        for index in 0..f.len(&format!("{at}/made_by")) {
            let command = f.text(&format!("{at}/made_by/{index}"));
            let _ = write!(body, "<code>{command}</code><br>");
        }
        body.push_str("</p>\n");
    }
}

/// The line to copy: of what was adopted together, or alone.
fn command(body: &mut String, f: &Figures<'_>, at: &str, rows: usize) {
    let is_adopted = |row: &usize| f.text(&format!("{at}/rows/{row}/decision")) == "adopt";
    // What is put together comes last.
    let Some(row) = (0..rows).rev().find(is_adopted) else {
        body.push_str("<p>Nothing made this scene measurably faster: keep the defaults.</p>\n");
        return;
    };
    let _ = writeln!(
        body,
        "<h3>To draw it so</h3>\n<p class=\"copy\"><code>{}</code><button type=\"button\">Copy</button></p>",
        f.text(&format!("{at}/rows/{row}/command"))
    );
}
