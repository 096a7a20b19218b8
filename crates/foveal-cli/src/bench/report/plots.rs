//! Plots as inline SVG. Their figures are the JSON's; ticks stand where rows are.

mod load;
mod quality;
mod timeline;

use std::fmt::Write;

pub(super) use load::load;
pub(super) use quality::quality;
pub(super) use timeline::timeline;

use super::html::Figures;
use super::plan::Bench;

const WIDTH: f64 = 360.0;
const COLORS: [&str; 6] = [
    "#4e9ad9", "#e08e45", "#5fb87a", "#c96bb0", "#b59a2c", "#3fa7aa",
];

/// What tells the i-th of several lines: its colour, and what fills its dots. The second half's dots are rings.
fn mark(i: usize) -> (&'static str, &'static str) {
    let color = COLORS[i % COLORS.len()];
    let is_ring = (i / COLORS.len()) % 2 == 1;
    (color, if is_ring { "var(--card)" } else { color })
}

/// More bars than these are not legible: other plots say it better, and the table has all rows.
const MOST_BARS: usize = 16;

/// A bar per row, where they are few.
pub(super) fn cost(f: &Figures<'_>, at: &str, bench: &Bench) -> Option<String> {
    let rows = f.len(&format!("{at}/rows"));
    if rows > MOST_BARS && (bench.quality.is_some() || bench.load.is_some()) {
        return None;
    }
    let rows = rows.min(MOST_BARS);
    let value = |row: usize| f.number(&format!("{at}/rows/{row}/{}", bench.cost));
    let most = (0..rows).filter_map(value).fold(1e-9, f64::max);
    let height = rows as f64 * 34.0 + 4.0;
    let mut svg = format!("<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\">");
    for row in 0..rows {
        let Some(ms) = value(row) else { continue };
        let y = row as f64 * 34.0;
        let width = (ms / most * (WIDTH - 80.0)).max(1.0);
        let color = COLORS[row % COLORS.len()];
        let _ = write!(
            svg,
            "<text class=\"faint\" x=\"0\" y=\"{:.1}\">{}</text>\
             <rect x=\"0\" y=\"{:.1}\" width=\"{width:.1}\" height=\"12\" rx=\"2\" fill=\"{color}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            y + 12.0,
            f.text(&format!("{at}/rows/{row}/label")),
            y + 17.0,
            width + 6.0,
            y + 27.0,
            f.svg_figure(&format!("{at}/rows/{row}/{}", bench.cost), 1.0, 2),
        );
    }
    svg.push_str("</svg>");
    Some(svg)
}
