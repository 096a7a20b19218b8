//! What is captured: which cameras at which moments, and how a flight becomes frames.

use foveal::Settings;
use foveal_scene::{Aabb, Camera, Clip};
use glam::{Mat4, Quat};

use crate::Format;

/// A frame of a capture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pose {
    pub(crate) camera: Camera,
    /// The moment of an animated scene, in seconds.
    pub(crate) time_s: f32,
}

/// A capture that was ordered.
#[derive(Clone, Debug)]
pub(crate) struct Job {
    pub(crate) settings: Settings,
    pub(crate) clip: Clip,
    pub(crate) poses: Vec<Pose>,
    pub(crate) format: Format,
    pub(crate) per_second: f32,
}

/// How a capture ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Ended {
    /// Where it is now.
    Done(String),
    /// What became of it.
    Cancelled(String),
    Failed(String),
}

/// A turn around the middle of `bounds`, back to where it began; the first frame is what `camera`
/// sees. The scene's time runs from `time_s` where it `plays`.
pub(crate) fn turntable(
    camera: &Camera,
    bounds: Aabb,
    frames: u32,
    (time_s, per_second, plays): (f32, f32, bool),
) -> Vec<Pose> {
    let center = if bounds.is_empty() {
        camera.eye()
    } else {
        bounds.center()
    };
    let pose = |frame: u32| {
        let angle = std::f32::consts::TAU * frame as f32 / frames.max(1) as f32;
        let turned = Mat4::from_translation(center)
            * Mat4::from_rotation_y(angle)
            * Mat4::from_translation(-center);
        let world_from_view = if frame == 0 {
            camera.world_from_view
        } else {
            turned * camera.world_from_view
        };
        let elapsed = if plays {
            frame as f32 / per_second
        } else {
            0.0
        };
        Pose {
            camera: Camera {
                name: "turntable".to_owned(),
                world_from_view,
                ..camera.clone()
            },
            time_s: time_s + elapsed,
        }
    };
    (0..frames).map(pose).collect()
}

/// Where the camera was while it was flown.
#[derive(Clone, Debug, Default)]
pub(crate) struct Flight {
    /// Seconds since the start, ascending, and what was seen then.
    seen: Vec<(f64, Pose)>,
}

impl Flight {
    pub(crate) fn add(&mut self, at_s: f64, pose: Pose) {
        if self.seen.last().is_none_or(|(last, _)| at_s > *last) {
            self.seen.push((at_s, pose));
        }
    }

    /// Its frames, evenly in time; between two places the camera moves straight and turns evenly.
    pub(crate) fn frames(&self, frames: u32, per_second: f32) -> Vec<Pose> {
        let Some((_, first)) = self.seen.first() else {
            return Vec::new();
        };
        let at = |frame: u32| {
            let at_s = f64::from(frame) / f64::from(per_second);
            let after = self.seen.partition_point(|(s, _)| *s < at_s);
            let Some((to_s, to)) = self.seen.get(after) else {
                return self.seen.last().map_or(first, |(_, pose)| pose).clone();
            };
            let Some((from_s, from)) = after.checked_sub(1).and_then(|i| self.seen.get(i)) else {
                return to.clone();
            };
            from.towards(to, ((at_s - from_s) / (to_s - from_s)) as f32)
        };
        (0..frames).map(at).collect()
    }
}

impl Pose {
    fn towards(&self, to: &Self, part: f32) -> Self {
        let (a, b) = (&self.camera.world_from_view, &to.camera.world_from_view);
        let eye = a.w_axis.truncate().lerp(b.w_axis.truncate(), part);
        let turned = Quat::from_mat4(a).slerp(Quat::from_mat4(b), part);
        let camera = Camera {
            name: "flight".to_owned(),
            world_from_view: Mat4::from_rotation_translation(turned, eye),
            ..self.camera.clone()
        };
        // An animation that began anew between both does not run backwards.
        let time_s = if to.time_s >= self.time_s {
            self.time_s + (to.time_s - self.time_s) * part
        } else {
            self.time_s
        };
        Self { camera, time_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn camera(eye: Vec3) -> Camera {
        Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 1.0)
    }

    #[test]
    fn a_turntable_begins_with_the_view_and_keeps_height_and_distance() {
        let bounds = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::splat(1.0),
        };
        let view = camera(Vec3::new(3.0, 2.0, 1.0));
        let poses = turntable(&view, bounds, 8, (1.0, 4.0, true));
        assert_eq!(poses.len(), 8);
        assert_eq!(poses[0].camera.world_from_view, view.world_from_view);
        for pose in &poses {
            let eye = pose.camera.eye();
            assert!(
                (eye.y - 2.0).abs() < 1e-5 && (eye.length() - view.eye().length()).abs() < 1e-4
            );
            let forward = -pose.camera.world_from_view.z_axis.truncate();
            assert!((forward + eye.normalize()).length() < 1e-4);
        }
        let opposite = poses[4].camera.eye();
        assert!((opposite - Vec3::new(-3.0, 2.0, -1.0)).length() < 1e-4);
        assert_eq!((poses[0].time_s, poses[4].time_s), (1.0, 2.0));
        let still = turntable(&view, bounds, 8, (1.0, 4.0, false));
        assert_eq!(still[7].time_s, 1.0);
    }

    #[test]
    fn a_flight_is_cut_into_even_frames() {
        let mut flight = Flight::default();
        assert!(flight.frames(3, 10.0).is_empty());
        for (at_s, x) in [(0.0, 1.0), (0.35, 1.7), (0.35, 9.0), (1.0, 3.0)] {
            let camera = camera(Vec3::new(x, 0.0, 1e6));
            flight.add(at_s, Pose { camera, time_s: x });
        }
        let frames = flight.frames(12, 10.0);
        let x: Vec<f32> = frames.iter().map(|pose| pose.camera.eye().x).collect();
        for (i, expected) in [(0, 1.0), (1, 1.2), (3, 1.6), (10, 3.0), (11, 3.0)] {
            assert!((x[i] - expected).abs() < 1e-4, "{i}: {x:?}");
            assert!((frames[i].time_s - expected).abs() < 1e-4);
        }
    }
}
