//! What surfaces that light passes read and write besides the radiance.

use crate::Settings;
use crate::formats::{DEPTH_FORMAT, RADIANCE_FORMAT};
use crate::gpu::{Gpu, MipChain, layered_target};
use crate::stereo::{EyeLayout, Submission};

/// The coarsest level of the picture behind: blocks of 64 x 64 pixels.
pub(super) const COARSEST: u32 = 6;

/// First column of the right eye's picture in the picture behind. No texel of the coarsest level
/// spans both eyes' (`behind.wgsl`).
pub(super) fn behind_stride(width: u32) -> u32 {
    let block = 1 << COARSEST;
    width.checked_next_multiple_of(block).unwrap_or(width)
}

/// What transmissive surfaces read and write besides the radiance.
#[derive(Debug)]
pub(crate) struct TransmissionTargets {
    /// The picture without them; level l holds means over about 2^l pixels.
    pub(super) behind: MipChain,
    /// The G-buffer's depth, and theirs. The reduced renderer draws theirs to the G-buffer's own,
    /// as WebGL 2 copies no depth: nothing reads it before geometry is drawn anew.
    pub(super) depth_view: Option<wgpu::TextureView>,
}

impl TransmissionTargets {
    pub(crate) fn new(gpu: &Gpu, settings: &Settings, submission: Submission) -> Self {
        let layout = EyeLayout::of(settings);
        let (size, layers) = layout.layers(submission);
        let read = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let format = RADIANCE_FORMAT;
        let stride = behind_stride(layout.width);
        let before = stride.saturating_mul(layout.eyes - 1);
        let whole = (before.saturating_add(layout.width), layout.height);
        let label = "picture behind";
        let copied = wgpu::TextureUsages::COPY_DST;
        Self {
            behind: MipChain::new(gpu, label, whole, 0..=COARSEST, format, read),
            depth_view: (!gpu.is_reduced())
                .then(|| layered_target(gpu, "forward depth", size, layers, DEPTH_FORMAT, copied)),
        }
    }

    pub(crate) fn bytes(&self) -> u64 {
        let depth = self.depth_view.as_ref().map_or(0, |view| {
            let size = view.texture().size();
            let texels = u64::from(size.width) * u64::from(size.height);
            texels * u64::from(size.depth_or_array_layers) * 4
        });
        self.behind.bytes() + depth
    }
}
