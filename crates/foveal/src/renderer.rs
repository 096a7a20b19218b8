//! One frame, top to bottom.

use foveal_scene::{Camera, Scene};

use crate::antialias::AntialiasStage;
use crate::composite::CompositePass;
use crate::culling::{CullingCounts, CullingStage};
use crate::forward::ForwardPass;
use crate::frame::FrameUniform;
use crate::geometry::{DrawList, GeometryPass};
use crate::gpu::{
    CpuTimer, ErrorTrap, Gpu, GpuTimer, read_buffer, read_texture, submitted_work_done,
};
use crate::lights::{ClusterGrid, LightAssigner};
use crate::output::{OverlayPass, ToneMapPass, ViewPass};
use crate::rate::{RateImage, RateMapPass};
use crate::recorder::Recorder;
use crate::scene::{FrameBindings, SceneOnGpu, material_layout};
use crate::shading::{CoarseShading, CountPass, Samples, ShadingPass};
use crate::targets::Targets;
use crate::{CoarseStats, Error, FrameStats, SceneStats, Settings, Shading, Timing};

/// The caller's clock: milliseconds since any fixed moment.
pub type Clock = fn() -> f64;

/// What changes from frame to frame besides the scene's pose.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Where the frame is seen from.
    pub camera: &'a Camera,
    /// Where the frame before it was seen from, for motion vectors; `None`: from the same place.
    pub previous_camera: Option<&'a Camera>,
}

/// Draws scenes.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    clock: Option<Clock>,
    timer: GpuTimer,
    frame_bindings: FrameBindings,
    material_layout: wgpu::BindGroupLayout,
    stages: Stages,
    rate_image: Option<RateImage>,
    scene: SceneOnGpu,
    draw_list: DrawList,
}

/// What depends on the settings.
#[derive(Debug)]
struct Stages {
    settings: Settings,
    culling: Option<CullingStage>,
    targets: Targets,
    lights: LightAssigner,
    geometry: GeometryPass,
    shading: ShadingPass,
    antialias: Option<AntialiasStage>,
    coarse: Option<CoarseStages>,
    forward: ForwardPass,
    tone_map: ToneMapPass,
    view: Option<ViewPass>,
}

/// What stands in for shading every pixel.
#[derive(Debug)]
struct CoarseStages {
    rate_map: RateMapPass,
    shading: CoarseShading,
    composite: CompositePass,
    overlay: Option<OverlayPass>,
}

impl CoarseStages {
    fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame: &wgpu::BindGroupLayout,
        full: &ShadingPass,
        image: Option<&RateImage>,
    ) -> Self {
        let mut rate_map = RateMapPass::new(gpu, settings, frame);
        if let Some(image) = image {
            rate_map.set_image(gpu, image);
        }
        Self {
            rate_map,
            shading: CoarseShading::new(gpu, settings, frame, full.input_layout()),
            composite: CompositePass::new(gpu, settings, frame),
            overlay: OverlayPass::new(gpu, settings.view, frame),
        }
    }
}

impl Stages {
    async fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_bindings: &FrameBindings,
        material_layout: &wgpu::BindGroupLayout,
        rate_image: Option<&RateImage>,
    ) -> Result<Self, Error> {
        settings.validate(&gpu.device.limits())?;
        let trap = ErrorTrap::new(gpu, "preparing the renderer");
        let frame = frame_bindings.layout();
        let shading = ShadingPass::new(gpu, settings, frame);
        let stages = Self {
            settings: settings.clone(),
            culling: CullingStage::new(settings.culling, settings.width, settings.height)?,
            targets: Targets::new(gpu, settings),
            lights: LightAssigner::new(gpu, frame),
            geometry: GeometryPass::new(gpu, settings, frame, material_layout),
            antialias: AntialiasStage::new(gpu, settings, frame, &shading),
            coarse: (settings.shading == Shading::Coarse)
                .then(|| CoarseStages::new(gpu, settings, frame, &shading, rate_image)),
            shading,
            forward: ForwardPass::new(gpu, settings, frame, material_layout),
            tone_map: ToneMapPass::new(gpu, settings, frame),
            view: ViewPass::new(gpu, settings.view, frame),
        };
        trap.finish().await?;
        Ok(stages)
    }
}

