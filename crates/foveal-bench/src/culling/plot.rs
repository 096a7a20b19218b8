//! A plot of its own file: panels side by side, both axes logarithmic, milliseconds upwards.

use maud::{Markup, PreEscaped, html};

use crate::svg::{self, Axis, at};

/// One diagram.
pub(super) struct Panel {
    pub(super) title: String,
    /// Name, and points (x, milliseconds), all greater than 0.
    pub(super) lines: Vec<(&'static str, Vec<(f64, f64)>)>,
}

const COLORS: [&str; 2] = ["#1f6fb4", "#d9622b"];
const WIDTH: f64 = 340.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 52.0;
const TOP: f64 = 34.0;
const PLOT: (f64, f64) = (270.0, 210.0);

/// All panels in one picture.
pub(super) fn svg(panels: &[Panel]) -> String {
    let width = WIDTH * panels.len() as f64;
    let svg = html! {
        svg xmlns="http://www.w3.org/2000/svg" width=(width) height=(HEIGHT) font-family="sans-serif" font-size="11" {
            rect width="100%" height="100%" fill="white" {}
            @for (i, panel) in panels.iter().enumerate() {
                (PreEscaped("\n"))
                g transform=(format!("translate({} 0)", WIDTH * i as f64)) { (draw(panel)) }
            }
        }
    };
    svg.into_string() + "\n"
}

fn draw(panel: &Panel) -> Markup {
    let points = || panel.lines.iter().flat_map(|(_, points)| points);
    let (across, upward) = (
        Axis::decades(points().map(|p| p.0)),
        Axis::decades(points().map(|p| p.1)),
    );
    let x = |value: f64| LEFT + across.place(value) * PLOT.0;
    let y = |value: f64| TOP + (1.0 - upward.place(value)) * PLOT.1;
    let (right, bottom) = (LEFT + PLOT.0, TOP + PLOT.1);
    let place = |&(px, py): &(f64, f64)| (x(px), y(py), 3.0);
    html! {
        @for tick in across.powers_of_ten() {
            path d=(format!("M{:.1} {TOP}V{bottom}", x(tick))) stroke="#ddd" {}
            text x=(at(x(tick))) y=(at(bottom + 15.0)) text-anchor="middle" { (short(tick)) }
        }
        @for tick in upward.powers_of_ten() {
            path d=(format!("M{LEFT} {:.1}H{right}", y(tick))) stroke="#ddd" {}
            text x=(at(LEFT - 5.0)) y=(at(y(tick) + 4.0)) text-anchor="end" { (short(tick)) }
        }
        rect x=(LEFT) y=(TOP) width=(PLOT.0) height=(PLOT.1) fill="none" stroke="#888" {}
        text x=(at(LEFT + PLOT.0 / 2.0)) y=(at(bottom + 34.0)) text-anchor="middle" { (panel.title) }
        text x=(at(LEFT - 5.0)) y=(at(TOP - 10.0)) text-anchor="end" { "ms" }
        @for (i, ((name, points), color)) in panel.lines.iter().zip(COLORS).enumerate() {
            (svg::line(&points.iter().map(place).collect::<Vec<_>>(), color, color))
            text x=(LEFT + 8.0 + 90.0 * i as f64) y=(TOP - 10.0) fill=(color) { (name) }
        }
    }
}

/// 1000 as 1 k.
fn short(value: f64) -> String {
    match value {
        v if v >= 1e6 => format!("{} M", v / 1e6),
        v if v >= 1e3 => format!("{} k", v / 1e3),
        v if v >= 1.0 => format!("{v}"),
        v => format!("{v:.4}").trim_end_matches('0').to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plot_is_whole_whatever_the_points() {
        let panel = |points: Vec<(f64, f64)>| Panel {
            title: "boxes".to_owned(),
            lines: vec![("a", points)],
        };
        let svg = svg(&[panel(vec![]), panel(vec![(1000.0, 0.02), (1e6, 30.0)])]);
        assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"));
        assert_eq!(svg.matches("<circle").count(), 2);
    }

    #[test]
    fn ticks_read_well() {
        assert_eq!(
            [0.01, 1.0, 1e4, 1e7].map(short),
            ["0.01", "1", "10 k", "10 M"]
        );
    }
}
