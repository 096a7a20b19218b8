//! Quality against speed: a dot per row, a curve where something grows along it.

use std::fmt::Write;

use super::super::html::Figures;
use super::super::plan::{Bench, Quality};
use super::{WIDTH, mark};

const LEFT: f64 = 52.0;
const RIGHT: f64 = WIDTH - 24.0;
const TOP: f64 = 36.0;
const FLOOR: f64 = 220.0;
/// Figures nearer to each other than this are not both shown.
const LEAST_GAP: f64 = 16.0;
/// More curves than these cannot be told apart; the table has all rows.
const MOST_CURVES: usize = 12;

/// A row of the table.
struct Dot {
    row: usize,
    x: f64,
    error: f64,
    /// What grows along the curve.
    along: f64,
}

struct Curve {
    /// What tells it from the others, and how the legend spells it.
    key: String,
    name: String,
    dots: Vec<Dot>,
}

/// The curves of rows whose `apart` is `part`, each in the order of what grows along it.
fn curves(f: &Figures<'_>, at: &str, quality: &Quality, part: &str) -> Vec<Curve> {
    let mut all: Vec<Curve> = Vec::new();
    for row in 0..f.len(&format!("{at}/rows")) {
        let of = |key: &str| format!("{at}/rows/{row}/{key}");
        if quality.apart.is_some_and(|key| f.word(&of(key)) != part) {
            continue;
        }
        let (Some(x), Some(error)) = (f.number(&of(quality.x)), f.number(&of(quality.error)))
        else {
            continue;
        };
        let along = quality.along.and_then(|(key, _)| f.number(&of(key)));
        let dot = Dot {
            row,
            x,
            error,
            along: along.unwrap_or_default(),
        };
        let words = quality.series.iter().map(|key| f.word(&of(key)));
        let key = words.collect::<Vec<_>>().join(", ");
        match all.iter_mut().find(|curve| curve.key == key) {
            Some(curve) if quality.along.is_some() => curve.dots.push(dot),
            _ => {
                let shown = quality.series.iter().map(|key| match *key {
                    "lights" => format!("{} lights", f.svg_figure(&of(key), 1.0, 0)),
                    _ => f.text(&of(key)),
                });
                all.push(Curve {
                    key,
                    name: shown.collect::<Vec<_>>().join(", "),
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
pub(in super::super) fn quality(f: &Figures<'_>, at: &str, bench: &Bench) -> Vec<(String, String)> {
    let Some(quality) = &bench.quality else {
        return Vec::new();
    };
    let mut parts: Vec<String> = Vec::new();
    for row in 0..f.len(&format!("{at}/rows")) {
        let part = quality.apart.map_or(String::new(), |key| {
            f.word(&format!("{at}/rows/{row}/{key}"))
        });
        if !parts.contains(&part) {
            parts.push(part);
        }
    }
    parts
        .into_iter()
        .filter_map(|part| {
            let curves = curves(f, at, quality, &part);
            let svg = plot(f, at, quality, &curves)?;
            Some((part, svg))
        })
        .collect()
}

fn plot(f: &Figures<'_>, at: &str, quality: &Quality, curves: &[Curve]) -> Option<String> {
    let dots: Vec<&Dot> = curves.iter().flat_map(|curve| &curve.dots).collect();
    let farthest = dots.iter().max_by(|a, b| a.x.total_cmp(&b.x))?;
    let nearest = dots.iter().min_by(|a, b| a.x.total_cmp(&b.x))?;
    let worst = dots.iter().max_by(|a, b| a.error.total_cmp(&b.error))?;
    let best = dots.iter().min_by(|a, b| a.error.total_cmp(&b.error))?;
    let x = |value: f64| LEFT + value / farthest.x.max(1e-9) * (RIGHT - LEFT - 8.0);
    let y = |error: f64| FLOOR - error / worst.error.max(1e-9) * (FLOOR - TOP);

    let is_curve = curves.iter().any(|curve| curve.dots.len() > 1);
    let legend = FLOOR + if is_curve { 74.0 } else { 56.0 };
    let height = legend + curves.len() as f64 * 18.0;
    let mut svg = format!("<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\">");
    let _ = write!(
        svg,
        "<path d=\"M{LEFT} 10V{FLOOR}H{RIGHT}\" fill=\"none\" stroke=\"currentColor\" opacity=\"0.5\"/>\
         <text class=\"faint\" x=\"{RIGHT}\" y=\"{}\" text-anchor=\"end\">{}</text>\
         <text class=\"faint\" x=\"{}\" y=\"18\">FLIP error: low is better</text>",
        FLOOR + 34.0,
        quality.axis,
        LEFT + 6.0,
    );
    let figure =
        |dot: &Dot, key, digits| f.svg_figure(&format!("{at}/rows/{}/{key}", dot.row), 1.0, digits);
    let mut across = |dot: &Dot| {
        let _ = write!(
            svg,
            "<path d=\"M{at_x:.1} {FLOOR}v4\" stroke=\"currentColor\" opacity=\"0.5\"/>\
             <text class=\"faint\" x=\"{at_x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            FLOOR + 17.0,
            figure(dot, quality.x, quality.digits),
            at_x = x(dot.x),
        );
    };
    across(farthest);
    if x(farthest.x) - x(nearest.x) > 2.5 * LEAST_GAP {
        across(nearest);
    }
    let mut upward = |dot: &Dot| {
        let _ = write!(
            svg,
            "<path d=\"M{LEFT} {at_y:.1}h-4\" stroke=\"currentColor\" opacity=\"0.5\"/>\
             <text class=\"faint\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            LEFT - 6.0,
            y(dot.error) + 4.0,
            figure(dot, quality.error, 4),
            at_y = y(dot.error),
        );
    };
    upward(worst);
    if y(best.error) - y(worst.error) > LEAST_GAP {
        upward(best);
    }
    if let (Some((_, title)), true) = (quality.along, is_curve) {
        let _ = write!(
            svg,
            "<text class=\"faint\" x=\"{RIGHT}\" y=\"{}\" text-anchor=\"end\">larger dots: {title}</text>",
            FLOOR + 52.0,
        );
    }
    for (i, curve) in curves.iter().enumerate() {
        let (stroke, fill) = mark(i);
        let mut path = String::new();
        let mut circles = String::new();
        for (j, dot) in curve.dots.iter().enumerate() {
            let (x, y) = (x(dot.x), y(dot.error));
            let _ = write!(path, "{}{x:.1} {y:.1}", if j == 0 { 'M' } else { 'L' });
            let radius = if is_curve { 3.0 + 1.5 * j as f64 } else { 5.0 };
            let _ = write!(
                circles,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"2\"/>"
            );
        }
        let base = legend + i as f64 * 18.0;
        let _ = write!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"2\"/>{circles}\
             <circle cx=\"{}\" cy=\"{:.1}\" r=\"5\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"2\"/>\
             <text x=\"{}\" y=\"{base:.1}\">{}</text>",
            LEFT + 6.0,
            base - 4.0,
            LEFT + 18.0,
            curve.name,
        );
    }
    svg.push_str("</svg>");
    Some(svg)
}
