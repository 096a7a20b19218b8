//! The part of the occlusion buffer that one thread draws into.

use super::block::{BlockState, DepthBlock};
use super::record::Record;
use super::slots::Slots;
use crate::simd::Lanes;

/// Some rows of blocks of the buffer, exclusively.
pub(crate) struct Band<'a> {
    pub(crate) blocks_x: u32,
    pub(crate) first_row: u32,
    pub(crate) rows: u32,
    pub(crate) depth: &'a mut [DepthBlock],
    pub(crate) min: &'a mut [i16],
    pub(crate) states: &'a mut [BlockState],
    pub(crate) slots: Slots<'a>,
    /// Whether any block has margin pixels.
    pub(crate) has_margins: bool,
    pub(crate) margin: &'a mut [u64],
    pub(crate) margin_depths: &'a mut [[i16; 2]],
    pub(crate) work: &'a mut [u32],
    /// Set where it is recorded what clusters change.
    pub(crate) record: Option<Record<'a>>,
}

/// One block of a band.
pub(crate) struct BlockMut<'a, 'b> {
    pub(crate) depth: &'a mut DepthBlock,
    pub(crate) min: &'a mut i16,
    pub(crate) state: &'a mut BlockState,
    pub(crate) slots: &'a mut Slots<'b>,
}

impl<'a> Band<'a> {
    /// Block number `i` of the band.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn block_mut(&mut self, i: usize) -> BlockMut<'_, 'a> {
        BlockMut {
            depth: &mut self.depth[i],
            min: &mut self.min[i],
            state: &mut self.states[i],
            slots: &mut self.slots,
        }
    }

    /// Whether a surface at this depth or farther changes none of the blocks (first and last,
    /// inclusive).
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn hides(&self, [x0, y0, x1, y1]: [u32; 4], code: i16) -> bool {
        for y in y0..=y1 {
            let row = (y - self.first_row) * self.blocks_x;
            let row = &self.min[(row + x0) as usize..=(row + x1) as usize];
            if row.iter().any(|&m| code > m) {
                return false;
            }
        }
        true
    }

    /// Adds work to some rows of blocks, the same for each.
    pub(crate) fn share(&mut self, rows: core::ops::Range<u32>, work: u32) {
        let each = work.div_ceil(rows.len() as u32);
        for row in &mut self.work[rows.start as usize..rows.end as usize] {
            *row += each;
        }
    }

    /// Prefetches the blocks (first and last, inclusive) that a surface of this depth may change.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn prefetch<L: Lanes>(&self, l: L, [x0, y0, x1, y1]: [u32; 4], code: i16) {
        for y in y0..=y1 {
            let row = (y - self.first_row) * self.blocks_x;
            for i in (row + x0) as usize..=(row + x1) as usize {
                if code > self.min[i] {
                    l.prefetch(&self.depth[i]);
                }
            }
        }
    }

    /// The pixels of block `i` that a surface between depths `far` and `near` must not cover, since
    /// they lie in a silhouette margin.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn margin(&self, i: usize, far: i16, near: i16) -> u64 {
        if !self.has_margins {
            return 0;
        }
        let pixels = self.margin[i];
        if pixels != 0 {
            let [border_far, border_near] = self.margin_depths[i];
            if (near < border_far) | (far > border_near) {
                return 0;
            }
        }
        pixels
    }

    /// The first `rows` rows of blocks, and the rest.
    pub(crate) fn split(self, rows: u32) -> (Band<'a>, Band<'a>) {
        let rows = rows.min(self.rows);
        let at = (rows * self.blocks_x) as usize;
        let (d0, d1) = self.depth.split_at_mut(at);
        let (m0, m1) = self.min.split_at_mut(at);
        let (h0, h1) = self.states.split_at_mut(at);
        let (p0, p1) = self.slots.split(at);
        let (e0, e1) = self.margin.split_at_mut(at);
        let (r0, r1) = self.margin_depths.split_at_mut(at);
        let (w0, w1) = self.work.split_at_mut(rows as usize);
        (
            Band {
                blocks_x: self.blocks_x,
                first_row: self.first_row,
                rows,
                depth: d0,
                min: m0,
                states: h0,
                slots: p0,
                has_margins: self.has_margins,
                margin: e0,
                margin_depths: r0,
                work: w0,
                record: None,
            },
            Band {
                blocks_x: self.blocks_x,
                first_row: self.first_row + rows,
                rows: self.rows - rows,
                depth: d1,
                min: m1,
                states: h1,
                slots: p1,
                has_margins: self.has_margins,
                margin: e1,
                margin_depths: r1,
                work: w1,
                record: None,
            },
        )
    }
}
