//! One frame as commands, stage by stage.

use super::plan::{FramePlan, SampleChoice};
use super::{Frame, Renderer, Seen, Stages, Target};
use crate::ambient::{OcclusionUniform, Reach};
use crate::antialias::Shadings;
use crate::culling::{ObjectStats, has_cells, has_receivers};
use crate::forward::TransmissionTargets;
use crate::frame::FrameUniform;
use crate::geometry::{Draws, ResolveAt};
use crate::gpu::CpuTimer;
use crate::lights::{ClusterGrid, SceneLights};
use crate::rate::{FinestRate, RequestUniform};
use crate::recorder::Recorder;
use crate::shading::HistoryStage;
use crate::shadow::Receivers;
use crate::stereo::EyeLayout;
use crate::targets::Targets;
use crate::{FrameStats, Geometry, ShadowSizes};
use foveal_scene::Camera;

impl Renderer {
    /// The frame.
    pub(super) fn submit(
        &mut self,
        frame: &Frame<'_>,
        seen: &Seen,
        target: Option<Target<'_>>,
        cpu: &mut CpuTimer,
    ) -> FrameStats {
        self.take_rate_image();
        self.end_motion();
        let culled = self.cull(frame, seen);
        cpu.stage("culling");
        self.list_draws(frame);
        cpu.stage("draw list");
        let clusters = self.upload(frame, seen);
        cpu.stage("upload");
        let cameras = (frame.camera, frame.previous_camera.unwrap_or(frame.camera));
        let plan = self.stages.plan(cameras);
        self.find_shadows(seen, &plan);
        cpu.stage("shadows");
        self.encode_frame((frame, &plan), seen, target, &clusters, cpu);
        self.scene.is_shown = true;
        self.submitted(culled, cpu)
    }

    /// What has moved with a pose that a frame has shown rests in the next.
    fn end_motion(&mut self) {
        if !self.scene.end_motion(&self.gpu) {
            return;
        }
        if let Some(variable) = &mut self.stages.variable {
            variable.scene_moved();
        }
        if let Some(history) = self.stages.history() {
            history.scene_moved();
        }
        let uniforms = self.scene.instance_uniforms();
        (self.frame_bindings).write_instances(&self.gpu, uniforms);
    }

    /// Gives the stages a rate image that is new.
    fn take_rate_image(&mut self) {
        if std::mem::take(&mut self.rate_image_is_new)
            && let (Some(coarse), Some(image)) = (&mut self.stages.coarse, &self.rate_image)
        {
            coarse.rate_map.set_image(&self.gpu, image);
            if let Some(history) = &mut coarse.history {
                history.scene_moved();
            }
        }
    }

    /// Finds the visible objects, or keeps the last frame's while culling is frozen.
    fn cull(&mut self, frame: &Frame<'_>, seen: &Seen) -> ObjectStats {
        let settings = &self.stages.settings;
        let objects = self.scene.stats.objects;
        if self.stages.culling.is_some() && has_cells(settings) {
            self.scene.place_cells();
        }
        match &mut self.stages.culling {
            Some(culling) if self.frozen && culling.visibility().len() == objects as usize => {
                culling.object_stats()
            }
            Some(culling) => {
                let size = (settings.picture.width, settings.picture.height);
                let eyes = settings.is_stereo().then_some(&seen.eyes);
                culling.cull(&self.scene.culling, frame.camera, eyes, size, self.clock)
            }
            None => ObjectStats {
                visible: objects,
                ..ObjectStats::default()
            },
        }
    }

    /// Lists the draws of what is seen, and makes the pipelines that they need.
    fn list_draws(&mut self, frame: &Frame<'_>) {
        let (gpu, scene, list) = (&self.gpu, &self.scene, &mut self.draw_list);
        let Stages {
            settings,
            culling,
            geometry,
            forward,
            targets,
            submission,
            ..
        } = &mut *self.stages;
        let is_visible = |object| culling.as_ref().is_none_or(|c| c.is_visible(object));
        list.build(
            scene,
            frame.camera,
            settings.geometry.merge_draws,
            is_visible,
        );
        geometry.prepare(gpu, scene, list);
        forward.prepare(gpu, list);
        if list.has_forward() {
            targets.blend_samples(gpu, settings);
        }
        if !list.transmissive.is_empty() && targets.transmission.is_none() {
            let (submission, _) = submission;
            let transmission = TransmissionTargets::new(gpu, settings, *submission);
            targets.transmission = Some(transmission);
        }
    }

