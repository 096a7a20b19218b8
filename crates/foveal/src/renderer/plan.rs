//! Which samples a frame shades.

use super::Stages;
use crate::shading::RatePlan;
use foveal_scene::Camera;

/// Samples of the G-buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum SampleChoice {
    /// One per pixel.
    #[default]
    Every,
    /// One or a few per block of the rate map.
    Coarse,
    /// Those that the rate mask lists.
    Variable,
}

/// Which samples a frame shades, chosen once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FramePlan {
    /// Samples whose rates are found before anything is shaded: by the rate map or the rate mask.
    /// [`SampleChoice::Every`] needs no rates.
    pub(super) rates: SampleChoice,
    /// Where materials are resolved.
    pub(super) materials: SampleChoice,
    /// Where surfaces are lit besides edges; `None` where no light is shown, or edges are all that
    /// is lit.
    pub(super) lighting: Option<SampleChoice>,
    /// Pixels at edges are lit more than once: the picture is made from sub-samples.
    pub(super) edges: bool,
    /// Every pixel is shaded besides, to measure what rates save.
    pub(super) compares: bool,
    /// The picture shows light, not a view of the G-buffer.
    pub(super) is_lit: bool,
}

impl Stages {
    /// Chooses the samples of the next frame, seen by the first of these cameras and the last one
    /// by the second.
    pub(super) fn plan(&mut self, cameras: (&Camera, &Camera)) -> FramePlan {
        let is_lit = self.settings.picture.view.is_lit();
        let stage = self.settings.stage();
        let (at_rates, chosen) = match (&mut self.variable, &mut self.coarse) {
            _ if !is_lit => Default::default(),
            (Some(variable), _) => (SampleChoice::Variable, variable.plan(cameras)),
            (_, Some(coarse)) => (SampleChoice::Coarse, coarse.plan(&self.settings, cameras)),
            _ => Default::default(),
        };
        let rates = match chosen {
            RatePlan { active: true, .. } => at_rates,
            _ => SampleChoice::Every,
        };
        let of_rates = |applies: bool| {
            if applies { rates } else { SampleChoice::Every }
        };
        let needs_ordinary = |a: &crate::antialias::AntialiasStage| a.needs_ordinary();
        let lighting = match of_rates(rates == SampleChoice::Coarse || stage.has_lighting()) {
            SampleChoice::Every if !self.antialias.as_ref().is_none_or(needs_ordinary) => None,
            chosen => Some(chosen),
        };
        FramePlan {
            rates,
            materials: of_rates(stage.has_material()),
            lighting: lighting.filter(|_| is_lit),
            edges: self.antialias.is_some(),
            compares: chosen.compares,
            is_lit,
        }
    }
}
