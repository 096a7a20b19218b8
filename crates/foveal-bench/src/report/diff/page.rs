//! Two reports beside each other as one page, without network.

use std::fmt::Write;

use serde_json::Value;

use super::super::html::{STYLE, escaped};
use super::pairs::{Change, Pair};

/// The page.
pub(super) fn of(old: &Value, new: &Value, pairs: &[Pair]) -> String {
    let mut body = String::new();
    let text = |report: &Value, pointer: &str| {
        let text = report.pointer(pointer).and_then(Value::as_str);
        escaped(text.unwrap_or_default())
    };
    let _ = write!(
        body,
        "<h1>Two reports</h1>\n<p>The scene <b>{}</b> at {} x {} pixels. Ratios are the old time by the new one: above 1 it became \
         faster. A change is one of more than a twentieth whose passes do not overlap.</p>\n",
        text(new, "/scene"),
        new["width"],
        new["height"],
    );
    for (name, report) in [("Old", old), ("New", new)] {
        let _ = writeln!(
            body,
            "<p class=\"faint\">{name}: Foveal {}, {}, {}</p>",
            text(report, "/program_version"),
            text(report, "/machine/processor"),
            text(report, "/adapter/name"),
        );
    }
    let changed: Vec<&Pair> = pairs.iter().filter(|p| p.change != Change::Same).collect();
    body.push_str("<section>\n<h2>What changed</h2>\n");
    if changed.is_empty() {
        body.push_str("<p>No time changed beyond the noise.</p>\n");
    } else {
        table(&mut body, &changed);
    }
    body.push_str("</section>\n");
    let mut benches: Vec<&str> = pairs.iter().map(|pair| pair.bench.as_str()).collect();
    benches.dedup();
    for bench in benches {
        let own: Vec<&Pair> = pairs.iter().filter(|pair| pair.bench == bench).collect();
        let _ = writeln!(
            body,
            "<details><summary>{}: {} times</summary>",
            escaped(bench),
            own.len()
        );
        table(&mut body, &own);
        body.push_str("</details>\n");
    }
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Two Foveal reports</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n<style>{STYLE}\ntd.faster {{ color: var(--good); }} td.slower {{ color: var(--bad); }}\n\
         </style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}

fn table(body: &mut String, pairs: &[&Pair]) {
    body.push_str(
        "<div class=\"scroll\"><table><tr><th>row</th><th>figure</th><th>old ms</th><th>new ms</th><th>old / new</th><th></th></tr>\n",
    );
    for pair in pairs {
        let change = match pair.change {
            Change::Slower => "slower",
            Change::Faster => "faster",
            Change::Same => "no difference",
        };
        let _ = writeln!(
            body,
            "<tr><td>{}, {}</td><td>{}</td><td>{:.3}</td><td>{:.3}</td><td>{:.2}</td><td class=\"{change}\">{change}</td></tr>",
            escaped(&pair.bench),
            escaped(&pair.row),
            escaped(&pair.figure),
            pair.old_ms,
            pair.new_ms,
            pair.old_ms / pair.new_ms,
        );
    }
    body.push_str("</table></div>\n");
}
