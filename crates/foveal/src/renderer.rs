//! The renderer as its host sees it; `submit.rs` tells the frame.

use foveal_scene::{Camera, Scene};

use crate::ambient::AmbientStage;
use crate::antialias::AntialiasStage;
use crate::culling::CullingStage;
use crate::environment::{EnvironmentStage, ToBind, resolved};
use crate::forward::ForwardPass;
use crate::geometry::{DrawList, GeometryPass};
use crate::gpu::{CpuTimer, ErrorTrap, Gpu, GpuTimer};
use crate::lights::LightAssigner;
use crate::output::{EyesPass, PresentPass, ToneMapPass, Upscale, ViewPass};
use crate::rate::RateImage;
use crate::scene::{ArrayLimits, FrameBindings, SceneOnGpu, material_layout};
use crate::shading::{HistoryStage, ShadingPass, VariableStage};
use crate::shadow::ShadowStage;
use crate::stereo::{Eye, LensFit, Submission, Trials};
use crate::targets::Targets;
use crate::{Clock, Error, FrameStats, Settings, Target};
use change::Change;
use coarse::CoarseStages;
use in_flight::InFlight;

mod change;
mod coarse;
mod environment;
#[cfg(test)]
mod fault_tests;
mod in_flight;
mod mend;
mod plan;
mod results;
#[cfg(test)]
mod room_tests;
mod scenes;
#[cfg(test)]
mod settings_tests;
mod stages;
mod stats;
mod submit;
#[cfg(test)]
mod testing;

/// What changes from frame to frame besides the scene's pose.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Frame<'a> {
    /// Where the frame is seen from.
    pub camera: &'a Camera,
    /// Where the frame before was seen from, for motion vectors. Unless this is the camera that was
    /// drawn last, nothing is kept from that frame. `None` means the same place as
    /// [`camera`](Self::camera); so does an orthographic camera with two eyes.
    pub previous_camera: Option<&'a Camera>,
}

impl<'a> Frame<'a> {
    /// A frame seen from `camera`, as the one before it was.
    #[must_use]
    pub fn new(camera: &'a Camera) -> Self {
        Self {
            camera,
            previous_camera: None,
        }
    }

    /// The same, where the frame before it was seen from `previous`.
    #[must_use]
    pub fn with_previous(self, previous: impl Into<Option<&'a Camera>>) -> Self {
        Self {
            previous_camera: previous.into(),
            ..self
        }
    }
}

/// What a host lends to a renderer.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct RendererOptions {
    /// The host's clock. Without one there are no times of the CPU, no budget of culling, and ways
    /// of drawing two eyes are not timed.
    pub clock: Option<Clock>,
}

impl RendererOptions {
    /// The same with a clock.
    #[must_use]
    pub fn with_clock(self, clock: Clock) -> Self {
        Self { clock: Some(clock) }
    }
}

/// Draws scenes.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    clock: Option<Clock>,
    timer: GpuTimer,
    frame_bindings: FrameBindings,
    material_layout: wgpu::BindGroupLayout,
    /// On the heap: what makes a renderer would hold it on the stack several times.
    stages: Box<Stages>,
    /// How each way of drawing two eyes did on this device.
    trials: Trials,
    rate_image: Option<RateImage>,
    /// The stages have not got the rate image yet.
    rate_image_is_new: bool,
    environment: EnvironmentStage,
    scene: SceneOnGpu,
    draw_list: DrawList,
    present: PresentPass,
    /// As the caller has them; the stages have those at which the frame is drawn.
    settings: Settings,
    upscale: Option<Upscale>,
    frozen: bool,
    in_flight: Option<InFlight>,
    /// A call failed half way; what it may have left half made is made anew before the next frame.
    is_torn: bool,
}

/// What a frame is seen with.
struct Seen {
    eyes: [Eye; 2],
    eyes_before: [Eye; 2],
    lenses: Option<[LensFit; 2]>,
}

/// What depends on the settings.
#[derive(Debug)]
struct Stages {
    settings: Settings,
    culling: Option<CullingStage>,
    targets: Targets,
    lights: LightAssigner,
    shadows: ShadowStage,
    ambient: Option<AmbientStage>,
    geometry: GeometryPass,
    shading: ShadingPass,
    antialias: Option<AntialiasStage>,
    coarse: Option<CoarseStages>,
    variable: Option<VariableStage>,
    forward: ForwardPass,
    tone_map: ToneMapPass,
    view: Option<ViewPass>,
    eyes_shown: Option<EyesPass>,
    /// How eyes are submitted, and why so.
    submission: (Submission, String),
}

