//! Quality against speed: a dot per row, a curve where something grows along it.

use maud::{Markup, html};

use crate::report::bench::{Bench, Quality};
use crate::report::html::Figures;
use crate::svg::{self, WIDTH, at, heights, mark, tick_text, ticks};

const LEFT: f64 = 52.0;
const RIGHT: f64 = WIDTH - 24.0;
const TOP: f64 = 36.0;
const FLOOR: f64 = 220.0;
/// More curves than these cannot be told apart; the table has all rows.
const MOST_CURVES: usize = 12;

/// A row of the table.
struct Dot {
    x: f64,
    error: f64,
    /// What grows along the curve.
    along: f64,
}

struct Curve {
    /// What tells it from the others, and how the legend spells it.
    key: String,
    name: Markup,
    dots: Vec<Dot>,
}

/// The curves of rows whose `apart` is `part`, each in the order of what grows along it.
fn curves(f: &Figures<'_>, bench_at: &str, quality: &Quality, part: &str) -> Vec<Curve> {
    let mut all: Vec<Curve> = Vec::new();
    for row in 0..f.len(&format!("{bench_at}/rows")) {
        let of = |key: &str| format!("{bench_at}/rows/{row}/{key}");
        if quality.apart.is_some_and(|key| f.word(&of(key)) != part) {
            continue;
        }
        let (Some(x), Some(error)) = (f.number(&of(quality.x)), f.number(&of(quality.error.0)))
        else {
            continue;
        };
        let error = quality.best.map_or(error, |best| best - error);
        let along = quality.along.and_then(|(key, _)| f.number(&of(key)));
        let dot = Dot {
            x,
            error,
            along: along.unwrap_or_default(),
        };
        let words = quality.series.iter().map(|key| f.word(&of(key)));
        let key = words.collect::<Vec<_>>().join(", ");
        match all.iter_mut().find(|curve| curve.key == key) {
            Some(curve) if quality.along.is_some() => curve.dots.push(dot),
            _ => {
                let shown = |key: &str| match key {
                    "lights" => html! { (f.svg_figure(&of(key), 1.0, 0)) " lights" },
                    _ => html! { (f.text(&of(key))) },
                };
                let name = html! {
                    @for (i, key) in quality.series.iter().enumerate() {
                        @if i > 0 { ", " }
                        (shown(key))
                    }
                };
                all.push(Curve {
                    key,
                    name,
                    dots: vec![dot],
                });
            }
        }
    }
    for curve in &mut all {
        curve.dots.sort_by(|a, b| a.along.total_cmp(&b.along));
    }
    all.truncate(MOST_CURVES);
    all
}

/// A plot for each part of the rows, with the part's name.
pub(crate) fn quality(f: &Figures<'_>, bench_at: &str, bench: &Bench) -> Vec<(String, Markup)> {
    let Some(quality) = &bench.quality else {
        return Vec::new();
    };
    let mut parts: Vec<String> = Vec::new();
    for row in 0..f.len(&format!("{bench_at}/rows")) {
        let part = quality.apart.map_or(String::new(), |key| {
            f.word(&format!("{bench_at}/rows/{row}/{key}"))
        });
        if !parts.contains(&part) {
            parts.push(part);
        }
    }
    parts
        .into_iter()
        .filter_map(|part| {
            let curves = curves(f, bench_at, quality, &part);
            let svg = plot(quality, &curves)?;
            Some((part, svg))
        })
        .collect()
}

fn plot(quality: &Quality, curves: &[Curve]) -> Option<Markup> {
    let dots: Vec<&Dot> = curves.iter().flat_map(|curve| &curve.dots).collect();
    let most_x = dots.iter().map(|dot| dot.x).max_by(f64::total_cmp)?;
    let most_error = dots.iter().map(|dot| dot.error).max_by(f64::total_cmp)?;
    let (across, upward) = (ticks(most_x), ticks(most_error));
    let ends = [&across, &upward].map(|ticks| ticks.last().copied().unwrap_or(1.0));
    let x = |value: f64| LEFT + value / ends[0] * (RIGHT - LEFT - 8.0);
    let y = |error: f64| FLOOR - error / ends[1] * (FLOOR - TOP);

    let is_curve = curves.iter().any(|curve| curve.dots.len() > 1);
    let legend = FLOOR + if is_curve { 74.0 } else { 56.0 };
    let height = legend + curves.len() as f64 * 18.0;
    let drawn = |i: usize, curve: &Curve| {
        let (color, fill) = mark(i);
        let radius = |j: usize| if is_curve { 3.0 + 1.5 * j as f64 } else { 5.0 };
        let dots = curve.dots.iter().enumerate();
        let places: Vec<_> = dots
            .map(|(j, dot)| (x(dot.x), y(dot.error), radius(j)))
            .collect();
        html! {
            (svg::line(&places, color, fill))
            (svg::legend(i, LEFT, legend, &curve.name))
        }
    };
    Some(html! {
        svg viewBox=(format!("0 0 {WIDTH} {height}")) role="img" {
            path d=(format!("M{LEFT} 10V{FLOOR}H{RIGHT}")) fill="none" stroke="currentColor" opacity="0.5" {}
            text.faint x=(RIGHT) y=(FLOOR + 34.0) text-anchor="end" { (quality.axis) }
            text.faint x=(LEFT + 6.0) y="18" { (quality.error.1) }
            (heights(&upward, LEFT, RIGHT, y))
            @for tick in across {
                path d=(format!("M{:.1} {FLOOR}v4", x(tick))) stroke="currentColor" opacity="0.5" {}
                text.faint.tick x=(at(x(tick))) y=(FLOOR + 17.0) text-anchor="middle" { (tick_text(tick)) }
            }
            @if let (Some((_, title)), true) = (quality.along, is_curve) {
                text.faint x=(RIGHT) y=(FLOOR + 52.0) text-anchor="end" { "larger dots: " (title) }
            }
            @for (i, curve) in curves.iter().enumerate() {
                (drawn(i, curve))
            }
        }
    })
}
