//! Reference and chosen side compared while they are drawn in turn.

use foveal::FrameStats;
use foveal_measure::{Comparison, Pair, Series, turn};

use crate::viewer::Wish;

/// Frames of both sides that are drawn before any counts.
const WARM_UP: u64 = 8;

/// Pairs of frames of one view with the same settings on both sides.
#[derive(Default)]
pub(crate) struct Measuring {
    shown: Option<Wish>,
    drawn: u64,
    frames: Series,
    passes: Series,
}

impl Measuring {
    /// Begins anew where another view is shown than before.
    pub(crate) fn show(&mut self, wish: &Wish) {
        if !self
            .shown
            .as_ref()
            .is_some_and(|shown| shown.shows_the_same(wish))
        {
            *self = Self {
                shown: Some(wish.clone()),
                ..Self::default()
            };
        }
    }

    /// Which side draws the next frame first: 0 the reference, 1 the chosen one.
    pub(crate) fn order(&self) -> Vec<usize> {
        turn(self.drawn, 2)
    }

    /// Takes over what both sides took.
    pub(crate) fn add(&mut self, reference: &FrameStats, chosen: &FrameStats) {
        let reference_first = self.order().first() == Some(&0);
        self.drawn += 1;
        if self.drawn <= WARM_UP || self.frames.is_done() {
            return;
        }
        let pair = |ms: fn(&FrameStats) -> f64| Pair {
            reference_ms: ms(reference),
            chosen_ms: ms(chosen),
            reference_first,
        };
        self.frames.push(pair(|stats| stats.frame_ms));
        self.passes
            .push(pair(|stats| stats.gpu_ms.iter().map(|pass| pass.ms).sum()));
    }

    pub(crate) fn frame(&self) -> Option<&Comparison> {
        self.frames.found()
    }

    pub(crate) fn passes(&self) -> Option<&Comparison> {
        self.passes.found()
    }

    pub(crate) fn is_done(&self) -> bool {
        self.frames.is_done()
    }
}
