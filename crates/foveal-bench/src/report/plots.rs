//! Plots as inline SVG. Their figures are the JSON's; ticks of an axis stand at round numbers and are marked as such.

mod load;
mod quality;
mod ratios;
mod timeline;

use std::fmt::Write;

pub(super) use load::load;
pub(super) use quality::quality;
pub(super) use ratios::ratios;
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

/// Round numbers from 0 to at least `most`: 1, 2 or 5 times a power of ten apart, three to six of them.
fn ticks(most: f64) -> Vec<f64> {
    let rough = most.max(1e-9) / 4.0;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * power);
    let step = step
        .into_iter()
        .find(|&s| s >= rough)
        .unwrap_or(10.0 * power);
    (0..=(most / step).ceil() as usize)
        .map(|i| i as f64 * step)
        .collect()
}

/// A tick's number, with as many decimals as it needs.
fn tick_text(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A line from the least to the most of the passes, along x.
fn error_bar(svg: &mut String, least: f64, most: f64, y: f64) {
    let _ = write!(
        svg,
        "<path d=\"M{least:.1} {:.1}v6M{least:.1} {y:.1}H{most:.1}M{most:.1} {:.1}v6\" fill=\"none\" \
         stroke=\"currentColor\" class=\"error\"/>",
        y - 3.0,
        y - 3.0,
    );
}

/// As [`error_bar`], along y.
fn upright_error_bar(svg: &mut String, x: f64, least: f64, most: f64) {
    let _ = write!(
        svg,
        "<path d=\"M{:.1} {least:.1}h6M{x:.1} {least:.1}V{most:.1}M{:.1} {most:.1}h6\" fill=\"none\" \
         stroke=\"currentColor\" class=\"error\"/>",
        x - 3.0,
        x - 3.0,
    );
}

/// A line across the plot for each tick, with its number to the left.
fn heights(svg: &mut String, ticks: &[f64], left: f64, right: f64, y: impl Fn(f64) -> f64) {
    for &tick in ticks {
        let at_y = y(tick);
        let _ = write!(
            svg,
            "<path d=\"M{left} {at_y:.1}H{right}\" class=\"grid\"/>\
             <text class=\"faint tick\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            left - 4.0,
            at_y + 4.0,
            tick_text(tick),
        );
    }
}

/// A bar per row, where they are few, with the passes' range.
pub(super) fn cost(f: &Figures<'_>, at: &str, bench: &Bench) -> Option<String> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_few_and_reach_the_largest() {
        for most in [0.003, 0.9, 1.0, 7.0, 59.6, 1234.0] {
            let ticks = ticks(most);
            assert!((3..=6).contains(&ticks.len()), "{ticks:?}");
            assert!(*ticks.last().unwrap() >= most * 0.999, "{ticks:?}");
        }
        assert_eq!(ticks(59.6), [0.0, 20.0, 40.0, 60.0]);
        assert_eq!(
            (tick_text(0.25), tick_text(40.0)),
            ("0.25".to_owned(), "40".to_owned())
        );
    }
}
