//! The content of one block of 8x8 pixels.

use crate::format::EMPTY;

/// Depth codes of 64 pixels, row by row.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct DepthBlock(pub(crate) [i16; 64]);

/// The partial coverage of a block. Bit `8 * row + column` of a number stands for a pixel.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct PartialBlock {
    /// Covered samples as bit planes, in an order that only the instruction set knows that wrote
    /// them.
    pub(crate) bits: [u64; 16],
    /// Farthest depth code so far, for pixels in `any`.
    pub(crate) depth: [i16; 64],
    /// Covered pixel centres.
    pub(crate) center: u64,
    /// Pixels with partial coverage.
    pub(crate) any: u64,
}

impl DepthBlock {
    /// A block without depth.
    pub(crate) const EMPTY: Self = Self([EMPTY; 64]);
}

impl PartialBlock {
    /// No partial coverage.
    pub(crate) const NONE: Self = Self {
        bits: [0; 16],
        depth: [i16::MAX; 64],
        center: 0,
        any: 0,
    };
}

/// The block holds nothing. Its memory is stale until the frame is complete.
pub(crate) const KIND_EMPTY: u32 = 0;
/// The block has depth.
pub(crate) const KIND_DEPTH: u32 = 1;
/// The block has depth, and pixels with partial coverage.
pub(crate) const KIND_PARTIAL: u32 = 2;
/// The block has depth, and pixels with partial coverage in two layers.
pub(crate) const KIND_LAYERS: u32 = 3;

/// The state of a block: its kind in the two lowest bits, and above them the slot of its partial
/// coverage, if it has any.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockState(u32);

impl BlockState {
    pub(crate) const EMPTY: Self = Self(KIND_EMPTY);
    pub(crate) const DEPTH: Self = Self(KIND_DEPTH);

    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn partial(state: u32, slot: u32) -> Self {
        Self(slot << 2 | state)
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn kind(self) -> u32 {
        self.0 & 3
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn slot(self) -> u32 {
        self.0 >> 2
    }
}
