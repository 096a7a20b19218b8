//! Contrast sensitivity by spatial frequency and luminance, for what stays and for what changes.
//!
//! FovVideoVDP (Mantiuk et al. 2021) gives both temporal channels a sensitivity that depends on
//! frequency, luminance and eccentricity, the last by the cortical magnification factor: a place at
//! eccentricity *e* sees a frequency as the fovea sees a higher one. The polynomials below are our
//! own: fitted to responses of the published metric to noise of low contrast on grey, for 0.26 to
//! 40 cycles per degree and 0.1 to 1000 cd/m² (docs/eye-metric.md). They are within 0.5 % (root
//! mean square) of what was measured.

/// Smallest and largest luminance that sensitivity tells apart, cd/m².
pub(crate) const LUMINANCE: (f32, f32) = (0.1, 1000.0);

/// `c[i][j]` of the sum of c (ln ρ / 2)^i (ln L / 4)^j, which is the sustained channel's ln S.
const SUSTAINED: [[f64; 6]; 7] = [
    [
        6.9139078, 1.2190079, -0.6801217, -0.2848437, 0.2088883, -0.0319026,
    ],
    [
        -1.1583367, 1.2000536, 0.0259115, 0.0245199, -0.0102781, -0.0120357,
    ],
    [
        -1.8811156, -0.0785904, -0.0871700, 0.0687394, 0.0326748, 0.0,
    ],
    [0.3253671, 0.1137802, -0.1295197, -0.1169558, 0.0, 0.0],
    [-0.2156266, 0.1671671, 0.1926278, 0.0, 0.0, 0.0],
    [-0.0321724, -0.1775496, 0.0, 0.0, 0.0, 0.0],
    [0.0620018, 0.0, 0.0, 0.0, 0.0, 0.0],
];

/// Coefficients in ln ρ / 2 of ln(S transient / S sustained); luminance does not matter.
const TRANSIENT: [f64; 8] = [
    1.768776, -2.044512, 0.341735, -0.294059, 0.688291, 0.153187, -0.477748, 0.147300,
];

/// Least and greatest frequency of the fit, cycles per degree.
const FREQUENCIES: (f64, f64) = (0.2, 70.0);
/// Above 41 cycles per degree sensitivity falls by this further power.
const CUT_OFF: (f64, f64) = (41.0, 11.0);

/// Natural logarithm of the sustained channel's sensitivity; frequency in cycles per degree,
/// luminance in cd/m².
pub(crate) fn ln_sustained(frequency: f64, luminance: f64) -> f64 {
    let ln_frequency = frequency.max(FREQUENCIES.0).ln();
    let x = ln_frequency.min(FREQUENCIES.1.ln()) / 2.0;
    let (dark, bright) = (f64::from(LUMINANCE.0), f64::from(LUMINANCE.1));
    let l = luminance.clamp(dark, bright).ln() / 4.0;
    let fit = horner(
        x,
        SUSTAINED.iter().map(|row| horner(l, row.iter().copied())),
    );
    fit - CUT_OFF.1 * (ln_frequency - CUT_OFF.0.ln()).max(0.0)
}

/// The transient channel's sensitivity by the sustained one's.
pub(crate) fn transient_ratio(frequency: f64) -> f64 {
    let x = frequency.clamp(FREQUENCIES.0, 40.0).ln() / 2.0;
    horner(x, TRANSIENT.into_iter()).exp()
}

fn horner(x: f64, coefficients: impl DoubleEndedIterator<Item = f64>) -> f64 {
    coefficients.rev().fold(0.0, |sum, c| sum * x + c)
}

/// The sustained sensitivity as a table over ln luminance and ln frequency.
#[derive(Clone, Debug)]
pub(crate) struct SensitivityTable {
    frequencies: usize,
    first: f32,
    per_unit: f32,
    values: Vec<f32>,
}

impl SensitivityTable {
    const LUMINANCES: usize = 93;

    /// For frequencies between two, in cycles per degree.
    pub(crate) fn new(lowest: f32, highest: f32) -> Self {
        let (first, last) = (lowest.ln(), highest.max(lowest * 1.001).ln());
        let frequencies = ((last - first) * 20.0).ceil() as usize + 2;
        let per_unit = (frequencies - 1) as f32 / (last - first);
        let (dark, bright) = LUMINANCE;
        let step = (bright / dark).ln() / (Self::LUMINANCES - 1) as f32;
        let values = (0..Self::LUMINANCES)
            .flat_map(|l| (0..frequencies).map(move |f| (l, f)))
            .map(|(l, f)| {
                let luminance = (dark.ln() + l as f32 * step).exp();
                let frequency = (first + f as f32 / per_unit).exp();
                ln_sustained(f64::from(frequency), f64::from(luminance)) as f32
            })
            .collect();
        Self {
            frequencies,
            first,
            per_unit,
            values,
        }
    }

    /// Where a frequency, by its natural logarithm, lies between the table's columns.
    pub(crate) fn column(&self, ln_frequency: f32) -> f32 {
        let last = (self.frequencies - 1) as f32 - 1e-3;
        ((ln_frequency - self.first) * self.per_unit).clamp(0.0, last)
    }

    /// Sensitivity at a column and a luminance in cd/m².
    pub(crate) fn at(&self, column: f32, luminance: f32) -> f32 {
        let (dark, bright) = LUMINANCE;
        let rows = (Self::LUMINANCES - 1) as f32;
        let row = (luminance.max(dark) / dark).ln() * (rows / (bright / dark).ln());
        let row = row.min(rows - 1e-3);
        let (r, c) = (row as usize, column as usize);
        let (y, x) = (row - r as f32, column - c as f32);
        let at = r * self.frequencies + c;
        let (upper, lower) = (&self.values[at..], &self.values[at + self.frequencies..]);
        let upper = upper[0] + (upper[1] - upper[0]) * x;
        let lower = lower[0] + (lower[1] - lower[0]) * x;
        (upper + (lower - upper) * y).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sensitivity_has_its_peak_near_one_cycle_per_degree_and_falls_off() {
        let s = |frequency| ln_sustained(frequency, 30.0);
        assert!(s(1.0) > s(0.3) && s(1.0) > s(4.0));
        assert!(s(4.0) > s(16.0) && s(16.0) > s(60.0) + 3.0);
    }

    #[test]
    fn more_light_shows_finer_detail() {
        assert!(ln_sustained(10.0, 100.0) > ln_sustained(10.0, 10.0));
        assert!(ln_sustained(10.0, 10.0) > ln_sustained(10.0, 1.0));
        assert!(
            (ln_sustained(10.0, 0.01) - ln_sustained(10.0, 0.1)).abs() < 1e-6,
            "luminance is clamped"
        );
    }

    #[test]
    fn change_is_seen_best_where_it_is_coarse() {
        assert!(transient_ratio(0.5) > 4.0 * transient_ratio(8.0));
    }

    #[test]
    fn the_table_is_the_function() {
        let table = SensitivityTable::new(0.5, 50.0);
        for frequency in [0.5, 0.7, 3.3, 12.0, 49.0f32] {
            for luminance in [0.03, 0.1, 2.2, 90.0, 999.0f32] {
                let table = table.at(table.column(frequency.ln()), luminance).ln();
                let exact = ln_sustained(f64::from(frequency), f64::from(luminance)) as f32;
                assert!(
                    (table - exact).abs() < 4e-3,
                    "{frequency} {luminance}: {table} {exact}"
                );
            }
        }
    }
}
