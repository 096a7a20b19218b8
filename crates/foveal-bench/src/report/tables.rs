//! A bench's figures and its commands, as the verdict and the sections show them.

use std::fmt::Write;

use super::bench::Column;
use super::html::Figures;

/// The bench's commands, one a line.
pub(super) fn commands(body: &mut String, f: &Figures<'_>, at: &str) {
    for index in 0..f.len(&format!("{at}/commands")) {
        let command = f.text(&format!("{at}/commands/{index}"));
        let _ = write!(body, "<code>{command}</code><br>");
    }
}

/// The rows as a table: medians, and under them the passes' range where they differ.
pub(super) fn table(body: &mut String, f: &Figures<'_>, at: &str, columns: &[Column]) {
    let rows = f.len(&format!("{at}/rows"));
    if rows == 0 {
        return;
    }
    body.push_str("<h3>Ours, here</h3>\n<div class=\"scroll\"><table><tr><th></th>");
    for column in columns {
        let _ = write!(body, "<th>{}</th>", column.title);
    }
    body.push_str("</tr>");
    for row in 0..rows {
        let label = f.text(&format!("{at}/rows/{row}/label"));
        let _ = write!(body, "<tr><td>{label}</td>");
        for column in columns {
            let pointer = format!("{at}/rows/{row}/{}", column.key);
            let figure = f.figure(&pointer, column.factor, column.digits);
            let end = |i: usize| {
                let pointer = format!("{at}/rows/{row}/spread/{}/{i}", column.key);
                f.number(&pointer)?;
                Some(f.figure(&pointer, column.factor, column.digits))
            };
            let range = match (end(0), end(1)) {
                (Some(least), Some(most)) => {
                    format!("<br><small>{least} &ndash; {most}</small>")
                }
                _ => String::new(),
            };
            let _ = write!(body, "<td>{figure}{range}</td>");
        }
        body.push_str("</tr>");
    }
    body.push_str("</table></div>\n");
}
