//! Composite: the samples of a tiling become one radiance per pixel.

mod nearest;

pub(crate) use nearest::NearestComposite;

use crate::gpu::Gpu;
use crate::recorder::Recorder;
use crate::shading::CoarseTargets;
use crate::targets::Targets;
use crate::{Composite, Settings};

/// The composite that the settings ask for.
#[derive(Debug)]
pub(crate) enum CompositePass {
    Nearest(NearestComposite),
}

impl CompositePass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        match settings.composite {
            Composite::Nearest | Composite::Paper | Composite::Smooth => {
                Self::Nearest(NearestComposite::new(gpu, frame_layout))
            }
        }
    }

    /// Encodes the passes: joins `from`'s samples in the radiance target.
    pub(crate) fn join(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &Targets,
        from: &CoarseTargets,
    ) {
        let radiance = &targets.radiance_view;
        match self {
            Self::Nearest(nearest) => nearest.join(recorder, from, radiance),
        }
    }
}
