//! What stands in for shading every pixel, and when it does not.

use crate::composite::CompositePass;
use crate::gpu::Gpu;
use crate::output::OverlayPass;
use crate::rate::{RateImage, RateMapPass};
use crate::shading::{Balance, CoarseShading, Compared, HistoryStage, RatePlan, ShadingPass};
use crate::stereo::EyeLayout;
use crate::{Antialiasing, CoarseStats, Settings, Timing};
use foveal_scene::Camera;

/// Frames before the first comparison: after those in which the backend is chosen.
const UNCOMPARED: u32 = 8;
/// The same where light is kept, by the one backend that can.
const UNCOMPARED_WITH_HISTORY: u32 = 3;
/// Passes that shading every pixel does not need.
const EXTRA: [&str; 8] = [
    "requested levels",
    "rate pyramid",
    "rate owner",
    "tile listing",
    "tile counting",
    "patches",
    "composite",
    "reprojection of light",
];

/// What stands in for shading every pixel.
#[derive(Debug)]
pub(super) struct CoarseStages {
    pub(super) rate_map: RateMapPass,
    pub(super) shading: CoarseShading,
    pub(super) composite: CompositePass,
    /// Stands in for both where light is kept from frame to frame.
    pub(super) history: Option<HistoryStage>,
    pub(super) overlay: Option<OverlayPass>,
    /// Says that the device cannot keep light; else empty.
    without_history: String,
    /// `None`: it stays on, and is not compared.
    balance: Option<Balance>,
    /// What the last frame did.
    last: RatePlan,
    /// The scene has taken another pose since.
    has_moved: bool,
}

impl CoarseStages {
    pub(super) fn new(
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
        let history = HistoryStage::new(gpu, settings, frame, full.input_layout());
        let overlay = OverlayPass::new(gpu, settings.picture.view, frame);
        // The overlay shows tiles.
        let forced = settings.rate.force || overlay.is_some();
        // Anti-aliasing shades edges in fine tiles alone: more than lighting would have to be
        // compared.
        let weighs = settings.antialiasing.mode == Antialiasing::None;
        let uncompared = match &history {
            Some(_) => UNCOMPARED_WITH_HISTORY,
            None => UNCOMPARED,
        };
        Self {
            rate_map,
            shading: CoarseShading::new(gpu, settings, frame, full.input_layout()),
            composite: CompositePass::new(gpu, settings, frame),
            history,
            overlay,
            without_history: HistoryStage::notice(gpu, settings),
            balance: weighs.then(|| {
                // What is forced has no use for comparisons, and benches would time them.
                let compares = gpu.tells_times() && !forced;
                Balance::new(forced, uncompared, compares)
            }),
            last: RatePlan::default(),
            has_moved: false,
        }
    }

    /// The next frame shows another pose.
    pub(super) fn scene_moved(&mut self) {
        self.has_moved = true;
    }

    /// What the next frame does, seen by the first of these cameras and the last one by the second.
    pub(super) fn plan(&mut self, settings: &Settings, cameras: (&Camera, &Camera)) -> RatePlan {
        if let Some(history) = &mut self.history {
            history.follow(settings, cameras);
        }
        let moves = std::mem::take(&mut self.has_moved) || cameras.0 != cameras.1;
        let rests = match &self.history {
            Some(history) => history.rests(),
            // What is off comes back while something moves: a still picture would change.
            None => !moves && self.balance.as_ref().is_some_and(Balance::is_off),
        };
        self.last = match &mut self.balance {
            // What shows the same picture again costs next to nothing, whichever way.
            Some(balance) if !rests => {
                let plan = balance.plan();
                // The backend that is compared is the one that stays.
                let compares =
                    plan.compares && (self.history.is_some() || self.shading.has_chosen());
                RatePlan { compares, ..plan }
            }
            balance => RatePlan {
                active: balance.as_ref().is_none_or(|b| !b.is_off()),
                compares: false,
            },
        };
        self.last
    }

    /// What was measured belongs to another scene or size.
    pub(super) fn weigh_again(&mut self) {
        if let Some(balance) = &mut self.balance {
            balance.start_again();
        }
    }

    /// Whether the last frame was shaded coarsely.
    pub(super) fn is_active(&self) -> bool {
        self.last.active
    }

    /// What is known of a frame that shaded every pixel, before its passes were timed.
    pub(super) fn in_full(&self, settings: &Settings) -> CoarseStats {
        let again = self.history.as_ref().is_some_and(HistoryStage::is_again);
        let pixels = EyeLayout::of(settings).pixels();
        CoarseStats {
            samples_per_level: vec![if again { 0 } else { pixels }],
            shaded_fraction: f64::from(u8::from(!again)),
            backend: "none".to_owned(),
            backend_reason: "every pixel is shaded".to_owned(),
            ..CoarseStats::default()
        }
    }

    /// Puts what is known of cost and gain, and what there is to say, into a frame's `stats`, after
    /// passes that took `gpu_ms`.
    pub(super) fn weigh(
        &mut self,
        settings: &Settings,
        gpu_ms: &[Timing],
        stats: CoarseStats,
    ) -> CoarseStats {
        let stats = CoarseStats {
            notice: self.without_history.clone(),
            ..stats
        };
        let Some(balance) = &mut self.balance else {
            return stats;
        };
        let runs = (true, settings.stage().has_material());
        if let Some(compared) = Compared::find(gpu_ms, runs, &EXTRA) {
            balance.observe(compared);
        }
        let last = balance.last();
        CoarseStats {
            full_ms: last.full_ms,
            coarse_ms: last.rated_ms + last.extra_ms,
            notice: match balance.notice("coarse shading") {
                off if off.is_empty() => stats.notice,
                off => off,
            },
            ..stats
        }
    }

    /// Puts another balance in place.
    #[cfg(test)]
    pub(super) fn set_balance(&mut self, balance: Balance) {
        self.balance = Some(balance);
    }
}

#[cfg(test)]
mod tests;
