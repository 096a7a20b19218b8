//! Figures as columns of text.

use foveal_measure::{Finding, median};
use serde::Serialize;

/// Lines of cells, each column as wide as its widest cell, numbers (all but the first column) to
/// the right.
pub(super) fn text(lines: &[Vec<String>]) -> String {
    let columns = lines.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = lines.iter().filter_map(|line| line.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    lines
        .iter()
        .map(|line| {
            let cells = line.iter().zip(&widths).enumerate();
            let cells = cells.map(|(column, (cell, &width))| match column {
                0 => format!("{cell:<width$}"),
                _ => format!("{cell:>width$}"),
            });
            cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
        })
        .collect()
}

/// A number with so many digits, or a dash where none was measured.
pub(super) fn number_text(number: Option<f64>, digits: usize) -> String {
    number.map_or_else(|| "-".to_owned(), |number| format!("{number:.digits$}"))
}

/// A ratio with so many digits; `~` before one that is no difference, or of too few rounds to tell.
pub(super) fn ratio_text(ratio: f64, finding: Finding, digits: usize) -> String {
    match finding {
        Finding::Faster | Finding::Slower => format!("{ratio:.digits$}"),
        Finding::NoDifference | Finding::TooFew => format!("~ {ratio:.digits$}"),
    }
}

/// A kebab-case name, as the settings file spells it.
pub(super) fn name_of(value: impl Serialize) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(name)) => name,
        _ => String::new(),
    }
}

/// A quality with two digits.
pub(super) fn jod_text(jod: Option<f32>) -> String {
    number_text(jod.map(f64::from), 2)
}

/// The median time of passes; `None` where the device takes no times of them, which are 0 then.
pub(super) fn passes_ms(ms: &[f64]) -> Option<f64> {
    Some(median(ms)).filter(|&ms| ms > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_measured_is_a_dash() {
        assert_eq!(passes_ms(&[0.0; 3]), None);
        assert_eq!(number_text(passes_ms(&[1.0, 2.0, 3.0]), 1), "2.0");
        assert_eq!(number_text(None, 1), "-");
    }

    #[test]
    fn a_ratio_that_says_nothing_is_marked() {
        let text = |finding| ratio_text(2.184, finding, 2);
        assert_eq!([text(Finding::Faster), text(Finding::Slower)], ["2.18"; 2]);
        assert_eq!(
            [text(Finding::TooFew), text(Finding::NoDifference)],
            ["~ 2.18"; 2]
        );
    }

    #[test]
    fn columns_line_up() {
        let line = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        let lines = [line(["mode", "ms"]), line(["a", "12.5"])];
        assert_eq!(text(&lines), "mode    ms\na     12.5\n");
    }
}
