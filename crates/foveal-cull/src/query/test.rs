//! A rectangle with a depth against the buffer.

use crate::depth::{BLOCK, DepthBuffer, SAMPLES, STATE_EMPTY};

/// Pixels from `x0, y0` to `x1, y1`, inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PixelRect {
    pub(crate) x0: u32,
    pub(crate) y0: u32,
    pub(crate) x1: u32,
    pub(crate) y1: u32,
}

impl PixelRect {
    /// Every pixel that the rectangle (samples) touches, clamped to the screen.
    #[inline(always)]
    pub(crate) fn from_samples(
        x0: f32,
        y0: f32,
        x1: f32,
        y1: f32,
        width: u32,
        height: u32,
    ) -> Self {
        let scale = 1.0 / SAMPLES as f32;
        // Float casts saturate, and give 0 for what is left of the screen.
        Self {
            x0: ((x0 * scale) as u32).min(width - 1),
            y0: ((y0 * scale) as u32).min(height - 1),
            x1: ((x1 * scale) as u32).min(width - 1),
            y1: ((y1 * scale) as u32).min(height - 1),
        }
    }
}

/// Whether everything at `code` or farther is hidden in the rectangle.
#[inline]
pub(crate) fn hidden(buffer: &DepthBuffer, rect: PixelRect, code: i16) -> bool {
    let (bx0, bx1) = (rect.x0 / BLOCK, rect.x1 / BLOCK);
    let (by0, by1) = (rect.y0 / BLOCK, rect.y1 / BLOCK);
    for by in by0..=by1 {
        let row = (by * buffer.blocks_x) as usize;
        for bx in bx0..=bx1 {
            let b = row + bx as usize;
            if code < buffer.min[b] {
                continue;
            }
            if buffer.state[b] == STATE_EMPTY {
                return false;
            }
            let x0 = rect.x0.max(bx * BLOCK) - bx * BLOCK;
            let x1 = rect.x1.min(bx * BLOCK + BLOCK - 1) - bx * BLOCK;
            let y0 = rect.y0.max(by * BLOCK) - by * BLOCK;
            let y1 = rect.y1.min(by * BLOCK + BLOCK - 1) - by * BLOCK;
            // The block's farthest pixel is in the rectangle if the whole block is.
            if x0 == 0 && y0 == 0 && x1 == BLOCK - 1 && y1 == BLOCK - 1 {
                return false;
            }
            let block = &buffer.depth[b].0;
            for y in y0..=y1 {
                let half = &block[(y / 2) as usize][(8 * (y % 2)) as usize..][..8];
                if half[x0 as usize..=x1 as usize].iter().any(|&d| code >= d) {
                    return false;
                }
            }
        }
    }
    true
}
