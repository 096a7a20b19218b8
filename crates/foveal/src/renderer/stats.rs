//! A frame's stats: what the CPU knows at once, and what the device counts and times.

use foveal_cull::Visibility;

use super::in_flight::{Counters, InFlight};
use super::{Renderer, Stages};
use crate::antialias::AntialiasStage;
use crate::culling::ObjectStats;
use crate::gpu::{Arriving, CpuTimer, ErrorTrap};
use crate::output::Upscale;
use crate::shading::{CountPass, HistoryStage};
use crate::stereo::EyeLayout;
use crate::{CoarseStats, Error, FrameStats, Timing};

impl Renderer {
    /// The buffers that the device counts in.
    pub(super) fn counters(&self) -> Counters<&wgpu::Buffer> {
        let stages = &self.stages;
        let tiles = match (&stages.coarse, &stages.targets.coarse, &stages.view) {
            (Some(coarse), Some(tiles), None) if coarse.is_active() => Some(tiles),
            _ => None,
        };
        let kept = tiles.and_then(|tiles| Some(&tiles.history.as_ref()?.listed));
        let tiles = tiles.filter(|_| kept.is_none());
        let samples = stages.targets.samples.as_ref();
        Counters {
            tiles: tiles.map(|tiles| &tiles.counts),
            unlit: tiles.and_then(|tiles| Some(&tiles.light.as_ref()?.unlit_counts)),
            kept,
            edges: samples
                .filter(|_| stages.antialias.is_some())
                .map(|samples| &samples.queue),
            rates: (stages
                .variable
                .as_ref()
                .zip(stages.targets.variable.as_ref()))
            .filter(|(stage, _)| stage.is_active())
            .map(|(_, targets)| &targets.listed),
        }
    }

    /// What culling found, without the objects that the pose does not show.
    fn without_hidden(&self, mut culled: ObjectStats) -> ObjectStats {
        let culling = self.stages.culling.as_ref();
        for object in self.scene.culling.hidden_objects() {
            let count = match culling.map_or(Visibility::Visible, |c| c.result(object)) {
                Visibility::Visible => &mut culled.visible,
                Visibility::Outside => &mut culled.outside,
                Visibility::Occluded => &mut culled.occluded,
                Visibility::Small => &mut culled.small,
            };
            *count = count.saturating_sub(1);
        }
        culled
    }

    /// What the CPU knows of the frame that it has just submitted.
    pub(super) fn submitted(&self, culled: ObjectStats, cpu: &CpuTimer) -> FrameStats {
        let Stages {
            settings,
            submission: (submission, reason),
            ..
        } = &*self.stages;
        let culled = self.without_hidden(culled);
        let (width, height) = self.settings.picture_size();
        let list = &self.draw_list;
        let forward = [
            &list.strokes,
            &list.lobed,
            &list.blended,
            &list.transmissive,
        ];
        let forward: usize = forward.map(Vec::len).iter().sum();
        let draws = (list.solid.len() + forward) as u64;
        FrameStats {
            width,
            height,
            cpu_ms: cpu.stages(),
            objects_visible: culled.visible,
            objects_outside: culled.outside,
            objects_occluded: culled.occluded,
            objects_small: culled.small,
            occluder_triangles: culled.occluder_triangles,
            occluders_over_budget: culled.over_budget,
            culling_reused: culled.reused,
            draws: draws * submission.passes(),
            triangles: self.draw_list.triangles * u64::from(EyeLayout::of(settings).eyes),
            shadows: self.stages.shadows.stats(),
            // What is counted on the device comes later.
            coarse: (self.stages.coarse.as_ref())
                .filter(|coarse| settings.picture.view.is_lit() && !coarse.is_active())
                .map(|coarse| coarse.in_full(settings)),
            stereo: settings.is_stereo().then(|| submission.stats(reason)),
            target_bytes: self.stages.targets.bytes()
                + self.upscale.as_ref().map_or(0, Upscale::bytes),
            ..FrameStats::default()
        }
    }

    /// The frame in flight, once all of its stats are there.
    pub(super) fn finished(&mut self) -> Result<Option<FrameStats>, Error> {
        #[cfg(not(target_arch = "wasm32"))]
        self.gpu.poll(wgpu::PollType::Poll)?;
        self.gpu.check_alive()?;
        let Some(in_flight) = &mut self.in_flight else {
            return Ok(None);
        };
        let arrived =
            |arriving: &Option<Arriving>| arriving.as_ref().is_none_or(Arriving::is_there);
        if !(in_flight.done.is_given()
            && arrived(&in_flight.counters.tiles)
            && arrived(&in_flight.counters.unlit)
            && arrived(&in_flight.counters.kept)
            && arrived(&in_flight.counters.edges)
            && arrived(&in_flight.counters.rates))
        {
            return Ok(None);
        }
        let Some(InFlight {
            stats,
            counters,
            done,
        }) = self.in_flight.take()
        else {
            return Ok(None);
        };
        // Later frames may be finished too: the last one's times are as good.
        let gpu_ms = self.last_times();
        let counters = Counters {
            tiles: counters.tiles.and_then(|arriving| arriving.take()),
            unlit: counters.unlit.and_then(|arriving| arriving.take()),
            kept: counters.kept.and_then(|arriving| arriving.take()),
            edges: counters.edges.and_then(|arriving| arriving.take()),
            rates: counters.rates.and_then(|arriving| arriving.take()),
        };
        let frame_ms = done.take_now().unwrap_or_default();
        Ok(Some(self.frame_stats(stats, &counters, gpu_ms, frame_ms)))
    }