impl Renderer {
    /// Builds the pipelines and the targets for `settings`; the scene is empty, and an environment
    /// that is filtered black.
    ///
    /// # Errors
    /// [`Error::Limit`] where the device offers less than [`Gpu::required_limits`]; that or
    /// [`Error::Setting`] where the settings cannot be met on it; [`Error::OutOfMemory`] where the
    /// targets do not fit.
    pub async fn new(
        gpu: &Gpu,
        settings: &Settings,
        options: RendererOptions,
    ) -> Result<Self, Error> {
        let RendererOptions { clock } = options;
        gpu.check_limits()?;
        settings.validate(&gpu.device.limits())?;
        let trap = ErrorTrap::new(gpu, "preparing the renderer");
        let frame_bindings = FrameBindings::new(gpu, ToBind::default());
        let material_layout = material_layout(gpu);
        let upscale = Upscale::new(gpu, settings);
        let present = PresentPass::new(gpu);
        let timer = GpuTimer::new(gpu);
        let limits = ArrayLimits::of(gpu);
        let scene = SceneOnGpu::new(
            gpu,
            &Scene::default(),
            Vec::new(),
            settings,
            &material_layout,
            limits,
        );
        trap.finish().await?;
        let (timer, scene) = (timer?, scene?);
        let mut trials = Trials::default();
        let stages = Stages::new(
            gpu,
            &resolved(settings.drawn(), false),
            &frame_bindings,
            &material_layout,
            None,
            (&mut trials, clock),
        )
        .await?;
        Ok(Self {
            gpu: gpu.clone(),
            clock,
            timer,
            frame_bindings,
            material_layout,
            stages,
            trials,
            rate_image: None,
            rate_image_is_new: false,
            environment: EnvironmentStage::default(),
            scene,
            draw_list: DrawList::default(),
            present,
            settings: settings.clone(),
            upscale,
            frozen: false,
            in_flight: None,
            is_torn: false,
        })
    }

    /// The settings in force.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Takes over other settings. A change of gaze, and of the width of points and lines, makes nothing
    /// anew and keeps the light history, so that a host with an eye tracker calls this before each
    /// frame. A change of the environment's intensity and rotation, and of the radius of ambient
    /// occlusion, with or without one of these, gives up the light history alone. A change of size alone rebuilds the targets
    /// alone; any other makes all pipelines anew.
    ///
    /// Some changes take effect with the next [`Renderer::set_scene`]
    /// ([`Settings::needs_scene_again`]): another
    /// [`LightingSettings::anisotropy`](crate::LightingSettings::anisotropy); a culling with
    /// occluders ([`Culling::has_occluders`](crate::Culling::has_occluders)) after one without; and
    /// with such a culling shadows after none, which are drawn with all casters until then.
    ///
    /// # Errors
    /// As [`Renderer::new`]; the renderer keeps its old settings then.
    pub async fn set_settings(&mut self, settings: &Settings) -> Result<(), Error> {
        settings.validate(&self.gpu.device.limits())?;
        if *settings == self.settings {
            return Ok(());
        }
        // The old settings may be what does not fit: the next frame mends with the new ones.
        self.mend_as_memory_allows().await?;
        let sizes = |s: &Settings| (s.picture_size(), s.drawn().picture_size());
        let upscale = if sizes(settings) == sizes(&self.settings) {
            None
        } else {
            let trap = ErrorTrap::new(&self.gpu, "resizing the picture");
            let upscale = Upscale::new(&self.gpu, settings);
            trap.finish().await?;
            Some(upscale)
        };
        let has_own = self.scene.image_light.is_some();
        self.draw_with(&resolved(settings.drawn(), has_own)).await?;
        if let Some(upscale) = upscale {
            self.upscale = upscale;
        }
        self.settings = settings.clone();
        Ok(())
    }

    /// Takes over other settings of what is drawn.
    async fn draw_with(&mut self, settings: &Settings) -> Result<(), Error> {
        let keeps_light = |s: &Settings| HistoryStage::is_used(&self.gpu, s);
        let change = Change::between(&self.stages.settings, settings, keeps_light);
        if change == Change::Nothing {
            return Ok(());
        }
        let trap = ErrorTrap::new(&self.gpu, "copying geometry for shaders");
        let readable = (self.scene.geometry).readable(&self.gpu, settings.geometry.path);
        trap.finish().await?;
        self.scene.geometry.take_readable(readable?);
        match change {
            Change::Nothing => {}
            Change::Frame => self.stages.see_strokes(settings),
            Change::Light => self.stages.forget_light(),
            Change::Size => self.resize(settings).await?,
            Change::Stages => return self.make_stages(settings).await,
        }
        self.stages.settings = settings.clone();
        Ok(())
    }

    /// Makes what depends on the target's size for other settings, which only differ in that.
    async fn resize(&mut self, settings: &Settings) -> Result<(), Error> {
        // Its counters are read from targets that go.
        self.in_flight = None;
        let mut culling = CullingStage::new(settings)?;
        let trap = ErrorTrap::new(&self.gpu, "resizing the targets");
        let submission = self.stages.submission.0;
        let targets = Targets::new(&self.gpu, settings, submission);
        trap.finish().await?;
        self.stages.targets = targets;
        self.stages.geometry.resize(settings);
        self.stages.forward.resize(settings);
        self.keep_frozen(culling.as_mut());
        self.stages.forget();
        self.stages.culling = culling;
        Ok(())
    }

