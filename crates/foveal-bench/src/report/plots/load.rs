//! Cost against load: a line per series, from the least load to the most.

use std::fmt::Write;

use super::axes::{WIDTH, heights, mark, ticks, upright_error_bar};
use crate::report::bench::{Bench, Load};
use crate::report::html::Figures;

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

/// A line per series and cost, each from the least load to the most; those with one load only are left out.
fn lines(f: &Figures<'_>, at: &str, load: &Load) -> Vec<Line> {
    let mut all: Vec<Line> = Vec::new();
    for row in 0..f.len(&format!("{at}/rows")) {
        let of = |key: &str| format!("{at}/rows/{row}/{key}");
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
        // What all series are compared with is the same in all of them: one line, of the row that comes first.
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
pub(crate) fn load(f: &Figures<'_>, at: &str, bench: &Bench) -> Option<String> {
    let load = bench.load.as_ref()?;
    let all = lines(f, at, load);
    let dots = || all.iter().flat_map(|line| &line.dots);
    let least = dots().map(|dot| dot.load).min_by(f64::total_cmp)?;
    let most = dots().map(|dot| dot.load).max_by(f64::total_cmp)?;
    let most_ms = dots().map(|dot| dot.cost).max_by(f64::total_cmp)?;
    let is_logarithmic = least > 0.0 && most / least > LOGARITHMIC_FROM;
    let along = |load: f64| {
        if is_logarithmic {
            (load / least).ln() / (most / least).ln()
        } else {
            (load - least) / (most - least)
        }
    };
    let x = |load: f64| LEFT + 14.0 + along(load) * (WIDTH - LEFT - 44.0);
    let ticks = ticks(most_ms);
    let top = ticks.last().copied().unwrap_or(1.0);
    let y = |cost: f64| FLOOR - cost / top * (FLOOR - 40.0);

    let height = FLOOR + 58.0 + all.len() as f64 * 18.0;
    let mut svg = format!("<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\">");
    let _ = write!(
        svg,
        "<path d=\"M{LEFT} 10V{FLOOR}H{right}\" fill=\"none\" stroke=\"currentColor\" opacity=\"0.5\"/>\
         <text class=\"faint\" x=\"{}\" y=\"18\">ms</text>\
         <text class=\"faint\" x=\"{right}\" y=\"{}\" text-anchor=\"end\">{}{}</text>",
        LEFT + 6.0,
        FLOOR + 34.0,
        load.title,
        if is_logarithmic { ", logarithmic" } else { "" },
        right = WIDTH - 10.0,
    );
    heights(&mut svg, &ticks, LEFT, WIDTH - 10.0, y);
    let mut loads: Vec<&Dot> = dots().collect();
    loads.sort_by(|a, b| a.load.total_cmp(&b.load));
    let mut last = f64::NEG_INFINITY;
    for dot in loads {
        let at_x = x(dot.load);
        if at_x - last >= LEAST_GAP {
            let _ = write!(
                svg,
                "<path d=\"M{at_x:.1} {FLOOR}v4\" stroke=\"currentColor\" opacity=\"0.5\"/>\
                 <text class=\"faint\" x=\"{at_x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                FLOOR + 17.0,
                f.svg_figure(&format!("{at}/rows/{}/{}", dot.row, load.x), 1.0, 0),
            );
            last = at_x;
        }
    }
    for (i, line) in all.iter().enumerate() {
        let (color, fill) = mark(i);
        let mut path = String::new();
        for (j, dot) in line.dots.iter().enumerate() {
            let end = |i: usize| {
                let spread = format!("{at}/rows/{}/spread/{}/{i}", dot.row, line.cost);
                f.number(&spread)
            };
            if let (Some(least), Some(most)) = (end(0), end(1)) {
                upright_error_bar(&mut svg, x(dot.load), y(least), y(most));
            }
            let (x, y) = (x(dot.load), y(dot.cost));
            let _ = write!(path, "{}{x:.1} {y:.1}", if j == 0 { 'M' } else { 'L' });
            let _ = write!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{fill}\" stroke=\"{color}\"/>"
            );
        }
        let base = FLOOR + 56.0 + i as f64 * 18.0;
        let _ = write!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>\
             <circle cx=\"{}\" cy=\"{:.1}\" r=\"5\" fill=\"{fill}\" stroke=\"{color}\"/><text x=\"{}\" y=\"{base:.1}\">{}</text>",
            LEFT + 6.0,
            base - 4.0,
            LEFT + 18.0,
            line.name,
        );
    }
    svg.push_str("</svg>");
    Some(svg)
}
