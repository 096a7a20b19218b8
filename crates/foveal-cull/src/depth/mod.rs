//! The occlusion buffer.

pub(crate) mod band;
pub(crate) mod block;
pub(crate) mod buffer;
pub(crate) mod hiz;
pub(crate) mod hiz_build;
pub(crate) mod hiz_layout;
pub(crate) mod slots;
