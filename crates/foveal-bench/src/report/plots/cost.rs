//! Each row's cost as a bar.

use std::fmt::Write;

use super::axes::{COLORS, WIDTH, error_bar, tick_text, ticks};
use crate::report::bench::Bench;
use crate::report::html::Figures;

/// More bars than these are not legible: other plots say it better, and the table has all rows.
const MOST_BARS: usize = 16;

/// A bar per row, where they are few, with the passes' range.
pub(crate) fn cost(f: &Figures<'_>, at: &str, bench: &Bench) -> Option<String> {
    let rows = f.len(&format!("{at}/rows"));
    if rows > MOST_BARS && (bench.quality.is_some() || bench.load.is_some()) {
        return None;
    }
    let rows = rows.min(MOST_BARS);
    let of = |row: usize, rest: &str| f.number(&format!("{at}/rows/{row}/{rest}"));
    let value = |row: usize| of(row, bench.cost);
    let end = |row: usize, i: usize| of(row, &format!("spread/{}/{i}", bench.cost));
    let most = (0..rows)
        .filter_map(|row| end(row, 1).or(value(row)))
        .fold(1e-9, f64::max);
    let ticks = ticks(most);
    let widest = ticks.last().copied().unwrap_or(most);
    let x = |ms: f64| ms / widest * (WIDTH - 64.0);
    let floor = rows as f64 * 34.0 + 2.0;
    let mut svg = format!(
        "<svg viewBox=\"-4 0 {} {}\" role=\"img\">",
        WIDTH + 4.0,
        floor + 24.0
    );
    for &tick in &ticks {
        let _ = write!(
            svg,
            "<path d=\"M{at_x:.1} 0V{floor:.1}\" class=\"grid\"/>\
             <text class=\"faint tick\" x=\"{at_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            floor + 15.0,
            tick_text(tick),
            at_x = x(tick),
        );
    }
    let _ = write!(
        svg,
        "<text class=\"faint\" x=\"{WIDTH}\" y=\"{:.1}\" text-anchor=\"end\">ms</text>",
        floor + 15.0
    );
    for row in 0..rows {
        let Some(ms) = value(row) else { continue };
        let y = row as f64 * 34.0;
        let width = x(ms).max(1.0);
        let color = COLORS[row % COLORS.len()];
        let _ = write!(
            svg,
            "<text class=\"faint\" x=\"0\" y=\"{:.1}\">{}</text>\
             <rect x=\"0\" y=\"{:.1}\" width=\"{width:.1}\" height=\"12\" rx=\"2\" fill=\"{color}\"/>",
            y + 12.0,
            f.text(&format!("{at}/rows/{row}/label")),
            y + 17.0,
        );
        let mut beside = width;
        if let (Some(least), Some(most)) = (end(row, 0), end(row, 1)) {
            error_bar(&mut svg, x(least), x(most), y + 23.0);
            beside = x(most);
        }
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            beside + 6.0,
            y + 27.0,
            f.svg_figure(&format!("{at}/rows/{row}/{}", bench.cost), 1.0, 2),
        );
    }
    svg.push_str("</svg>");
    Some(svg)
}
