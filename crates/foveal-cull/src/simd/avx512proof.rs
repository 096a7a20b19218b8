//! The proof that a CPU has AVX-512, which the lanes of eight and of sixteen need.

use super::avx2::Avx2;

/// Proof that the CPU has AVX-512 F, BW, DQ and VL, and AVX2.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(Avx2);

impl Avx512 {
    /// The proof, where it holds.
    pub(crate) fn detect() -> Option<Self> {
        let all = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        Avx2::detect().filter(|_| all).map(Self)
    }

    /// The lanes of AVX2, which the same proof covers.
    #[inline(always)]
    pub(super) fn avx2(self) -> Avx2 {
        self.0
    }
}
