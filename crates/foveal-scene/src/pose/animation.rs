//! Key frames and their interpolation (glTF 2.0 specification, appendix C).

use glam::{Quat, Vec4};

use super::{CameraPart, LightPart, MaterialPart};

/// How values between key frames are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interpolation {
    Step,
    Linear,
    /// Three values per key: in-tangent, value, out-tangent.
    CubicSpline,
}

/// Which property a channel moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    Translation,
    Rotation,
    Scale,
    /// All morph weights of a node.
    Weights,
    /// One of them.
    Weight(u32),
    /// Whether a node, and what is below it, is drawn.
    Visible,
    Camera(CameraPart),
    Light(LightPart),
    Material(MaterialPart),
}

impl Target {
    /// Whether it moves the node itself, and with it all that is below it.
    pub(crate) fn is_transform(self) -> bool {
        matches!(self, Self::Translation | Self::Rotation | Self::Scale)
    }

    /// Whether it changes the shape of the node's mesh.
    pub(crate) fn is_weight(self) -> bool {
        matches!(self, Self::Weights | Self::Weight(_))
    }

    /// Whether both, of one thing, move the same.
    pub(crate) fn meets(self, other: Self) -> bool {
        let whole = self == Self::Weights || other == Self::Weights;
        self == other || whole && self.is_weight() && other.is_weight()
    }
}

/// One property of one thing over time.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    /// Number in the file of the node, camera, light or material.
    pub(crate) number: u32,
    pub(crate) target: Target,
    pub(crate) interpolation: Interpolation,
    /// Numbers per value.
    pub(crate) width: usize,
    /// Seconds, ascending, at least one.
    pub(crate) times: Vec<f32>,
    pub(crate) values: Vec<f32>,
}

/// Channels with a common period: one clip.
#[derive(Clone, Debug)]
pub(crate) struct Animation {
    /// The file's name for it; empty without.
    pub(crate) name: String,
    pub(crate) channels: Vec<Channel>,
    /// Time of the last key of all channels.
    pub(crate) duration_s: f32,
}

impl Animation {
    pub(crate) fn new(name: String, channels: Vec<Channel>) -> Self {
        let duration_s = channels
            .iter()
            .filter_map(|c| c.times.last().copied())
            .fold(0.0, f32::max);
        Self {
            name,
            channels,
            duration_s,
        }
    }

    /// The animation's own time for a time of the scene: looped; times that are not finite count as
    /// 0.
    pub(crate) fn looped(&self, time_s: f32) -> f32 {
        if !time_s.is_finite() || self.duration_s <= 0.0 {
            return 0.0;
        }
        // The end itself is shown, not the start again: a still at the duration is the last key.
        if time_s == self.duration_s {
            return time_s;
        }
        time_s.rem_euclid(self.duration_s)
    }
}

impl Channel {
    /// The value at a time, filled up with zeros, of a channel with up to four numbers; `None` where
    /// the curve leads beyond the range of numbers.
    pub(crate) fn at(&self, time_s: f32) -> Option<[f32; 4]> {
        let mut value = [0.0; 4];
        self.sample(time_s, value.get_mut(..self.width)?);
        value.iter().all(|x| x.is_finite()).then_some(value)
    }

    /// The value at a time: clamped to the first and last key. `out` has `width` numbers.
    pub(crate) fn sample(&self, time_s: f32, out: &mut [f32]) {
        let next = self.times.partition_point(|&t| t <= time_s);
        let last = self.times.len() - 1;
        let (a, b) = (next.saturating_sub(1), next.min(last));
        if a == b || next == 0 || self.interpolation == Interpolation::Step {
            out.copy_from_slice(self.value(a));
            return;
        }
        let span = self.times[b] - self.times[a];
        let t = (time_s - self.times[a]) / span;
        match self.interpolation {
            Interpolation::CubicSpline => self.hermite(a, b, t, span, out),
            _ if self.target == Target::Rotation => {
                out.copy_from_slice(&slerp(self.value(a), self.value(b), t));
            }
            _ => {
                for ((o, &x), &y) in out.iter_mut().zip(self.value(a)).zip(self.value(b)) {
                    *o = x + (y - x) * t;
                }
            }
        }
    }

    /// Numbers of a key: `part` 0 is the in-tangent, 1 the value, 2 the out-tangent of a cubic
    /// spline.
    fn part(&self, key: usize, part: usize) -> &[f32] {
        let at = match self.interpolation {
            Interpolation::CubicSpline => key * 3 + part,
            _ => key,
        };
        &self.values[at * self.width..][..self.width]
    }

