//! What a frame is drawn into.

use crate::antialias::SampleTargets;
use crate::geometry::{GBuffer, VisibilityTargets};
use crate::gpu::{self, Gpu};
use crate::output::PICTURE_FORMAT;
use crate::shading::{CoarseTargets, RADIANCE_FORMAT, VariableTargets};
use crate::{Antialiasing, Settings, Shading};

/// G-buffer, radiance, picture.
const BYTES_PER_PIXEL: u64 = 28 + 8 + 4;

/// The targets of one frame size.
#[derive(Debug)]
pub(crate) struct Targets {
    pub(crate) gbuffer: GBuffer,
    /// Linear radiance, before exposure.
    pub(crate) radiance_view: wgpu::TextureView,
    /// The picture.
    pub(crate) picture_view: wgpu::TextureView,
    /// What anti-aliasing needs besides.
    pub(crate) samples: Option<SampleTargets>,
    /// With coarse shading.
    pub(crate) coarse: Option<CoarseTargets>,
    /// With variable shading.
    pub(crate) variable: Option<VariableTargets>,
}

impl Targets {
    /// The targets for settings that were found valid.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Self {
        let (width, height) = (settings.width, settings.height);
        let target = |label, format, usage| gpu::target(gpu, label, (width, height), format, usage);
        Self {
            gbuffer: GBuffer::new(gpu, settings.geometry, width, height),
            radiance_view: target(
                "radiance",
                RADIANCE_FORMAT,
                wgpu::TextureUsages::STORAGE_BINDING,
            ),
            picture_view: target("picture", PICTURE_FORMAT, wgpu::TextureUsages::empty()),
            samples: (settings.aa != Antialiasing::None).then(|| SampleTargets::new(gpu, settings)),
            coarse: (settings.shading == Shading::Coarse)
                .then(|| CoarseTargets::new(gpu, settings)),
            variable: (settings.shading == Shading::Variable)
                .then(|| VariableTargets::new(gpu, settings)),
        }
    }

    /// Bytes of all targets.
    pub(crate) fn bytes(&self) -> u64 {
        let size = self.picture_view.texture().size();
        u64::from(size.width) * u64::from(size.height) * BYTES_PER_PIXEL
            + self
                .gbuffer
                .visibility
                .as_ref()
                .map_or(0, VisibilityTargets::bytes)
            + self.samples.as_ref().map_or(0, SampleTargets::bytes)
            + self.coarse.as_ref().map_or(0, CoarseTargets::bytes)
            + self.variable.as_ref().map_or(0, VariableTargets::bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_targets_count_too() {
        let bytes = |shading| {
            let settings = Settings {
                shading,
                ..crate::testing::small(64, 64)
            };
            Targets::new(crate::testing::gpu(), &settings).bytes()
        };
        let full = bytes(Shading::Full);
        assert_eq!(full, 64 * 64 * BYTES_PER_PIXEL);
        // Its samples alone are 8 bytes a pixel on the finest of their levels.
        assert!(bytes(Shading::Coarse) > full + 64 * 64 * 8);
    }
}
