//! The occlusion buffer: blocks of 16-bit depth with coverage that is still partial, and the HiZ
//! above it.
//!
//! `block` is what one block stores, `slots` where partial coverage lives, `buffer` the whole,
//! `band` the rows that one thread draws into. `hiz_layout`, `hiz_build` and `hiz` are the table
//! that rectangles are looked up in.

pub(crate) mod band;
pub(crate) mod block;
pub(crate) mod buffer;
pub(crate) mod hiz;
pub(crate) mod hiz_build;
pub(crate) mod hiz_layout;
pub(crate) mod record;
pub(crate) mod slots;
