//! Which environment lights the frames.

use foveal_scene::Environment;

use super::EnvironmentMap;
use crate::{Background, EnvironmentSource, Settings};

/// The maps that settings choose from.
#[derive(Debug, Default)]
pub(crate) struct EnvironmentStage {
    /// The host's.
    image: Option<EnvironmentMap>,
    /// The last scene's sky, filtered.
    sky: Option<(Environment, EnvironmentMap)>,
    in_use: Option<EnvironmentMap>,
}

/// What a frame's uniform block has to say of the environment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EnvironmentTerms<'a> {
    pub(crate) sky: &'a Environment,
    /// Where a map stands for the sky.
    pub(crate) map: Option<&'a EnvironmentMap>,
}

impl EnvironmentStage {
    /// Takes over the host's map.
    pub(crate) fn set_image(&mut self, map: EnvironmentMap) {
        self.image = Some(map);
    }

    /// Chooses the map that the settings ask for, and filters the sky where that is it; whether it
    /// is another one than before.
    pub(crate) fn choose(&mut self, settings: &Settings, sky: &Environment) -> bool {
        let wanted = match (settings.lighting.environment, &self.image) {
            (EnvironmentSource::Gradient | EnvironmentSource::None, _) => None,
            (EnvironmentSource::Image, Some(image)) => Some(image.clone()),
            (EnvironmentSource::Image | EnvironmentSource::Sky, _) => {
                let known = self.sky.take().filter(|(of, _)| of == sky);
                let filtered = known.unwrap_or_else(|| (*sky, EnvironmentMap::of_gradient(sky)));
                let map = filtered.1.clone();
                self.sky = Some(filtered);
                Some(map)
            }
        };
        let is_same = match (&wanted, &self.in_use) {
            (None, None) => true,
            (Some(a), Some(b)) => a.is_same(b),
            _ => false,
        };
        self.in_use = wanted;
        !is_same
    }

    /// What a frame is told, in a scene with this sky.
    pub(crate) fn terms<'a>(&'a self, sky: &'a Environment) -> EnvironmentTerms<'a> {
        EnvironmentTerms {
            sky,
            map: self.map(),
        }
    }

    /// The map that was chosen.
    pub(crate) fn map(&self) -> Option<&EnvironmentMap> {
        self.in_use.as_ref()
    }
}

/// Settings that change how shaders look the environment up.
pub(crate) fn environment_constants(settings: &Settings) -> [(&'static str, f64); 2] {
    let environment = match settings.lighting.environment {
        EnvironmentSource::Gradient => 0,
        EnvironmentSource::Sky | EnvironmentSource::Image => 1,
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
    ]
}
