//! Checks of the settings of stereo, and what follows from them.

use super::refusal::{within, wrong};
use crate::Error;
use crate::EyeFrusta;
use crate::Output;
use crate::Stereo;
use crate::settings::stereo::TANGENTS;
use crate::settings::{Antialiasing, RateCombine, RateSource, Settings, Shading};
use crate::stereo::EyeLayout;

impl Settings {
    /// Whether there are two eyes.
    #[must_use]
    pub fn is_stereo(&self) -> bool {
        self.stereo.mode != Stereo::Off
    }

    /// Pixels of all eyes' pictures at the size at which they are drawn:
    /// [`FrameStats::shaded_samples`](crate::FrameStats::shaded_samples) where each takes one
    /// sample.
    #[must_use]
    pub fn drawn_pixels(&self) -> u64 {
        EyeLayout::of(&self.drawn()).pixels()
    }

    /// Whether both eyes have the same position, frustum and gaze, so that one picture serves both.
    pub(crate) fn is_seen_alike(&self) -> bool {
        let same = match self.stereo.frusta {
            EyeFrusta::Camera => true,
            EyeFrusta::Tangents([left, right]) => left == right,
        };
        self.is_stereo() && self.stereo.ipd_m == 0.0 && same && self.stereo.gaze_shift == [0.0; 2]
    }

    /// Width and height in pixels of the picture that [`crate::Renderer::read_picture`] returns.
    #[must_use]
    pub fn picture_size(&self) -> (u32, u32) {
        match self.stereo.output {
            _ if !self.is_stereo() => (self.picture.width, self.picture.height),
            Output::SideBySide | Output::Headset => {
                (self.picture.width.saturating_mul(2), self.picture.height)
            }
            Output::Flat | Output::SideBySideHalf => (self.picture.width, self.picture.height),
            Output::Anaglyph | Output::AnaglyphDubois => (self.picture.width, self.picture.height),
        }
    }

    /// Pictures side by side in what is shown: each eye's own, or one.
    pub(crate) fn pictures_beside(&self) -> usize {
        if self.is_stereo() {
            self.stereo.output.pictures_beside()
        } else {
            1
        }
    }
}

/// The setting by which the lens is a source of the rate map.
fn rate_by_lens(s: &Settings) -> Option<&'static str> {
    let has_second = s.coarse.combine != RateCombine::First;
    let first = (s.coarse.source == RateSource::Lens).then_some("rate");
    let second = (has_second && s.coarse.other_source == RateSource::Lens).then_some("rate-other");
    first
        .or(second)
        .filter(|_| s.shading.mode == Shading::Coarse)
}