    /// Writes the frame's uniform block and the list of drawn instances.
    fn upload(&mut self, frame: &Frame<'_>, seen: &Seen) -> ClusterGrid {
        let Stages {
            settings, lights, ..
        } = &mut *self.stages;
        (self.scene).expose(&self.gpu, settings.picture.exposure_stops);
        let (gpu, scene) = (&self.gpu, &self.scene);
        let layout = EyeLayout::of(settings);
        let clusters = ClusterGrid::new(&layout, &seen.eyes, frame.camera, &scene.lights);
        lights.reserve(gpu, &clusters);
        let uniform = FrameUniform::new(
            settings,
            frame.camera,
            &seen.eyes,
            &seen.eyes_before,
            self.environment.terms(&scene.environment),
            &clusters,
        );
        self.frame_bindings.write_frame(gpu, &uniform);
        self.frame_bindings.write_drawn(gpu, &self.draw_list.drawn);
        lights.assign_on_cpu(gpu, &uniform, &scene.lights);
        if let Some(ambient) = &self.stages.ambient {
            let settings = &self.stages.settings;
            ambient.write(gpu, &OcclusionUniform::new(settings, scene.diagonal_m));
        }
        let found = self.stages.targets.ambient.as_ref();
        self.frame_bindings
            .bind_ambient(gpu, found.map(|found| &found.resolved));
        clusters
    }

    /// Finds the tiles of the shadow atlas that the frame needs and has not.
    fn find_shadows(&mut self, seen: &Seen, plan: &FramePlan) {
        let Stages {
            settings,
            shadows,
            culling,
            ..
        } = &mut *self.stages;
        if !has_receivers(settings) {
            return;
        }
        // The culler answers for the view that it has seen last.
        let by_object = self.frozen;
        let cells = culling
            .as_ref()
            .and_then(|culling| culling.cells_seen(&self.scene.culling, by_object));
        let receivers = match cells {
            Some(cells) => Receivers::Cells(cells.into()),
            None => Receivers::Instances((&self.draw_list.drawn).into()),
        };
        let scene = (&self.scene, receivers);
        let follow_rates = settings.lighting.shadow_sizes == ShadowSizes::Rate
            && plan.rates == SampleChoice::Coarse;
        let rates = if follow_rates {
            FinestRate::new(settings, &seen.eyes)
        } else {
            None
        };
        let changed = shadows.prepare(&self.gpu, settings, scene, &seen.eyes, rates);
        if changed.is_empty() {
            return;
        }
        // What is kept of the frames before lacks those shadows.
        if let Some(variable) = &mut self.stages.variable {
            variable.scene_moved();
        }
        if let Some(history) = self.stages.history() {
            history.light_changed(&changed);
        }
    }

