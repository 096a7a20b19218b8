//! Frames drawn in turn, one side after the other, until there is an answer.

use crate::{Comparison, Pair};

/// Below this number of pairs there is no interval, as a run of equal signs is too likely.
pub const LEAST_PAIRS: usize = 10;

/// After this number of pairs no more are drawn: what is not found by then is small.
pub const ENOUGH_PAIRS: usize = 80;

/// After these numbers of pairs the sides are compared. Not after every pair: who looks again and
/// again sees a difference some time. Four looks make two thousandths eight at most.
const LOOKS: [usize; 4] = [10, 20, 40, ENOUGH_PAIRS];

/// The order in which `sides` sides draw the frame with this number: by lot, the same on every
/// machine.
///
/// That the lot decides is what makes the comparison valid: where the sides are equal, whatever
/// else slows a frame meets either with the same chance.
#[must_use]
pub fn turn(frame: u64, sides: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..sides).collect();
    // Fisher and Yates.
    for last in (1..sides).rev() {
        let lot = mixed(frame.wrapping_mul(0x1_0001).wrapping_add(last as u64));
        order.swap(last, (lot % (last as u64 + 1)) as usize);
    }
    order
}

/// SplitMix64's mixing function.
pub(crate) fn mixed(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Pairs of times as they come, and what they said when they were last looked at.
#[derive(Clone, Debug, Default)]
pub struct Series {
    pairs: Vec<Pair>,
    found: Option<Comparison>,
}

impl Series {
    /// Adds the times of a frame. After [`ENOUGH_PAIRS`] nothing is added.
    pub fn push(&mut self, pair: Pair) {
        if self.pairs.len() == ENOUGH_PAIRS {
            return;
        }
        self.pairs.push(pair);
        if LOOKS.contains(&self.pairs.len()) && !self.is_decided() {
            self.found = Comparison::of(&self.pairs);
        }
    }

    /// How many pairs there are.
    #[must_use]
    pub fn pairs(&self) -> usize {
        self.pairs.len()
    }

    /// What the pairs said at the last look; `None` before the first.
    #[must_use]
    pub fn found(&self) -> Option<&Comparison> {
        self.found.as_ref()
    }

    /// Whether more pairs can add nothing: a difference was found, or there are enough pairs.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.is_decided() || self.pairs.len() >= ENOUGH_PAIRS
    }

    fn is_decided(&self) -> bool {
        self.found.as_ref().is_some_and(Comparison::differs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Finding;

    fn pair(reference_ms: f64) -> Pair {
        Pair {
            reference_ms,
            chosen_ms: 10.0,
            reference_first: true,
        }
    }

    #[test]
    fn each_side_is_drawn_once_a_frame_and_first_as_often_as_others() {
        for sides in 1..6 {
            let mut first = vec![0; sides];
            for frame in 0..1000 {
                let mut order = turn(frame, sides);
                first[order[0]] += 1;
                order.sort_unstable();
                assert!(order.into_iter().eq(0..sides));
            }
            let expected = 1000 / sides;
            assert!(
                first.iter().all(|&n: &usize| n.abs_diff(expected) < 60),
                "{first:?}"
            );
        }
    }

    #[test]
    fn a_series_answers_at_its_looks_and_ends() {
        let mut series = Series::default();
        for n in 1..=ENOUGH_PAIRS + 5 {
            series.push(pair(10.0));
            assert_eq!(series.pairs(), n.min(ENOUGH_PAIRS));
            let looked = LOOKS.iter().rfind(|&&look| look <= n);
            assert_eq!(series.found().map(|found| found.pairs), looked.copied());
            assert_eq!(series.is_done(), n >= ENOUGH_PAIRS);
        }
    }

    #[test]
    fn a_difference_ends_a_series() {
        let mut series = Series::default();
        for frame in 0.. {
            if series.is_done() {
                break;
            }
            series.push(Pair {
                reference_first: turn(frame, 2)[0] == 0,
                ..pair(12.0)
            });
        }
        assert_eq!(series.pairs(), LOOKS[0]);
        assert_eq!(series.found().unwrap().finding, Finding::Faster);
    }
}
