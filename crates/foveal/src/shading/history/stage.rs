//! All of the light history that outlives a frame.

use super::HistoryTargets;
use super::changed::Changed;
use super::lit::{Lit, ROUND, is_used, notice};
use super::passes::HistoryParameters;
use super::passes::HistoryPasses;
use crate::gpu::Gpu;
use crate::lights::LightUniform;
use crate::rate::RateTargets;
use crate::recorder::Recorder;
use crate::shading::ShadingPass;
use crate::shading::coarse::UsedBackend;
use crate::shading::history::targets;
use crate::shadow::Place;
use crate::targets::Targets;
use crate::{CoarseStats, Settings, ShadowSizes, Shadows};
use foveal_scene::Camera;

/// By how much a gaze may move while all is at rest, in parts of the picture's sides.
const STEADY_GAZE: f32 = 0.01;

/// All that outlives a frame.
#[derive(Debug)]
pub(crate) struct HistoryStage {
    passes: HistoryPasses,
    /// The camera of the last frame that was drawn.
    last: Option<Camera>,
    /// The scene's pose has changed since.
    moved: bool,
    /// Where the eyes looked as the rest began: `EyeSettings::gaze` and `StereoSettings::gaze_shift`.
    gaze: [[f32; 2]; 2],
    /// Where lights have changed since.
    changed: Changed,
    /// Frames since nothing was kept.
    frame: u32,
    /// Frames at rest.
    rested: u32,
    /// The rest that this frame ends lasted a whole round: each pixel was shaded by itself.
    whole_round: bool,
    /// Nothing that is kept can be used.
    reset: bool,
    /// What has changed, for the frame at hand.
    now_changed: Changed,
    /// The last frame shaded every pixel, and kept no light.
    in_full: bool,
    /// The frame shows the last one's radiance again.
    again: bool,
    pub(super) lit: Lit,
    /// Of the last frame.
    pub(crate) parameters: HistoryParameters,
    /// Where light had changed in the last frame.
    pub(crate) changed_places: Vec<Place>,
}

impl HistoryStage {
    /// Whether light is reprojected.
    pub(crate) fn is_used(gpu: &Gpu, settings: &Settings) -> bool {
        is_used(gpu, settings)
    }

    /// A sentence where it is not, because the device cannot keep so much; else empty.
    pub(crate) fn notice(gpu: &Gpu, settings: &Settings) -> String {
        notice(&gpu.device.limits(), settings)
    }

