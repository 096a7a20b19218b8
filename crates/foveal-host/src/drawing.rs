//! A scene on a device, drawn moment by moment.

use std::rc::Rc;

use foveal::{Frame, FrameStats, RadianceImage, Renderer, Settings, Shading, Shadows};
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

/// Whether a frame's picture depends on the frames before.
pub fn follows_on(settings: &Settings) -> bool {
    let lighting = &settings.lighting;
    // Tiles that wait show shadows of frames before.
    let waits = lighting.shadows != Shadows::Off && lighting.shadow_budget > 0;
    waits || keeps_shading(settings)
}

/// Whether shading is kept from frame to frame, so that a moment drawn twice differs.
fn keeps_shading(settings: &Settings) -> bool {
    match settings.shading.mode {
        Shading::Full => false,
        Shading::Variable => true,
        Shading::Coarse => settings.keeps_light(),
    }
}

/// The figures of a frame that `draw` draws: again where anti-aliasing left surfaces out in want of
/// room, which it has from then on.
pub fn draw_with_room(
    mut draw: impl FnMut() -> anyhow::Result<FrameStats>,
) -> anyhow::Result<FrameStats> {
    let mut figures = draw()?;
    while figures.surfaces_left_out > 0 {
        let before = figures.surfaces_left_out;
        figures = draw()?;
        if figures.surfaces_left_out >= before {
            break;
        }
    }
    Ok(figures)
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
    /// frames drawn before, unless it follows on ([`follows_on`]): shading that is kept where the
    /// other is what was drawn last, shadows that wait on whatever was.
    pub fn draw_moment(&mut self, time_s: f32, previous_time_s: f32) -> anyhow::Result<FrameStats> {
        let is_elsewhere = self.posed_s != Some(previous_time_s);
        if is_elsewhere {
            self.pose(previous_time_s)?;
        }
        let mut previous_camera = self.viewpoint.at(&self.scene, previous_time_s);
        if is_elsewhere && self.scene.is_animated() {
            // By another name it is not the one that was drawn last: what is kept from frame to frame
            // is of another pose than motion is.
            previous_camera.name.push_str(" at another time");
        }
        // A pose that the last frame has shown rests without another.
        if is_elsewhere || time_s != previous_time_s {
            self.pose(time_s)?;
        }
        let camera = self.viewpoint.at(&self.scene, time_s);
        let frame = Frame::new(&camera).with_previous(&previous_camera);
        Ok(block_on(self.renderer.render(&frame))?)
    }

    /// As [`Drawing::draw_moment`]; where no shading is kept, with room for all of the picture's
    /// surfaces, so that which of them it shows does not depend on the frames before.
    pub fn draw_picture(
        &mut self,
        time_s: f32,
        previous_time_s: f32,
    ) -> anyhow::Result<FrameStats> {
        if keeps_shading(self.renderer.settings()) {
            return self.draw_moment(time_s, previous_time_s);
        }
        draw_with_room(|| self.draw_moment(time_s, previous_time_s))
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

#[cfg(test)]
mod tests {
    use super::*;
    use foveal::{CoarseBackend, CoarseSample, Composite, DebugView};

    type Change = fn(&mut Settings);

    fn coarse(change: Change) -> Settings {
        Settings::default()
            .with(|s| s.shading.mode = Shading::Coarse)
            .with(change)
    }

    #[test]
    fn what_keeps_no_light_follows_on_nothing() {
        assert!(follows_on(&coarse(|_| {})));
        let others: [Change; 5] = [
            |s| s.coarse.history = false,
            |s| s.coarse.composite = Composite::Smooth,
            |s| s.coarse.sample = CoarseSample::Typical,
            |s| s.coarse.backend = CoarseBackend::Stencil,
            |s| s.picture.view = DebugView::Motion,
        ];
        for (i, other) in others.into_iter().enumerate() {
            assert!(!follows_on(&coarse(other)), "{i}");
        }
    }

    #[test]
    fn shadows_that_wait_follow_on() {
        let full = |shadows, budget| {
            Settings::default().with(|s| {
                s.shading.mode = Shading::Full;
                (s.lighting.shadows, s.lighting.shadow_budget) = (shadows, budget);
            })
        };
        assert!(follows_on(&full(Shadows::Hard, 300)));
        assert!(!follows_on(&full(Shadows::Off, 300)));
        assert!(!follows_on(&full(Shadows::Soft, 0)));
    }

    #[test]
    fn a_frame_is_drawn_again_while_that_makes_room() {
        // (surfaces that each frame leaves out, frames that are drawn)
        for (left_out, frames) in [(&[0][..], 1), (&[9, 0], 2), (&[9, 5, 0], 3), (&[9, 9], 2)] {
            let mut drawn = left_out.iter();
            let draw = || {
                let mut stats = FrameStats::default();
                stats.surfaces_left_out = *drawn.next().unwrap();
                Ok(stats)
            };
            let last = draw_with_room(draw).unwrap().surfaces_left_out;
            assert_eq!(last, left_out[frames - 1]);
            assert_eq!(drawn.count(), 0);
        }
    }
}
