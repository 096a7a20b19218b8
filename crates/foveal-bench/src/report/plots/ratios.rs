//! Ratios with their intervals, one line each, on a logarithmic axis around 1.

use std::fmt::Write;

use super::axes::{WIDTH, error_bar, tick_text};
use crate::report::html::Figures;

const LINE: f64 = 34.0;
/// Where the axis may end, on either side.
const ENDS: [f64; 7] = [1.5, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];

/// The plot; `None` where no row has an interval.
pub(crate) fn ratios(f: &Figures<'_>, at: &str) -> Option<String> {
    let rows = f.len(&format!("{at}/rows"));
    let of = |row: usize, key: &str| f.number(&format!("{at}/rows/{row}/{key}"));
    let shown: Vec<(usize, [f64; 3])> = (0..rows)
        .filter_map(|row| Some((row, [of(row, "low")?, of(row, "ratio")?, of(row, "high")?])))
        .collect();
    let farthest = shown
        .iter()
        .flat_map(|(_, r)| r)
        .map(|r| r.ln().abs())
        .fold(0.0, f64::max);
    if shown.is_empty() {
        return None;
    }
    let end = ENDS.into_iter().find(|end| end.ln() >= farthest);
    let end = end.unwrap_or(64.0);
    let x = |ratio: f64| {
        let along = ratio.ln().clamp(-end.ln(), end.ln()) / end.ln();
        WIDTH / 2.0 + along * (WIDTH / 2.0 - 24.0)
    };
    let floor = shown.len() as f64 * LINE + 2.0;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {}\" role=\"img\">",
        floor + 36.0
    );
    let steps = match end {
        1.5 => vec![1.0 / 1.5, 1.0 / 1.2, 1.0, 1.2, 1.5],
        2.0 => vec![0.5, 1.0 / 1.4, 1.0, 1.4, 2.0],
        end => vec![1.0 / end, 0.5, 1.0, 2.0, end],
    };
    for tick in steps {
        let _ = write!(
            svg,
            "<path d=\"M{at_x:.1} 0V{floor:.1}\" class=\"{}\"/>\
             <text class=\"faint tick\" x=\"{at_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            if tick == 1.0 { "one" } else { "grid" },
            floor + 15.0,
            tick_text((tick * 100.0).round() / 100.0),
            at_x = x(tick),
        );
    }
    let _ = write!(
        svg,
        "<text class=\"faint\" x=\"0\" y=\"{y:.1}\">slower</text>\
         <text class=\"faint\" x=\"{WIDTH}\" y=\"{y:.1}\" text-anchor=\"end\">faster, times</text>",
        y = floor + 31.0
    );
    for (line, (row, [low, ratio, high])) in shown.into_iter().enumerate() {
        let y = line as f64 * LINE;
        let class = f.text(&format!("{at}/rows/{row}/finding"));
        let _ = write!(
            svg,
            "<text class=\"faint\" x=\"0\" y=\"{:.1}\">{}</text><g class=\"{class}\">",
            y + 12.0,
            f.text(&format!("{at}/rows/{row}/label")),
        );
        error_bar(&mut svg, x(low), x(high), y + 23.0);
        let _ = write!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"4\" fill=\"currentColor\"/></g>",
            x(ratio),
            y + 23.0
        );
    }
    svg.push_str("</svg>");
    Some(svg)
}
