//! Reference and chosen side compared while they are drawn in turn.

use foveal::FrameStats;
use foveal_measure::{Comparison, FrameTimes, Turns};

use super::Request;

/// What the pairs of frames say so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Compared {
    /// Pairs that count.
    pub(crate) pairs: usize,
    /// Whole frames, from the start of the processor's work until the device has finished.
    pub(crate) frame: Option<Comparison>,
    /// All passes on the device; `None` where it has no timestamps.
    pub(crate) passes: Option<Comparison>,
    /// Whether more pairs can add nothing.
    pub(crate) is_done: bool,
}

/// Pairs of one view with one reference and one choice. The moment of an animated scene may change:
/// both sides draw it.
pub(super) struct Measuring {
    request: Request,
    turns: Turns,
}

impl Measuring {
    pub(super) fn new(request: &Request) -> Self {
        Self {
            request: request.clone(),
            turns: Turns::default(),
        }
    }

    pub(super) fn is_of(&self, request: &Request) -> bool {
        self.request.has_the_sides_of(request)
    }

    /// Whether the reference is drawn first in the next pair.
    pub(super) fn reference_first(&self) -> bool {
        self.turns.reference_first()
    }

    /// Takes over what both sides took for the pair that was just drawn.
    pub(super) fn add(&mut self, reference: &FrameStats, chosen: &FrameStats) {
        self.turns.add(times(reference), times(chosen));
    }

    pub(super) fn is_done(&self) -> bool {
        self.turns.is_done()
    }

    pub(super) fn compared(&self) -> Compared {
        Compared {
            pairs: self.turns.pairs(),
            frame: self.turns.frame().cloned(),
            passes: self.turns.passes().cloned(),
            is_done: self.is_done(),
        }
    }
}

fn times(stats: &FrameStats) -> FrameTimes {
    FrameTimes {
        frame_ms: stats.frame_ms,
        passes_ms: stats.gpu_ms.iter().map(|pass| pass.ms).sum(),
    }
}
