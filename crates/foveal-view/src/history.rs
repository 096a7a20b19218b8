//! The last frames' times.

use std::collections::VecDeque;

/// As many as the graph shows.
const FRAMES: usize = 120;

#[derive(Clone, Debug, Default)]
pub(crate) struct History {
    frame_ms: VecDeque<f64>,
}

impl History {
    pub(crate) fn push(&mut self, frame_ms: f64) {
        if self.frame_ms.len() == FRAMES {
            self.frame_ms.pop_front();
        }
        self.frame_ms.push_back(frame_ms);
    }

    pub(crate) fn clear(&mut self) {
        self.frame_ms.clear();
    }

    pub(crate) fn frames(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.frame_ms.iter().copied()
    }

    /// The median, and the mean of the slowest hundredth (of the slowest frame, where there are
    /// fewer than 100).
    pub(crate) fn median_and_slowest(&self) -> Option<(f64, f64)> {
        let mut sorted: Vec<f64> = self.frames().collect();
        sorted.sort_by(f64::total_cmp);
        let median = *sorted.get(sorted.len() / 2)?;
        let slow = sorted.len().div_ceil(100);
        let slowest: f64 = sorted[sorted.len() - slow..].iter().sum();
        Some((median, slowest / slow as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_slow_frame_shows_in_the_slowest_and_not_in_the_median() {
        let mut history = History::default();
        assert_eq!(history.median_and_slowest(), None);
        for i in 0..150 {
            history.push(if i == 140 { 50.0 } else { 10.0 });
        }
        assert_eq!(history.frames().len(), FRAMES);
        // Two of 120 are the slowest hundredth.
        assert_eq!(history.median_and_slowest(), Some((10.0, 30.0)));
    }
}
