//! All of variable shading that outlives a frame.

use super::passes::{RateFrame, RatePasses};
use super::probes::Probes;
use super::view::RateView;
use crate::gpu::Gpu;
use crate::recorder::Recorder;
use crate::shading::balance::{Balance, Compared, RatePlan, sum_ms};
use crate::stereo::{Eye, EyeLayout};
use crate::targets::Targets;
use crate::{Antialiasing, Settings, Timing, VariableStats};
use foveal_scene::Camera;

/// Frames before the first comparison.
const UNCOMPARED: u32 = 3;
/// Passes that find rates and samples.
const MASK: &str = "rate mask";
const REPROJECTION: &str = "reprojection";

/// What is said where anti-aliasing leaves nothing to shade.
const COVERED: &str = "variable shading is off: ssaa shades every sub-sample";

/// All of variable shading that outlives a frame.
#[derive(Debug)]
pub(crate) struct VariableStage {
    passes: RatePasses,
    view: Option<RateView>,
    probes: Probes,
    balance: Balance,
    costs: VariableStats,
    /// Anti-aliasing shades every sub-sample: nothing at rates would be seen.
    is_covered: bool,
    /// The camera of the frame that the targets know.
    last: Option<Camera>,
    /// Frames since the targets knew nothing.
    frame: u32,
}

impl VariableStage {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
        input_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let view = RateView::new(gpu, settings.picture.view, frame_layout);
        // The view shows the frame's own rates.
        let forced = settings.rate.force || view.is_some();
        // As with coarse shading: what is forced has no use for comparisons, and benches would time
        // them.
        let compares = gpu.tells_times() && !forced;
        Self {
            passes: RatePasses::new(gpu, settings, frame_layout, input_layout),
            view,
            probes: Probes::default(),
            balance: Balance::new(forced, UNCOMPARED, compares),
            costs: VariableStats::default(),
            is_covered: settings.antialiasing.mode == Antialiasing::Ssaa,
            last: None,
            frame: 0,
        }
    }

    /// The next frame follows none: what is known belongs to another scene or size.
    pub(crate) fn forget(&mut self) {
        self.last = None;
    }

    /// What was measured belongs to another scene or size.
    pub(crate) fn weigh_again(&mut self) {
        self.balance.start_again();
        self.costs = VariableStats::default();
    }

    /// The next frame shows another pose.
    pub(crate) fn scene_moved(&mut self) {
        self.probes.disturb();
    }

    /// What the next frame does, seen by the first of these cameras and the last one by the second.
    pub(crate) fn plan(&mut self, (camera, previous): (&Camera, &Camera)) -> RatePlan {
        let rests = camera == previous && !self.probes.are_disturbed();
        let plan = match self.is_covered {
            true => RatePlan::default(),
            // What is off comes back while something moves: a still picture would change.
            false if self.balance.is_off() && rests => RatePlan::default(),
            false => self.balance.plan(),
        };
        if !plan.active {
            self.forget();
            self.probes.settle();
        }
        plan
    }

    /// Whether the last frame was shaded at a rate.
    pub(crate) fn is_active(&self) -> bool {
        self.last.is_some()
    }

    /// Puts another balance in place.
    #[cfg(test)]
    pub(crate) fn set_balance(&mut self, balance: Balance) {
        self.balance = balance;
    }

    /// Encodes the passes that find rates and samples.
    pub(crate) fn find_rates(
        &mut self,
        recorder: &mut Recorder<'_>,
        settings: &Settings,
        targets: &Targets,
        eyes: &[Eye; 2],
        (camera, previous): (&Camera, &Camera),
    ) {
        let Some(t) = &targets.variable else { return };
        let known = self.last.as_ref();
        let reset = known.is_none_or(|last| last != previous);
        if reset {
            self.frame = 0;
            self.probes.settle();
        } else if known != Some(camera) {
            self.probes.disturb();
        }
        let turn = RateFrame {
            even: self.frame.is_multiple_of(2),
            reset,
            probe: self.probes.next(),
        };
        self.passes
            .find_rates(recorder, settings, targets, (t, eyes), turn);
        self.last = Some(camera.clone());
        self.frame = self.frame.wrapping_add(1);
    }

    /// Encodes lighting of the samples that were found.
    pub(crate) fn shade(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        targets: &Targets,
    ) {
        if let Some(t) = &targets.variable {
            self.passes
                .shade(recorder, input, t, &targets.radiance_view);
        }
    }

    /// Encodes the view of the rates that the settings ask for.
    pub(crate) fn show(&self, recorder: &mut Recorder<'_>, targets: &Targets) {
        if let (Some(view), Some(t)) = (&self.view, &targets.variable) {
            view.draw(recorder, t, &targets.picture_view);
        }
    }

    /// The stats of a frame whose passes took `gpu_ms` and which counted `listed`; `None`: it was
    /// shaded in full.
    pub(crate) fn stats(
        &mut self,
        settings: &Settings,
        listed: Option<&[u8]>,
        gpu_ms: &[Timing],
    ) -> VariableStats {
        let layout = EyeLayout::of(settings);
        let pixels = layout.pixels();
        let mut stats = self.costs(settings, gpu_ms);
        stats.active = listed.is_some();
        stats.samples_per_rate = vec![pixels, 0, 0, 0, 0];
        if let Some(bytes) = listed {
            let words: Vec<u32> = bytemuck::pod_collect_to_vec(bytes);
            stats.samples_per_rate = words[4..9].iter().map(|&n| u64::from(n)).collect();
            let quads = layout.width.div_ceil(2) * layout.height.div_ceil(2) * layout.eyes;
            stats.unknown_fraction = f64::from(words[9]) / f64::from(quads);
        }
        stats.shaded_fraction = stats.samples_per_rate.iter().sum::<u64>() as f64 / pixels as f64;
        stats
    }

    /// What is known of cost and gain after a frame whose passes took `gpu_ms`.
    fn costs(&mut self, settings: &Settings, gpu_ms: &[Timing]) -> VariableStats {
        let stage = settings.stage();
        let costs = &mut self.costs;
        costs.mask_ms = sum_ms(gpu_ms, MASK);
        costs.reproject_ms = sum_ms(gpu_ms, REPROJECTION);
        costs.binning_ms = sum_ms(gpu_ms, "binning");
        let runs = (stage.has_lighting(), stage.has_material());
        if let Some(compared) = Compared::find(gpu_ms, runs, &[MASK, REPROJECTION]) {
            self.balance.observe(compared);
            costs.full_ms = compared.full_ms;
            costs.variable_ms = compared.rated_ms;
            costs.saved_ms = compared.full_ms - compared.rated_ms;
            costs.net_ms = compared.net_ms();
        }
        let notice = match self.is_covered {
            true => COVERED.to_owned(),
            false => self.balance.notice("variable shading"),
        };
        VariableStats {
            notice,
            ..costs.clone()
        }
    }
}
