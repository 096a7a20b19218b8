//! Which samples a frame shades.

use super::Stages;

/// Samples of the G-buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SampleChoice {
    /// One per pixel.
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
    /// Every pixel is shaded besides, to measure what variable shading saves.
    pub(super) compares: bool,
    /// The picture shows light, not a view of the G-buffer.
    pub(super) is_lit: bool,
}

impl Stages {
    /// Chooses the samples of the next frame.
    pub(super) fn plan(&mut self) -> FramePlan {
        let is_lit = self.settings.picture.view.is_lit();
        let stage = self.settings.stage();
        let variable = match &mut self.variable {
            Some(variable) if is_lit => variable.plan(),
            _ => crate::shading::VariablePlan::default(),
        };
        let rates = if variable.active {
            SampleChoice::Variable
        } else if self.coarse.is_some() && is_lit {
            SampleChoice::Coarse
        } else {
            SampleChoice::Every
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
            compares: variable.compares,
            is_lit,
        }
    }
}
