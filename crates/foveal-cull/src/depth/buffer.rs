//! The occlusion buffer.
//!
//! The buffer has 8x8-pixel blocks of 16-bit depth (see [`crate::format`]). The value of a pixel is
//! a *proof*: every point of a 4x4 grid over the pixel, and its centre, is covered by occluders at
//! that depth or nearer. Partly covered pixels keep their covered samples and the farthest depth
//! among them until the rest arrives, in two layers where the parts lie far apart. Every block also
//! keeps its farthest depth, which decides most tests by itself.

use super::band::Band;
use super::block::{BlockState, DepthBlock, KIND_EMPTY, PartialBlock};
use super::hiz_layout;
use super::slots::Slots;
use crate::format::{BLOCK, BLOCK_PIXELS, EMPTY};

/// The occlusion buffer of a culler.
#[derive(Clone, Debug)]
pub(crate) struct OcclusionBuffer {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) blocks_x: u32,
    pub(crate) blocks_y: u32,
    pub(crate) depth: Vec<DepthBlock>,
    /// Farthest depth code per block.
    pub(crate) min: Vec<i16>,
    pub(crate) states: Vec<BlockState>,
    /// Memory of the [`Slots`].
    partial: Vec<PartialBlock>,
    all: Vec<PartialBlock>,
    free: Vec<u32>,
    /// Pixels in silhouette margins of the cluster that is being drawn; none between clusters.
    pub(crate) margin: Vec<u64>,
    /// Farthest and nearest depth code of these margins, per block.
    pub(crate) margin_depths: Vec<[i16; 2]>,
    /// Work per row of blocks in the last frame, which decides the bands of the next.
    pub(crate) work: Vec<u32>,
    /// HiZ table of the complete frame, laid out as [`hiz_layout`] says.
    pub(crate) hiz: Vec<i16>,
    /// 1 if the memory of a block holds depth, of this frame or an earlier one; else 0.
    pub(crate) used: Vec<u8>,
    /// Drawing has begun, and `used` does not tell of it yet.
    is_unfinished: bool,
}