    /// `None` where light is not reprojected.
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame: &wgpu::BindGroupLayout,
        input: &wgpu::BindGroupLayout,
    ) -> Option<Self> {
        is_used(gpu, settings).then(|| Self {
            passes: HistoryPasses::new(gpu, settings, frame, input),
            last: None,
            moved: false,
            gaze: [settings.eye.gaze, settings.stereo.gaze_shift],
            changed: Changed::default(),
            frame: 0,
            rested: 0,
            whole_round: false,
            reset: true,
            now_changed: Changed::default(),
            in_full: false,
            again: false,
            lit: Lit::default(),
            parameters: HistoryParameters::default(),
            changed_places: Vec::new(),
        })
    }

    /// The next frame follows none.
    pub(crate) fn forget(&mut self) {
        self.last = None;
    }

    /// The next frame shows another pose of the scene.
    pub(crate) fn scene_moved(&mut self) {
        self.moved = true;
    }

    /// The next frame's lights are other ones.
    pub(crate) fn lights_changed(&mut self, before: &[LightUniform], now: &[LightUniform]) {
        self.changed.add(before, now);
    }

    /// Light differs within these spheres in the next frame: other shadows, or other surfaces.
    pub(crate) fn light_changed(&mut self, places: &[Place]) {
        self.changed.add_places(places);
    }

    /// Finds out what the next frame has in common with the last one.
    pub(crate) fn follow(&mut self, settings: &Settings, (camera, previous): (&Camera, &Camera)) {
        let gaze = [settings.eye.gaze, settings.stereo.gaze_shift];
        let is_whole = self.rested >= ROUND;
        // Once every pixel was shaded by itself it is all the same where the eyes look, unless the
        // tiles of shadows follow them.
        let lighting = &settings.lighting;
        let follows_gaze = !is_whole
            || (lighting.shadows != Shadows::Off && lighting.shadow_sizes == ShadowSizes::Rate);
        let moved = std::mem::take(&mut self.moved)
            || self.changed != Changed::Nowhere
            || (follows_gaze && !is_steady(self.gaze, gaze));
        let changed = std::mem::take(&mut self.changed);
        self.reset = self.last.as_ref().is_none_or(|last| last != previous)
            || changed == Changed::Everywhere;
        let rests = !self.reset && !moved && camera == previous;
        self.whole_round = is_whole && !rests;
        self.rested = if rests {
            self.rested.saturating_add(1)
        } else {
            self.gaze = gaze;
            0
        };
        self.last = Some(camera.clone());
        self.now_changed = changed;
    }

    /// Whether the next frame shows what the last one showed.
    pub(crate) fn rests(&self) -> bool {
        self.rested > 0
    }

    /// Whether the frame shows the last one's radiance again, all of whose pixels were shaded.
    pub(crate) fn is_again(&self) -> bool {
        self.again
    }

    /// Takes in where shadows differ that the frame at hand has found since [`Self::follow`].
    fn take_late_changes(&mut self) {
        match std::mem::take(&mut self.changed) {
            Changed::Nowhere => return,
            Changed::Within(places) => self.now_changed.add_places(&places),
            Changed::Everywhere => self.reset = true,
        }
        self.whole_round |= self.rested > ROUND;
        self.rested = 0;
        self.reset |= self.now_changed == Changed::Everywhere;
    }

    /// Decides what the frame does: `active` keeps light, otherwise every pixel is shaded.
    pub(crate) fn begin(&mut self, gpu: &Gpu, settings: &Settings, active: bool) {
        self.take_late_changes();
        self.again = !active && self.in_full && self.rests();
        if active && std::mem::take(&mut self.in_full) {
            (self.reset, self.rested) = (true, 0);
        }
        self.in_full = !active;
        let reset = self.reset;
        self.frame = if reset { 0 } else { self.frame.wrapping_add(1) };
        self.lit = Lit {
            even: self.lit.even != (self.rested == 0),
            turn: self.rested.checked_sub(1),
        };
        let changed = std::mem::take(&mut self.now_changed);
        self.parameters = self.frame_parameters(settings, reset);
        self.changed_places = match changed {
            Changed::Within(places) => places,
            Changed::Nowhere | Changed::Everywhere => Vec::new(),
        };
        self.passes
            .write(gpu, &self.parameters, &self.changed_places);
    }

    /// Parameters of the frame at hand.
    fn frame_parameters(&self, settings: &Settings, reset: bool) -> HistoryParameters {
        // What a block's renewal and tolerance are at a quality of 9.5; a step of one JOD is a
        // factor of 4. Found by measurement.
        let finer = 4.0_f32.powf(settings.eye.quality_jod - 9.5);
        HistoryParameters {
            rounding: rounding(self.frame),
            phase: match self.lit.turn {
                Some(turn) => turn,
                // The golden ratio's part: any few frames that follow each other lie evenly in the
                // order.
                None => self.frame.wrapping_mul(2_654_435_769),
            },
            reset: u32::from(reset),
            renewal: (finer / 12.0).clamp(1.0 / 64.0, 1.0),
            tolerance: (0.045 / finer).clamp(0.01, 1.0),
            change: 0.5,
            whole_round: u32::from(self.whole_round),
        }
    }

    /// Whether the frame's rates matter: at rest pixels are shaded in turn, whatever their rate.
    pub(crate) fn needs_rates(&self) -> bool {
        self.lit.turn.is_none()
    }

    /// Encodes the frame's lighting of solid surfaces into the radiance target.
    pub(crate) fn light(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        targets: &Targets,
        kept: (&RateTargets, &HistoryTargets),
    ) {
        self.passes.light(recorder, input, targets, kept, self.lit);
    }

    /// Encodes the lighting of every pixel of solid surfaces into the radiance target, by the pass
    /// of full shading.
    pub(crate) fn light_in_full(
        &self,
        recorder: &mut Recorder<'_>,
        shading: &ShadingPass,
        input: &wgpu::BindGroup,
        targets: &Targets,
        kept: &HistoryTargets,
    ) {
        if !self.again {
            shading.shade(recorder, input, &kept.radiance);
        }
        kept.show(recorder, &targets.radiance_view);
    }

    /// The stats of a frame that left these lists.
    pub(crate) fn stats(listed: &[u8], coarsest: u8, pixels: u64) -> CoarseStats {
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(listed);
        let levels = &words[1..=1 + usize::from(coarsest)];
        let samples_per_level: Vec<_> = levels.iter().map(|&n| u64::from(n)).collect();
        let unlit_pixels = u64::from(words[2 * targets::LISTED_BYTES as usize / 4]);
        let shaded = samples_per_level.iter().sum::<u64>() + unlit_pixels;
        CoarseStats {
            samples_per_level,
            unlit_pixels,
            shaded_fraction: shaded as f64 / pixels as f64,
            backend: UsedBackend::Compute.name().to_owned(),
            backend_reason: "light is kept from frame to frame".to_owned(),
            active: true,
            ..CoarseStats::default()
        }
    }
}

/// Whether eyes look at about the same place: trackers tremble while an eye rests.
fn is_steady(before: [[f32; 2]; 2], now: [[f32; 2]; 2]) -> bool {
    let apart = |i: usize, k: usize| (before[i][k] - now[i][k]).abs();
    (0..4).all(|i| apart(i / 2, i % 2) <= STEADY_GAZE)
}

/// What is added to places before they are rounded to whole pixels: so that what moves by a part of
/// a pixel a frame moves by that on average (the same recurrence as the pixels' order, in two
/// dimensions).
fn rounding(frame: u32) -> [f32; 2] {
    [3_242_174_889_u32, 2_447_445_414].map(|step| {
        let part = frame.wrapping_mul(step) >> 8;
        (part as f32 / 16_777_216.0 - 0.5) * 0.98
    })
}
