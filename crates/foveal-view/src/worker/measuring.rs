//! Reference and chosen side compared while they are drawn in turn.

use foveal::{FrameStats, Settings};
use foveal_measure::{Comparison, Pair, Series, turn};
use foveal_scene::Camera;

/// Frames of both sides that are drawn before any counts: drivers compile, and what adapts from frame to frame adapts.
const WARM_UP: u64 = 8;

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

/// Pairs of one view with one reference and one choice. The moment of an animated scene may change: both sides draw it.
pub(super) struct Measuring {
    reference: Settings,
    chosen: Settings,
    camera: Camera,
    drawn: u64,
    frames: Series,
    passes: Series,
}

impl Measuring {
    pub(super) fn new(reference: &Settings, chosen: &Settings, camera: &Camera) -> Self {
        Self {
            reference: reference.clone(),
            chosen: chosen.clone(),
            camera: camera.clone(),
            drawn: 0,
            frames: Series::default(),
            passes: Series::default(),
        }
    }

    pub(super) fn is_of(&self, reference: &Settings, chosen: &Settings, camera: &Camera) -> bool {
        self.reference == *reference && self.chosen == *chosen && self.camera == *camera
    }

    /// Whether the reference is drawn first in the next pair.
    pub(super) fn reference_first(&self) -> bool {
        turn(self.drawn, 2)[0] == 0
    }

    /// Takes over what both sides took for the pair that was just drawn.
    pub(super) fn add(&mut self, reference: &FrameStats, chosen: &FrameStats) {
        let reference_first = self.reference_first();
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

    pub(super) fn is_done(&self) -> bool {
        self.frames.is_done()
    }

    pub(super) fn compared(&self) -> Compared {
        Compared {
            pairs: self.frames.pairs(),
            frame: self.frames.found().cloned(),
            passes: self.passes.found().cloned(),
            is_done: self.is_done(),
        }
    }
}