    /// Encodes and submits the frame's passes.
    fn encode_frame(
        &mut self,
        (frame, plan): (&Frame<'_>, &FramePlan),
        seen: &Seen,
        target: Option<Target<'_>>,
        clusters: &ClusterGrid,
        cpu: &mut CpuTimer,
    ) {
        let (gpu, stages) = (&self.gpu, &mut self.stages);
        let cameras = (frame.camera, frame.previous_camera.unwrap_or(frame.camera));
        if let Some(history) = stages.coarse.as_mut().and_then(|c| c.history.as_mut()) {
            let keeps_light = plan.rates == SampleChoice::Coarse;
            history.begin(gpu, &stages.settings, keeps_light);
        }
        let draws = Draws {
            scene: &self.scene,
            list: &self.draw_list,
        };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let recorder = &mut Recorder {
            gpu,
            encoder: &mut encoder,
            timer: &mut self.timer,
            frame: &self.frame_bindings,
        };
        stages
            .lights
            .assign(recorder, &draws.scene.light_table, clusters);
        stages.shadows.draw(recorder, draws.scene);
        if plan.edges {
            stages.look_around_first(recorder, draws, plan);
        }
        stages.fill_gbuffer(recorder, draws, plan);
        stages.find_rates(recorder, draws, (seen, cameras), plan);
        if !plan.edges {
            stages.look_around(recorder, plan);
        }
        if plan.is_lit {
            stages.light(recorder, draws, plan);
            stages.blend(recorder, draws);
            stages.tone_map(recorder);
        } else {
            stages.show_gbuffer(recorder, draws);
        }
        let targets = &stages.targets;
        if let Some(eyes_shown) = &stages.eyes_shown {
            eyes_shown.show(recorder, seen.lenses.as_ref(), targets);
        }
        let (shown, pictures) = (targets.shown(), stages.settings.pictures_beside());
        if let Some(upscale) = &mut self.upscale {
            upscale.stretch(recorder, shown, pictures);
        }
        if let Some(target) = target {
            (self.present).present(recorder, shown, target, pictures);
        }
        self.timer.resolve(&mut encoder);
        cpu.stage("encode");

        gpu.queue.submit([encoder.finish()]);
        self.timer.end_frame();
        cpu.stage("submit");
    }
}

impl Stages {
    fn scene_lights<'a>(&'a self, draws: Draws<'a>) -> SceneLights<'a> {
        SceneLights {
            table: &draws.scene.light_table,
            assigner: &self.lights,
            shadows: &self.shadows,
        }
    }

    /// Ambient occlusion before sub-samples are drawn, which are lit as soon as they are: at every
    /// pixel, of geometry that is drawn once more for it.
    fn look_around_first(
        &mut self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        plan: &FramePlan,
    ) {
        if self.ambient.is_none() || !plan.is_lit {
            return;
        }
        let gbuffer = &self.targets.gbuffer;
        match self.settings.geometry.path {
            Geometry::Gbuffer => self.geometry.draw(recorder, draws, gbuffer),
            Geometry::Visibility => self.geometry.draw_triangles(recorder, draws, gbuffer),
        }
        self.look_around(recorder, plan);
    }

    /// Ambient occlusion: at the blocks of the rate map where the frame has one, else at every pixel.
    fn look_around(&mut self, recorder: &mut Recorder<'_>, plan: &FramePlan) {
        let Targets {
            gbuffer,
            coarse,
            ambient,
            ..
        } = &mut self.targets;
        let (Some(stage), Some(to)) = (&self.ambient, ambient) else {
            return;
        };
        if !plan.is_lit {
            return;
        }
        let history = self.coarse.as_ref().and_then(|c| c.history.as_ref());
        let reach = match coarse {
            // The last picture is shown again.
            _ if !plan.edges && history.is_some_and(|history| history.is_again()) => {
                Reach::EveryAtRest
            }
            _ if plan.edges || plan.rates != SampleChoice::Coarse => Reach::Every,
            _ if history.is_some_and(|history| !history.needs_rates()) => Reach::EveryAtRest,
            Some(tiles) => Reach::Blocks(&tiles.rate.owner.whole),
            None => Reach::Every,
        };
        stage.find(recorder, gbuffer, to, reach);
    }

    /// Geometry: what is seen at each pixel. Materials that are evaluated at a rate are left for
    /// later.
    fn fill_gbuffer(&self, recorder: &mut Recorder<'_>, draws: Draws<'_>, plan: &FramePlan) {
        let (geometry, gbuffer) = (&self.geometry, &self.targets.gbuffer);
        if plan.edges {
            self.draw_sub_samples(recorder, draws, plan);
        } else if plan.materials == SampleChoice::Every {
            geometry.draw(recorder, draws, gbuffer);
        } else {
            geometry.draw_triangles(recorder, draws, gbuffer);
        }
    }

