//! Limits that are part of the interface.

/// The largest width and height of an occlusion buffer, pixels.
pub const MAX_SIDE_PX: u32 = 4096;
