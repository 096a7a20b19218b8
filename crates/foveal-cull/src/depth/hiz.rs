//! Look-ups in the HiZ of a complete frame.

use super::buffer::OcclusionBuffer;
use super::hiz_layout::hiz_index;
use crate::format::{BLOCK, EMPTY};
use crate::simd::{I8, Lanes, four};

/// The HiZ of a complete frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hiz<'a> {
    pub(crate) buffer: &'a OcclusionBuffer,
}

impl<'a> Hiz<'a> {
    /// `None` where the table is too large for the 24-bit arithmetic of [`hiz_index`].
    pub(crate) fn new(buffer: &'a OcclusionBuffer) -> Option<Self> {
        (buffer.hiz.len() < 1 << 24).then_some(Self { buffer })
    }

    /// One bit per depth code that is farther than everything in its rectangle of pixels (left,
    /// top, right, bottom, inclusive). Conservative: the look-up may cover a somewhat larger
    /// rectangle.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn occluded<L: Lanes>(self, l: L, pixels: [I8<L>; 4], codes: &[i32; 8]) -> u32 {
        let block = l.int(BLOCK.trailing_zeros() as i32);
        let buffer = self.buffer;
        let index = hiz_index!(l, buffer, four!(i => pixels[i] >> block));
        let mut at = [0; 8];
        index.store(&mut at);
        let (table, mut bits) = (self.table(), 0);
        for i in 0..8 {
            bits |= u32::from(codes[i] < farthest_code(table, at[i])) << i;
        }
        bits
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn table(self) -> &'a [i16] {
        &self.buffer.hiz
    }
}

/// The farthest depth code at an index of the table. Scalar on purpose: gathers take several times
/// as long.
#[cfg_attr(not(unoptimized), inline(always))]
pub(crate) fn farthest_code(table: &[i16], at: i32) -> i32 {
    i32::from(table.get(at as usize).copied().unwrap_or(EMPTY))
}
