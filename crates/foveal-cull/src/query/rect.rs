//! The block-by-block test of a rectangle with a depth.

use super::axis_planes::AxisPlanes;
use super::faces::Faces;
use crate::depth::buffer::OcclusionBuffer;
use crate::format::{BLOCK, SAMPLES};
use crate::simd::Lanes;
use glam::Vec3;

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
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn from_samples([x0, y0, x1, y1]: [f32; 4], width: u32, height: u32) -> Self {
        let scale = 1.0 / SAMPLES as f32;
        // Float casts saturate, and give 0 for what is left of the screen.
        Self {
            x0: ((x0 * scale) as u32).min(width - 1),
            y0: ((y0 * scale) as u32).min(height - 1),
            x1: ((x1 * scale) as u32).min(width - 1),
            y1: ((y1 * scale) as u32).min(height - 1),
        }
    }

    /// First and last block, both inclusive.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn blocks(self) -> [u32; 4] {
        [
            self.x0 / BLOCK,
            self.y0 / BLOCK,
            self.x1 / BLOCK,
            self.y1 / BLOCK,
        ]
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn block_count(self) -> u32 {
        let [x0, y0, x1, y1] = self.blocks();
        (x1 - x0 + 1) * (y1 - y0 + 1)
    }

    /// The part in one block, one bit per pixel.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn bits(self, bx: u32, by: u32) -> u64 {
        let x0 = self.x0.max(bx * BLOCK) - bx * BLOCK;
        let x1 = self.x1.min(bx * BLOCK + BLOCK - 1) - bx * BLOCK;
        let y0 = self.y0.max(by * BLOCK) - by * BLOCK;
        let y1 = self.y1.min(by * BLOCK + BLOCK - 1) - by * BLOCK;
        let columns = (0xff >> (7 - x1)) & (0xffu64 << x0);
        let rows = (u64::MAX >> (8 * (7 - y1))) & (u64::MAX << (8 * y0));
        (columns * 0x0101_0101_0101_0101) & rows
    }
}

/// Whether everything at `code` or farther is occluded in the rectangle; and if not, whether the
/// box in it is (by its centre and half extent).
#[cfg_attr(not(unoptimized), inline(always))]
pub(crate) fn hidden<L: Lanes>(
    l: L,
    buffer: &OcclusionBuffer,
    rect: PixelRect,
    code: i16,
    place: Option<(&AxisPlanes, (Vec3, Vec3))>,
) -> bool {
    let mut faces: Option<Faces<L::W>> = None;
    let [bx0, by0, bx1, by1] = rect.blocks();
    for by in by0..=by1 {
        let row = (by * buffer.blocks_x) as usize;
        let farthest = &buffer.min[row + bx0 as usize..=row + bx1 as usize];
        for (bx, min) in (bx0..).zip(farthest) {
            if code < *min {
                continue;
            }
            if let Some(faces) = &faces
                && faces.miss(l.wide(), bx, by, *min)
            {
                continue;
            }
            let b = row + bx as usize;
            let here = rect.bits(bx, by);
            let depth = l.load_depths(&buffer.depth[b].0);
            let seen = here & !depth.gt(l.depth(code));
            if seen == 0 {
                continue;
            }
            let Some((planes, (center, half))) = place else {
                return false;
            };
            if faces.is_none() {
                faces = Faces::new(l.wide(), planes, center, half);
            }
            let Some(faces) = &faces else {
                return false;
            };
            if faces.seen(l, bx, by, seen, *min, depth) {
                return false;
            }
        }
    }
    true
}
