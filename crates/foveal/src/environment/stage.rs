//! Which environment lights the frames.

use foveal_scene::{Environment, ImageLight};

use super::EnvironmentMap;
use crate::{Background, EnvironmentSource, Settings};

/// The maps that settings choose from.
#[derive(Debug, Default)]
pub(crate) struct EnvironmentStage {
    /// The host's.
    image: Option<EnvironmentMap>,
    /// The last scene's sky, filtered.
    sky: Option<(Environment, EnvironmentMap)>,
    /// The last scene's own environment, filtered.
    own: Option<(ImageLight, EnvironmentMap)>,
    in_use: Option<EnvironmentMap>,
    /// The table of reflectances is bound.
    has_reflectances: bool,
}

/// What a frame's uniform block has to say of the environment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EnvironmentTerms<'a> {
    pub(crate) sky: &'a Environment,
    /// Where a map stands for the sky.
    pub(crate) map: Option<&'a EnvironmentMap>,
}

/// What is bound of an environment.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ToBind<'a> {
    /// Without one, a black one.
    pub(crate) map: Option<&'a EnvironmentMap>,
    /// Whether reflectances are looked up.
    pub(crate) reflectances: bool,
}

/// A choice that is not in force yet.
#[derive(Debug)]
pub(crate) struct ChosenEnvironment {
    stage: EnvironmentStage,
    /// Whether another map is in use than before.
    pub(crate) is_new: bool,
}

impl ChosenEnvironment {
    /// What to bind.
    pub(crate) fn to_bind(&self) -> ToBind<'_> {
        self.stage.to_bind()
    }
}

impl EnvironmentStage {
    /// Chooses the map that the settings ask for, and filters the sky or the scene's own environment
    /// where that is it; `image` is the host's map in place of the last one. Nothing changes before
    /// [`EnvironmentStage::take`].
    pub(crate) fn choose(
        &self,
        settings: &Settings,
        (sky, own): (&Environment, Option<&ImageLight>),
        image: Option<EnvironmentMap>,
    ) -> ChosenEnvironment {
        let image = image.or_else(|| self.image.clone());
        let mut filtered = self.sky.clone();
        // Of another scene's nothing is kept.
        let known = |of: &ImageLight| own.is_some_and(|own| is_same(of, own));
        let mut filtered_own = self.own.clone().filter(|(of, _)| known(of));
        let in_use = match (settings.lighting.environment, &image) {
            (EnvironmentSource::Gradient | EnvironmentSource::None, _) => None,
            (EnvironmentSource::Scene, _) => own.map(|own| {
                let filter = || (own.clone(), EnvironmentMap::of_light(own));
                let (_, map) = filtered_own.get_or_insert_with(filter);
                map.clone()
            }),
            (EnvironmentSource::Image, Some(image)) => Some(image.clone()),
            (EnvironmentSource::Image | EnvironmentSource::Sky, _) => {
                let (_, map) = match filtered.take().filter(|(of, _)| of == sky) {
                    Some(known) => filtered.insert(known),
                    None => filtered.insert((*sky, EnvironmentMap::of_gradient(sky))),
                };
                Some(map.clone())
            }
        };
        let is_same = match (&in_use, &self.in_use) {
            (None, None) => true,
            (Some(a), Some(b)) => a.is_same(b),
            _ => false,
        };
        let wants_table = settings.lighting.multiple_scattering || in_use.is_some();
        let lacks_table = wants_table && !self.has_reflectances;
        ChosenEnvironment {
            is_new: !is_same || lacks_table,
            stage: Self {
                image,
                sky: filtered,
                own: filtered_own,
                in_use,
                // What is bound stays.
                has_reflectances: wants_table || is_same && self.has_reflectances,
            },
        }
    }

    /// Takes a choice over.
    pub(crate) fn take(&mut self, chosen: ChosenEnvironment) {
        *self = chosen.stage;
    }

    /// What a frame is told, in a scene with this sky.
    pub(crate) fn terms<'a>(&'a self, sky: &'a Environment) -> EnvironmentTerms<'a> {
        EnvironmentTerms {
            sky,
            map: self.map(),
        }
    }

    /// What is bound.
    pub(crate) fn to_bind(&self) -> ToBind<'_> {
        ToBind {
            map: self.map(),
            reflectances: self.has_reflectances,
        }
    }

    /// The map that was chosen.
    pub(crate) fn map(&self) -> Option<&EnvironmentMap> {
        self.in_use.as_ref()
    }
}

/// Whether both are copies of one.
fn is_same(a: &ImageLight, b: &ImageLight) -> bool {
    let terms = |light: &ImageLight| (light.rotation, light.intensity, light.irradiance);
    std::sync::Arc::ptr_eq(&a.radiance, &b.radiance) && terms(a) == terms(b)
}

/// The settings as a scene is drawn with them: where it has no environment of its own, the gradient
/// stands for it.
pub(crate) fn resolved(settings: Settings, has_own: bool) -> Settings {
    settings.with(|s| {
        if s.lighting.environment == EnvironmentSource::Scene && !has_own {
            s.lighting.environment = EnvironmentSource::Gradient;
        }
    })
}

/// Settings that change how shaders look the environment up.
pub(crate) fn environment_constants(settings: &Settings) -> [(&'static str, f64); 4] {
    let environment = match settings.lighting.environment {
        EnvironmentSource::Gradient => 0,
        EnvironmentSource::Scene | EnvironmentSource::Sky | EnvironmentSource::Image => 1,
        EnvironmentSource::None => 2,
    };
    let background = match settings.lighting.background {
        Background::Environment => 0,
        Background::Blurred => 1,
        Background::None => 2,
    };
    [
        ("ENVIRONMENT", f64::from(environment)),
        ("BACKGROUND", f64::from(background)),
        (
            "MULTIPLE_SCATTERING",
            f64::from(u8::from(settings.lighting.multiple_scattering)),
        ),
        (
            "AMBIENT_OCCLUSION",
            f64::from(u8::from(settings.occludes_ambient())),
        ),
    ]
}
