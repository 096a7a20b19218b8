//! A plain SVG plot: panels side by side, both axes logarithmic, milliseconds upwards.

use std::fmt::Write;

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
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{HEIGHT}\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for (i, panel) in panels.iter().enumerate() {
        let _ = writeln!(svg, "<g transform=\"translate({} 0)\">", WIDTH * i as f64);
        draw(&mut svg, panel);
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

fn draw(svg: &mut String, panel: &Panel) {
    let points = || {
        panel
            .lines
            .iter()
            .flat_map(|(_, points)| points.iter().copied())
    };
    let x = Axis::over(points().map(|p| p.0));
    let y = Axis::over(points().map(|p| p.1));
    let place = |(px, py): (f64, f64)| {
        (
            LEFT + x.place(px) * PLOT.0,
            TOP + (1.0 - y.place(py)) * PLOT.1,
        )
    };
    let text = |svg: &mut String, x: f64, y: f64, anchor: &str, text: &str| {
        let _ = writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"
        );
    };
    for tick in x.ticks() {
        let (at, _) = place((tick, y.low()));
        let bottom = TOP + PLOT.1;
        let _ = writeln!(svg, "<path d=\"M{at:.1} {TOP}V{bottom}\" stroke=\"#ddd\"/>");
        text(svg, at, bottom + 15.0, "middle", &short(tick));
    }
    for tick in y.ticks() {
        let (_, at) = place((x.low(), tick));
        let right = LEFT + PLOT.0;
        let _ = writeln!(svg, "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"#ddd\"/>");
        text(svg, LEFT - 5.0, at + 4.0, "end", &short(tick));
    }
    let _ = writeln!(
        svg,
        "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888\"/>",
        PLOT.0, PLOT.1
    );
    text(
        svg,
        LEFT + PLOT.0 / 2.0,
        TOP + PLOT.1 + 34.0,
        "middle",
        &panel.title,
    );
    text(svg, LEFT - 5.0, TOP - 10.0, "end", "ms");
    for (i, ((name, points), color)) in panel.lines.iter().zip(COLORS).enumerate() {
        let path: Vec<String> = points
            .iter()
            .map(|&p| place(p))
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>",
            path.join(" ")
        );
        for point in &path {
            let (x, y) = point.split_once(',').unwrap_or(("0", "0"));
            let _ = writeln!(
                svg,
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"3\" fill=\"{color}\"/>"
            );
        }
        let at = LEFT + 8.0 + 90.0 * i as f64;
        let _ = writeln!(
            svg,
            "<text x=\"{at}\" y=\"{}\" fill=\"{color}\">{name}</text>",
            TOP - 10.0
        );
    }
}

/// Whole decades around the values, as exponents of ten.
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    fn over(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values
            .filter(|v| *v > 0.0 && v.is_finite())
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        if low > high {
            return Self {
                low: 0.0,
                high: 1.0,
            };
        }
        let (low, high) = (low.floor(), high.ceil());
        Self {
            low,
            high: high.max(low + 1.0),
        }
    }

    fn low(&self) -> f64 {
        10_f64.powf(self.low)
    }

    /// 0 at the low end to 1 at the high one.
    fn place(&self, value: f64) -> f64 {
        let exponent = value.max(f64::MIN_POSITIVE).log10();
        ((exponent - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    fn ticks(&self) -> impl Iterator<Item = f64> + use<> {
        (self.low as i32..=self.high as i32).map(|e| 10_f64.powi(e))
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
