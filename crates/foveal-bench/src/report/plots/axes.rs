//! What the plots share: sizes, colours, ticks, error bars.

use std::fmt::Write;

pub(super) const WIDTH: f64 = 360.0;
pub(super) const COLORS: [&str; 6] = [
    "#4e9ad9", "#e08e45", "#5fb87a", "#c96bb0", "#b59a2c", "#3fa7aa",
];

/// What tells the i-th of several lines: its colour, and what fills its dots. The second half's dots are rings.
pub(super) fn mark(i: usize) -> (&'static str, &'static str) {
    let color = COLORS[i % COLORS.len()];
    let is_ring = (i / COLORS.len()) % 2 == 1;
    (color, if is_ring { "var(--card)" } else { color })
}

/// Round numbers from 0 to at least `most`: 1, 2 or 5 times a power of ten apart, three to six of them.
pub(super) fn ticks(most: f64) -> Vec<f64> {
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
pub(super) fn tick_text(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A line from the least to the most of the passes, along x.
pub(super) fn error_bar(svg: &mut String, least: f64, most: f64, y: f64) {
    let _ = write!(
        svg,
        "<path d=\"M{least:.1} {:.1}v6M{least:.1} {y:.1}H{most:.1}M{most:.1} {:.1}v6\" fill=\"none\" \
         stroke=\"currentColor\" class=\"error\"/>",
        y - 3.0,
        y - 3.0,
    );
}

/// As [`error_bar`], along y.
pub(super) fn upright_error_bar(svg: &mut String, x: f64, least: f64, most: f64) {
    let _ = write!(
        svg,
        "<path d=\"M{:.1} {least:.1}h6M{x:.1} {least:.1}V{most:.1}M{:.1} {most:.1}h6\" fill=\"none\" \
         stroke=\"currentColor\" class=\"error\"/>",
        x - 3.0,
        x - 3.0,
    );
}

/// A line across the plot for each tick, with its number to the left.
pub(super) fn heights(
    svg: &mut String,
    ticks: &[f64],
    left: f64,
    right: f64,
    y: impl Fn(f64) -> f64,
) {
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
