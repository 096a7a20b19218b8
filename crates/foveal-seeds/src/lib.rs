//! Small good scene files, made on the spot: the importer's tests change them, the fuzzers begin
//! with them.
//!
//! ```
//! let file = foveal_seeds::rich();
//! assert!(file.glb().starts_with(b"glTF"));
//! ```
#![forbid(unsafe_code)]
#![allow(
    clippy::unwrap_used,
    reason = "used by tests alone, which may stop at once"
)]

mod around;
mod basis;
mod compressed;
mod crc;
mod file;
pub mod pointers;
mod rich;
mod strokes;

pub use around::{seen_from_within, surrounded};
pub use basis::{ETC1S, KTX2_SIZE, UASTC, UASTC_ZSTD, ktx2_file, ktx2_texel};
pub use compressed::{
    bumpy_grid, draco_file, draco_stream, gradient, grid_file, meshopt_file, webp_file,
};
pub use crc::crc32;
pub use file::File;
pub use rich::{extended, rich};
pub use strokes::strokes;