impl Renderer {
    /// Builds the pipelines and the targets for `settings`; the scene is empty.
    ///
    /// # Errors
    /// [`Error::Limit`] or [`Error::Setting`] where the settings cannot be met on this device;
    /// [`Error::OutOfMemory`] where the targets do not fit.
    pub async fn new(gpu: &Gpu, settings: &Settings, clock: Option<Clock>) -> Result<Self, Error> {
        let frame_bindings = FrameBindings::new(gpu);
        let material_layout = material_layout(gpu);
        let stages = Stages::new(gpu, settings, &frame_bindings, &material_layout, None).await?;
        let scene = SceneOnGpu::new(gpu, &Scene::default(), settings, &material_layout)?;
        Ok(Self {
            gpu: gpu.clone(),
            clock,
            timer: GpuTimer::new(gpu)?,
            frame_bindings,
            material_layout,
            stages,
            rate_image: None,
            scene,
            draw_list: DrawList::default(),
        })
    }

    /// The settings in force.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.stages.settings
    }

    /// Takes over other settings. A change of size alone rebuilds the targets alone; a change of
    /// [`Settings::anisotropy`], and one to [`Culling::Occlusion`](crate::Culling::Occlusion), whose occluders are
    /// baked with the scene, takes effect with the next [`Renderer::set_scene`].
    ///
    /// # Errors
    /// As [`Renderer::new`]; the renderer keeps its old settings then.
    pub async fn set_settings(&mut self, settings: &Settings) -> Result<(), Error> {
        settings.validate(&self.gpu.device.limits())?;
        let old = &self.stages.settings;
        if *settings == *old {
            return Ok(());
        }
        self.scene.geometry.check(&self.gpu, settings.geometry)?;
        if (Settings {
            width: settings.width,
            height: settings.height,
            ..old.clone()
        }) == *settings
        {
            let culling = CullingStage::new(settings.culling, settings.width, settings.height)?;
            let trap = ErrorTrap::new(&self.gpu, "resizing the targets");
            let targets = Targets::new(&self.gpu, settings);
            trap.finish().await?;
            self.stages.culling = culling;
            self.stages.targets = targets;
            self.stages.settings = settings.clone();
            return Ok(());
        }
        self.stages = Stages::new(
            &self.gpu,
            settings,
            &self.frame_bindings,
            &self.material_layout,
            self.rate_image.as_ref(),
        )
        .await?;
        Ok(())
    }

    /// Takes over the picture of [`crate::RateSource::Image`]; until there is one, that source wishes every pixel.
    pub fn set_rate_image(&mut self, image: RateImage) {
        if let Some(coarse) = &mut self.stages.coarse {
            coarse.rate_map.set_image(&self.gpu, &image);
        }
        self.rate_image = Some(image);
    }

    /// Uploads a scene in place of the last one.
    ///
    /// # Errors
    /// [`Error::Limit`] where the scene exceeds the device's limits, [`Error::OutOfMemory`]; the renderer
    /// keeps its old scene then.
    pub async fn set_scene(&mut self, scene: &Scene) -> Result<(), Error> {
        let trap = ErrorTrap::new(&self.gpu, "uploading the scene");
        let uploaded = SceneOnGpu::new(
            &self.gpu,
            scene,
            &self.stages.settings,
            &self.material_layout,
        );
        trap.finish().await?;
        let uploaded = uploaded?;
        let geometry = self.stages.settings.geometry;
        uploaded.geometry.check(&self.gpu, geometry)?;
        let trap = ErrorTrap::new(&self.gpu, "uploading the scene's instances");
        let written = self
            .frame_bindings
            .write_instances(&self.gpu, uploaded.instance_uniforms());
        trap.finish().await?;
        written?;
        self.scene = uploaded;
        Ok(())
    }

    /// Takes over a new pose of the same scene (after [`Scene::pose`]). The pose before it becomes the
    /// previous one, from which motion vectors are taken.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub async fn update_pose(&mut self, scene: &Scene) -> Result<(), Error> {
        let trap = ErrorTrap::new(&self.gpu, "uploading the scene's pose");
        self.scene.update_pose(&self.gpu, scene);
        self.frame_bindings
            .write_instances(&self.gpu, self.scene.instance_uniforms())?;
        trap.finish().await
    }

    /// Draws one frame into the renderer's own picture and waits until it is done.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`], [`Error::Validation`].
    pub async fn render(&mut self, frame: &Frame<'_>) -> Result<FrameStats, Error> {
        let trap = ErrorTrap::new(&self.gpu, "drawing the frame");
        let mut cpu = CpuTimer::start(self.clock);
        let culled = self.submit(frame, &mut cpu);
        trap.finish().await?;
        submitted_work_done(&self.gpu).await?;
        let frame_ms = cpu.since_start_ms();
        let gpu_ms = self.timer.collect(&self.gpu);
        let coarse = self.coarse_stats(&gpu_ms).await?;
        let Stages {
            settings,
            targets,
            antialias,
            ..
        } = &self.stages;
        let pixels = u64::from(settings.width) * u64::from(settings.height);
        let lit = settings.view.is_lit();
        let mut shaded_samples = match &coarse {
            Some(coarse) => coarse.shaded_samples(),
            None => u64::from(lit) * pixels,
        };
        let mut edge_fraction = 0.0;
        if let Some(antialias) = antialias {
            let counts = antialias.counts(&self.gpu, targets).await?;
            if !antialias.needs_ordinary() && coarse.is_none() {
                shaded_samples = 0;
            }
            shaded_samples += u64::from(lit) * counts.evaluations;
            edge_fraction = counts.edge_pixels as f64 / pixels as f64;
        }
        Ok(FrameStats {
            width: settings.width,
            height: settings.height,
            cpu_ms: cpu.stages(),
            objects_visible: culled.visible,
            objects_outside: culled.outside,
            objects_occluded: culled.occluded,
            occluder_triangles: culled.occluder_triangles,
            draws: (self.draw_list.solid.len() + self.draw_list.blended.len()) as u64,
            triangles: self.draw_list.triangles,
            shaded_samples,
            edge_fraction,
            target_bytes: targets.bytes(),
            coarse,
            gpu_ms,
            frame_ms,
        })
    }

    /// What coarse shading did in the last frame, whose passes took `gpu_ms`; tells the choice of the backend.
    async fn coarse_stats(&mut self, gpu_ms: &[Timing]) -> Result<Option<CoarseStats>, Error> {
        let Stages {
            settings,
            targets,
            coarse,
            view,
            ..
        } = &mut self.stages;
        let (Some(coarse), Some(tiles), None) = (coarse, &targets.coarse, view) else {
            return Ok(None);
        };
        let counts = read_buffer(&self.gpu, &tiles.counts).await?;
        let tiles = CountPass::tiles(&counts, settings.coarsest_level);
        let pixels = u64::from(settings.width) * u64::from(settings.height);
        Ok(Some(coarse.shading.stats(tiles, pixels, gpu_ms)))
    }

    /// The frame.
    fn submit(&mut self, frame: &Frame<'_>, cpu: &mut CpuTimer) -> CullingCounts {
        let Self {
            gpu,
            timer,
            frame_bindings,
            stages,
            scene,
            draw_list,
            ..
        } = self;
        let Stages {
            settings,
            culling,
            targets,
            lights,
            geometry,
            shading,
            antialias,
            coarse,
            forward,
            tone_map,
            view,
        } = stages;

        let culled = match culling {
            Some(culling) => culling.cull(
                &scene.culling,
                frame.camera,
                settings.width,
                settings.height,
            ),
            None => CullingCounts {
                visible: scene.stats.objects,
                ..CullingCounts::default()
            },
        };
        cpu.stage("culling");

        let is_visible = |object| culling.as_ref().is_none_or(|c| c.is_visible(object));
        draw_list.build(scene, frame.camera.eye(), is_visible);
        geometry.prepare(gpu, scene, draw_list);
        forward.prepare(gpu, draw_list);
        cpu.stage("draw list");

        let clusters =
            ClusterGrid::new(settings.width, settings.height, frame.camera, &scene.lights);
        lights.reserve(gpu, &clusters);
        let before = frame.previous_camera.unwrap_or(frame.camera);
        let uniform = FrameUniform::new(
            settings,
            frame.camera,
            before,
            &scene.environment,
            &clusters,
        );
        frame_bindings.write_frame(gpu, &uniform);
        frame_bindings.write_drawn(gpu, &draw_list.drawn);
        cpu.stage("upload");

        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let recorder = &mut Recorder {
            gpu,
            encoder: &mut encoder,
            timer,
            frame: frame_bindings,
        };
        lights.assign(recorder, &scene.light_buffer, &clusters);
        if let Some(antialias) = antialias {
            let shade = settings.view.is_lit();
            antialias.draw(
                recorder, scene, draw_list, geometry, shading, lights, targets, shade,
            );
        } else {
            geometry.draw(recorder, scene, draw_list, &targets.gbuffer);
        }
        if let Some(view) = view {
            view.show(recorder, &targets.gbuffer, &targets.picture_view);
        } else if !antialias
            .as_ref()
            .is_some_and(|a| a.show(recorder, targets))
        {
            let input = shading.input(gpu, &targets.gbuffer, &scene.light_buffer, lights.bits());
            if let (Some(coarse), Some(tiles)) = (coarse.as_ref(), &targets.coarse) {
                coarse
                    .rate_map
                    .draw(recorder, settings, &targets.gbuffer, &tiles.rate);
                coarse.shading.shade(recorder, &input, tiles);
                coarse.composite.join(recorder, targets, tiles);
            } else if antialias
                .as_ref()
                .is_none_or(AntialiasStage::needs_ordinary)
            {
                let target = &targets.radiance_view;
                shading.shade(recorder, &input, Samples::EveryPixel, target);
            }
            if let Some(antialias) = antialias {
                antialias.combine(recorder, targets);
            }
            forward.draw(recorder, scene, lights.bits(), draw_list, targets);
            tone_map.map(recorder, &targets.radiance_view, &targets.picture_view);
            if let (Some(overlay), Some(tiles)) = (
                coarse.as_ref().and_then(|c| c.overlay.as_ref()),
                &targets.coarse,
            ) {
                overlay.draw(recorder, tiles, &targets.picture_view);
            }
        }
        timer.resolve(&mut encoder);
        cpu.stage("encode");

        gpu.queue.submit([encoder.finish()]);
        timer.end_frame();
        cpu.stage("submit");
        culled
    }

    /// The last frame's picture: sRGB RGBA8 rows, top to bottom, `width * height * 4` bytes, alpha 255.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`].
    pub async fn read_picture(&self) -> Result<Vec<u8>, Error> {
        let trap = ErrorTrap::new(&self.gpu, "reading the picture back");
        let bytes = read_texture(&self.gpu, self.stages.targets.picture_view.texture()).await;
        trap.finish().await?;
        bytes
    }

    /// Counts of the scene that was set last.
    #[must_use]
    pub fn scene_stats(&self) -> SceneStats {
        self.scene.stats
    }
}

