//! What follows a call that failed half way.
//!
//! Memory runs out, or a driver refuses a call, anywhere between a frame's first buffer and its
//! submission. Every buffer that grows and every pipeline that is made when it is first needed may
//! be invalid then. They are made anew, all of them, before the next frame: slow, but rare, and no
//! stage has to know how to fail.

use super::{Renderer, Stages};
use crate::gpu::{ErrorTrap, GpuTimer};
use crate::output::{PresentPass, Upscale};
use crate::scene::FrameBindings;
use crate::{Error, Settings};

impl Renderer {
    /// Passes a result on, and remembers an error.
    pub(super) fn torn<T>(&mut self, result: Result<T, Error>) -> Result<T, Error> {
        self.is_torn |= result.is_err();
        result
    }

    /// Makes anew what a failure may have left half made: everything but the scene's own resources,
    /// which are replaced only when all of them are there. Of these a pose changes lights and
    /// materials, which are uploaded again, and the vertices of meshes that deform, which the host uploads again.
    pub(super) async fn mend(&mut self) -> Result<(), Error> {
        if !self.is_torn {
            return Ok(());
        }
        self.gpu.check_alive()?;
        let trap = ErrorTrap::new(&self.gpu, "going on after a failure");
        let mut bindings = FrameBindings::new(&self.gpu, self.environment.to_bind());
        bindings.write_instances(&self.gpu, self.scene.instance_uniforms());
        self.scene.write_posed(&self.gpu);
        let present = PresentPass::new(&self.gpu);
        let timer = GpuTimer::new(&self.gpu);
        let upscale = Upscale::new(&self.gpu, &self.settings);
        trap.finish().await?;
        let timer = timer?;
        let settings = self.stages.settings.clone();
        let mut stages = self.new_stages(&settings, Some(&bindings)).await?;
        // It is the processor's alone, and may be frozen.
        stages.culling = self.stages.culling.take();
        (self.stages, self.frame_bindings) = (stages, bindings);
        (self.present, self.timer, self.upscale) = (present, timer, upscale);
        self.in_flight = None;
        self.rate_image_is_new = false;
        self.is_torn = false;
        Ok(())
    }

    /// As [`Self::mend`], but where memory is out all stays torn for the next call to mend.
    pub(super) async fn mend_as_memory_allows(&mut self) -> Result<(), Error> {
        match self.mend().await {
            Err(Error::OutOfMemory { .. }) => Ok(()),
            mended => mended,
        }
    }

    /// The stages for other settings, and for other bindings where there are any.
    pub(super) async fn new_stages(
        &mut self,
        settings: &Settings,
        bindings: Option<&FrameBindings>,
    ) -> Result<Box<Stages>, Error> {
        Stages::new(
            &self.gpu,
            settings,
            bindings.unwrap_or(&self.frame_bindings),
            &self.material_layout,
            self.rate_image.as_ref(),
            (&mut self.trials, self.clock),
        )
        .await
    }
}
