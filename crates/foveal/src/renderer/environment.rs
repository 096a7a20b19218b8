//! Which environment is bound.

use foveal_scene::{Environment, ImageLight};

use super::Renderer;
use crate::environment::{ChosenEnvironment, EnvironmentMap};
use crate::gpu::ErrorTrap;
use crate::scene::BoundEnvironment;
use crate::{Error, Settings};

impl Renderer {
    /// Takes over the map of [`EnvironmentSource::Image`](crate::EnvironmentSource::Image) in place
    /// of the last one; until there is one, the scene's sky stands for it.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`]; the renderer keeps its old map then.
    pub async fn set_environment(&mut self, map: EnvironmentMap) -> Result<(), Error> {
        self.mend().await?;
        let (settings, scene) = (&self.stages.settings, &self.scene);
        let around = (&scene.environment, scene.image_light.as_ref());
        let environment = self.upload_environment(settings, around, Some(map)).await?;
        self.take_environment(environment);
        Ok(())
    }

    /// Chooses the environment that settings, scene and host ask for, and uploads it where it is
    /// another one than before. Nothing changes before [`Renderer::take_environment`].
    pub(super) async fn upload_environment(
        &self,
        settings: &Settings,
        around: (&Environment, Option<&ImageLight>),
        image: Option<EnvironmentMap>,
    ) -> Result<(ChosenEnvironment, Option<BoundEnvironment>), Error> {
        let chosen = self.environment.choose(settings, around, image);
        if !chosen.is_new {
            return Ok((chosen, None));
        }
        let trap = ErrorTrap::new(&self.gpu, "uploading the environment");
        let bindings = &self.frame_bindings;
        let bound = bindings.with_environment(&self.gpu, chosen.to_bind());
        trap.finish().await?;
        Ok((chosen, Some(bound)))
    }

    pub(super) fn take_environment(
        &mut self,
        (chosen, bound): (ChosenEnvironment, Option<BoundEnvironment>),
    ) {
        self.environment.take(chosen);
        if let Some(bound) = bound {
            self.frame_bindings.set_environment(bound);
            self.stages.forget_light();
        }
    }
}
