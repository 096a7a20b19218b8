//! The C interface of [`foveal_cull`]: software occlusion culling on the CPU.
//!
//! For C and C++. Rust programs use [`foveal_cull`] itself, whose documentation says what is
//! promised and how coordinates are meant. The header `include/foveal_cull.h` documents every
//! function; `include/foveal_cull.hpp` wraps it for C++17, and `include/moc_shim.hpp` takes the
//! calls of Masked Occlusion Culling.
//!
//! # The border
//! Everything that C can get wrong and that can be noticed is an error code: null and misaligned
//! pointers, wrong lengths, arrays for results that overlap the boxes or ids of the same call,
//! numbers that are not finite, ids of removed objects and of other sets, unknown enumerators,
//! structs of another version, an object that another thread is changing. No panic crosses the
//! border. What cannot be noticed is the caller's promise: pointers that are neither null nor valid,
//! objects that were destroyed, and arrays and structs that are shorter than said.
//!
//! Unsafe code is in the modules below, and each block says why it is sound. They only translate:
//! no algorithm is here.
#![deny(unsafe_op_in_unsafe_fn)]

mod border;
mod culler;
mod errors;
mod frame;
mod jobs;
mod learning;
mod mesh;
mod numbers;
mod occludees;
mod occluders;
mod place;
mod rebuild;
mod receivers;
mod status;
mod tree;
mod usefulness;
mod version;
mod view;

pub use culler::*;
pub use errors::*;
pub use frame::*;
pub use jobs::*;
pub use learning::*;
pub use mesh::*;
pub use occludees::*;
pub use occluders::*;
pub use rebuild::*;
pub use receivers::*;
pub use status::FovealCullStatus;
pub use tree::*;
pub use usefulness::*;
pub use version::*;
pub use view::*;