impl OcclusionBuffer {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let (blocks_x, blocks_y) = (width.div_ceil(BLOCK), height.div_ceil(BLOCK));
        let n = (blocks_x * blocks_y) as usize;
        Self {
            width,
            height,
            blocks_x,
            blocks_y,
            depth: vec![DepthBlock::EMPTY; n],
            min: vec![EMPTY; n],
            states: vec![BlockState::EMPTY; n],
            partial: vec![PartialBlock::NONE; n],
            all: vec![PartialBlock::NONE; n],
            free: vec![0; 2 * n],
            margin: vec![0; n],
            margin_depths: vec![[0; 2]; n],
            work: vec![0; blocks_y as usize],
            hiz: vec![EMPTY; hiz_layout::len(blocks_x, blocks_y)],
            used: vec![0; n],
            is_unfinished: false,
        }
    }

    pub(crate) fn clear(&mut self) {
        // A panic ended the last frame.
        if self.is_unfinished {
            for (used, state) in self.used.iter_mut().zip(&self.states) {
                *used |= u8::from(state.kind() != KIND_EMPTY);
            }
            self.is_unfinished = false;
        }
        self.min.fill(EMPTY);
        self.states.fill(BlockState::EMPTY);
    }

    /// Ends of `bands` bands of about equal work, as far as the last frame tells.
    pub(crate) fn cut(&self, bands: usize, ends: &mut [u32]) {
        let all = u64::from(self.blocks_y) + self.work.iter().map(|&w| u64::from(w)).sum::<u64>();
        let (mut done, mut row) = (0, 0);
        for (i, end) in ends[..bands].iter_mut().enumerate() {
            let wanted = all * (i as u64 + 1) / bands as u64;
            // Every band has a row, and leaves one for each band that follows.
            let (least, most) = (row + 1, self.blocks_y - (bands - 1 - i) as u32);
            while row < most && (row < least || done < wanted) {
                // A row goes to the side of the cut on which more of it lies.
                let here = 1 + u64::from(self.work[row as usize]);
                if row >= least && done + here / 2 > wanted {
                    break;
                }
                done += here;
                row += 1;
            }
            *end = if i + 1 == bands { self.blocks_y } else { row };
        }
    }

    /// All rows of blocks as one band. Work is counted anew.
    pub(crate) fn band(&mut self) -> Band<'_> {
        self.work.fill(0);
        self.is_unfinished = true;
        Band {
            blocks_x: self.blocks_x,
            first_row: 0,
            rows: self.blocks_y,
            depth: &mut self.depth,
            min: &mut self.min,
            states: &mut self.states,
            slots: Slots::new(&mut self.partial, &mut self.all, &mut self.free),
            has_margins: false,
            margin: &mut self.margin,
            margin_depths: &mut self.margin_depths,
            work: &mut self.work,
            record: None,
        }
    }

    /// Clears stale blocks, so that later reads need not ask for the state. Few blocks are stale.
    pub(crate) fn empty_stale(&mut self) {
        self.is_unfinished = false;
        let chunks = self.states.chunks(64).zip(self.used.chunks_mut(64));
        for ((held, used), depths) in chunks.zip(self.depth.chunks_mut(64)) {
            let nothing = |state: &BlockState| u8::from(state.kind() == KIND_EMPTY);
            let any = held
                .iter()
                .zip(&*used)
                .fold(0, |any, (h, u)| any | (nothing(h) & u));
            if any != 0 {
                for ((h, u), depth) in held.iter().zip(&*used).zip(depths) {
                    if nothing(h) & u != 0 {
                        depth.0.fill(EMPTY);
                    }
                }
            }
            for (h, u) in held.iter().zip(used) {
                *u = 1 - nothing(h);
            }
        }
    }

    /// Depth code of one pixel.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn code_of_pixel(&self, x: u32, y: u32) -> i16 {
        let block = y / BLOCK * self.blocks_x + x / BLOCK;
        if self.states[block as usize].kind() == KIND_EMPTY {
            return EMPTY;
        }
        self.code_at((block * BLOCK_PIXELS + y % BLOCK * BLOCK + x % BLOCK) as usize)
    }

    /// Depth code by index: block by block, row by row in a block. Only valid once a frame is
    /// complete.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn code_at(&self, at: usize) -> i16 {
        let size = BLOCK_PIXELS as usize;
        self.depth[at / size].0[at % size]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_an_earlier_frame_left_behind_is_emptied() {
        let mut buffer = OcclusionBuffer::new(200, 80);
        // By frame: which blocks hold depth.
        let holds: [fn(usize) -> bool; 4] = [|b| b % 3 == 0, |b| b % 2 == 0, |_| false, |b| b > 90];
        for (code, holds) in (1i16..).zip(holds) {
            buffer.clear();
            buffer.band();
            for b in (0..buffer.states.len()).filter(|&b| holds(b)) {
                buffer.states[b] = BlockState::DEPTH;
                buffer.depth[b].0.fill(code);
            }
            // A frame that a panic ends.
            if code == 2 {
                continue;
            }
            buffer.empty_stale();
            for b in 0..buffer.states.len() {
                let expected = if holds(b) { code } else { EMPTY };
                assert_eq!(buffer.depth[b].0, [expected; 64], "frame {code}, block {b}");
                assert_eq!(buffer.code_at(64 * b + 63), expected);
            }
        }
    }

    #[test]
    fn every_band_has_rows_and_about_its_share_of_the_work() {
        for (height, bands) in [(8, 1), (64, 8), (360, 2), (360, 5), (1440, 64)] {
            let mut buffer = OcclusionBuffer::new(16, height);
            for seed in 0..50u32 {
                for (i, work) in (0u32..).zip(&mut buffer.work) {
                    *work = (i.wrapping_mul(2_654_435_761).wrapping_add(seed * 97) >> 20)
                        % (1 + seed * 20);
                }
                let mut ends = [0; 64];
                buffer.cut(bands, &mut ends);
                let largest = buffer.work.iter().max().map_or(0, |&w| 1 + w);
                let all = buffer.blocks_y + buffer.work.iter().sum::<u32>();
                let mut first = 0;
                for &end in &ends[..bands] {
                    assert!(end > first, "{height} {bands} {seed}: {ends:?}");
                    let rows = &buffer.work[first as usize..end as usize];
                    let work = rows.iter().map(|w| 1 + w).sum::<u32>();
                    assert!(
                        rows.len() == 1 || work <= all / bands as u32 + 2 * largest,
                        "{height} {bands} {seed}: {ends:?}"
                    );
                    first = end;
                }
                assert_eq!(first, buffer.blocks_y);
            }
        }
    }
}
