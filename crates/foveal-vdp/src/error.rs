//! What can be wrong with the input.

/// Everything that this crate refuses. Nothing here panics on input.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VdpError {
    /// A number of the display model is not finite or out of its range.
    #[error("the display's {what} is {value}, which is outside of its range ({range})")]
    Display {
        /// The quantity, with its unit.
        what: &'static str,
        /// What was given.
        value: f32,
        /// What it may be.
        range: &'static str,
    },
    /// A picture has fewer than 4 pixels or more than 16,384 in one axis.
    #[error("a picture of {width}x{height} pixels: each axis has 4 to 16384")]
    Size {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// A picture's pixels are not as many as its size says.
    #[error("{found} pixels where the size asks for {expected}")]
    PixelCount {
        /// Width times height.
        expected: usize,
        /// The length of the slice.
        found: usize,
    },
    /// The gaze is not finite, or farther from the picture than ten times its size.
    #[error("the gaze {x},{y} is not near the picture, which reaches from 0,0 to 1,1")]
    Gaze {
        /// From the left border, in widths of the picture.
        x: f32,
        /// From the upper border, in heights of the picture.
        y: f32,
    },
    /// The frame rate is outside of 5 to 1,000 frames per second.
    #[error("{0} frames per second: the rate is 5 to 1000")]
    FrameRate(f32),
    /// A video without frames.
    #[error("a video without frames")]
    NoFrames,
}
