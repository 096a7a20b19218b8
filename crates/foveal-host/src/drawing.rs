//! A scene on a device, drawn moment by moment.

use std::rc::Rc;

use foveal::{Frame, FrameStats, RadianceImage, Renderer};
use foveal_scene::Scene;
use pollster::block_on;

use crate::camera::Viewpoint;
use crate::picture::Picture;

/// When a frame is, in seconds.
pub fn moment(frame: u32, fps: f32) -> f32 {
    // In f64: exact for every frame number, so that the moment does not depend on how it was
    // reached.
    (f64::from(frame) / f64::from(fps)) as f32
}

/// Everything that one frame needs, ready.
pub struct Drawing {
    /// The renderer, which holds the scene.
    pub renderer: Renderer,
    /// What is drawn.
    pub scene: Scene,
    /// Where it is seen from.
    pub viewpoint: Rc<Viewpoint>,
    /// Time of the renderer's current pose; `None` where it is not known, or does not matter.
    posed_s: Option<f32>,
}

impl Drawing {
    /// `renderer` holds `scene`, posed at time 0.
    pub fn new(renderer: Renderer, scene: Scene, viewpoint: Rc<Viewpoint>) -> Self {
        Self {
            renderer,
            scene,
            viewpoint,
            posed_s: Some(0.0),
        }
    }

    /// Draws a moment, with motion since another. Its picture depends on the two alone, not on the
    /// frames drawn before.
    pub fn draw_moment(&mut self, time_s: f32, previous_time_s: f32) -> anyhow::Result<FrameStats> {
        let is_elsewhere = self.posed_s != Some(previous_time_s);
        if is_elsewhere {
            self.pose(previous_time_s)?;
        }
        let previous_camera = self.viewpoint.at(&self.scene, previous_time_s);
        // A pose that the last frame has shown rests without another.
        if is_elsewhere || time_s != previous_time_s {
            self.pose(time_s)?;
        }
        let camera = self.viewpoint.at(&self.scene, time_s);
        let frame = Frame::new(&camera).with_previous(&previous_camera);
        Ok(block_on(self.renderer.render(&frame))?)
    }

    /// The last frame.
    pub fn picture(&self, stats: &FrameStats) -> anyhow::Result<Picture> {
        let bytes = block_on(self.renderer.read_picture())?;
        Picture::from_rgba(stats.width, stats.height, bytes)
    }

    /// The last frame's radiance.
    pub fn radiance(&self) -> anyhow::Result<RadianceImage> {
        Ok(block_on(self.renderer.read_radiance())?)
    }

    fn pose(&mut self, time_s: f32) -> anyhow::Result<()> {
        if self.scene.is_animated() {
            self.posed_s = None;
            self.scene.pose(time_s);
            block_on(self.renderer.update_pose(&self.scene))?;
            self.posed_s = Some(time_s);
        }
        Ok(())
    }
}
