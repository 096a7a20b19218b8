//! One frame as commands, stage by stage.

use super::{Frame, Renderer, Seen, Stages, Target};
use crate::FrameStats;
use crate::antialias::AntialiasStage;
use crate::culling::CullingCounts;
use crate::frame::FrameUniform;
use crate::geometry::{DrawList, Evaluation};
use crate::gpu::CpuTimer;
use crate::lights::ClusterGrid;
use crate::recorder::Recorder;
use crate::scene::SceneOnGpu;
use crate::shading::{HistoryStage, Plan, Samples};
use crate::stereo::EyeLayout;

impl Renderer {
    /// The frame.
    pub(super) fn submit(
        &mut self,
        frame: &Frame<'_>,
        seen: &Seen,
        target: Option<Target<'_>>,
        cpu: &mut CpuTimer,
    ) -> FrameStats {
        let Self {
            gpu,
            timer,
            frame_bindings,
            stages,
            scene,
            draw_list,
            present,
            upscale,
            clock,
            frozen,
            ..
        } = self;
        let Stages {
            settings,
            culling,
            lights,
            geometry,
            variable,
            forward,
            targets,
            ..
        } = stages;
        let plan = match variable {
            Some(variable) if settings.view.is_lit() => variable.plan(),
            _ => Plan::default(),
        };

        let culled = match culling {
            Some(culling)
                if *frozen && culling.visibility().len() == scene.stats.objects as usize =>
            {
                culling.counts()
            }
            Some(culling) => {
                let size = (settings.width, settings.height);
                let eyes = settings.is_stereo().then_some(&seen.eyes);
                culling.cull(&scene.culling, frame.camera, eyes, size, *clock)
            }
            None => CullingCounts {
                visible: scene.stats.objects,
                ..CullingCounts::default()
            },
        };
        cpu.stage("culling");

        let is_visible = |object| culling.as_ref().is_none_or(|c| c.is_visible(object));
        draw_list.build(scene, frame.camera.eye(), settings.merge_draws, is_visible);
        geometry.prepare(gpu, scene, draw_list);
        forward.prepare(gpu, draw_list);
        if !draw_list.blended.is_empty() {
            targets.blend_samples(gpu, settings);
        }
        cpu.stage("draw list");

        let clusters = ClusterGrid::new(
            &EyeLayout::of(settings),
            &seen.eyes,
            frame.camera,
            &scene.lights,
        );
        lights.reserve(gpu, &clusters);
        let uniform = FrameUniform::new(
            settings,
            frame.camera,
            &seen.eyes,
            &seen.eyes_before,
            &scene.environment,
            &clusters,
        );
        frame_bindings.write_frame(gpu, &uniform);
        frame_bindings.write_drawn(gpu, &draw_list.drawn);
        lights.assign_on_cpu(gpu, &uniform, &scene.lights);
        cpu.stage("upload");

        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let recorder = &mut Recorder {
            gpu,
            encoder: &mut encoder,
            timer,
            frame: frame_bindings,
        };
        lights.assign(recorder, &scene.light_buffer, &clusters);
        stages.see(recorder, scene, draw_list, (frame, seen), &plan);
        stages.light(recorder, scene, draw_list, &plan);
        let targets = &stages.targets;
        if let Some(eyes_shown) = &stages.eyes_shown {
            eyes_shown.show(recorder, seen.lenses.as_ref(), targets);
        }
        if let Some(upscale) = upscale {
            upscale.stretch(recorder, targets.shown());
        }
        if let Some(target) = target {
            present.present(recorder, targets.shown(), target);
        }
        timer.resolve(&mut encoder);
        cpu.stage("encode");

        gpu.queue.submit([encoder.finish()]);
        timer.end_frame();
        cpu.stage("submit");
        self.submitted(culled, cpu)
    }
}

