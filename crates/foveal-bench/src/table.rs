//! Figures as columns of text.

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

/// A quality with two digits.
pub(super) fn jod_text(jod: Option<f32>) -> String {
    jod.map_or_else(|| "-".to_owned(), |jod| format!("{jod:.2}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let line = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        let lines = [line(["mode", "ms"]), line(["a", "12.5"])];
        assert_eq!(text(&lines), "mode    ms\na     12.5\n");
    }
}
