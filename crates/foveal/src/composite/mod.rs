//! Composite: the samples of a tiling become one radiance per pixel.
//!
//! All take level-0 tiles, which are pixels, as they are. `light` puts each pixel's own surface
//! into the samples' light; the others join the samples' radiance: `nearest` repeats a tile's
//! sample; `paper` is the interpolation of the original method; `smooth` is continuous, exact
//! where radiance is an affine function of the position, and reads the G-buffer so as not to mix
//! surfaces.

mod light;
mod light_targets;
mod patch_targets;
mod patches;
mod smooth;
mod taps;

pub(crate) use crate::formats::LIGHT_FORMAT;
pub(crate) use light_targets::LightTargets;
pub(crate) use patch_targets::{PatchTargets, check_limits};

#[cfg(test)]
mod edges_tests;
#[cfg(test)]
mod light_tests;
#[cfg(test)]
mod light_twin;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;

#[cfg(test)]
pub(crate) use light_twin::deviation_from_bits;

use light::LightComposite;
use smooth::SmoothComposite;
use taps::TapComposite;

use crate::gpu::Gpu;
use crate::recorder::Recorder;
use crate::shading::CoarseTargets;
use crate::targets::Targets;
use crate::{Composite, Settings, shader};

/// The composite that the settings ask for.
#[derive(Debug)]
pub(crate) enum CompositePass {
    Light(LightComposite),
    Taps(TapComposite),
    Smooth(SmoothComposite),
}

impl CompositePass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let taps = |shader, entry| Self::Taps(TapComposite::new(gpu, frame_layout, shader, entry));
        match settings.coarse.composite {
            // Where all tiles are pixels there is nothing to smooth.
            Composite::Smooth if settings.coarse.coarsest_level > 0 => {
                Self::Smooth(SmoothComposite::new(gpu, settings, frame_layout))
            }
            Composite::Light => Self::Light(LightComposite::new(gpu, settings, frame_layout)),
            Composite::Paper => taps(shader::COMPOSITE_PAPER, "paper"),
            Composite::Nearest | Composite::Smooth => taps(shader::COMPOSITE_NEAREST, "nearest"),
        }
    }

    /// Encodes the passes: joins `from`'s samples in the radiance target.
    pub(crate) fn join(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &Targets,
        from: &CoarseTargets,
    ) {
        match (self, &from.patches, &from.light) {
            (Self::Taps(taps), ..) => taps.join(recorder, from, &targets.radiance_view),
            (Self::Smooth(smooth), Some(patches), _) => {
                smooth.join(recorder, targets, from, patches);
            }
            (Self::Light(composite), _, Some(light)) => {
                composite.join(recorder, targets, from, light);
            }
            // Targets and passes are made for the same settings.
            (Self::Smooth(_), None, _) | (Self::Light(_), _, None) => {}
        }
    }

    /// Encodes what follows once the pixels that [`Self::join`] left were shaded.
    pub(crate) fn follow(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &Targets,
        light: &LightTargets,
    ) {
        if let Self::Light(composite) = self {
            composite.follow(recorder, targets, light);
        }
    }
}
