//! The same walk in a window twice, without culling and with it, and every picture compared.

use super::modes::Mode;
use super::place::Place;
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy_foveal_cull::CpuOcclusionStats;

/// Frames in the first pose of each walk that are not compared: everything is uploaded, shaders are
/// compiled, and what is seen has been drawn for long enough to be relied on.
const AHEAD: usize = 12;
/// Frames after a walk until its last pictures have come back.
const BEHIND: usize = 8;
/// Metres that the walker goes in a frame.
const PACE: f32 = 0.3;

/// Two walks, under way or done.
#[derive(Resource, Clone, Debug)]
pub struct Twice {
    frames: usize,
    modes: [Mode; 2],
    /// Frames since the first one.
    frame: usize,
    /// Of each walk.
    pictures: [Vec<Option<Vec<u8>>>; 2],
    /// What was culled in the second walk, summed over its frames.
    pub culled: CpuOcclusionStats,
}

/// What two walks have shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Frames of each walk.
    pub frames: usize,
    /// Of these, frames of which a picture did not come back.
    pub missing: usize,
    /// Frames whose pictures differ between the walks.
    pub differ: usize,
    /// Pixels that differ in the worst of them.
    pub most_pixels: usize,
    /// Frames whose picture differs from the one before in the same walk.
    pub moved: usize,
}

impl Twice {
    /// Two walks of so many frames, by one way of culling and by another.
    pub fn new(frames: usize, modes: [Mode; 2]) -> Self {
        Self {
            frames,
            modes,
            frame: 0,
            pictures: [(); 2].map(|()| vec![None; frames]),
            culled: CpuOcclusionStats::default(),
        }
    }

    fn frames_of_walk(&self) -> usize {
        AHEAD + self.frames + BEHIND
    }

    /// Goes on by a frame: sets the way of culling and the camera, and asks for the frame's picture.
    /// For a system that runs before `PostUpdate`.
    pub fn step(world: &mut World, place: &dyn Place) {
        let Some(mut twice) = world.get_resource_mut::<Self>() else {
            return;
        };
        if twice.is_done() {
            return;
        }
        let (walk, frame) = (
            twice.frame / twice.frames_of_walk(),
            twice.frame % twice.frames_of_walk(),
        );
        twice.frame += 1;
        let (mode, at) = (twice.modes[walk], frame.saturating_sub(AHEAD));
        let compared = frame >= AHEAD && at < twice.frames;
        if frame == 0 {
            mode.set(world);
        }
        let mut cameras = world.query_filtered::<&mut Transform, With<Camera3d>>();
        for mut pose in cameras.iter_mut(world) {
            *pose = place.walker(PACE * at as f32);
        }
        if compared {
            world.spawn(Screenshot::primary_window()).observe(
                move |shot: On<ScreenshotCaptured>, twice: Option<ResMut<Self>>| {
                    if let Some(mut twice) = twice {
                        twice.pictures[walk][at] = shot.image.data.clone();
                    }
                },
            );
        }
    }

    /// Adds what was culled in this frame. For a system after `PostUpdate`.
    pub fn note(twice: Option<ResMut<Self>>, stats: Res<CpuOcclusionStats>) {
        let Some(mut twice) = twice else { return };
        let second = twice.frames_of_walk() + AHEAD + 1;
        if (second..second + twice.frames).contains(&twice.frame) {
            let sum = &mut twice.culled;
            sum.meshes += stats.meshes;
            sum.meshes_hidden += stats.meshes_hidden;
            sum.casters += stats.casters;
            sum.casters_hidden += stats.casters_hidden;
            sum.casters_unseen += stats.casters_unseen;
            sum.refused_views += stats.refused_views;
            sum.update_time += stats.update_time;
            sum.camera_time += stats.camera_time;
            sum.light_time += stats.light_time;
        }
    }

    /// Whether both walks are over.
    pub fn is_done(&self) -> bool {
        self.frame >= 2 * self.frames_of_walk()
    }

    /// Compares the pictures.
    pub fn compare(&self) -> Comparison {
        let mut found = Comparison {
            frames: self.frames,
            ..Comparison::default()
        };
        let [first, second] = &self.pictures;
        for pair in first.iter().zip(second) {
            let (Some(a), Some(b)) = pair else {
                found.missing += 1;
                continue;
            };
            let pixels = pixels_that_differ(a, b);
            found.differ += usize::from(pixels > 0);
            found.most_pixels = found.most_pixels.max(pixels);
        }
        found.moved = first.windows(2).filter(|pair| pair[0] != pair[1]).count();
        found
    }
}

/// Pixels that differ between two pictures of four bytes a pixel.
pub fn pixels_that_differ(a: &[u8], b: &[u8]) -> usize {
    let (a, b) = (a.as_chunks::<4>().0, b.as_chunks::<4>().0);
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}
