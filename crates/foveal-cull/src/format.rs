//! The format of the occlusion buffer: samples, pixels, blocks, and 16-bit depth codes.
//!
//! Depth is `near / distance` for perspective views and linear for orthographic ones; larger is
//! nearer. A depth code is a shortened float with five bits of exponent and eleven of mantissa,
//! always rounded away from the eye.

/// Samples per pixel and axis.
pub(crate) const SAMPLES: u32 = 4;
const _: () = assert!(
    crate::limits::MAX_SIDE_PX * SAMPLES <= 16_384,
    "places within rows of samples have 15 bits"
);
/// Pixels per block side.
pub(crate) const BLOCK: u32 = 8;
/// Samples per block side.
pub(crate) const BLOCK_SAMPLES: u32 = BLOCK * SAMPLES;
/// Pixels per block.
pub(crate) const BLOCK_PIXELS: u32 = BLOCK * BLOCK;
/// The code of a pixel without depth: infinitely far.
pub(crate) const EMPTY: i16 = i16::MIN;
/// `to_bits(1.0) >> 12`, the bits of the largest code.
const ONE_BITS: i32 = 0x3f800;
/// Difference between the shifted bits of a float and its code.
pub(crate) const CODE_OFFSET: i32 = ONE_BITS - i16::MAX as i32;

/// The least depth that has a code of its own, that of a pixel without depth. What is farther is
/// taken to be there, so that it is not behind empty pixels.
pub(crate) const LEAST_DEPTH: f32 = f32::from_bits(((EMPTY as i32 + CODE_OFFSET) as u32) << 12);

/// The code of a depth, rounded away from the eye.
#[inline]
pub(crate) fn encode(depth: f32) -> i16 {
    ((depth.max(0.0).to_bits() >> 12) as i32 - CODE_OFFSET).clamp(-32768, 32767) as i16
}

/// The depth of a code.
#[inline]
pub(crate) fn decode(code: i16) -> f32 {
    if code == EMPTY {
        0.0
    } else {
        f32::from_bits(((i32::from(code) + CODE_OFFSET) << 12) as u32)
    }
}
