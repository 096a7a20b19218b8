//! Two sides compared: their times, the ratio with its interval, and what that means.

use serde::{Deserialize, Serialize};

use crate::series::turn;
use crate::signed_rank::{estimate, median_of_means};
use crate::spread::Spread;

/// How sure an interval is: of a thousand comparisons of equal sides two may find a difference.
pub const CONFIDENCE: f64 = 0.998;

/// Ratios nearer to 1 than this part are no difference: two renderers with equal settings can be
/// this far apart by where their memory lies.
pub const MARGIN: f64 = 0.02;

/// The times that two sides took for the same frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The reference's time in milliseconds.
    pub reference_ms: f64,
    /// The chosen side's time in milliseconds.
    pub chosen_ms: f64,
    /// Whether the reference was drawn before the chosen side, as [`turn`] said.
    pub reference_first: bool,
}

impl Pair {
    fn is_valid(&self) -> bool {
        [self.reference_ms, self.chosen_ms]
            .iter()
            .all(|ms| ms.is_finite() && *ms > 0.0)
    }

    /// The logarithm of reference / chosen: swapped sides give the same with the other sign.
    fn log_ratio(&self) -> f64 {
        self.reference_ms.ln() - self.chosen_ms.ln()
    }

    /// 1 where the reference came first, else -1.
    fn sign(&self) -> f64 {
        if self.reference_first { 1.0 } else { -1.0 }
    }
}

/// What a comparison found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Finding {
    /// Too few pairs to tell.
    TooFew,
    /// Within the noise, or within [`MARGIN`].
    NoDifference,
    /// The chosen side takes less time.
    Faster,
    /// The chosen side takes more time.
    Slower,
}

impl Finding {
    /// What it means that this interval holds the true ratio; `None` where there are too few pairs
    /// for one.
    ///
    /// ```
    /// use foveal_measure::Finding;
    /// assert_eq!(Finding::of(Some([1.1, 1.3])), Finding::Faster);
    /// assert_eq!(Finding::of(Some([1.01, 1.3])), Finding::NoDifference);
    /// assert_eq!(Finding::of(None), Finding::TooFew);
    /// ```
    #[must_use]
    pub fn of(interval: Option<[f64; 2]>) -> Self {
        match interval {
            None => Self::TooFew,
            Some([low, _]) if low > 1.0 + MARGIN => Self::Faster,
            Some([_, high]) if high < 1.0 / (1.0 + MARGIN) => Self::Slower,
            Some(_) => Self::NoDifference,
        }
    }
}

/// Two sides that drew the same frames in turn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The reference's times in milliseconds.
    pub reference: Spread,
    /// The chosen side's times in milliseconds.
    pub chosen: Spread,
    /// Reference / chosen: above 1 the chosen side is faster. The median over all pairs of frames,
    /// which need not be the ratio of the medians.
    pub ratio: f64,
    /// The interval that holds the true ratio with [`CONFIDENCE`]; `None` where there are too few
    /// pairs.
    pub interval: Option<[f64; 2]>,
    /// How many pairs there are.
    pub pairs: usize,
    /// What that means.
    pub finding: Finding,
}