#[cfg(test)]
impl Renderer {
    /// Makes coarse samples affine functions of their position from the next frame on.
    pub(crate) fn shade_affine(&mut self) {
        let stages = &mut self.stages;
        if let Some(coarse) = &mut stages.coarse {
            coarse.shading = CoarseShading::with_shaders(
                &self.gpu,
                &stages.settings,
                self.frame_bindings.layout(),
                stages.shading.input_layout(),
                crate::shader::COARSE_AFFINE,
            );
        }
    }

    pub(crate) fn geometry(&self) -> &GeometryPass {
        &self.stages.geometry
    }

    pub(crate) fn targets(&self) -> &Targets {
        &self.stages.targets
    }

    pub(crate) fn lights(&self) -> (&LightAssigner, &[crate::lights::LightUniform]) {
        (&self.stages.lights, &self.scene.lights)
    }

    /// Draws the frame again.
    pub(crate) fn redraw(&mut self, camera: &Camera) -> FrameStats {
        let frame = Frame {
            camera,
            previous_camera: None,
        };
        pollster::block_on(self.render(&frame)).expect("frame is drawn")
    }

    /// Draws the frame again in bands of `rows` rows.
    pub(crate) fn redraw_in_bands(&mut self, camera: &Camera, rows: u32) -> FrameStats {
        let settings = &self.stages.settings;
        let targets = crate::antialias::SampleTargets::in_bands(&self.gpu, settings, rows);
        self.stages.targets.samples = Some(targets);
        self.redraw(camera)
    }

    /// Shades the last frame's G-buffer again, sample by sample from a list, into its radiance target.
    pub(crate) fn shade_list(&mut self, texels: &[(u32, u32)]) {
        let Self {
            gpu,
            timer,
            frame_bindings,
            stages,
            scene,
            ..
        } = self;
        let targets = &stages.targets;
        let list = crate::shading::SampleList::from_texels(gpu, texels);
        let input = stages.shading.input(
            gpu,
            &targets.gbuffer,
            &scene.light_buffer,
            stages.lights.bits(),
        );
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let recorder = &mut Recorder {
            gpu,
            encoder: &mut encoder,
            timer,
            frame: frame_bindings,
        };
        stages.shading.shade(
            recorder,
            &input,
            Samples::List(&list),
            &targets.radiance_view,
        );
        timer.resolve(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        timer.end_frame();
    }
}