impl Stages {
    /// Encodes geometry, the rates that what is seen asks for, and materials that are evaluated at these.
    fn see(
        &mut self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        draw_list: &DrawList,
        (frame, seen): (&Frame<'_>, &Seen),
        plan: &Plan,
    ) {
        let Self {
            settings,
            targets,
            lights,
            geometry,
            shading,
            antialias,
            coarse,
            variable,
            forward,
            ..
        } = self;
        let material = settings.stage().has_material();
        let coarse = match (coarse, &targets.coarse) {
            (Some(coarse), Some(tiles)) if settings.view.is_lit() => Some((coarse, tiles)),
            _ => None,
        };
        if let Some(antialias) = antialias {
            let shade = settings.view.is_lit();
            antialias.draw(
                recorder, scene, draw_list, geometry, shading, forward, lights, targets, shade,
            );
        } else if material && (plan.active || coarse.is_some()) {
            geometry.draw_triangles(recorder, scene, draw_list, &targets.gbuffer);
        } else {
            geometry.draw(recorder, scene, draw_list, &targets.gbuffer);
        }
        let evaluate = |recorder: &mut _, at| {
            geometry.evaluate(recorder, scene, draw_list, &targets.gbuffer, &at)
        };
        if let Some((coarse, tiles)) = coarse {
            let eyes = (&seen.eyes, seen.lenses.as_ref());
            if let Some(history) = &mut coarse.history {
                let before = frame.previous_camera.unwrap_or(frame.camera);
                history.begin(recorder.gpu, settings, (frame.camera, before));
            }
            if coarse
                .history
                .as_ref()
                .is_none_or(HistoryStage::needs_rates)
            {
                coarse
                    .rate_map
                    .draw(recorder, settings, eyes, &targets.gbuffer, &tiles.rate);
            }
            if material {
                evaluate(recorder, Evaluation::at_rates(&tiles.rate.owner.whole));
            }
        }
        if let (Some(variable), true) = (variable.as_mut(), plan.active) {
            let before = frame.previous_camera.unwrap_or(frame.camera);
            let cameras = (frame.camera, before);
            variable.find_rates(recorder, settings, targets, &seen.eyes, cameras);
            if let (Some(t), true) = (&targets.variable, material) {
                if plan.compares {
                    evaluate(recorder, Evaluation::COMPARED);
                }
                evaluate(recorder, Evaluation::at_rates(&t.mask));
            }
        }
    }

    /// Encodes the picture of what is seen: a view of the G-buffer, or light and what is made of it.
    fn light(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        draw_list: &DrawList,
        plan: &Plan,
    ) {
        let Self {
            settings,
            targets,
            lights,
            shading,
            antialias,
            coarse,
            variable,
            forward,
            tone_map,
            view,
            ..
        } = self;
        if let Some(view) = view {
            let places = scene.geometry.places();
            view.show(recorder, &targets.gbuffer, places, &targets.picture_view);
            return;
        }
        if antialias
            .as_ref()
            .is_some_and(|a| a.show(recorder, targets))
        {
            return;
        }
        let input = shading.input(recorder.gpu, &targets.gbuffer, &scene.light_buffer, lights);
        if let (Some(coarse), Some(tiles)) = (coarse.as_ref(), &targets.coarse) {
            if let (Some(history), Some(kept)) = (&coarse.history, &tiles.history) {
                history.light(recorder, &input, targets, (&tiles.rate, kept));
            } else {
                coarse.shading.shade(recorder, &input, tiles);
                coarse.composite.join(recorder, targets, tiles);
                if let Some(light) = &tiles.light {
                    let unlit = Samples::List(&light.unlit);
                    shading.shade(recorder, &input, unlit, &targets.radiance_view);
                }
            }
        } else if let (Some(variable), true) = (
            variable.as_ref(),
            plan.active && settings.stage().has_lighting(),
        ) {
            if plan.compares {
                let target = &targets.radiance_view;
                shading.shade_every_pixel(recorder, &input, target, "full shading");
            }
            variable.shade(recorder, &input, targets);
        } else if antialias
            .as_ref()
            .is_none_or(AntialiasStage::needs_ordinary)
        {
            let target = &targets.radiance_view;
            shading.shade(recorder, &input, Samples::EveryPixel, target);
        }
        if let Some(antialias) = antialias {
            antialias.combine(recorder, scene, shading, lights, targets);
            antialias.blend(recorder, draw_list, targets);
        } else {
            forward.draw(recorder, scene, lights, draw_list, targets);
        }
        let finished = targets.variable.as_ref().and_then(|t| t.finished.as_ref());
        let finished = finished.unwrap_or(&targets.picture_view);
        tone_map.map(recorder, &targets.radiance_view, finished);
        if let Some(variable) = variable {
            variable.show(recorder, targets);
        }
        if let (Some(overlay), Some(tiles)) = (
            coarse.as_ref().and_then(|c| c.overlay.as_ref()),
            &targets.coarse,
        ) {
            overlay.draw(recorder, tiles, &targets.picture_view);
        }
    }
}
