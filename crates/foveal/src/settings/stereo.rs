//! Settings of stereo: the way both eyes are drawn, their poses and frusta, and the presentation of
//! their pictures.

use serde::{Deserialize, Serialize};

use super::{Antialiasing, RateCombine, RateSource, Settings, Shading};
use crate::Error;
use crate::stereo::EyeLayout;

/// Number of eyes, and submission of their geometry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stereo {
    /// One eye.
    #[default]
    Off,
    /// Two eyes, drawn in the fastest way that works on this device.
    Auto,
    /// Two eyes; each draw is submitted once with twice the instances, into one target of twice the
    /// width.
    Instanced,
    /// Two eyes; each draw is submitted once, and the device repeats it into a layer for each eye.
    Multiview,
    /// Two eyes; each draw is submitted once per eye: the reference.
    TwoPass,
}

/// Method that keeps one eye's geometry out of the other eye's half of the target with
/// [`Stereo::Instanced`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EyeClipping {
    /// Clip distances where the device has them, else discard.
    #[default]
    Auto,
    /// A clip plane between the halves, also with [`Stereo::TwoPass`], which otherwise uses
    /// scissors alone. Clipped triangles are other polygons, so their last bits differ.
    Clip,
    /// Fragments in the other half are discarded.
    Discard,
}

/// Presentation of both eyes' pictures. With one eye its picture is shown unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// The picture of the left or only eye.
    #[default]
    Flat,
    /// Left beside right, each at full width: twice the width.
    SideBySide,
    /// Left beside right, each at half its width.
    SideBySideHalf,
    /// For red-cyan glasses: the left eye's luma in red, the right eye's in green and blue.
    Anaglyph,
    /// For red-cyan glasses: colours by Dubois' least-squares projection.
    AnaglyphDubois,
    /// Left beside right, each distorted against a headset's lens.
    Headset,
}

/// A headset's lens as a radial polynomial. Radii are tangents of the angle to the lens's axis. A
/// point that the screen shows at radius `p` appears to the eye at `p (1 + k1 p² + k2 p⁴ + k3 p⁶)`,
/// times a factor per colour.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct LensProfile {
    /// Coefficients k1, k2, k3.
    pub distortion: [f32; 3],
    /// Factors c0, c1 of red: it is seen at c0 + c1 p² times the radius of green.
    #[serde(default = "no_fringe")]
    pub red: [f32; 2],
    /// Factors c0, c1 of blue.
    #[serde(default = "no_fringe")]
    pub blue: [f32; 2],
}

fn no_fringe() -> [f32; 2] {
    [1.0, 0.0]
}

impl LensProfile {
    /// Reads a lens from a name, or from coefficients with commas between: k1, k2, k3, optionally
    /// followed by c0 and c1 of red and of blue. `None` for anything else.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let pure = |distortion| Self {
            distortion,
            red: no_fringe(),
            blue: no_fringe(),
        };
        Some(match text {
            "ideal" => pure([0.0; 3]),
            // The viewers' own parameters:
            // https://support.google.com/cardboard/manufacturers/answer/6324808
            "cardboard-v1" => pure([0.441, 0.156, 0.0]),
            "cardboard-v2" => pure([0.34, 0.55, 0.0]),
            // The SDK's 1, 0.22, 0.24 and 0.996, -0.004, 1.014, 0 are of radii in halves of an
            // eye's 74.88 mm wide half of the screen, which is 41 mm away: 0.9132 as a tangent.
            "dk1" => Self {
                distortion: [0.2638, 0.3451, 0.0],
                red: [0.996, -0.0048],
                blue: [1.014, 0.0],
            },
            _ => match numbers(text)?[..] {
                [k1, k2, k3] => pure([k1, k2, k3]),
                [k1, k2, k3, r0, r1, b0, b1] => Self {
                    distortion: [k1, k2, k3],
                    red: [r0, r1],
                    blue: [b0, b1],
                },
                _ => return None,
            },
        })
    }
}

fn numbers(text: &str) -> Option<Vec<f32>> {
    text.split(',').map(|n| n.trim().parse().ok()).collect()
}

impl Settings {
    /// Whether there are two eyes.
    #[must_use]
    pub fn is_stereo(&self) -> bool {
        self.stereo != Stereo::Off
    }

    /// Whether both eyes have the same position, frustum and gaze, so that one picture serves both.
    pub(crate) fn is_seen_alike(&self) -> bool {
        let same = matches!(self.frusta(), Ok(None))
            || matches!(self.frusta(), Ok(Some([a, b])) if a == b);
        self.is_stereo() && self.ipd == 0.0 && same && self.gaze_shift == [0.0; 2]
    }

    /// Width and height in pixels of the picture that [`crate::Renderer::read_picture`] returns.
    #[must_use]
    pub fn picture_size(&self) -> (u32, u32) {
        match self.show {
            _ if !self.is_stereo() => (self.width, self.height),
            Output::SideBySide | Output::Headset => (2 * self.width, self.height),
            Output::Flat | Output::SideBySideHalf => (self.width, self.height),
            Output::Anaglyph | Output::AnaglyphDubois => (self.width, self.height),
        }
    }