    /// The G-buffer of each pixel's largest surface, from sub-samples that are drawn band by band.
    fn draw_sub_samples(&self, recorder: &mut Recorder<'_>, draws: Draws<'_>, plan: &FramePlan) {
        let Self {
            targets,
            geometry,
            shading,
            forward,
            ..
        } = self;
        let (Some(antialias), Some(samples)) = (&self.antialias, &targets.samples) else {
            return;
        };
        let lights = self.scene_lights(draws);
        let gbuffer = samples.gbuffer();
        let input =
            (!antialias.sorts_triangles()).then(|| shading.input(recorder.gpu, gbuffer, lights));
        let input = input.as_ref();
        let blended = samples
            .blended()
            .filter(|_| plan.is_lit && draws.list.has_forward());
        antialias.begin(recorder, samples);
        for band in samples.bands() {
            let windows = samples.windows(band.0);
            if antialias.sorts_triangles() {
                geometry.draw_triangle_windows(recorder, draws, gbuffer, &windows);
            } else {
                geometry.draw_windows(recorder, draws, gbuffer, &windows);
            }
            let shade = plan.is_lit;
            let shadings = Shadings { input, shade };
            antialias.merge(recorder, draws.scene, targets, band, shadings);
            // Last of the band: points and lines write the sub-samples' depth.
            if let Some(blended) = blended {
                let target = (&blended.samples_view, &gbuffer.depth_view);
                forward.draw_alone(recorder, draws, lights, target, &windows);
                antialias.average(recorder, blended, band);
            }
        }
        if let Some(further) = samples.further_gbuffer() {
            geometry.resolve(recorder, draws, &targets.gbuffer, &ResolveAt::FULL);
            geometry.resolve_further(recorder, draws, further);
        }
    }

    /// Shading rates that what is seen asks for, and materials that are evaluated at these.
    fn find_rates(
        &mut self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        (seen, cameras): (&Seen, (&Camera, &Camera)),
        plan: &FramePlan,
    ) {
        let Self {
            settings,
            targets,
            geometry,
            coarse,
            variable,
            ..
        } = self;
        let gbuffer = &targets.gbuffer;
        let rates = match plan.rates {
            SampleChoice::Every => return,
            SampleChoice::Coarse => {
                let (Some(coarse), Some(tiles)) = (coarse, &targets.coarse) else {
                    return;
                };
                let history = coarse.history.as_ref();
                let smooths_by_rate = crate::antialias::follows_rates(settings);
                if smooths_by_rate || history.is_none_or(HistoryStage::needs_rates) {
                    // The device may lack room for the light that settings would have kept.
                    let request = if settings.keeps_light() && history.is_none() {
                        RequestUniform::of_one_frame
                    } else {
                        RequestUniform::new
                    };
                    let request = request(settings, &seen.eyes, seen.lenses.as_ref());
                    let rate_map = &coarse.rate_map;
                    rate_map.draw(recorder, &request, gbuffer, &tiles.rate);
                }
                &tiles.rate.owner.whole
            }
            SampleChoice::Variable => {
                let (Some(variable), Some(rates)) = (variable, &targets.variable) else {
                    return;
                };
                variable.find_rates(recorder, settings, targets, &seen.eyes, cameras);
                &rates.mask
            }
        };
        if plan.materials != plan.rates {
            return;
        }
        if plan.compares {
            geometry.resolve(recorder, draws, gbuffer, &ResolveAt::COMPARED);
        }
        geometry.resolve(recorder, draws, gbuffer, &ResolveAt::at_rates(rates));
    }

