//! Where each eye has its picture in a target.

use super::{Drawn, Submission};
use crate::geometry::Window;
use crate::{Settings, Shading};

/// The pictures of one or two eyes, side by side in a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct EyeLayout {
    /// 1 or 2.
    pub(crate) eyes: u32,
    /// Width of one eye's picture in pixels.
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// First column of the right eye's picture: the width, or more where no quad of 2 x 2 pixels, and
    /// no coarse block, is to span both.
    pub(crate) stride: u32,
}

impl EyeLayout {
    pub(crate) fn of(settings: &Settings) -> Self {
        let coarsest = match settings.shading.mode {
            // Devices find mip levels by quads: each eye's lie as those of one eye do.
            Shading::Full => 1,
            // Samples stand for 4 x 4 pixels at most, and every fourth quad across is probed.
            Shading::Variable => 3,
            // The rate map's cells are 2 x 2 pixels at least.
            Shading::Coarse => u32::from(settings.coarse.coarsest_level).max(1),
        };
        let width = settings.picture.width;
        Self {
            eyes: 1 + u32::from(settings.is_stereo() && !settings.is_seen_alike()),
            width,
            height: settings.picture.height,
            stride: width
                .checked_next_multiple_of(1 << coarsest)
                .unwrap_or(width),
        }
    }

    /// Width and height of the targets in texels.
    pub(crate) fn target_size(&self) -> (u32, u32) {
        let before = self.stride.saturating_mul(self.eyes - 1);
        (before.saturating_add(self.width), self.height)
    }

    /// The part of a window onto the whole target that `drawn` goes to.
    pub(crate) fn window_of(&self, drawn: Drawn, window: Window) -> Window {
        let eye = match drawn {
            Drawn::ForEye(eye) => eye,
            // A layer holds one eye's picture alone; there is no other window.
            Drawn::ForEachLayer => return Window::sized(self.width, self.height),
            Drawn::Once | Drawn::Twice => return window,
        };
        let part = window.part;
        let scale = window.frame[2] / self.target_size().0 as f32;
        let first = eye * self.stride;
        let low = (first as f32 * scale).round() as u32;
        let end = ((first + self.width) as f32 * scale).round() as u32;
        Window {
            part: [part[0] + low, part[1], end - low, part[3]],
            ..window
        }
    }

    /// Width and height of what geometry is drawn into, and its layers.
    pub(crate) fn layers(&self, submission: Submission) -> ((u32, u32), u32) {
        match submission {
            Submission::Multiview => ((self.stride, self.height), self.eyes),
            _ => (self.target_size(), 1),
        }
    }

    /// Pixels of all eyes' pictures.
    pub(crate) fn pixels(&self) -> u64 {
        (u64::from(self.width) * u64::from(self.height)).saturating_mul(self.eyes.into())
    }
}
