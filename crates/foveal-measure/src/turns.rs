//! Two sides that draw in turn, as a window and a page show them.

use crate::{Comparison, Pair, Series, turn};

/// Frames of both sides that are drawn before any counts: drivers compile, and what adapts from
/// frame to frame adapts.
pub const WARM_UP: u64 = 8;

/// The times of one frame of one side, in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTimes {
    /// The whole frame, from the start of the processor's work until the device has finished.
    pub frame_ms: f64,
    /// All passes on the device together; 0 where it has no timestamps.
    pub passes_ms: f64,
}

/// A reference and a chosen side of one view: which one draws first, and what their times say so
/// far.
#[derive(Clone, Debug, Default)]
pub struct Turns {
    drawn: u64,
    frames: Series,
    passes: Series,
}

impl Turns {
    /// Whether the reference is drawn first in the next pair.
    #[must_use]
    pub fn reference_first(&self) -> bool {
        turn(self.drawn, 2).first() == Some(&0)
    }

    /// Takes over the times of the pair that was just drawn. The first [`WARM_UP`] pairs do not
    /// count, nor do those after the end.
    pub fn add(&mut self, reference: FrameTimes, chosen: FrameTimes) {
        let reference_first = self.reference_first();
        self.drawn += 1;
        if self.drawn <= WARM_UP || self.is_done() {
            return;
        }
        let pair = |ms: fn(&FrameTimes) -> f64| Pair {
            reference_ms: ms(&reference),
            chosen_ms: ms(&chosen),
            reference_first,
        };
        self.frames.push(pair(|times| times.frame_ms));
        self.passes.push(pair(|times| times.passes_ms));
    }

    /// How many pairs count.
    #[must_use]
    pub fn pairs(&self) -> usize {
        self.frames.pairs()
    }

    /// The comparison of whole frames; `None` before the first look.
    #[must_use]
    pub fn frame(&self) -> Option<&Comparison> {
        self.frames.found()
    }

    /// The comparison of all passes on the device; `None` before the first look, and without
    /// timestamps.
    #[must_use]
    pub fn passes(&self) -> Option<&Comparison> {
        self.passes.found()
    }

    /// Whether more pairs can add nothing.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.frames.is_done()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ENOUGH_PAIRS, Finding, LEAST_PAIRS};

    fn times(ms: f64) -> FrameTimes {
        FrameTimes {
            frame_ms: ms,
            passes_ms: 0.5 * ms,
        }
    }

    #[test]
    fn the_warm_up_does_not_count_and_a_difference_ends_it() {
        let mut turns = Turns::default();
        for drawn in 1..=WARM_UP + LEAST_PAIRS as u64 + 3 {
            // A slow start would hide the difference.
            let slow = if drawn <= WARM_UP { 1000.0 } else { 0.0 };
            turns.add(times(12.0), times(10.0 + slow));
            let counted = drawn.saturating_sub(WARM_UP).min(LEAST_PAIRS as u64);
            assert_eq!(turns.pairs() as u64, counted);
        }
        assert!(turns.is_done());
        assert_eq!(turns.frame().unwrap().finding, Finding::Faster);
        assert_eq!(turns.passes().unwrap().finding, Finding::Faster);
    }

    #[test]
    fn equal_sides_draw_first_in_turn_and_end_at_enough_pairs() {
        let mut turns = Turns::default();
        let mut first = 0;
        while !turns.is_done() {
            first += usize::from(turns.reference_first());
            turns.add(times(10.0), times(10.0));
        }
        assert_eq!(turns.pairs(), ENOUGH_PAIRS);
        assert!((20..68).contains(&first), "{first}");
    }
}
