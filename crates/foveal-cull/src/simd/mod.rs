//! Lanes: the one seam between the kernels and instruction sets.
//!
//! Kernels are written once, generic over [`Lanes`], and instantiated for the portable
//! implementation (plain arrays), for 128-bit registers (SSE2, NEON and wasm's simd128), for AVX2
//! and for AVX-512. There is no fused multiply-add and no approximate reciprocal anywhere, so that
//! every instruction set gives the same bits.

mod arrays;
mod instruction_set;
mod lanes;
pub(crate) mod portable;
mod twice;
#[cfg(test)]
mod twins;

#[cfg(target_arch = "x86_64")]
#[allow(
    unsafe_code,
    reason = "the one place for intrinsics; every method is held to the portable twin by a test"
)]
pub(crate) mod avx2;
#[cfg(target_arch = "x86_64")]
#[allow(
    unsafe_code,
    reason = "as for AVX2; held to the portable twin by the same tests"
)]
pub(crate) mod avx512;
#[cfg(target_arch = "x86_64")]
mod avx512proof;
#[cfg(target_arch = "x86_64")]
#[allow(
    unsafe_code,
    reason = "as for AVX2; held to the portable twin by the same tests"
)]
mod avx512x16;
#[cfg(any(
    target_arch = "x86_64",
    all(
        target_arch = "aarch64",
        target_feature = "neon",
        target_endian = "little"
    ),
    all(target_arch = "wasm32", target_feature = "simd128"),
))]
#[allow(
    unsafe_code,
    reason = "as for AVX2; held to the portable twin by the same tests"
)]
mod narrow;

pub(crate) use arrays::{four, larger, smaller, three, two};
pub use instruction_set::InstructionSet;
pub(crate) use lanes::{
    Depths, Doubles, F8, F16, I8, I16, Kernel, Lanes, M8, M16, Samples, Sixteen,
};
