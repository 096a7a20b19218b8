//! What a frame is drawn into.

use crate::antialias::SampleTargets;
use crate::geometry::GBuffer;
use crate::gpu::Gpu;
use crate::output::PICTURE_FORMAT;
use crate::shading::{CoarseTargets, RADIANCE_FORMAT};
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
}

impl Targets {
    /// The targets for settings that were found valid.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Self {
        let (width, height) = (settings.width, settings.height);
        let target = |label, format, usage| {
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width,
                    height,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage
                    | wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        let sampled = wgpu::TextureUsages::TEXTURE_BINDING;
        Self {
            gbuffer: GBuffer::new(gpu, width, height),
            radiance_view: target(
                "radiance",
                RADIANCE_FORMAT,
                sampled | wgpu::TextureUsages::STORAGE_BINDING,
            ),
            picture_view: target("picture", PICTURE_FORMAT, sampled),
            samples: (settings.aa != Antialiasing::None).then(|| SampleTargets::new(gpu, settings)),
            coarse: (settings.shading == Shading::Coarse)
                .then(|| CoarseTargets::new(gpu, settings)),
        }
    }

    /// Bytes of all targets.
    pub(crate) fn bytes(&self) -> u64 {
        let size = self.picture_view.texture().size();
        u64::from(size.width) * u64::from(size.height) * BYTES_PER_PIXEL
            + self.samples.as_ref().map_or(0, SampleTargets::bytes)
            + self.coarse.as_ref().map_or(0, CoarseTargets::bytes)
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
