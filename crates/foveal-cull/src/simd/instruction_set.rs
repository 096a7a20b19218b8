//! The instruction sets, and the dispatch of kernels to them.

use super::lanes::Kernel;
use super::portable;
#[cfg(target_arch = "x86_64")]
use super::{avx2, avx512proof as avx512};

/// An instruction set that kernels run with. All give the same results, to the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InstructionSet {
    /// Plain arrays, as the compiler vectorizes them for the target.
    Portable,
    /// 128-bit SSE2, which every x86-64 CPU has.
    Sse2,
    /// 128-bit NEON, which every 64-bit ARM CPU has (little-endian; other targets are
    /// [`Portable`](Self::Portable)).
    Neon,
    /// WebAssembly's 128-bit registers, in modules compiled with `-C target-feature=+simd128`. They
    /// cannot be detected at run time, so modules without it are [`Portable`](Self::Portable).
    Simd128,
    /// 256-bit AVX2.
    Avx2,
    /// AVX-512 (F, BW, DQ, VL): 512-bit registers for whole blocks.
    Avx512,
}

impl InstructionSet {
    /// The 128-bit instruction set that the target always has, if any.
    const NARROW: Option<Self> = if cfg!(target_arch = "x86_64") {
        Some(Self::Sse2)
    } else if cfg!(all(
        target_arch = "aarch64",
        target_feature = "neon",
        target_endian = "little"
    )) {
        Some(Self::Neon)
    } else if cfg!(all(target_arch = "wasm32", target_feature = "simd128")) {
        Some(Self::Simd128)
    } else {
        None
    };

    /// The instruction sets of this machine, the fastest last.
    pub fn available() -> impl Iterator<Item = Self> {
        let detected = [
            #[cfg(target_arch = "x86_64")]
            avx2::Avx2::detect().map(|_| Self::Avx2),
            #[cfg(target_arch = "x86_64")]
            avx512::Avx512::detect().map(|_| Self::Avx512),
        ];
        [Some(Self::Portable), Self::NARROW]
            .into_iter()
            .chain(detected)
            .flatten()
    }

    /// The fastest instruction set of this machine.
    #[must_use]
    pub fn detect() -> Self {
        Self::available().last().unwrap_or(Self::Portable)
    }

    /// Runs a kernel with this instruction set, or with the next smaller one that the machine has.
    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[cfg(target_arch = "x86_64")]
        {
            if self == Self::Avx512
                && let Some(lanes) = avx512::Avx512::detect()
            {
                return lanes.run(kernel);
            }
            if matches!(self, Self::Avx2 | Self::Avx512)
                && let Some(lanes) = avx2::Avx2::detect()
            {
                return lanes.run(kernel);
            }
        }
        #[cfg(any(
            target_arch = "x86_64",
            all(
                target_arch = "aarch64",
                target_feature = "neon",
                target_endian = "little"
            ),
            all(target_arch = "wasm32", target_feature = "simd128"),
        ))]
        if self != Self::Portable {
            return kernel.run(super::narrow::Narrow::of_target());
        }
        kernel.run(portable::Portable)
    }
}