    fn value(&self, key: usize) -> &[f32] {
        self.part(key, 1)
    }

    fn hermite(&self, a: usize, b: usize, t: f32, span: f32, out: &mut [f32]) {
        let (t2, t3) = (t * t, t * t * t);
        let (from, to) = (2.0 * t3 - 3.0 * t2 + 1.0, -2.0 * t3 + 3.0 * t2);
        let (leave, arrive) = (span * (t3 - 2.0 * t2 + t), span * (t3 - t2));
        let (v0, out0) = (self.value(a), self.part(a, 2));
        let (v1, in1) = (self.value(b), self.part(b, 0));
        for (i, o) in out.iter_mut().enumerate() {
            *o = from * v0[i] + leave * out0[i] + to * v1[i] + arrive * in1[i];
        }
    }
}

/// Spherical interpolation along the shorter arc.
fn slerp(a: &[f32], b: &[f32], t: f32) -> [f32; 4] {
    let read = |v: &[f32]| Vec4::new(v[0], v[1], v[2], v[3]).normalize_or(Vec4::W);
    let (a, b) = (Quat::from_vec4(read(a)), Quat::from_vec4(read(b)));
    a.slerp(b, t).to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(
        interpolation: Interpolation,
        target: Target,
        width: usize,
        values: &[f32],
    ) -> Channel {
        Channel {
            number: 0,
            target,
            interpolation,
            width,
            times: vec![1.0, 2.0, 4.0],
            values: values.to_vec(),
        }
    }

    fn at(channel: &Channel, time_s: f32) -> Vec<f32> {
        let mut out = vec![0.0; channel.width];
        channel.sample(time_s, &mut out);
        out
    }

    #[test]
    fn step_holds_and_linear_goes_evenly() {
        let step = channel(Interpolation::Step, Target::Weights, 1, &[10.0, 20.0, 40.0]);
        let linear = channel(
            Interpolation::Linear,
            Target::Weights,
            1,
            &[10.0, 20.0, 40.0],
        );
        for (time, held, even) in [
            (0.0, 10.0, 10.0),
            (1.0, 10.0, 10.0),
            (1.5, 10.0, 15.0),
            (2.0, 20.0, 20.0),
            (3.0, 20.0, 30.0),
            (4.0, 40.0, 40.0),
            (9.0, 40.0, 40.0),
        ] {
            assert_eq!(at(&step, time), [held], "step at {time}");
            assert_eq!(at(&linear, time), [even], "linear at {time}");
        }
    }

    #[test]
    fn a_cubic_spline_meets_its_keys_and_tangents() {
        // in-tangent, value, out-tangent per key; straight line of slope 10, then flat ends.
        let values = [10.0, 10.0, 10.0, 10.0, 20.0, 0.0, 0.0, 40.0, 0.0];
        let cubic = channel(Interpolation::CubicSpline, Target::Weights, 1, &values);
        assert_eq!(at(&cubic, 1.0), [10.0]);
        assert!((at(&cubic, 1.25)[0] - 12.5).abs() < 1e-5);
        assert_eq!(at(&cubic, 2.0), [20.0]);
        assert!((at(&cubic, 3.0)[0] - 30.0).abs() < 1e-5);
        assert!((at(&cubic, 2.5)[0] - (20.0 + 20.0 * 0.15625)).abs() < 1e-4);
        assert_eq!(at(&cubic, 5.0), [40.0]);
    }

    #[test]
    fn rotations_take_the_shorter_arc() {
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let values = [
            0.0, 0.0, 0.0, 1.0, 0.0, -half, 0.0, -half, 0.0, 0.0, 0.0, 1.0,
        ];
        let turn = channel(Interpolation::Linear, Target::Rotation, 4, &values);
        let middle = Quat::from_slice(&at(&turn, 1.5));
        let expected = Quat::from_rotation_y(std::f32::consts::FRAC_PI_4);
        assert!(middle.dot(expected).abs() > 0.9999, "{middle}");
    }

    #[test]
    fn time_loops_over_the_duration_and_tolerates_nonsense() {
        let animation = Animation::new(
            String::new(),
            vec![channel(Interpolation::Step, Target::Weights, 1, &[0.0; 3])],
        );
        assert_eq!(animation.looped(5.0), 1.0);
        assert_eq!(animation.looped(4.0), 4.0);
        assert_eq!(animation.looped(-1.0), 3.0);
        assert_eq!(animation.looped(f32::NAN), 0.0);
    }
}
