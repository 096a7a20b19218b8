//! What all plots share: sizes, colours, axes, ticks, lines with dots, error bars.

use maud::{Markup, html};

pub(crate) const WIDTH: f64 = 360.0;
pub(crate) const COLORS: [&str; 6] = [
    "#4e9ad9", "#e08e45", "#5fb87a", "#c96bb0", "#b59a2c", "#3fa7aa",
];

/// What tells the i-th of several lines: its colour, and what fills its dots. The second half's
/// dots are rings.
pub(crate) fn mark(i: usize) -> (&'static str, &'static str) {
    let color = COLORS[i % COLORS.len()];
    let is_ring = (i / COLORS.len()) % 2 == 1;
    (color, if is_ring { "var(--card)" } else { color })
}

/// Round numbers from 0 to at least `most`: 1, 2 or 5 times a power of ten apart, three to six of
/// them.
pub(crate) fn ticks(most: f64) -> Vec<f64> {
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
pub(crate) fn tick_text(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A coordinate as the markup has it: one decimal.
pub(crate) fn at(coordinate: f64) -> String {
    format!("{coordinate:.1}")
}

/// Where a value lies on an axis, from 0 at its low end to 1 at its high one.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Axis {
    /// Between two values.
    Linear(f64, f64),
    /// Between two values above 0, by their logarithms.
    Logarithmic(f64, f64),
}

impl Axis {
    /// Whole decades around the values; one decade where there are none.
    pub(crate) fn decades(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values
            .filter(|v| *v > 0.0 && v.is_finite())
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        if low > high {
            return Self::Logarithmic(1.0, 10.0);
        }
        let (low, high) = (low.floor(), high.ceil());
        Self::Logarithmic(10f64.powf(low), 10f64.powf(high.max(low + 1.0)))
    }

    /// 0 at the low end to 1 at the high one; beyond them for values beyond.
    pub(crate) fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear(low, high) => (value - low) / (high - low),
            Self::Logarithmic(low, high) => {
                (value.max(f64::MIN_POSITIVE) / low).ln() / (high / low).ln()
            }
        }
    }

    /// The powers of ten on it.
    pub(crate) fn powers_of_ten(self) -> Vec<f64> {
        let (Self::Linear(low, high) | Self::Logarithmic(low, high)) = self;
        let exponent = |value: f64| value.max(f64::MIN_POSITIVE).log10();
        let first = (exponent(low) - 1e-9).ceil() as i32;
        let last = (exponent(high) + 1e-9).floor() as i32;
        (first..=last).map(|e| 10f64.powi(e)).collect()
    }
}

/// A line through places, and a dot with its radius on each of them.
pub(crate) fn line(places: &[(f64, f64, f64)], color: &str, fill: &str) -> Markup {
    let mut path = String::new();
    for (i, (x, y, _)) in places.iter().enumerate() {
        let pen = if i == 0 { 'M' } else { 'L' };
        path += &format!("{pen}{x:.1} {y:.1}");
    }
    html! {
        path d=(path) fill="none" stroke=(color) stroke-width="2" {}
        @for (x, y, radius) in places {
            circle cx=(at(*x)) cy=(at(*y)) r=(radius) fill=(fill) stroke=(color) {}
        }
    }
}

/// The i-th line of a legend, below a height: a dot as on the line, and the line's name.
pub(crate) fn legend(i: usize, left: f64, below: f64, name: &Markup) -> Markup {
    let (color, fill) = mark(i);
    let base = below + i as f64 * 18.0;
    html! {
        circle cx=(left + 6.0) cy=(at(base - 4.0)) r="5" fill=(fill) stroke=(color) {}
        text x=(left + 18.0) y=(at(base)) { (name) }
    }
}

/// A line from the least to the most of the passes, along x.
pub(crate) fn error_bar(least: f64, most: f64, y: f64) -> Markup {
    let top = y - 3.0;
    let path = format!("M{least:.1} {top:.1}v6M{least:.1} {y:.1}H{most:.1}M{most:.1} {top:.1}v6");
    html! { path.error d=(path) fill="none" stroke="currentColor" {} }
}

/// As [`error_bar`], along y.
pub(crate) fn upright_error_bar(x: f64, least: f64, most: f64) -> Markup {
    let left = x - 3.0;
    let path = format!("M{left:.1} {least:.1}h6M{x:.1} {least:.1}V{most:.1}M{left:.1} {most:.1}h6");
    html! { path.error d=(path) fill="none" stroke="currentColor" {} }
}

/// A line across the plot for each tick, with its number to the left.
pub(crate) fn heights(ticks: &[f64], left: f64, right: f64, y: impl Fn(f64) -> f64) -> Markup {
    html! {
        @for &tick in ticks {
            path.grid d=(format!("M{left} {:.1}H{right}", y(tick))) {}
            text.faint.tick x=(at(left - 4.0)) y=(at(y(tick) + 4.0)) text-anchor="end" { (tick_text(tick)) }
        }
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

    #[test]
    fn axes_reach_from_0_to_1_over_whole_decades() {
        let axis = Axis::decades([0.02, 30.0].into_iter());
        assert_eq!(axis.powers_of_ten().len(), 5);
        assert!(axis.place(0.01).abs() < 1e-9 && (axis.place(100.0) - 1.0).abs() < 1e-9);
        assert!((axis.place(1.0) - 0.5).abs() < 1e-9);
        assert_eq!(Axis::Linear(2.0, 4.0).place(3.0), 0.5);
        // Equal values and none are a decade.
        for values in [vec![10.0], vec![]] {
            assert_eq!(Axis::decades(values.into_iter()).powers_of_ten().len(), 2);
        }
    }
}
