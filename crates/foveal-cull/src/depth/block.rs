//! What one block of 8x8 pixels stores.

use crate::format::EMPTY;

/// Depth of 64 pixels, row by row.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct DepthBlock(pub(crate) [i16; 64]);

/// What partly covered pixels of a block have so far. Bit `8 * row + column` of a number is a pixel.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct PartialBlock {
    /// All samples, in an order that only the instruction set knows which wrote them.
    pub(crate) planes: [u64; 16],
    /// Farthest depth so far, of pixels that have anything.
    pub(crate) depth: [i16; 64],
    /// Pixel centres.
    pub(crate) center: u64,
    /// Pixels that have anything.
    pub(crate) any: u64,
}

impl DepthBlock {
    /// A block that holds nothing.
    pub(crate) const EMPTY: Self = Self([EMPTY; 64]);
}

impl PartialBlock {
    /// Nothing is covered in part.
    pub(crate) const NONE: Self = Self {
        planes: [0; 16],
        depth: [i16::MAX; 64],
        center: 0,
        any: 0,
    };
}

/// Block holds nothing; its memory is stale until the frame is complete.
pub(crate) const STATE_EMPTY: u32 = 0;
/// Block has depth.
pub(crate) const STATE_DEPTH: u32 = 1;
/// Block has depth and partly covered pixels.
pub(crate) const STATE_PARTIAL: u32 = 2;
/// And these in two layers.
pub(crate) const STATE_LAYERS: u32 = 3;

/// What a block holds: one of the states, and above its two bits the slot of its partly covered pixels, if it has any.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held(u32);

impl Held {
    pub(crate) const NOTHING: Self = Self(STATE_EMPTY);
    pub(crate) const DEPTH: Self = Self(STATE_DEPTH);

    #[inline(always)]
    pub(crate) fn partial(state: u32, slot: u32) -> Self {
        Self(slot << 2 | state)
    }

    #[inline(always)]
    pub(crate) fn state(self) -> u32 {
        self.0 & 3
    }

    #[inline(always)]
    pub(crate) fn slot(self) -> u32 {
        self.0 >> 2
    }
}
