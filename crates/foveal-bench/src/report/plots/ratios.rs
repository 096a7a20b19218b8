//! Ratios with their intervals, one line each, on a logarithmic axis around 1.

use maud::{Markup, html};

use crate::report::html::Figures;
use crate::svg::{WIDTH, at, error_bar, tick_text};

const LINE: f64 = 34.0;
/// Where the axis may end, on either side.
const ENDS: [f64; 7] = [1.5, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];

/// The plot; `None` where no row has an interval.
pub(crate) fn ratios(f: &Figures<'_>, bench_at: &str) -> Option<Markup> {
    let rows = f.len(&format!("{bench_at}/rows"));
    let of = |row: usize, key: &str| f.number(&format!("{bench_at}/rows/{row}/{key}"));
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
    let steps = match end {
        1.5 => vec![1.0 / 1.5, 1.0 / 1.2, 1.0, 1.2, 1.5],
        2.0 => vec![0.5, 1.0 / 1.4, 1.0, 1.4, 2.0],
        end => vec![1.0 / end, 0.5, 1.0, 2.0, end],
    };
    let interval = |line: usize, row: usize, [low, ratio, high]: [f64; 3]| {
        let y = line as f64 * LINE;
        html! {
            text.faint x="0" y=(at(y + 12.0)) { (f.text(&format!("{bench_at}/rows/{row}/label"))) }
            g class=(f.text(&format!("{bench_at}/rows/{row}/finding"))) {
                (error_bar(x(low), x(high), y + 23.0))
                circle cx=(at(x(ratio))) cy=(at(y + 23.0)) r="4" fill="currentColor" {}
            }
        }
    };
    Some(html! {
        svg viewBox=(format!("0 0 {WIDTH} {}", floor + 36.0)) role="img" {
            @for tick in steps {
                path class=(if tick == 1.0 { "one" } else { "grid" }) d=(format!("M{:.1} 0V{floor:.1}", x(tick))) {}
                text.faint.tick x=(at(x(tick))) y=(at(floor + 15.0)) text-anchor="middle" {
                    (tick_text((tick * 100.0).round() / 100.0))
                }
            }
            text.faint x="0" y=(at(floor + 31.0)) { "slower" }
            text.faint x=(WIDTH) y=(at(floor + 31.0)) text-anchor="end" { "faster, times" }
            @for (line, (row, ends)) in shown.into_iter().enumerate() {
                (interval(line, row, ends))
            }
        }
    })
}
