//! Hooks for the crate's own tests and fuzz targets. Not part of the interface.
//!
//! Needs the feature `testing`.

use crate::occluder::{MESH_HEADER, seal};
use crate::query::moving::OccludeeSet;

/// Gives changed bytes of a baked mesh the length and the checksum that fit them, so that a test
/// reaches what is behind these checks. Shorter bytes than a header stay as they are.
pub fn seal_mesh_bytes(bytes: &mut [u8]) {
    if bytes.len() >= MESH_HEADER {
        let length = (bytes.len() as u64).to_le_bytes();
        bytes[16..24].copy_from_slice(&length);
        seal(bytes);
    }
}

/// From here on queries take the hierarchy of a set wherever it fits, also where a list is faster.
pub fn prefer_tree(set: &mut OccludeeSet) {
    set.prefer_tree();
}
