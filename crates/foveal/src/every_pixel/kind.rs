//! Whether passes are drawn or dispatched.

use crate::gpu::Gpu;
use crate::{LightingPass, Settings};

/// Pixels on each side of a dispatch's workgroup.
pub(super) const TILE: u32 = 8;

impl LightingPass {
    /// The kind of pass that this is on a device: `Fragment` or `Compute`.
    #[must_use]
    pub fn resolved(self, gpu: &Gpu) -> Self {
        match self {
            Self::Compute if !gpu.is_reduced() => Self::Compute,
            // docs/decisions/0256-lighting-by-compute.md.
            Self::Auto if !gpu.is_reduced() && gpu.is_discrete() => Self::Compute,
            _ => Self::Fragment,
        }
    }
}

/// Whether passes are dispatched.
pub(super) fn dispatches(gpu: &Gpu, settings: &Settings) -> bool {
    settings.lighting.pass.resolved(gpu) == LightingPass::Compute
}
