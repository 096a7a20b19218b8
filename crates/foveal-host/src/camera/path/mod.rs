//! Camera paths from JSON keyframes, smooth in between.
//!
//! A file is a list of `{"t": seconds, "eye": [x, y, z], "target": [x, y, z], "up": […],
//! "fov_y_deg": …}`. Without `t`, key n is at n seconds. Eye, target, up and field of view follow a
//! Catmull-Rom spline through the keys (Catmull and Rom 1974): a cubic Hermite curve whose slope at
//! a key is that from the key before it to the key after it, and at an end that to its neighbour.
//! Before the first and after the last key the camera stands still.

#[cfg(test)]
mod tests;

use std::path::Path;

use anyhow::{Context, bail};
use foveal_scene::Camera;
use glam::Vec3;
use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct JsonKey {
    t: Option<f32>,
    eye: [f32; 3],
    target: [f32; 3],
    #[serde(default = "upwards")]
    up: [f32; 3],
    fov_y_deg: Option<f32>,
}

fn upwards() -> [f32; 3] {
    [0.0, 1.0, 0.0]
}

/// Where the camera is at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pose {
    eye: Vec3,
    target: Vec3,
    up: Vec3,
    fov_y_deg: f32,
}

/// A curve through camera poses, as `--path FILE.json` takes it.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraPath {
    /// At least one, times strictly increasing.
    keys: Vec<(f32, Pose)>,
}

impl CameraPath {
    /// Reads a file of keyframes; those without a field of view get `fov_y_deg`.
    pub(super) fn read(path: &Path, fov_y_deg: f32) -> anyhow::Result<Self> {
        let text = crate::text_file::read(path)
            .with_context(|| format!("cannot read the camera path '{}'", path.display()))?;
        Self::parse(&text, fov_y_deg)
            .with_context(|| format!("the camera path '{}' is wrong", path.display()))
    }

    /// Reads the text of such a file.
    ///
    /// # Errors
    /// Names the keyframe.
    pub fn parse(text: &str, fov_y_deg: f32) -> anyhow::Result<Self> {
        let json: Vec<JsonKey> = serde_json::from_str(text)?;
        if json.is_empty() {
            bail!("it has no keyframes");
        }
        let timed = json.iter().filter(|key| key.t.is_some()).count();
        if timed != 0 && timed != json.len() {
            bail!(
                "{timed} of its {} keyframes have a time t; give it to all or to none",
                json.len()
            );
        }
        let mut keys: Vec<(f32, Pose)> = Vec::with_capacity(json.len());
        for (number, key) in json.iter().enumerate() {
            let (time_s, pose) = key
                .checked(number, fov_y_deg)
                .with_context(|| format!("keyframe {number}"))?;
            if keys.last().is_some_and(|&(before, _)| before >= time_s) {
                bail!("keyframe {number}: its time {time_s} is not later than the one before it");
            }
            keys.push((time_s, pose));
        }
        Ok(Self { keys })
    }

    /// The camera at `time_s` seconds.
    pub fn at(&self, time_s: f32) -> Camera {
        let Pose {
            eye,
            target,
            up,
            fov_y_deg,
        } = self.pose(time_s);
        // Between keys a spline may overshoot what each key keeps to.
        let fov_y_rad = fov_y_deg.clamp(0.1, 179.0).to_radians();
        Camera {
            name: "path".to_owned(),
            ..Camera::look_at(eye, target, up, fov_y_rad)
        }
    }

    fn pose(&self, time_s: f32) -> Pose {
        let next = self.keys.partition_point(|&(t, _)| t <= time_s);
        let (Some(&(t0, a)), Some(&(t1, b))) = (self.keys[..next].last(), self.keys.get(next))
        else {
            return if next == 0 {
                self.keys[0].1
            } else {
                self.keys[next - 1].1
            };
        };
        let span = t1 - t0;
        let (slope_a, slope_b) = (self.slope(next - 1), self.slope(next));
        hermite(
            a,
            slope_a.scaled(span),
            b,
            slope_b.scaled(span),
            (time_s - t0) / span,
        )
    }

    /// Change per second at a key.
    fn slope(&self, key: usize) -> Pose {
        let (t0, a) = self.keys[key.saturating_sub(1)];
        let (t1, b) = self.keys[(key + 1).min(self.keys.len() - 1)];
        b.plus(a.scaled(-1.0)).scaled(1.0 / (t1 - t0))
    }
}

impl JsonKey {
    fn checked(&self, number: usize, fov_y_deg: f32) -> anyhow::Result<(f32, Pose)> {
        let time_s = self.t.unwrap_or(number as f32);
        let pose = Pose {
            eye: self.eye.into(),
            target: self.target.into(),
            up: self.up.into(),
            fov_y_deg: self.fov_y_deg.unwrap_or(fov_y_deg),
        };
        let finite = pose.eye.is_finite() && pose.target.is_finite() && pose.up.is_finite();
        if !finite || !time_s.is_finite() {
            bail!("its numbers must be finite");
        }
        if pose.eye == pose.target {
            bail!("eye and target are the same point");
        }
        if pose.up == Vec3::ZERO {
            bail!("up is [0, 0, 0]");
        }
        if !(pose.fov_y_deg > 0.0 && pose.fov_y_deg < 180.0) {
            bail!(
                "fov_y_deg is {}; it must lie between 0 and 180",
                pose.fov_y_deg
            );
        }
        Ok((time_s, pose))
    }
}

impl Pose {
    fn plus(self, other: Self) -> Self {
        Self {
            eye: self.eye + other.eye,
            target: self.target + other.target,
            up: self.up + other.up,
            fov_y_deg: self.fov_y_deg + other.fov_y_deg,
        }
    }

    fn scaled(self, by: f32) -> Self {
        Self {
            eye: self.eye * by,
            target: self.target * by,
            up: self.up * by,
            fov_y_deg: self.fov_y_deg * by,
        }
    }
}

/// The cubic from `a` to `b` with slopes `a_slope` and `b_slope`, at `x` in [0, 1].
fn hermite(a: Pose, a_slope: Pose, b: Pose, b_slope: Pose, x: f32) -> Pose {
    let (x2, x3) = (x * x, x * x * x);
    a.scaled(2.0 * x3 - 3.0 * x2 + 1.0)
        .plus(a_slope.scaled(x3 - 2.0 * x2 + x))
        .plus(b.scaled(3.0 * x2 - 2.0 * x3))
        .plus(b_slope.scaled(x3 - x2))
}
