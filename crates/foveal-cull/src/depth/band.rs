//! The part of the buffer that one thread draws into.

use super::block::{DepthBlock, Held};
use super::slots::Pool;
use crate::simd::Lanes;

/// Some block rows of the buffer, exclusively.
pub(crate) struct Band<'a> {
    pub(crate) blocks_x: u32,
    pub(crate) first_row: u32,
    pub(crate) rows: u32,
    pub(crate) depth: &'a mut [DepthBlock],
    pub(crate) min: &'a mut [i16],
    pub(crate) held: &'a mut [Held],
    pub(crate) pool: Pool<'a>,
    /// Whether any pixels are erased.
    pub(crate) erases: bool,
    pub(crate) erased: &'a mut [u64],
    pub(crate) border: &'a mut [[i16; 2]],
    pub(crate) work: &'a mut [u32],
}

/// One block of it.
pub(crate) struct Here<'a, 'b> {
    pub(crate) depth: &'a mut DepthBlock,
    pub(crate) min: &'a mut i16,
    pub(crate) held: &'a mut Held,
    pub(crate) pool: &'a mut Pool<'b>,
}

impl<'a> Band<'a> {
    /// The block with this number.
    #[inline(always)]
    pub(crate) fn here(&mut self, i: usize) -> Here<'_, 'a> {
        Here {
            depth: &mut self.depth[i],
            min: &mut self.min[i],
            held: &mut self.held[i],
            pool: &mut self.pool,
        }
    }

    /// Whether nothing of this depth or farther can change any of the blocks (first and last, inclusive).
    #[inline(always)]
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

    /// Counts work for some rows, the same for each.
    pub(crate) fn share(&mut self, rows: core::ops::Range<u32>, work: u32) {
        let each = work.div_ceil(rows.len() as u32);
        for row in &mut self.work[rows.start as usize..rows.end as usize] {
            *row += each;
        }
    }

    /// Fetches what drawing something of this depth into the blocks (first and last, inclusive) will touch.
    #[inline(always)]
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

    /// The pixels of a block that something from `far` to `near` must leave alone.
    #[inline(always)]
    pub(crate) fn erased(&self, i: usize, far: i16, near: i16) -> u64 {
        if !self.erases {
            return 0;
        }
        let pixels = self.erased[i];
        if pixels != 0 {
            let [border_far, border_near] = self.border[i];
            if (near < border_far) | (far > border_near) {
                return 0;
            }
        }
        pixels
    }

    /// The first `rows` block rows, and the rest.
    pub(crate) fn split(self, rows: u32) -> (Band<'a>, Band<'a>) {
        let rows = rows.min(self.rows);
        let at = (rows * self.blocks_x) as usize;
        let (d0, d1) = self.depth.split_at_mut(at);
        let (m0, m1) = self.min.split_at_mut(at);
        let (h0, h1) = self.held.split_at_mut(at);
        let (p0, p1) = self.pool.split(at);
        let (e0, e1) = self.erased.split_at_mut(at);
        let (r0, r1) = self.border.split_at_mut(at);
        let (w0, w1) = self.work.split_at_mut(rows as usize);
        (
            Band {
                blocks_x: self.blocks_x,
                first_row: self.first_row,
                rows,
                depth: d0,
                min: m0,
                held: h0,
                pool: p0,
                erases: self.erases,
                erased: e0,
                border: r0,
                work: w0,
            },
            Band {
                blocks_x: self.blocks_x,
                first_row: self.first_row + rows,
                rows: self.rows - rows,
                depth: d1,
                min: m1,
                held: h1,
                pool: p1,
                erases: self.erases,
                erased: e1,
                border: r1,
                work: w1,
            },
        )
    }
}