    /// Shading and composite: the radiance of opaque surfaces at each pixel.
    fn light(&self, recorder: &mut Recorder<'_>, draws: Draws<'_>, plan: &FramePlan) {
        let Self {
            targets, shading, ..
        } = self;
        let radiance = &targets.radiance_view;
        let lights = self.scene_lights(draws);
        let input = &shading.input(recorder.gpu, &targets.gbuffer, lights);
        if plan.compares && plan.lighting == Some(plan.rates) {
            shading.shade_every_pixel(recorder, input, radiance, "full shading");
        }
        match plan.lighting {
            None => {}
            Some(SampleChoice::Every) => self.light_in_full(recorder, input),
            Some(SampleChoice::Coarse) => self.light_coarsely(recorder, input),
            Some(SampleChoice::Variable) => {
                if let Some(variable) = &self.variable {
                    variable.shade(recorder, input, targets);
                }
            }
        }
        if let Some(antialias) = &self.antialias {
            let further = targets.samples.as_ref().and_then(|s| s.further_gbuffer());
            let further = further.map(|gbuffer| shading.input(recorder.gpu, gbuffer, lights));
            antialias.combine(recorder, targets, further.as_ref());
        }
    }

    /// Light at every pixel.
    fn light_in_full(&self, recorder: &mut Recorder<'_>, input: &wgpu::BindGroup) {
        let (targets, shading) = (&self.targets, &self.shading);
        let history = self.coarse.as_ref().and_then(|c| c.history.as_ref());
        let kept = targets.coarse.as_ref().and_then(|t| t.history.as_ref());
        match (history, kept) {
            (Some(history), Some(kept)) => {
                history.light_in_full(recorder, shading, input, targets, kept);
            }
            _ => {
                let radiance = &targets.radiance_view;
                shading.shade(recorder, input, radiance);
            }
        }
    }

    /// Light at the samples of the rate map, joined at each pixel.
    fn light_coarsely(&self, recorder: &mut Recorder<'_>, input: &wgpu::BindGroup) {
        let targets = &self.targets;
        let (Some(coarse), Some(tiles)) = (&self.coarse, &targets.coarse) else {
            return;
        };
        if let (Some(history), Some(kept)) = (&coarse.history, &tiles.history) {
            return history.light(recorder, input, targets, (&tiles.rate, kept));
        }
        coarse.shading.shade(recorder, input, tiles);
        coarse.composite.join(recorder, targets, tiles);
        if let Some(light) = &tiles.light {
            let radiance = &targets.radiance_view;
            coarse.shading.shade_unlit(recorder, input, light, radiance);
            coarse.composite.follow(recorder, targets, light);
        }
    }

    /// Forward: points and lines, lobes of opaque surfaces, blended surfaces over them, and at last
    /// what light passes.
    fn blend(&self, recorder: &mut Recorder<'_>, draws: Draws<'_>) {
        match &self.antialias {
            Some(antialias) => antialias.blend(recorder, draws.list, &self.targets),
            None => {
                let lights = self.scene_lights(draws);
                self.forward.draw(recorder, draws, lights, &self.targets);
            }
        }
        let lights = self.scene_lights(draws);
        let targets = &self.targets;
        (self.forward).draw_transmissive(recorder, draws, lights, targets);
    }

    /// Tone map: radiance to display values, and what debug views lay over the picture.
    fn tone_map(&self, recorder: &mut Recorder<'_>) {
        let targets = &self.targets;
        let finished = targets.variable.as_ref().and_then(|t| t.finished.as_ref());
        let finished = finished.unwrap_or(&targets.picture_view);
        self.tone_map
            .map(recorder, &targets.radiance_view, finished);
        if let Some(variable) = &self.variable {
            variable.show(recorder, targets);
        }
        let overlay = self.coarse.as_ref().and_then(|c| c.overlay.as_ref());
        if let (Some(overlay), Some(tiles)) = (overlay, &targets.coarse) {
            overlay.draw(recorder, tiles, &targets.picture_view);
        }
    }

    /// A debug view of the G-buffer or of anti-aliasing in place of light.
    fn show_gbuffer(&self, recorder: &mut Recorder<'_>, draws: Draws<'_>) {
        let targets = &self.targets;
        if let Some(view) = &self.view {
            let places = draws.scene.geometry.places();
            view.show(recorder, &targets.gbuffer, places, &targets.picture_view);
        } else if let Some(antialias) = &self.antialias {
            antialias.show(recorder, targets);
        }
    }
}
