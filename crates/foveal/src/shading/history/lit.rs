//! What a frame does with the light history.

use crate::gpu::Gpu;
use crate::stereo::EyeLayout;
use crate::{CoarseBackend, CoarseSample, Composite, DebugView, Settings, Shading};

/// Frames at rest until each pixel was shaded by itself.
pub(crate) const ROUND: u32 = 16;

/// Whether these settings keep a light history on this device.
pub(super) fn is_used(gpu: &Gpu, settings: &Settings) -> bool {
    settings.coarse.history
        // Other views of a lit frame show its tiles.
        && settings.picture.view == DebugView::Final
        && settings.shading.mode == Shading::Coarse
        && settings.coarse.composite == Composite::Light
        && settings.coarse.sample == CoarseSample::Center
        && settings.coarse.backend != CoarseBackend::Stencil
        && !gpu.is_reduced()
        && fits(gpu, settings)
}

/// What a frame does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Lit {
    /// Which of the targets are this frame's.
    pub(super) even: bool,
    /// At rest: whose turn it is.
    pub(super) turn: Option<u32>,
}

/// Texels that a listed sample can name along each side.
const LARGEST_SIDE: u32 = 1 << 14;
/// Bytes of a listed sample.
pub(super) const SAMPLE_BYTES: u64 = 8;

/// Whether the lists of a frame of this size can be bound.
pub(super) fn fits(gpu: &Gpu, settings: &Settings) -> bool {
    let (width, height) = EyeLayout::of(settings).target_size();
    if width.max(height) > LARGEST_SIDE {
        return false;
    }
    let bytes = u64::from(width) * u64::from(height) * SAMPLE_BYTES;
    bytes <= gpu.device.limits().max_storage_buffer_binding_size
}