    /// Frusta of both eyes as tangents (left, right, bottom, top); `None` where the camera's
    /// frustum is used.
    pub(crate) fn frusta(&self) -> Result<Option<[[f32; 4]; 2]>, Error> {
        if self.eye_tangents.is_empty() {
            return Ok(None);
        }
        match numbers(&self.eye_tangents).as_deref() {
            Some(&[a, b, c, d, e, f, g, h]) => Ok(Some([[a, b, c, d], [e, f, g, h]])),
            _ => Err(Error::Setting {
                name: "eye-tangents",
                value: self.eye_tangents.clone(),
                expected: TANGENTS,
            }),
        }
    }

    /// The lens of the headset output.
    pub(crate) fn lens_profile(&self) -> Result<LensProfile, Error> {
        LensProfile::parse(&self.lens).ok_or_else(|| Error::Setting {
            name: "lens",
            value: self.lens.clone(),
            expected: "cardboard-v2, cardboard-v1, dk1, ideal, or 3 or 7 numbers",
        })
    }

    /// Whether a source of the rate map is the lens.
    pub(crate) fn rates_by_lens(&self) -> bool {
        let second = self.rate_combine != RateCombine::First;
        self.shading == Shading::Coarse
            && (self.rate == RateSource::Lens || second && self.rate_other == RateSource::Lens)
    }
}

const TANGENTS: &str = "eight numbers between -100 and 100: left < right and bottom < top of the left eye, then of the right";

/// Checks the settings of stereo.
pub(super) fn validate(s: &Settings, limits: &wgpu::Limits) -> Result<(), Error> {
    let wrong = |name, value: String, expected| {
        Err(Error::Setting {
            name,
            value,
            expected,
        })
    };
    if s.rates_by_lens() && !(s.is_stereo() && s.show == Output::Headset) {
        return wrong(
            "rate",
            "lens".to_owned(),
            "another source unless stereo is on and the output is a headset's",
        );
    }
    if s.stereo == Stereo::Multiview && s.aa != Antialiasing::None {
        let expected = "auto, instanced or two-pass where edges are smoothed: sub-samples of both eyes lie in one target";
        return wrong("stereo", "multiview".to_owned(), expected);
    }
    if !(0.0..=1000.0).contains(&s.ipd) {
        return wrong("ipd", s.ipd.to_string(), "between 0 and 1000 metres");
    }
    if !(1e-3..=1e9).contains(&s.convergence) {
        let value = s.convergence.to_string();
        return wrong("convergence", value, "between 0.001 and 1e9 metres");
    }
    let frusta = s.frusta()?;
    for [left, right, bottom, top] in frusta.iter().flatten() {
        let sound = [left, right, bottom, top].iter().all(|t| t.abs() <= 100.0);
        if !(sound && right - left >= 1e-3 && top - bottom >= 1e-3) {
            return wrong("eye-tangents", s.eye_tangents.clone(), TANGENTS);
        }
    }
    let [x, y] = s.gaze_shift;
    if !(x.abs() <= 16.0 && y.abs() <= 16.0) {
        let expected = "two numbers between -16 and 16";
        return wrong("gaze-shift", format!("{x},{y}"), expected);
    }
    crate::stereo::check_lens(&s.lens_profile()?)?;
    let layout = EyeLayout::of(s);
    let width = u64::from(layout.target_size().0).max(u64::from(s.picture_size().0));
    if width > u64::from(limits.max_texture_dimension_2d) {
        return Err(Error::Limit {
            what: "the width of both eyes' pictures side by side".to_owned(),
            value: width,
            limit: limits.max_texture_dimension_2d.into(),
            hint: ": take a smaller width".to_owned(),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(s: &Settings) -> String {
        let error = s.validate(&wgpu::Limits::default());
        error.err().map_or(String::new(), |e| e.to_string())
    }

    #[test]
    fn impossible_eyes_and_lenses_are_refused_by_name() {
        let stereo = Settings {
            stereo: Stereo::Instanced,
            ..Settings::default()
        };
        assert_eq!(message(&stereo), "");
        type Change = fn(&mut Settings);
        let wrong: [(&str, Change); 14] = [
            ("ipd", |s| s.ipd = -0.06),
            ("ipd", |s| s.ipd = f32::NAN),
            ("convergence", |s| s.convergence = 0.0),
            ("convergence", |s| s.convergence = f32::INFINITY),
            ("eye-tangents", |s| {
                s.eye_tangents = "1,-1,-1,1,-1,1,-1,1".into()
            }),
            ("eye-tangents", |s| {
                s.eye_tangents = "-1,1,-1,1,-1,1,1,1".into()
            }),
            ("eye-tangents", |s| {
                s.eye_tangents = "-1,nan,-1,1,-1,1,-1,1".into()
            }),
            ("eye-tangents", |s| {
                s.eye_tangents = "-1,inf,-1,1,-1,1,-1,1".into()
            }),
            ("eye-tangents", |s| s.eye_tangents = "-1,1,-1,1".into()),
            ("gaze-shift", |s| s.gaze_shift = [f32::NAN, 0.0]),
            ("rate", |s| {
                (s.shading, s.rate) = (Shading::Coarse, RateSource::Lens);
            }),
            ("lens", |s| s.lens = "-0.5,0,0".into()),
            ("lens", |s| s.lens = "nan,0,0".into()),
            ("both eyes", |s| s.width = 5000),
        ];
        for (name, change) in wrong {
            let mut s = stereo.clone();
            change(&mut s);
            let text = message(&s);
            assert!(text.contains(name), "{name}: '{text}'");
        }
    }
}
