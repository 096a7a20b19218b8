//! One of the two pictures: a renderer with its settings and what its last frame cost.

use foveal::{Frame, FrameStats, Gpu, Renderer, Settings};
use foveal_scene::{Camera, Scene};

/// A renderer that follows its settings frame by frame.
pub(crate) struct Side {
    renderer: Renderer,
    /// What the page asks for; taken over before the next frame.
    requested: Settings,
    /// Where the last frame was seen from.
    previous: Option<Camera>,
}

impl Side {
    pub(crate) async fn new(gpu: &Gpu, settings: &Settings, scene: &Scene) -> Result<Self, String> {
        let mut renderer = Renderer::new(
            gpu,
            settings,
            foveal::RendererOptions::default().with_clock(now_ns),
        )
        .await
        .map_err(|cause| cause.to_string())?;
        renderer
            .set_scene(scene)
            .await
            .map_err(|cause| cause.to_string())?;
        Ok(Self {
            renderer,
            requested: settings.clone(),
            previous: None,
        })
    }

    pub(crate) fn request(&mut self, settings: Settings) {
        self.requested = settings;
    }

    pub(crate) async fn set_scene(&mut self, scene: &Scene) -> Result<(), String> {
        self.previous = None;
        // What is baked into the upload; settings that cannot be met are the next frame's to
        // report.
        let picture = &self.renderer.settings().picture;
        let (width, height) = (picture.width, picture.height);
        let settings = self.requested.clone().with(|s| {
            s.picture.width = width;
            s.picture.height = height;
        });
        let _ = self.renderer.set_settings(&settings).await;
        self.renderer
            .set_scene(scene)
            .await
            .map_err(|cause| cause.to_string())
    }

    /// Draws the next frame, shown as `width` x `height` pixels. `scene` is what was set last:
    /// settings that are baked into the upload set it anew.
    pub(crate) async fn draw(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        (width, height): (u32, u32),
    ) -> Result<FrameStats, String> {
        let mut settings = self.requested.clone().with(|s| {
            s.picture.width = width;
            s.picture.height = height;
        });
        // Some outputs show both eyes in full, side by side.
        let shown = u64::from(settings.picture_size().0.max(1));
        settings.picture.width = (u64::from(width).pow(2) / shown).max(1) as u32;
        let uploads = settings.needs_scene_again(self.renderer.settings());
        self.renderer
            .set_settings(&settings)
            .await
            .map_err(|cause| cause.to_string())?;
        if uploads {
            self.set_scene(scene).await?;
        }
        let frame = Frame::new(camera).with_previous(self.previous.as_ref());
        let stats = self.renderer.render(&frame).await;
        let stats = stats.map_err(|cause| cause.to_string())?;
        // One that failed was seen from nowhere.
        self.previous = Some(camera.clone());
        Ok(stats)
    }

    /// Pixels that the last frame drew, of all eyes' pictures.
    pub(crate) fn drawn_pixels(&self) -> u64 {
        self.renderer.settings().drawn_pixels()
    }

    /// The last frame, sRGB-encoded.
    pub(crate) fn picture(&self) -> &wgpu::TextureView {
        self.renderer.picture()
    }

    /// Its pixels.
    pub(crate) async fn read_picture(&self) -> Result<Vec<u8>, String> {
        self.renderer
            .read_picture()
            .await
            .map_err(|cause| cause.to_string())
    }
}

/// The page's clock in nanoseconds.
fn now_ns() -> u64 {
    (now_ms() * 1e6) as u64
}

/// The page's clock in milliseconds.
pub(crate) fn now_ms() -> f64 {
    web_sys::window()
        .and_then(|w| w.performance())
        .map_or(0.0, |p| p.now())
}
