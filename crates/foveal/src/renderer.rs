//! One frame, top to bottom.

use foveal_scene::{Camera, Scene};

use crate::{Error, FrameStats, Gpu, SceneStats, Settings};

/// The caller's clock: milliseconds since any fixed moment.
pub type Clock = fn() -> f64;

/// What changes from frame to frame besides the scene's pose.
#[derive(Clone, Debug)]
pub struct Frame<'a> {
    /// Where the frame is seen from.
    pub camera: &'a Camera,
    /// Where the frame before it was seen from, for motion vectors; `None`: from the same place.
    pub previous_camera: Option<&'a Camera>,
}

/// Draws scenes.
#[derive(Debug)]
pub struct Renderer {
    settings: Settings,
}

impl Renderer {
    /// Builds the pipelines and the targets for `settings`.
    ///
    /// # Errors
    /// [`Error::Limit`] or [`Error::Setting`] where the settings cannot be met on this device;
    /// [`Error::OutOfMemory`] where the targets do not fit.
    pub async fn new(gpu: &Gpu, settings: &Settings, clock: Option<Clock>) -> Result<Self, Error> {
        let _ = (gpu, clock);
        Ok(Self {
            settings: settings.clone(),
        })
    }

    /// Takes over other settings; targets and pipelines are rebuilt where they must be.
    ///
    /// # Errors
    /// As [`Renderer::new`]; the renderer keeps its old settings then.
    pub async fn set_settings(&mut self, settings: &Settings) -> Result<(), Error> {
        self.settings = settings.clone();
        Ok(())
    }

    /// Uploads a scene in place of the last one.
    ///
    /// # Errors
    /// [`Error::Limit`] where the scene exceeds the device's limits, [`Error::OutOfMemory`].
    pub async fn set_scene(&mut self, scene: &Scene) -> Result<(), Error> {
        let _ = scene;
        Ok(())
    }

    /// Takes over a new pose of the same scene (after [`Scene::pose`]). The pose before it becomes the
    /// previous one, from which motion vectors are taken.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub async fn update_pose(&mut self, scene: &Scene) -> Result<(), Error> {
        let _ = scene;
        Ok(())
    }

    /// Draws one frame into the renderer's own output and waits (asynchronously) for its figures.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`], [`Error::Validation`].
    pub async fn render(&mut self, frame: &Frame<'_>) -> Result<FrameStats, Error> {
        let _ = frame;
        Ok(FrameStats::default())
    }

    /// The last frame's picture: sRGB RGBA8 rows, top to bottom, `width * height * 4` bytes, alpha 255.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`].
    pub async fn read_picture(&self) -> Result<Vec<u8>, Error> {
        Ok(vec![
            0;
            (self.settings.width * self.settings.height * 4)
                as usize
        ])
    }

    /// Counts of the scene that was set last.
    #[must_use]
    pub fn scene_stats(&self) -> SceneStats {
        SceneStats::default()
    }
}