    /// What the passes of the last finished frame took; empty where none is finished.
    pub(super) fn last_times(&mut self) -> Vec<Timing> {
        let mut last = Vec::new();
        loop {
            let passes = self.timer.collect(&self.gpu);
            if passes.is_empty() {
                return last;
            }
            last = passes;
        }
    }

    /// All stats of a frame, from what the CPU knew, the bytes of the counters and the times.
    pub(super) fn frame_stats(
        &mut self,
        stats: FrameStats,
        counters: &Counters<Vec<u8>>,
        gpu_ms: Vec<Timing>,
        frame_ms: f64,
    ) -> FrameStats {
        let coarse = self.coarse_stats(counters, &gpu_ms);
        let coarse = coarse.or_else(|| stats.coarse.clone());
        let lit = self.stages.settings.picture.view.is_lit();
        let stages = &mut self.stages;
        let variable = stages.variable.as_mut().filter(|_| lit);
        let bytes = counters.rates.as_deref();
        let variable = variable.map(|v| v.stats(&stages.settings, bytes, &gpu_ms));
        let weighed = stages.coarse.as_mut().zip(coarse);
        let coarse = weighed.map(|(c, stats)| c.weigh(&stages.settings, &gpu_ms, stats));
        let stages = &self.stages;
        let pixels = EyeLayout::of(&stages.settings).pixels();
        let mut shaded_samples = match (&coarse, &variable) {
            (Some(coarse), _) => coarse.shaded_samples(),
            (None, Some(variable)) if stages.settings.stage().has_lighting() => {
                variable.samples_per_rate.iter().sum()
            }
            _ => u64::from(lit) * pixels,
        };
        let mut edge_fraction = 0.0;
        let mut surfaces_left_out = 0;
        if let (Some(antialias), Some(bytes)) = (&stages.antialias, &counters.edges) {
            let edges = AntialiasStage::stats(antialias, bytes, &stages.targets, pixels);
            if !antialias.needs_ordinary() && coarse.is_none() {
                shaded_samples = 0;
            }
            shaded_samples += u64::from(lit) * edges.evaluations;
            edge_fraction = edges.edge_pixels as f64 / pixels as f64;
            if let Some(samples) = &mut self.stages.targets.samples {
                surfaces_left_out = samples.note_wanted(edges.entries);
            }
        }
        FrameStats {
            shaded_samples,
            edge_fraction,
            surfaces_left_out,
            coarse,
            variable,
            gpu_ms,
            frame_ms,
            ..stats
        }
    }

    /// Makes the room that anti-aliasing lacked in a frame. Without memory for it all stays as it
    /// is: that frame was drawn, and so are those to come.
    pub(super) async fn make_room(&mut self) -> Result<(), Error> {
        let Stages {
            settings, targets, ..
        } = &mut *self.stages;
        let Some(samples) = &mut targets.samples else {
            return Ok(());
        };
        let Some(room) = samples.room_to_make(&self.gpu, settings) else {
            return Ok(());
        };
        let trap = ErrorTrap::new(&self.gpu, "making room for edges");
        let grown = samples.grown(&self.gpu, settings, room);
        match trap.finish().await {
            Ok(()) => *samples = grown,
            Err(Error::OutOfMemory { .. }) => samples.refuse(room),
            error => return self.torn(error),
        }
        Ok(())
    }

    /// What coarse shading did; tells the choice of the backend what the passes took.
    fn coarse_stats(
        &mut self,
        counters: &Counters<Vec<u8>>,
        gpu_ms: &[Timing],
    ) -> Option<CoarseStats> {
        let settings = &self.stages.settings;
        if let Some(bytes) = &counters.kept {
            let pixels = EyeLayout::of(settings).pixels();
            return Some(HistoryStage::stats(
                bytes,
                settings.coarse.coarsest_level,
                pixels,
            ));
        }
        let bytes = counters.tiles.as_ref()?;
        let tiles = CountPass::tiles(bytes, settings.coarse.coarsest_level);
        let unlit = counters
            .unlit
            .as_ref()
            .map_or(0, |bytes| CountPass::tiles(bytes, 0)[0]);
        let pixels = EyeLayout::of(settings).pixels();
        let coarse = self.stages.coarse.as_mut()?;
        Some(coarse.shading.stats(tiles, unlit, pixels, gpu_ms))
    }
}