/// Checks the settings of stereo.
pub(super) fn validate(s: &Settings, limits: &wgpu::Limits) -> Result<(), Error> {
    if let Some(name) = rate_by_lens(s)
        && !(s.is_stereo() && s.stereo.output == Output::Headset)
    {
        let expected = "another source unless stereo is on and the output is a headset's";
        return wrong(name, "lens", expected);
    }
    if s.stereo.mode == Stereo::Multiview && s.antialiasing.mode != Antialiasing::None {
        let expected = "auto, instanced or two-pass where edges are smoothed: sub-samples of both eyes lie in one target";
        return wrong("stereo", "multiview", expected);
    }
    let ipd = s.stereo.ipd_m;
    within("ipd", ipd, 0.0..=1000.0, "between 0 and 1000 metres")?;
    let convergence = s.stereo.convergence_m;
    within(
        "convergence",
        convergence,
        1e-3..=1e9,
        "between 0.001 and 1e9 metres",
    )?;
    let frusta = match s.stereo.frusta {
        EyeFrusta::Camera => &[][..],
        EyeFrusta::Tangents(ref eyes) => &eyes[..],
    };
    for [left, right, bottom, top] in frusta {
        let sound = [left, right, bottom, top].iter().all(|t| t.abs() <= 100.0);
        if !(sound && right - left >= 1e-3 && top - bottom >= 1e-3) {
            return wrong("eye-tangents", s.stereo.frusta, TANGENTS);
        }
    }
    let [x, y] = s.stereo.gaze_shift;
    if !(x.abs() <= 16.0 && y.abs() <= 16.0) {
        let expected = "two numbers between -16 and 16";
        return wrong("gaze-shift", format!("{x},{y}"), expected);
    }
    crate::stereo::check_lens(&s.stereo.lens.profile())?;
    let layout = EyeLayout::of(&s.drawn());
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
    use crate::settings::Stereo;

    fn message(s: &Settings) -> String {
        let error = s.validate(&wgpu::Limits::default());
        error.err().map_or(String::new(), |e| e.to_string())
    }

    #[test]
    fn drawn_pixels_are_those_of_all_eyes_before_they_are_stretched() {
        let mut settings = Settings::default().with(|s| {
            (s.picture.width, s.picture.height) = (320, 180);
            s.picture.render_scale = 0.5;
        });
        assert_eq!(settings.drawn_pixels(), 160 * 90);
        settings.stereo.mode = Stereo::Instanced;
        assert_eq!(settings.drawn_pixels(), 2 * 160 * 90);
    }

    #[test]
    fn sizes_of_pictures_that_no_device_has_are_refused_and_not_computed_with() {
        let huge = Settings::default().with(|s| {
            (s.picture.width, s.picture.height) = (u32::MAX, u32::MAX);
            s.stereo.mode = Stereo::Instanced;
            s.stereo.output = Output::SideBySide;
        });
        assert_eq!(huge.picture_size(), (u32::MAX, u32::MAX));
        assert_eq!(huge.drawn_pixels(), u64::MAX);
        assert!(message(&huge).contains("the picture's width"));
    }

    #[test]
    fn impossible_eyes_and_lenses_are_refused_by_name() {
        let stereo = Settings::default().with(|s| s.stereo.mode = Stereo::Instanced);
        assert_eq!(message(&stereo), "");
        type Change = fn(&mut Settings);
        let wrong: [(&str, Change); 14] = [
            ("ipd", |s| s.stereo.ipd_m = -0.06),
            ("ipd", |s| s.stereo.ipd_m = f32::NAN),
            ("convergence", |s| s.stereo.convergence_m = 0.0),
            ("convergence", |s| s.stereo.convergence_m = f32::INFINITY),
            ("eye-tangents", |s| {
                s.stereo.frusta = "1,-1,-1,1,-1,1,-1,1".parse().expect("it can be read")
            }),
            ("eye-tangents", |s| {
                s.stereo.frusta = "-1,1,-1,1,-1,1,1,1".parse().expect("it can be read")
            }),
            ("eye-tangents", |s| {
                s.stereo.frusta = "-1,nan,-1,1,-1,1,-1,1".parse().expect("it can be read")
            }),
            ("eye-tangents", |s| {
                s.stereo.frusta = "-1,inf,-1,1,-1,1,-1,1".parse().expect("it can be read")
            }),
            ("gaze-shift", |s| s.stereo.gaze_shift = [f32::NAN, 0.0]),
            ("setting rate is lens", |s| {
                (s.shading.mode, s.coarse.source) = (Shading::Coarse, RateSource::Lens);
            }),
            ("setting rate-other is lens", |s| {
                s.shading.mode = Shading::Coarse;
                s.coarse.combine = RateCombine::Finer;
                s.coarse.other_source = RateSource::Lens;
            }),
            ("lens", |s| {
                s.stereo.lens = "-0.5,0,0".parse().expect("it can be read")
            }),
            ("lens", |s| {
                s.stereo.lens = "nan,0,0".parse().expect("it can be read")
            }),
            ("both eyes", |s| s.picture.width = 5000),
        ];
        for (name, change) in wrong {
            let mut s = stereo.clone();
            change(&mut s);
            let text = message(&s);
            assert!(text.contains(name), "{name}: '{text}'");
        }
    }
}
