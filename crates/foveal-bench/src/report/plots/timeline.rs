//! A frame as a timeline: a lane per unit, its stages one after the other.

use maud::{Markup, html};

use crate::report::html::Figures;
use crate::svg::{COLORS, WIDTH, at};

/// A lane's height with its name.
const LANE: f64 = 44.0;

/// Rows are stages `{unit, stage, ms}` in the order in which they run; those of other units than
/// CPU and GPU (the whole frame) have no lane.
pub(crate) fn timeline(f: &Figures<'_>, bench_at: &str) -> Markup {
    let rows = f.len(&format!("{bench_at}/rows"));
    let unit = |row: usize| f.text(&format!("{bench_at}/rows/{row}/unit"));
    let ms = |row: usize| {
        f.number(&format!("{bench_at}/rows/{row}/ms"))
            .unwrap_or(0.0)
    };
    let of_unit = |name: &str| (0..rows).filter(|&row| unit(row) == name).collect();
    let lanes: [(&str, Vec<usize>); 2] = ["CPU", "GPU"].map(|name| (name, of_unit(name)));
    let longest = lanes
        .iter()
        .map(|(_, stages)| stages.iter().map(|&row| ms(row)).sum::<f64>())
        .fold(1e-9, f64::max);
    let shown: usize = lanes.iter().map(|(_, stages)| stages.len()).sum();
    let legend = lanes.len() as f64 * LANE;
    let height = legend + 8.0 + shown as f64 * 18.0;
    let mut drawn = Vec::new();
    let mut named = 0;
    for (lane, (name, stages)) in lanes.iter().enumerate() {
        let top = lane as f64 * LANE;
        drawn.push(html! { text.faint x="0" y=(at(top + 12.0)) { (name) } });
        let mut start = 0.0;
        for &row in stages {
            let color = COLORS[named % COLORS.len()];
            // Each further round through the colours is paler, so that a stage is not taken for
            // another.
            let opacity = format!("{:.2}", 1.0 / (1 + named / COLORS.len()) as f64);
            let width = ms(row) / longest * WIDTH;
            let line = legend + 16.0 + named as f64 * 18.0;
            drawn.push(html! {
                rect x=(format!("{start:.2}")) y=(at(top + 17.0)) width=(format!("{width:.2}")) height="18" fill=(color)
                    opacity=(opacity) {}
                rect x="0" y=(at(line - 9.0)) width="10" height="10" rx="2" fill=(color) opacity=(opacity) {}
                text x="16" y=(at(line)) {
                    (name) ", " (f.text(&format!("{bench_at}/rows/{row}/stage"))) ": "
                    (f.svg_figure(&format!("{bench_at}/rows/{row}/ms"), 1.0, 2)) " ms"
                }
            });
            start += width;
            named += 1;
        }
    }
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {height}")) role="img" {
            @for part in drawn {
                (part)
            }
        }
    }
}
