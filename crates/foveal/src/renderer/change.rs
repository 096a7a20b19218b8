//! How much of a renderer other settings make anew.

use crate::Settings;
use crate::stereo::EyeLayout;

/// What changes with other settings of what is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    Nothing,
    /// What each frame reads anyway: gazes, and the widths of points and lines.
    Frame,
    /// That, and what light reaches places, so that none is kept.
    Light,
    /// The targets' size, and the widths of points and lines.
    Size,
    /// Anything else: pipelines and targets are made anew.
    Stages,
}

impl Change {
    /// What differs in `new` from `old`. `keeps_light`: whether a light history is kept with some
    /// settings, which depends on the device.
    pub(super) fn between(
        old: &Settings,
        new: &Settings,
        keeps_light: impl Fn(&Settings) -> bool,
    ) -> Self {
        if new == old {
            return Self::Nothing;
        }
        let stroked = old.clone().with(|s| {
            s.geometry.point_size_px = new.geometry.point_size_px;
            s.geometry.line_width_px = new.geometry.line_width_px;
        });
        let sized = stroked.clone().with(|s| {
            s.picture.width = new.picture.width;
            s.picture.height = new.picture.height;
        });
        let looking = stroked.with(|s| {
            s.eye.gaze = new.eye.gaze;
            s.stereo.gaze_shift = new.stereo.gaze_shift;
        });
        let lit = looking.clone().with(|s| {
            s.lighting.environment_intensity = new.lighting.environment_intensity;
            s.lighting.environment_rotation_deg = new.lighting.environment_rotation_deg;
            s.lighting.environment_image = new.lighting.environment_image.clone();
            s.lighting.ambient_occlusion_radius_m = new.lighting.ambient_occlusion_radius_m;
        });
        // With a gaze of its own each eye has a picture of its own.
        let is_laid_out = EyeLayout::of(old) == EyeLayout::of(new);
        if looking == *new && is_laid_out {
            Self::Frame
        } else if lit == *new && is_laid_out {
            Self::Light
        } else if sized == *new && keeps_light(old) == keeps_light(new) {
            Self::Size
        } else {
            Self::Stages
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Shading, Stereo};

    #[test]
    fn a_change_makes_anew_what_the_largest_of_its_parts_does() {
        type Part = fn(&mut Settings);
        let gaze: Part = |s| s.eye.gaze = [0.2, 0.7];
        let width: Part = |s| s.picture.width += 16;
        let light: Part = |s| s.lighting.environment_intensity = 2.0;
        let rotation: Part = |s| s.lighting.environment_rotation_deg = 30.0;
        let radius: Part = |s| s.lighting.ambient_occlusion_radius_m = 2.0;
        let stroke: Part = |s| s.geometry.line_width_px = 3.0;
        let shading: Part = |s| s.shading.mode = Shading::Coarse;
        let old = Settings::default();
        let cases: [(&[Part], Change); 12] = [
            (&[], Change::Nothing),
            (&[gaze], Change::Frame),
            (&[stroke], Change::Frame),
            (&[gaze, stroke], Change::Frame),
            (&[light], Change::Light),
            (&[rotation, radius, gaze, stroke], Change::Light),
            (&[width], Change::Size),
            (&[width, stroke], Change::Size),
            (&[width, gaze], Change::Stages),
            (&[width, light], Change::Stages),
            (&[shading], Change::Stages),
            (&[shading, gaze], Change::Stages),
        ];
        for (number, (parts, expected)) in cases.into_iter().enumerate() {
            let new = old.clone().with(|s| parts.iter().for_each(|part| part(s)));
            let found = Change::between(&old, &new, |_| false);
            assert_eq!(found, expected, "case {number}");
        }
    }

    #[test]
    fn a_size_with_which_light_is_no_longer_kept_makes_the_stages_anew() {
        let old = Settings::default();
        let new = old.clone().with(|s| s.picture.width = 4000);
        let fits = |s: &Settings| s.picture.width < 2000;
        assert_eq!(Change::between(&old, &new, fits), Change::Stages);
        assert_eq!(Change::between(&new, &old, fits), Change::Stages);
        assert_eq!(Change::between(&old, &new, |_| true), Change::Size);
    }

    #[test]
    fn a_gaze_of_its_own_for_each_eye_lays_out_the_targets_anew() {
        // Without a distance both eyes see the same, unless they look elsewhere.
        let old = Settings::default().with(|s| {
            s.stereo.mode = Stereo::TwoPass;
            s.stereo.ipd_m = 0.0;
            s.shading.mode = Shading::Coarse;
        });
        let apart = |x: f32| old.clone().with(|s| s.stereo.gaze_shift = [x, 0.0]);
        let change = |old: &Settings, new: &Settings| Change::between(old, new, |_| false);
        assert_eq!(change(&old, &apart(0.1)), Change::Stages);
        assert_eq!(change(&apart(0.1), &apart(0.2)), Change::Frame);
    }
}
