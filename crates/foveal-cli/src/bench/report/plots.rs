//! Plots as inline SVG. Their figures are the JSON's; axes say where better is instead of inventing ticks.

mod load;
mod timeline;

use std::fmt::Write;

pub(super) use load::load;
pub(super) use timeline::timeline;

use super::html::Figures;
use super::plan::Bench;

const WIDTH: f64 = 360.0;
const COLORS: [&str; 6] = [
    "#4e9ad9", "#e08e45", "#5fb87a", "#c96bb0", "#b59a2c", "#3fa7aa",
];
/// More bars than these are not legible; the table has all rows.
const MOST_BARS: usize = 16;

/// A bar per row.
pub(super) fn cost(f: &Figures<'_>, at: &str, bench: &Bench) -> String {
    let rows = f.len(&format!("{at}/rows")).min(MOST_BARS);
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
    svg
}

/// A dot per row: cost to the right, error upwards.
pub(super) fn quality(f: &Figures<'_>, at: &str, bench: &Bench) -> Option<String> {
    let (cost, error) = bench.quality?;
    let number = |row: usize, key: &str| f.number(&format!("{at}/rows/{row}/{key}"));
    let points: Vec<(usize, f64, f64)> = (0..f.len(&format!("{at}/rows")))
        .filter_map(|row| Some((row, number(row, cost)?, number(row, error)?)))
        .collect();
    let largest = |of: fn(&(usize, f64, f64)) -> f64| points.iter().map(of).fold(1e-9, f64::max);
    let (right, top) = (largest(|p| p.1), largest(|p| p.2));
    let plot = 220.0;
    let height = plot + 46.0 + points.len() as f64 * 18.0;
    let mut svg = format!("<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\">");
    let _ = write!(
        svg,
        "<path d=\"M30 10V{plot}H{}\" fill=\"none\" stroke=\"currentColor\" opacity=\"0.5\"/>\
         <text class=\"faint\" x=\"{}\" y=\"{}\" text-anchor=\"end\">cost, ms: left is better</text>\
         <text class=\"faint\" x=\"36\" y=\"18\">FLIP error: low is better</text>",
        WIDTH - 10.0,
        WIDTH - 10.0,
        plot + 16.0,
    );
    for (i, &(row, ms, flip)) in points.iter().enumerate() {
        let color = COLORS[i % COLORS.len()];
        let x = 30.0 + ms / right * (WIDTH - 60.0);
        let y = plot - flip / top * (plot - 40.0);
        let line = plot + 40.0 + i as f64 * 18.0;
        let _ = write!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" fill=\"{color}\"/>\
             <circle cx=\"36\" cy=\"{:.1}\" r=\"5\" fill=\"{color}\"/><text x=\"48\" y=\"{line:.1}\">{}: {} ms, {}</text>",
            line - 4.0,
            f.text(&format!("{at}/rows/{row}/label")),
            f.svg_figure(&format!("{at}/rows/{row}/{cost}"), 1.0, 1),
            f.svg_figure(&format!("{at}/rows/{row}/{error}"), 1.0, 4),
        );
    }
    svg.push_str("</svg>");
    Some(svg)
}
