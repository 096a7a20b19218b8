//! What the rate map is drawn to.

use crate::Settings;
use crate::every_pixel::LevelPass;
use crate::gpu::{Gpu, MipChain};
use crate::stereo::EyeLayout;

/// The rate map of one frame size: of each block a level, and whether a geometric edge lies in it
/// (`shared/blocks.wgsl`).
#[derive(Debug)]
pub(crate) struct RateTargets {
    /// Minimum of the requested levels per block, from level 1 on.
    pub(crate) pyramid: MipChain,
    /// Owner level of 2 x 2 pixels each: a single level, 1.
    pub(crate) owner: MipChain,
}

impl RateTargets {
    /// Bytes of both.
    pub(crate) fn bytes(&self) -> u64 {
        self.pyramid.bytes() + self.owner.bytes()
    }

    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Self {
        let size = EyeLayout::of(settings).target_size();
        // Level 0 tiles are found by their parent, so there is always one.
        let coarsest = u32::from(settings.coarse.coarsest_level).max(1);
        let (format, written) = LevelPass::format(gpu, settings);
        let usage = written | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let chain = |label, last| MipChain::new(gpu, label, size, 1..=last, format, usage);
        Self {
            pyramid: chain("rate pyramid", coarsest),
            owner: chain("owner levels", 1),
        }
    }
}
