//! Draws pictures and videos as `foveal render` does, each with a renderer of its own, and keeps
//! those that several displays share.

use std::rc::Rc;

use foveal::{FrameStats, Settings};
use foveal_scene::Scene;

use crate::subject::{Subject, timed_renderer};
use foveal_host::camera::Viewpoint;
use foveal_host::drawing::{Drawing, moment};
use foveal_host::picture::Picture;

/// Pictures of one way of shading, one after the other.
#[derive(Debug)]
pub(super) struct Shot {
    pub(super) pictures: Vec<Picture>,
    /// Lighting evaluations by pixels, the mean over all pictures.
    pub(super) lit_fraction: f64,
}

/// Where pictures are drawn.
pub(super) struct Studio<'a> {
    pub(super) subject: &'a Subject,
    at_rest: Rc<Viewpoint>,
    along: Rc<Viewpoint>,
    stills: Vec<(Settings, Rc<Shot>)>,
    videos: Vec<(Settings, Rc<Shot>)>,
}

impl<'a> Studio<'a> {
    /// `at_rest` is where pictures are seen from, `along` videos.
    pub(super) fn new(subject: &'a Subject, at_rest: Rc<Viewpoint>, along: Rc<Viewpoint>) -> Self {
        Self {
            subject,
            at_rest,
            along,
            stills: Vec::new(),
            videos: Vec::new(),
        }
    }

    /// Drops what no picture of this size needs.
    pub(super) fn forget_other_sizes(&mut self, size: (u32, u32)) {
        for shots in [&mut self.stills, &mut self.videos] {
            shots.retain(|(settings, _)| (settings.picture.width, settings.picture.height) == size);
        }
    }

    /// The picture after `warmup` others of the same view.
    pub(super) fn still(&mut self, settings: &Settings, warmup: u32) -> anyhow::Result<Rc<Shot>> {
        if let Some((_, shot)) = self.stills.iter().find(|(known, _)| known == settings) {
            return Ok(Rc::clone(shot));
        }
        let mut drawing = self.drawing(settings, &self.at_rest)?;
        for _ in 0..warmup {
            drawing.draw_picture(0.0, 0.0)?;
        }
        let shot = Rc::new(shoot(&mut drawing, &[0.0])?);
        self.stills.push((settings.clone(), Rc::clone(&shot)));
        Ok(shot)
    }

    /// A video along the path. `is_shared`: other displays have the same, so that it is kept for
    /// them; to keep all would take gigabytes.
    pub(super) fn video(
        &mut self,
        settings: &Settings,
        is_shared: bool,
        (frames, fps): (u32, f32),
    ) -> anyhow::Result<Rc<Shot>> {
        if let Some((_, shot)) = self.videos.iter().find(|(known, _)| known == settings) {
            return Ok(Rc::clone(shot));
        }
        let mut drawing = self.drawing(settings, &self.along)?;
        let moments: Vec<f32> = (0..frames).map(|frame| moment(frame, fps)).collect();
        let shot = Rc::new(shoot(&mut drawing, &moments)?);
        if is_shared {
            self.videos.push((settings.clone(), Rc::clone(&shot)));
        }
        Ok(shot)
    }

    /// A renderer for what moves along the path.
    pub(super) fn along(&self, settings: &Settings) -> anyhow::Result<Drawing> {
        self.drawing(settings, &self.along)
    }

    fn drawing(&self, settings: &Settings, view: &Rc<Viewpoint>) -> anyhow::Result<Drawing> {
        let Subject { gpu, scene, .. } = self.subject;
        let renderer = timed_renderer(gpu, scene, settings)?;
        // What does not move is on the device, and not looked at again.
        let scene = if scene.is_animated() {
            Scene {
                textures: Vec::new(),
                ..scene.clone()
            }
        } else {
            Scene {
                name: scene.name.clone(),
                cameras: scene.cameras.clone(),
                ..Scene::default()
            }
        };
        Ok(Drawing::new(renderer, scene, Rc::clone(view)))
    }
}

/// Draws these moments, each after the one before it.
fn shoot(drawing: &mut Drawing, moments: &[f32]) -> anyhow::Result<Shot> {
    let mut pictures = Vec::new();
    let mut lit = 0.0;
    let mut before_s = moments.first().copied().unwrap_or(0.0);
    for &time_s in moments {
        let stats = drawing.draw_picture(time_s, before_s)?;
        lit += lit_fraction(&stats);
        pictures.push(drawing.picture(&stats)?);
        before_s = time_s;
    }
    Ok(Shot {
        lit_fraction: lit / moments.len().max(1) as f64,
        pictures,
    })
}

fn lit_fraction(stats: &FrameStats) -> f64 {
    let pixels = u64::from(stats.width) * u64::from(stats.height);
    stats.shaded_samples as f64 / pixels.max(1) as f64
}

#[cfg(test)]
mod tests {
    use foveal_host::camera::CameraArgs;

    use super::*;

    #[test]
    fn only_a_video_that_displays_share_is_kept() {
        let scene = foveal_generate::cornell();
        let view = Viewpoint::choose(&CameraArgs::default(), &scene, "cornell").unwrap();
        let view = Rc::new(view);
        let camera = view.at(&scene, 0.0);
        let gpu = foveal_host::gpu::open(None).unwrap();
        let subject = Subject { gpu, scene, camera };
        let mut studio = Studio::new(&subject, Rc::clone(&view), view);
        let settings = Settings::default().with(|s| {
            s.picture.width = 16;
            s.picture.height = 16;
        });
        for (is_shared, kept) in [(false, 0), (true, 1), (true, 1)] {
            let shot = studio.video(&settings, is_shared, (2, 30.0)).unwrap();
            assert_eq!((shot.pictures.len(), studio.videos.len()), (2, kept));
        }
    }
}
