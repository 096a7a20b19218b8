//! Each row's cost as a bar.

use maud::{Markup, html};

use crate::report::bench::Bench;
use crate::report::html::Figures;
use crate::svg::{COLORS, WIDTH, at, error_bar, tick_text, ticks};

/// More bars than these are not legible: other plots say it better, and the table has all rows.
const MOST_BARS: usize = 16;

/// Characters of a label that surely fit the plot's width.
const MOST_CHARACTERS: usize = 54;

/// The label, without its middle where it is too long.
fn fitting(label: &str) -> String {
    let count = label.chars().count();
    if count <= MOST_CHARACTERS {
        return label.to_owned();
    }
    let half = (MOST_CHARACTERS - 1) / 2;
    let ends = label.chars().take(half);
    let end = label.chars().skip(count - half);
    ends.chain(['\u{2026}']).chain(end).collect()
}

/// A bar per row, where they are few, with the passes' range.
pub(crate) fn cost(f: &Figures<'_>, bench_at: &str, bench: &Bench) -> Option<Markup> {
    let rows = f.len(&format!("{bench_at}/rows"));
    if rows > MOST_BARS && (bench.quality.is_some() || bench.load.is_some()) {
        return None;
    }
    let rows = rows.min(MOST_BARS);
    let of = |row: usize, rest: &str| f.number(&format!("{bench_at}/rows/{row}/{rest}"));
    let value = |row: usize| of(row, bench.cost);
    let end = |row: usize, i: usize| of(row, &format!("spread/{}/{i}", bench.cost));
    let most = (0..rows)
        .filter_map(|row| end(row, 1).or(value(row)))
        .fold(1e-9, f64::max);
    let ticks = ticks(most);
    let widest = ticks.last().copied().unwrap_or(most);
    let x = |ms: f64| ms / widest * (WIDTH - 64.0);
    let floor = rows as f64 * 34.0 + 2.0;
    let bar = |row: usize, ms: f64| {
        let y = row as f64 * 34.0;
        let width = x(ms).max(1.0);
        let range = end(row, 0).zip(end(row, 1));
        let beside = range.map_or(width, |(_, most)| x(most));
        html! {
            text.faint x="0" y=(at(y + 12.0)) { (fitting(f.text(&format!("{bench_at}/rows/{row}/label")))) }
            rect x="0" y=(at(y + 17.0)) width=(at(width)) height="12" rx="2" fill=(COLORS[row % COLORS.len()]) {}
            @if let Some((least, most)) = range {
                (error_bar(x(least), x(most), y + 23.0))
            }
            text x=(at(beside + 6.0)) y=(at(y + 27.0)) {
                (f.svg_figure(&format!("{bench_at}/rows/{row}/{}", bench.cost), 1.0, 2))
            }
        }
    };
    Some(html! {
        svg viewBox=(format!("-4 0 {} {}", WIDTH + 4.0, floor + 24.0)) role="img" {
            @for tick in ticks {
                path.grid d=(format!("M{:.1} 0V{floor:.1}", x(tick))) {}
                text.faint.tick x=(at(x(tick))) y=(at(floor + 15.0)) text-anchor="middle" { (tick_text(tick)) }
            }
            text.faint x=(WIDTH) y=(at(floor + 15.0)) text-anchor="end" { "ms" }
            @for row in 0..rows {
                @if let Some(ms) = value(row) {
                    (bar(row, ms))
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_that_is_too_long_keeps_its_ends() {
        assert_eq!(fitting("smooth, compute"), "smooth, compute");
        let long = fitting(&format!("a scene {} frame, mono", "\u{e9}".repeat(90)));
        assert_eq!(long.chars().count(), MOST_CHARACTERS - 1);
        assert!(long.starts_with("a scene ") && long.ends_with(" frame, mono"));
    }
}