    /// Makes all stages for other settings.
    async fn make_stages(&mut self, settings: &Settings) -> Result<(), Error> {
        // Its counters are read from targets that go.
        self.in_flight = None;
        let mut stages = self.new_stages(settings, None).await?;
        self.keep_frozen(stages.culling.as_mut());
        let around = (&self.scene.environment, self.scene.image_light.as_ref());
        let environment = self.upload_environment(settings, around, None).await?;
        self.stages = stages;
        self.rate_image_is_new = false;
        self.take_environment(environment);
        Ok(())
    }

    /// Where culling is frozen, what it found last goes to the stage that takes its place.
    fn keep_frozen(&self, culling: Option<&mut CullingStage>) {
        if let (true, Some(now), Some(before)) = (self.frozen, culling, &self.stages.culling) {
            now.keep(before, &self.scene.culling);
        }
    }

    /// Takes over the picture of [`crate::RateSource::Image`]; until there is one, that source
    /// requests every pixel.
    ///
    /// # Errors
    /// [`Error::Limit`] where a side exceeds the device's textures; the renderer keeps the picture
    /// that it has then.
    pub fn set_rate_image(&mut self, image: RateImage) -> Result<(), Error> {
        let (width, height) = image.size();
        let limit = self.gpu.device.limits().max_texture_dimension_2d;
        if width.max(height) > limit {
            return Err(Error::Limit {
                what: "the larger side of the picture of rates in pixels".to_owned(),
                value: u64::from(width.max(height)),
                limit: u64::from(limit),
                hint: String::new(),
            });
        }
        self.rate_image = Some(image);
        self.rate_image_is_new = true;
        Ok(())
    }

    /// Draws one frame into the renderer's own picture and waits until it is done.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`], [`Error::Validation`]; [`Error::Setting`] where
    /// the camera makes no sense or cannot be two eyes'.
    pub async fn render(&mut self, frame: &Frame<'_>) -> Result<FrameStats, Error> {
        self.mend().await?;
        self.wake_culler();
        let seen = Seen::new(&self.stages.settings, frame)?;
        let trap = ErrorTrap::new(&self.gpu, "drawing the frame");
        let mut cpu = CpuTimer::start(self.clock);
        let submitted = self.submit(frame, &seen, None, &mut cpu);
        let in_flight = InFlight::new(&self.gpu, submitted, &self.counters(), cpu);
        let drawn = trap.finish().await;
        self.torn(drawn)?;
        let waited = in_flight.wait(&self.gpu).await;
        let (submitted, counters, frame_ms) = self.torn(waited)?;
        let trap = ErrorTrap::new(&self.gpu, "drawing the frame");
        // Frames of `render_to` before it may be finished with it.
        let gpu_ms = self.last_times();
        let stats = self.frame_stats(submitted, &counters, gpu_ms, frame_ms);
        let collected = trap.finish().await;
        self.torn(collected)?;
        // What was too small for the frame grows now.
        self.make_room().await?;
        Ok(stats)
    }

    /// Draws one frame into the host's texture, stretched to its size, and waits for nothing.
    /// Returns the stats of an earlier frame that has been finished since the last call; a host
    /// that draws all the time gets them every few frames. The host's own passes may follow at
    /// once: they are executed after these.
    ///
    /// # Errors
    /// As [`Renderer::render`]; [`Error::Validation`] where `target` cannot be drawn to.
    pub async fn render_to(
        &mut self,
        frame: &Frame<'_>,
        target: Target<'_>,
    ) -> Result<Option<FrameStats>, Error> {
        self.mend().await?;
        self.wake_culler();
        let seen = Seen::new(&self.stages.settings, frame)?;
        let trap = ErrorTrap::new(&self.gpu, "drawing the frame");
        let finished = self.finished()?;
        let mut cpu = CpuTimer::start(self.clock);
        let submitted = self.submit(frame, &seen, Some(target), &mut cpu);
        if self.in_flight.is_none() {
            self.in_flight = Some(InFlight::new(&self.gpu, submitted, &self.counters(), cpu));
        }
        // What a frame that failed has left in the targets is not carried on to the next one.
        let drawn = trap.finish().await;
        self.torn(drawn)?;
        self.make_room().await?;
        Ok(finished)
    }

    /// Wakes the threads that will soon have to rasterize occluders.
    fn wake_culler(&self) {
        if let Some(culling) = self.stages.culling.as_ref().filter(|_| !self.frozen) {
            culling.wake();
        }
    }

    /// Whether frames draw what culling found last, whatever their camera sees: to look at a result
    /// from elsewhere.
    pub fn freeze_culling(&mut self, frozen: bool) {
        if std::mem::replace(&mut self.frozen, frozen) == frozen {
            return;
        }
        // Other things may be seen from the same place.
        if let Some(variable) = &mut self.stages.variable {
            variable.scene_moved();
        }
        if let Some(history) = self.stages.history() {
            history.scene_moved();
        }
    }
}
