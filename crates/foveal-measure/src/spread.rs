//! Several measurements of one thing: the median, and how far they lie apart.

use serde::{Deserialize, Serialize};

/// The median of some times, how far they lie apart, and how many they are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// A tenth of all lies below this.
    pub low: f64,
    /// A tenth of all lies above this.
    pub high: f64,
    /// How many there are.
    pub frames: usize,
}

impl Spread {
    /// `None` of nothing.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        Some(Self {
            median: of_sorted(&sorted, 0.5),
            low: of_sorted(&sorted, 0.1),
            high: of_sorted(&sorted, 0.9),
            frames: sorted.len(),
        })
    }
}

/// The median: the central value, or the mean of the two central ones; 0 of nothing.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// The value below which `part` (0 to 1) of all lies, interpolated between neighbours; 0 of
/// nothing.
#[must_use]
pub fn quantile(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    of_sorted(&sorted, part)
}

pub(crate) fn of_sorted(sorted: &[f64], part: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    let place = part.clamp(0.0, 1.0) * last as f64;
    let (below, above) = (place.floor() as usize, place.ceil() as usize);
    let part = place - below as f64;
    // Not by weights: equal neighbours stay what they are, to the bit.
    sorted[below] + part * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_median_is_the_central_value() {
        assert_eq!(median(&[]), 0.0);
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
    }

    #[test]
    fn a_tenth_lies_below_and_a_tenth_above() {
        let values: Vec<f64> = (0..=100).map(f64::from).collect();
        let spread = Spread::of(&values).unwrap();
        assert_eq!((spread.low, spread.median, spread.high), (10.0, 50.0, 90.0));
        assert_eq!(spread.frames, 101);
        assert_eq!(Spread::of(&[]), None);
    }

    proptest! {
        #[test]
        fn the_spread_encloses_the_median(values in prop::collection::vec(0.001..1e4, 1..40)) {
            let spread = Spread::of(&values).unwrap();
            prop_assert!(spread.low <= spread.median && spread.median <= spread.high);
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            let most = values.iter().copied().fold(0.0, f64::max);
            prop_assert!(least <= spread.low && spread.high <= most);
        }
    }
}
