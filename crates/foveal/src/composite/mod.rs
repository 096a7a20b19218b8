//! Composite: the samples of a tiling become one radiance per pixel.
//!
//! All three take level-0 tiles, which are pixels, as they are. `nearest` repeats a tile's sample; `paper` is the
//! interpolation of the technique's source; `smooth` is continuous, exact where radiance is an affine function
//! of the position, and reads the G-buffer so as not to mix surfaces.

mod patches;
mod smooth;
mod taps;

pub(crate) use patches::{PatchTargets, check_limits};

#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;

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
    Taps(TapComposite),
    Smooth(SmoothComposite),
}

impl CompositePass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let taps = |parts, entry| Self::Taps(TapComposite::new(gpu, frame_layout, parts, entry));
        match settings.composite {
            // Where all tiles are pixels there is nothing to smooth.
            Composite::Smooth if settings.coarsest_level > 0 => {
                Self::Smooth(SmoothComposite::new(gpu, settings, frame_layout))
            }
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
        match (self, &from.patches) {
            (Self::Taps(taps), _) => taps.join(recorder, from, &targets.radiance_view),
            (Self::Smooth(smooth), Some(patches)) => smooth.join(recorder, targets, from, patches),
            // Targets and passes are made for the same settings.
            (Self::Smooth(_), None) => {}
        }
    }
}
