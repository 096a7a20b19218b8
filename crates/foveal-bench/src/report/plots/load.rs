//! Cost against load: a line per series, from the least load to the most.

use maud::{Markup, html};

use crate::report::bench::{Bench, Load};
use crate::report::html::Figures;
use crate::svg::{self, Axis, WIDTH, at, heights, legend, mark, ticks, upright_error_bar};

/// From this ratio of the largest load to the least, the axis is logarithmic.
const LOGARITHMIC_FROM: f64 = 12.0;
/// Loads closer than this on the axis share a figure.
const LEAST_GAP: f64 = 40.0;
const LEFT: f64 = 34.0;
const FLOOR: f64 = 220.0;

/// A row of the table as a dot.
struct Dot {
    row: usize,
    load: f64,
    cost: f64,
}

/// Dots that a line joins.
struct Line {
    /// What of the row costs this.
    cost: &'static str,
    name: String,
    dots: Vec<Dot>,
}

/// A line per series and cost, each from the least load to the most; those with one load only are
/// left out.
fn lines(f: &Figures<'_>, bench_at: &str, load: &Load) -> Vec<Line> {
    let mut all: Vec<Line> = Vec::new();
    for row in 0..f.len(&format!("{bench_at}/rows")) {
        let of = |key: &str| format!("{bench_at}/rows/{row}/{key}");
        let is_other = |&(key, text): &(&str, &str)| f.text(&of(key)) != text;
        let Some(x) = f.number(&of(load.x)) else {
            continue;
        };
        if load.only.iter().any(is_other) {
            continue;
        }
        let words: Vec<String> = load.series.iter().map(|key| f.word(&of(key))).collect();
        let mut named = vec![];
        for &(cost, title) in load.costs {
            let title = (!title.is_empty()).then(|| title.to_owned());
            let name: Vec<String> = words.iter().cloned().chain(title).collect();
            named.push((cost, name.join(", ")));
        }
        // What all series are compared with is the same in all of them: one line, of the row that
        // comes first.
        if let Some((cost, title)) = load.reference
            && !all
                .iter()
                .any(|line| line.cost == cost && line.dots.iter().any(|dot| dot.load == x))
        {
            named.push((cost, title.to_owned()));
        }
        for (cost, name) in named {
            let Some(ms) = f.number(&of(cost)) else {
                continue;
            };
            let dot = Dot {
                row,
                load: x,
                cost: ms,
            };
            match all.iter_mut().find(|line| line.name == name) {
                Some(line) => line.dots.push(dot),
                None => all.push(Line {
                    cost,
                    name,
                    dots: vec![dot],
                }),
            }
        }
    }
    for line in &mut all {
        line.dots.sort_by(|a, b| a.load.total_cmp(&b.load));
    }
    all.retain(|line| matches!(line.dots.as_slice(), [a, .., b] if a.load < b.load));
    all
}

/// The plot, where the rows have more than one load.
pub(crate) fn load(f: &Figures<'_>, bench_at: &str, bench: &Bench) -> Option<Markup> {
    let load = bench.load.as_ref()?;
    let all = lines(f, bench_at, load);
    let dots = || all.iter().flat_map(|line| &line.dots);
    let least = dots().map(|dot| dot.load).min_by(f64::total_cmp)?;
    let most = dots().map(|dot| dot.load).max_by(f64::total_cmp)?;
    let most_ms = dots().map(|dot| dot.cost).max_by(f64::total_cmp)?;
    let is_logarithmic = least > 0.0 && most / least > LOGARITHMIC_FROM;
    let axis = if is_logarithmic {
        Axis::Logarithmic(least, most)
    } else {
        Axis::Linear(least, most)
    };
    let x = |load: f64| LEFT + 14.0 + axis.place(load) * (WIDTH - LEFT - 44.0);
    let ticks = ticks(most_ms);
    let top = ticks.last().copied().unwrap_or(1.0);
    let y = |cost: f64| FLOOR - cost / top * (FLOOR - 40.0);
    let right = WIDTH - 10.0;

    let mut loads: Vec<&Dot> = dots().collect();
    loads.sort_by(|a, b| a.load.total_cmp(&b.load));
    let mut last = f64::NEG_INFINITY;
    loads.retain(|dot| {
        let is_apart = x(dot.load) - last >= LEAST_GAP;
        if is_apart {
            last = x(dot.load);
        }
        is_apart
    });
    let range = |line: &Line, dot: &Dot| {
        let end = |i: usize| {
            f.number(&format!(
                "{bench_at}/rows/{}/spread/{}/{i}",
                dot.row, line.cost
            ))
        };
        end(0).zip(end(1))
    };
    let line = |i: usize, of: &Line| {
        let (color, fill) = mark(i);
        let places: Vec<_> = of
            .dots
            .iter()
            .map(|dot| (x(dot.load), y(dot.cost), 4.0))
            .collect();
        html! {
            @for dot in &of.dots {
                @if let Some((least, most)) = range(of, dot) {
                    (upright_error_bar(x(dot.load), y(least), y(most)))
                }
            }
            (svg::line(&places, color, fill))
            (legend(i, LEFT, FLOOR + 56.0, &html! { (of.name) }))
        }
    };
    let height = FLOOR + 58.0 + all.len() as f64 * 18.0;
    Some(html! {
        svg viewBox=(format!("0 0 {WIDTH} {height}")) role="img" {
            path d=(format!("M{LEFT} 10V{FLOOR}H{right}")) fill="none" stroke="currentColor" opacity="0.5" {}
            text.faint x=(LEFT + 6.0) y="18" { "ms" }
            text.faint x=(right) y=(FLOOR + 34.0) text-anchor="end" {
                (load.title) @if is_logarithmic { ", logarithmic" }
            }
            (heights(&ticks, LEFT, right, y))
            @for dot in loads {
                path d=(format!("M{:.1} {FLOOR}v4", x(dot.load))) stroke="currentColor" opacity="0.5" {}
                text.faint x=(at(x(dot.load))) y=(FLOOR + 17.0) text-anchor="middle" {
                    (f.svg_figure(&format!("{bench_at}/rows/{}/{}", dot.row, load.x), 1.0, 0))
                }
            }
            @for (i, of) in all.iter().enumerate() {
                (line(i, of))
            }
        }
    })
}
