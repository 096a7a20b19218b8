//! What a frame is drawn into.

use crate::ambient::AmbientTargets;
use crate::antialias::SampleTargets;
use crate::forward::TransmissionTargets;
use crate::geometry::{GBuffer, VisibilityTargets};
use crate::gpu::{self, Gpu};
use crate::output::PICTURE_FORMAT;
use crate::shading::{CoarseTargets, RADIANCE_FORMAT, VariableTargets};
use crate::stereo::{EyeLayout, Submission};
use crate::{Antialiasing, Settings, Shading};

/// G-buffer, radiance, picture.
const BYTES_PER_PIXEL: u64 = 28 + 8 + 4;

/// The targets of one frame size.
#[derive(Debug)]
pub(crate) struct Targets {
    pub(crate) gbuffer: GBuffer,
    /// Linear radiance, before exposure.
    pub(crate) radiance_view: wgpu::TextureView,
    /// Where blended surfaces are drawn over it, if that is to a layer for each eye.
    pub(crate) radiance_layers: Option<wgpu::TextureView>,
    /// Once something has been drawn that light passes.
    pub(crate) transmission: Option<TransmissionTargets>,
    /// The eyes' pictures.
    pub(crate) picture_view: wgpu::TextureView,
    /// The picture as the output shows it, where that is not the same.
    pub(crate) shown_view: Option<wgpu::TextureView>,
    /// What anti-aliasing needs besides.
    pub(crate) samples: Option<SampleTargets>,
    /// With coarse shading.
    pub(crate) coarse: Option<CoarseTargets>,
    /// With variable shading.
    pub(crate) variable: Option<VariableTargets>,
    /// With ambient occlusion.
    pub(crate) ambient: Option<AmbientTargets>,
}

impl Targets {
    /// The targets for settings that were found valid.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings, submission: Submission) -> Self {
        let layout = EyeLayout::of(settings);
        let (width, height) = layout.target_size();
        let (size, layers) = layout.layers(submission);
        let layered = submission == Submission::Multiview;
        let copied = if layered {
            wgpu::TextureUsages::COPY_DST
        } else {
            wgpu::TextureUsages::empty()
        };
        let target = |label, format, usage| gpu::target(gpu, label, (width, height), format, usage);
        Self {
            gbuffer: GBuffer::new(gpu, settings.geometry.path, size, layers),
            radiance_view: target(
                "radiance",
                RADIANCE_FORMAT,
                if gpu.is_reduced() {
                    wgpu::TextureUsages::empty()
                } else {
                    wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_DST
                },
            ),
            radiance_layers: layered.then(|| {
                let label = "radiance of blended surfaces";
                gpu::layered_target(gpu, label, size, layers, RADIANCE_FORMAT, copied)
            }),
            transmission: None,
            picture_view: target("picture", PICTURE_FORMAT, wgpu::TextureUsages::empty()),
            shown_view: settings.is_stereo().then(|| {
                let (size, none) = (settings.picture_size(), wgpu::TextureUsages::empty());
                gpu::target(gpu, "shown picture", size, PICTURE_FORMAT, none)
            }),
            samples: (settings.antialiasing.mode != Antialiasing::None)
                .then(|| SampleTargets::new(gpu, settings)),
            coarse: (settings.shading.mode == Shading::Coarse)
                .then(|| CoarseTargets::new(gpu, settings)),
            variable: (settings.shading.mode == Shading::Variable)
                .then(|| VariableTargets::new(gpu, settings)),
            ambient: AmbientTargets::new(gpu, settings),
        }
    }

    /// Makes room for blended surfaces at the sub-samples, where there are sub-samples and no room.
    pub(crate) fn blend_samples(&mut self, gpu: &Gpu, settings: &Settings) {
        if let Some(samples) = &mut self.samples
            && let Some(blending) = samples.blending(gpu, settings)
        {
            *samples = blending;
        }
    }

    /// The picture as it is shown.
    pub(crate) fn shown(&self) -> &wgpu::TextureView {
        self.shown_view.as_ref().unwrap_or(&self.picture_view)
    }

    /// Bytes of all targets.
    pub(crate) fn bytes(&self) -> u64 {
        let texels = |view: &wgpu::TextureView| {
            let size = view.texture().size();
            u64::from(size.width) * u64::from(size.height) * u64::from(size.depth_or_array_layers)
        };
        let visibility = self.gbuffer.visibility.as_ref();
        texels(&self.picture_view) * BYTES_PER_PIXEL
            + self.shown_view.as_ref().map_or(0, texels) * 4
            + self.radiance_layers.as_ref().map_or(0, texels) * 8
            + (self.transmission.as_ref()).map_or(0, TransmissionTargets::bytes)
            + visibility.map_or(0, VisibilityTargets::bytes)
            + self.samples.as_ref().map_or(0, SampleTargets::bytes)
            + self.coarse.as_ref().map_or(0, CoarseTargets::bytes)
            + self.variable.as_ref().map_or(0, VariableTargets::bytes)
            + self.ambient.as_ref().map_or(0, AmbientTargets::bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_targets_count_too() {
        let bytes = |shading| {
            let settings = crate::testing::small(64, 64).with(|s| s.shading.mode = shading);
            Targets::new(crate::testing::gpu(), &settings, Submission::Mono).bytes()
        };
        let full = bytes(Shading::Full);
        assert_eq!(full, 64 * 64 * BYTES_PER_PIXEL);
        // Its samples alone are 8 bytes a pixel on the finest of their levels.
        assert!(bytes(Shading::Coarse) > full + 64 * 64 * 8);
    }
}
