//! HiZ

use super::buffer::DepthBuffer;
use super::hiz_layout::place_of;
use crate::format::{BLOCK, EMPTY};
use crate::simd::{Lanes, four};

/// The summary of a finished depth buffer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coarse<'a> {
    pub(crate) buffer: &'a DepthBuffer,
}

impl<'a> Coarse<'a> {
    /// `None` where the summary is too large to be numbered by its kernel.
    pub(crate) fn new(buffer: &'a DepthBuffer) -> Option<Self> {
        (buffer.coarse.len() < 1 << 24).then_some(Self { buffer })
    }

    /// A bit per code that is farther than all that is known in its rectangle of pixels (left, top, right, bottom,
    /// inclusive) or somewhat farther, as [`crate::summary`] tells.
    #[inline(always)]
    pub(crate) fn hides<L: Lanes>(self, l: L, pixels: [L::I; 4], codes: &[i32; 8]) -> u32 {
        let block = l.isplat(BLOCK.trailing_zeros() as i32);
        let buffer = self.buffer;
        let index = place_of!(l, buffer, four!(i => l.ishr(pixels[i], block)));
        let mut at = [0; 8];
        l.istore(index, &mut at);
        let (table, mut bits) = (self.table(), 0);
        for i in 0..8 {
            bits |= u32::from(codes[i] < known(table, at[i])) << i;
        }
        bits
    }

    #[inline(always)]
    pub(crate) fn table(self) -> &'a [i16] {
        &self.buffer.coarse
    }
}

/// The farthest code at a place of the summary. One by one: a gather takes several times as long.
#[inline(always)]
pub(crate) fn known(table: &[i16], at: i32) -> i32 {
    i32::from(table.get(at as usize).copied().unwrap_or(EMPTY))
}