impl Comparison {
    /// Compares pairs of times. Pairs in which a time is not a positive number are left out; `None`
    /// where none is left.
    ///
    /// Where the side that is drawn first always takes longer (or less long), as after a pause,
    /// that is taken out first, in two ways. For the ratio: half of what the pairs that the reference
    /// began are apart from the others; where one side began all pairs, nothing is known of it. For
    /// the interval: the mean of what was drawn first to what was drawn after it, which is the same
    /// whoever began, so that equal sides are found equal. Where one side began more pairs than
    /// the other, that takes a part of the ratio for an advantage of beginning: the interval
    /// reaches from there to the ratio.
    #[must_use]
    pub fn of(pairs: &[Pair]) -> Option<Self> {
        let pairs: Vec<Pair> = pairs.iter().copied().filter(Pair::is_valid).collect();
        let without = |being_first: f64| -> Vec<f64> {
            let logs = pairs.iter();
            logs.map(|p| p.log_ratio() - p.sign() * being_first)
                .collect()
        };
        let of_first: Vec<f64> = pairs.iter().map(|p| p.sign() * p.log_ratio()).collect();
        let (careful, interval) = estimate(&without(median_of_means(&of_first)?), CONFIDENCE)?;
        let begun_by = |reference: bool| {
            let pairs = pairs.iter().filter(|p| p.reference_first == reference);
            median_of_means(&pairs.map(Pair::log_ratio).collect::<Vec<_>>())
        };
        let being_first = match (begun_by(true), begun_by(false)) {
            (Some(reference), Some(chosen)) => 0.5 * (reference - chosen),
            _ => 0.0,
        };
        let ratio = median_of_means(&without(being_first))?;
        let moved = ratio - careful;
        let interval = interval.map(|[low, high]| {
            let (low, high) = (low + moved.min(0.0), high + moved.max(0.0));
            // Rounding.
            [low.min(ratio), high.max(ratio)]
        });
        let interval = interval.map(|ends| ends.map(f64::exp));
        let times = |side: fn(&Pair) -> f64| pairs.iter().map(side).collect::<Vec<_>>();
        Some(Self {
            reference: Spread::of(&times(|p| p.reference_ms))?,
            chosen: Spread::of(&times(|p| p.chosen_ms))?,
            ratio: ratio.exp(),
            interval,
            pairs: pairs.len(),
            finding: Finding::of(interval),
        })
    }

    /// Compares two of several sides that were drawn round by round: in round n, counted from 0, in
    /// the order `turn(n, sides)`. Each of the two is given by its number and its times, one per
    /// round.
    #[must_use]
    pub fn of_rounds(
        sides: usize,
        (reference, reference_ms): (usize, &[f64]),
        (chosen, chosen_ms): (usize, &[f64]),
    ) -> Option<Self> {
        let pairs: Vec<Pair> = (0..)
            .zip(reference_ms.iter().zip(chosen_ms))
            .map(|(round, (&reference_ms, &chosen_ms))| {
                let order = turn(round, sides);
                let first = order
                    .iter()
                    .find(|&&side| side == reference || side == chosen);
                Pair {
                    reference_ms,
                    chosen_ms,
                    reference_first: first == Some(&reference),
                }
            })
            .collect();
        Self::of(&pairs)
    }

    /// Whether the sides differ.
    #[must_use]
    pub fn differs(&self) -> bool {
        matches!(self.finding, Finding::Faster | Finding::Slower)
    }

