//! The Laplacian pyramid (Burt and Adelson 1983): kernel 1/20, 1/4, 2/5, 1/4, 1/20.

/// A plane of numbers, rows top to bottom.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plane {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) values: Vec<f32>,
}

const KERNEL: [f32; 5] = [0.05, 0.25, 0.4, 0.25, 0.05];

impl Plane {
    /// From `width * height` values.
    pub(crate) fn new(width: usize, height: usize, values: Vec<f32>) -> Self {
        debug_assert_eq!(values.len(), width * height);
        Self {
            width,
            height,
            values,
        }
    }

    fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.width..][..self.width]
    }

    /// The next level: low-passed, every second row and column. Borders are mirrored, but for the
    /// right one where just one of width and height is odd: there the published metric weighs the
    /// last column by the height's parity, which makes it 1.25 or 0.75 times as bright. Scores
    /// depend on it, so that we do the same.
    pub(crate) fn reduced(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut values = Vec::with_capacity(width * height);
        let mut column_sums = vec![0.0; self.width];
        for y in 0..height {
            column_sums.fill(0.0);
            for (offset, weight) in KERNEL.into_iter().enumerate() {
                let row = self.row(mirrored(2 * y + offset, self.height));
                for (sum, &value) in column_sums.iter_mut().zip(row) {
                    *sum += weight * value;
                }
            }
            reduce_row(&column_sums, self.height % 2 == 1, &mut values);
        }
        Self::new(width, height, values)
    }

    /// The level above, low-passed: `width` and `height` are its size.
    pub(crate) fn expanded(&self, width: usize, height: usize) -> Self {
        let mut values = Vec::with_capacity(width * height);
        let mut columns = vec![0.0; self.width];
        for y in 0..height {
            let middle = y / 2;
            let below = self.row((middle + 1).min(self.height - 1));
            let here = self.row(middle);
            if y % 2 == 0 {
                let above = self.row(middle.saturating_sub(1));
                let rows = above.iter().zip(here).zip(below);
                for (column, ((a, h), b)) in columns.iter_mut().zip(rows) {
                    *column = 0.1 * (a + b) + 0.8 * h;
                }
            } else {
                for (column, (h, b)) in columns.iter_mut().zip(here.iter().zip(below)) {
                    *column = 0.5 * (h + b);
                }
            }
            expand_row(&columns, width, &mut values);
        }
        Self::new(width, height, values)
    }
}

/// The row that stands for row `place - 2`, which may lie outside.
fn mirrored(place: usize, length: usize) -> usize {
    let inside = if place < 2 { 1 - place } else { place - 2 };
    let inside = if inside < length {
        inside
    } else {
        (2 * length - 1).saturating_sub(inside)
    };
    inside.min(length - 1)
}

fn reduce_row(row: &[f32], odd_border: bool, out: &mut Vec<f32>) {
    let width = row.len();
    let start = out.len();
    let outside_is_black = |x: usize| {
        let taps = KERNEL.into_iter().enumerate();
        taps.map(|(offset, weight)| {
            let place = (x + offset).checked_sub(2);
            weight * place.and_then(|p| row.get(p)).unwrap_or(&0.0)
        })
        .sum::<f32>()
    };
    // Where all five taps lie inside.
    let last_inner = width.saturating_sub(3);
    out.extend((0..width).step_by(2).map(|x| {
        if x >= 2 && x <= last_inner {
            let taps = &row[x - 2..x + 3];
            0.05 * (taps[0] + taps[4]) + 0.25 * (taps[1] + taps[3]) + 0.4 * taps[2]
        } else {
            outside_is_black(x)
        }
    }));
    let second = row[1.min(width - 1)];
    out[start] += 0.25 * row[0] + 0.05 * second;
    let end = out.len() - 1;
    out[end] += if odd_border {
        0.25 * row[width - 1] + 0.05 * row[width.saturating_sub(2)]
    } else {
        0.05 * row[width - 1]
    };
}

fn expand_row(columns: &[f32], width: usize, out: &mut Vec<f32>) {
    let last = columns.len() - 1;
    out.extend((0..width).map(|x| {
        let middle = x / 2;
        let (here, right) = (columns[middle], columns[(middle + 1).min(last)]);
        if x % 2 == 0 {
            0.1 * (columns[middle.saturating_sub(1)] + right) + 0.8 * here
        } else {
            0.5 * (here + right)
        }
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_stays_grey() {
        for (width, height) in [(8, 8), (16, 6), (7, 9), (5, 5), (4, 4)] {
            let plane = Plane::new(width, height, vec![3.0; width * height]);
            let reduced = plane.reduced();
            assert_eq!(
                (reduced.width, reduced.height),
                (width.div_ceil(2), height.div_ceil(2))
            );
            let expanded = reduced.expanded(width, height);
            for value in reduced.values.iter().chain(&expanded.values) {
                assert!((value - 3.0).abs() < 1e-5, "{width}x{height}: {value}");
            }
        }
    }

    #[test]
    fn the_right_border_goes_by_the_parity_of_the_height() {
        let last = |width: usize, height: usize| {
            let plane = Plane::new(width, height, vec![1.0; width * height]);
            *plane.reduced().values.last().unwrap()
        };
        assert!((last(8, 7) - 1.25).abs() < 1e-6);
        assert!((last(7, 8) - 0.75).abs() < 1e-6);
    }

    #[test]
    fn a_dot_spreads_by_the_kernel() {
        let mut plane = Plane::new(9, 9, vec![0.0; 81]);
        plane.values[4 * 9 + 4] = 1.0;
        let reduced = plane.reduced();
        assert!((reduced.values[2 * 5 + 2] - 0.16).abs() < 1e-6);
        assert!((reduced.values[2 * 5 + 1] - 0.02).abs() < 1e-6);
    }
}
