//! What can be asked of a renderer about its last frame.

use foveal_cull::Visibility;

use super::Renderer;
use crate::culling::{CullingStage, CullingStats};
use crate::gpu::{ErrorTrap, start_reading};
use crate::output::RadianceImage;
use crate::stereo::EyeLayout;
use crate::{DebugView, Error, SceneStats};

impl Renderer {
    /// The last frame's picture: sRGB RGBA8 rows, top to bottom, `width * height * 4` bytes with
    /// [`Settings::picture_size`](crate::Settings::picture_size), alpha 255. Black where no frame
    /// has been drawn since [`Renderer::picture`] became another one.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`].
    pub async fn read_picture(&self) -> Result<Vec<u8>, Error> {
        let trap = ErrorTrap::new(&self.gpu, "reading the picture back");
        let reading = start_reading(&self.gpu, self.picture().texture());
        trap.finish().await?;
        let mut bytes = reading.bytes(&self.gpu).await?;
        // As a new texture is: no frame has been drawn into it.
        if bytes.iter().all(|byte| *byte == 0) {
            bytes.as_chunks_mut().0.fill([0, 0, 0, 255]);
        }
        Ok(bytes)
    }

    /// The last frame's radiance, at the size at which the frame was drawn
    /// ([`PictureSettings::render_scale`](crate::PictureSettings::render_scale) makes it smaller).
    /// Two eyes lie side by side, without lenses. Black as [`Renderer::read_picture`] is.
    ///
    /// # Errors
    /// [`Error::Setting`] where a debug view was drawn; [`Error::DeviceLost`],
    /// [`Error::OutOfMemory`].
    pub async fn read_radiance(&self) -> Result<RadianceImage, Error> {
        let settings = &self.stages.settings;
        if settings.picture.view != DebugView::Final {
            return Err(Error::Setting {
                name: "view",
                value: "a debug view".to_owned(),
                expected: "final: debug views have no radiance",
            });
        }
        let texture = self.stages.targets.radiance_view.texture();
        let trap = ErrorTrap::new(&self.gpu, "reading the radiance back");
        let reading = start_reading(&self.gpu, texture);
        trap.finish().await?;
        let bytes = reading.bytes(&self.gpu).await?;
        let layout = EyeLayout::of(settings);
        let eyes = if settings.is_stereo() { 2 } else { 1 };
        Ok(RadianceImage::new(&bytes, texture.width(), &layout, eyes))
    }

    /// What the culler found in the last frame; `None` without culling.
    #[must_use]
    pub fn culling(&self) -> Option<CullingStats> {
        self.stages.culling.as_ref().map(CullingStage::stats)
    }

    /// What became of each of the scene's objects in the last frame; empty without culling.
    #[must_use]
    pub fn visibility(&self) -> &[Visibility] {
        match &self.stages.culling {
            Some(culling) => culling.visibility(),
            None => &[],
        }
    }

    /// The last frame's occlusion buffer: width, height, and rows from the top, near / distance (0:
    /// nothing proven), for orthographic cameras 1 at the near plane to 0 at the far one. `None`
    /// without culling.
    #[must_use]
    pub fn occluder_depth(&self) -> Option<(u32, u32, Vec<f32>)> {
        self.stages.culling.as_ref().map(CullingStage::depth)
    }

    /// The last frame's picture on the device, as [`Renderer::read_picture`] gives it: sRGB-encoded
    /// [`wgpu::TextureFormat::Rgba8Unorm`]. Ask for it after each frame: other settings, another
    /// scene, and a call after one that failed may make another one, all zeros until a frame is
    /// drawn.
    #[must_use]
    pub fn picture(&self) -> &wgpu::TextureView {
        match &self.upscale {
            Some(upscale) => upscale.picture_view(),
            None => self.stages.targets.shown(),
        }
    }

    /// Counts of the scene that was set last.
    #[must_use]
    pub fn scene_stats(&self) -> SceneStats {
        self.scene.stats
    }
}