    /// The ratio in few words: "1.26x (1.22 to 1.30)", "no difference (0.98 to 1.03)", "too few
    /// frames".
    #[must_use]
    pub fn text(&self) -> String {
        let Some([low, high]) = self.interval else {
            return "too few frames".to_owned();
        };
        let interval = format!("({low:.2} to {high:.2})");
        if self.differs() {
            format!("{:.2}x {interval}", self.ratio)
        } else {
            format!("no difference {interval}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pair(reference_ms: f64, chosen_ms: f64) -> Pair {
        Pair {
            reference_ms,
            chosen_ms,
            reference_first: true,
        }
    }

    fn pairs() -> impl Strategy<Value = Vec<Pair>> {
        let any = (0.01..1e3, 0.01..1e3, any::<bool>());
        let pair = any.prop_map(|(reference_ms, chosen_ms, reference_first)| Pair {
            reference_ms,
            chosen_ms,
            reference_first,
        });
        prop::collection::vec(pair, 1..60)
    }

    proptest! {
        #[test]
        fn swapped_sides_give_the_inverse(pairs in pairs()) {
            let found = Comparison::of(&pairs).unwrap();
            let swap = |p: &Pair| Pair {
                reference_ms: p.chosen_ms,
                chosen_ms: p.reference_ms,
                reference_first: !p.reference_first,
            };
            let swapped: Vec<_> = pairs.iter().map(swap).collect();
            let swapped = Comparison::of(&swapped).unwrap();
            prop_assert!((found.ratio * swapped.ratio - 1.0).abs() < 1e-9);
            prop_assert_eq!((found.reference, found.chosen), (swapped.chosen, swapped.reference));
            let other = match found.finding {
                Finding::Faster => Finding::Slower,
                Finding::Slower => Finding::Faster,
                same => same,
            };
            prop_assert_eq!(swapped.finding, other);
        }

        #[test]
        fn neither_the_unit_nor_the_order_of_frames_matters(pairs in pairs(), unit in 0.001..1e3) {
            let found = Comparison::of(&pairs).unwrap();
            let scale = |p: &Pair| Pair {
                reference_ms: p.reference_ms * unit,
                chosen_ms: p.chosen_ms * unit,
                ..*p
            };
            let scaled: Vec<_> = pairs.iter().rev().map(scale).collect();
            let scaled = Comparison::of(&scaled).unwrap();
            prop_assert!((found.ratio / scaled.ratio - 1.0).abs() < 1e-9);
            prop_assert_eq!(found.interval.is_some(), scaled.interval.is_some());
        }

        #[test]
        fn the_interval_encloses_the_ratio_and_there_is_one_from_enough_pairs(pairs in pairs()) {
            let found = Comparison::of(&pairs).unwrap();
            prop_assert_eq!(found.interval.is_some(), pairs.len() >= crate::LEAST_PAIRS);
            if let Some([low, high]) = found.interval {
                prop_assert!(low <= found.ratio && found.ratio <= high);
            }
        }

        #[test]
        fn equal_times_are_no_difference(ms in 0.01..1e3, n in 0_usize..60) {
            let pairs = vec![pair(ms, ms); crate::LEAST_PAIRS + n];
            let found = Comparison::of(&pairs).unwrap();
            prop_assert_eq!(found.finding, Finding::NoDifference);
            prop_assert_eq!(found.text(), "no difference (1.00 to 1.00)");
        }
    }

    #[test]
    fn what_is_no_time_is_left_out() {
        assert_eq!(Comparison::of(&[]), None);
        let odd = [
            pair(0.0, 1.0),
            pair(1.0, f64::NAN),
            pair(-1.0, 1.0),
            pair(1.0, f64::INFINITY),
        ];
        assert_eq!(Comparison::of(&odd), None);
        let found = Comparison::of(&[odd[0], pair(3.0, 2.0)]).unwrap();
        assert_eq!((found.pairs, found.finding), (1, Finding::TooFew));
        assert_eq!(found.text(), "too few frames");
    }

    proptest! {
        #[test]
        fn a_ratio_is_found_whoever_is_drawn_first_how_often(
            (ratio, first) in (0.1..10.0, 0.8..1.25),
            begins in prop::collection::vec(any::<bool>(), 1..40),
        ) {
            let pairs: Vec<_> = (begins.iter())
                .map(|&reference_first| Pair {
                    reference_ms: ratio * if reference_first { first } else { 1.0 },
                    chosen_ms: if reference_first { 1.0 } else { first },
                    reference_first,
                })
                .collect();
            let found = Comparison::of(&pairs).unwrap();
            let known = begins.contains(&true) && begins.contains(&false);
            let most = if known { 1.0 + 1e-9 } else { 1.25 };
            let off = found.ratio / ratio;
            prop_assert!(off < most && 1.0 / off < most, "{} of {ratio}", found.ratio);
        }
    }

    #[test]
    fn a_slower_side_says_so() {
        let found = Comparison::of_rounds(3, (2, &[1.0; 20]), (0, &[2.0; 20])).unwrap();
        assert_eq!(found.finding, Finding::Slower);
        assert_eq!(found.text(), "0.50x (0.50 to 0.50)");
    }
}
