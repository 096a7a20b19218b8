//! What is made again with the settings.

use super::{Clock, CoarseStages, Frame, Seen, Stages};
use crate::ambient::AmbientStage;
use crate::antialias::AntialiasStage;
use crate::culling::CullingStage;
use crate::forward::ForwardPass;
use crate::geometry::GeometryPass;
use crate::gpu::{ErrorTrap, Gpu};
use crate::lights::LightAssigner;
use crate::output::{EyesPass, ToneMapPass, ViewPass};
use crate::rate::RateImage;
use crate::scene::FrameBindings;
use crate::shading::{HistoryStage, ShadingPass, VariableStage};
use crate::shadow::ShadowStage;
use crate::stereo::{EyeLayout, LensFit, Submission, Trials, eyes};
use crate::targets::Targets;
use crate::{Error, Settings, Shading};
use foveal_scene::{Camera, Projection};

impl Seen {
    /// # Errors
    /// [`Error::Setting`] where a camera or a lens makes no sense.
    pub(super) fn new(settings: &Settings, frame: &Frame<'_>) -> Result<Self, Error> {
        let eyes_now = eyes(settings, frame.camera)?;
        let is_parallel = |camera: &&Camera| {
            let parallel = matches!(camera.projection, Projection::Orthographic { .. });
            settings.is_stereo() && parallel
        };
        Ok(Self {
            eyes: eyes_now,
            // Two eyes have not seen a frame in parallel projection: one eye has.
            eyes_before: match frame.previous_camera.filter(|before| !is_parallel(before)) {
                Some(before) => eyes(settings, before)?,
                None => eyes_now,
            },
            lenses: LensFit::of(settings, &eyes_now)?,
        })
    }
}

impl Stages {
    /// What is kept from frame to frame.
    pub(super) fn history(&mut self) -> Option<&mut HistoryStage> {
        self.coarse.as_mut()?.history.as_mut()
    }

    /// The next frame has the points and lines of these settings, which may be of other widths.
    pub(super) fn see_strokes(&mut self, settings: &Settings) {
        let widths = |s: &Settings| (s.geometry.point_size_px, s.geometry.line_width_px);
        if widths(&self.settings) != widths(settings)
            && let Some(variable) = &mut self.variable
        {
            variable.scene_moved();
        }
    }

    /// What is known of the light is out of date.
    pub(super) fn forget_light(&mut self) {
        if let Some(variable) = &mut self.variable {
            variable.forget();
        }
        if let Some(history) = self.history() {
            history.forget();
        }
    }

    /// The next frame follows none: what is known belongs to another scene or size.
    pub(super) fn forget(&mut self) {
        self.shadows.forget();
        self.culling.iter_mut().for_each(CullingStage::forget);
        if let Some(coarse) = &mut self.coarse {
            coarse.weigh_again();
        }
        if let Some(variable) = &mut self.variable {
            variable.weigh_again();
        }
        self.forget_light();
    }

    /// As [`Self::forget`], after another scene, which another backend may suit.
    pub(super) fn forget_scene(&mut self) {
        self.forget();
        if let Some(coarse) = &mut self.coarse {
            coarse.shading.choose_again();
        }
    }

    pub(super) async fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_bindings: &FrameBindings,
        material_layout: &wgpu::BindGroupLayout,
        rate_image: Option<&RateImage>,
        (trials, clock): (&mut Trials, Option<Clock>),
    ) -> Result<Box<Self>, Error> {
        settings.validate(&gpu.device.limits())?;
        let (submission, reason) = Submission::choose(gpu, settings, trials, clock).await?;
        let trap = ErrorTrap::new(gpu, "preparing the renderer");
        let frame = frame_bindings.layout();
        let shading = ShadingPass::new(gpu, settings, frame);
        let layout = EyeLayout::of(settings);
        let shadows = ShadowStage::new(gpu, settings, frame, material_layout);
        let stages = Box::new(Self {
            settings: settings.clone(),
            culling: CullingStage::new(settings)?,
            targets: Targets::new(gpu, settings, submission),
            lights: LightAssigner::new(gpu, layout.eyes, frame),
            shadows,
            ambient: AmbientStage::new(gpu, settings, frame_bindings.open_layout()),
            geometry: GeometryPass::new(gpu, settings, submission, frame, material_layout),
            antialias: AntialiasStage::new(gpu, settings, frame, &shading),
            coarse: (settings.shading.mode == Shading::Coarse)
                .then(|| CoarseStages::new(gpu, settings, frame, &shading, rate_image)),
            variable: (settings.shading.mode == Shading::Variable)
                .then(|| VariableStage::new(gpu, settings, frame, shading.input_layout())),
            shading,
            forward: ForwardPass::new(
                gpu,
                settings,
                submission,
                (frame, frame_bindings.open_layout()),
                material_layout,
            ),
            tone_map: ToneMapPass::new(gpu, settings, frame),
            view: ViewPass::new(gpu, settings.picture.view, frame),
            eyes_shown: EyesPass::new(gpu, settings, frame),
            submission: (submission, reason),
        });
        trap.finish().await?;
        Ok(stages)
    }
}
