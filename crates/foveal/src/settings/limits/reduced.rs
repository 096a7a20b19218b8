//! Settings on devices without storage buffers and compute shaders
//! ([`Gpu::reduced_limits`](crate::Gpu::reduced_limits)).

use super::refusal::wrong;
use crate::Error;
use crate::settings::{
    Antialiasing, DebugView, Geometry, LightingPass, Setting, Settings, Shading, Shadows,
};

/// Stages that are missing on such devices, with what only they ask for.
const MISSING_STAGES: [&str; 6] = [
    "Anti-aliasing",
    "Shading",
    "Eye",
    "Coarse shading",
    "Work per sample",
    "Variable shading",
];

/// Single settings that are missing there.
const MISSING_KEYS: [&str; 9] = [
    "view",
    "geometry",
    "material-dispatch",
    "lighting-pass",
    "shadow-sizes",
    "light-radius",
    "sun-angle",
    "eye-clipping",
    "gaze-shift",
];

/// Choices that are missing there, of settings that are not: key and name.
const MISSING_NAMES: [(&str, &str); 1] = [("shadows", "contact")];

impl Setting {
    /// Whether the setting has an effect on devices that offer only
    /// [`Gpu::reduced_limits`](crate::Gpu::reduced_limits).
    #[must_use]
    pub fn is_in_reduced_set(&self) -> bool {
        !MISSING_STAGES.contains(&self.stage) && !MISSING_KEYS.contains(&self.key)
    }

    /// Whether such devices can draw this choice of a setting that
    /// [has an effect](Self::is_in_reduced_set) there.
    #[must_use]
    pub fn has_name_in_reduced_set(&self, name: &str) -> bool {
        !MISSING_NAMES.contains(&(self.key, name))
    }
}

/// Checks that the settings need nothing that is missing there.
pub(super) fn validate(s: &Settings) -> Result<(), Error> {
    let requests = [
        ("view", s.picture.view == DebugView::Final, "final"),
        ("geometry", s.geometry.path == Geometry::Gbuffer, "gbuffer"),
        ("aa", s.antialiasing.mode == Antialiasing::None, "none"),
        (
            "shadows",
            s.lighting.shadows != Shadows::Contact,
            "off, hard or soft",
        ),
        (
            "lighting-pass",
            s.lighting.pass != LightingPass::Compute,
            "fragment",
        ),
        ("shading", s.shading.mode == Shading::Full, "full"),
    ];
    match requests.into_iter().find(|(_, is_met, _)| !is_met) {
        None => Ok(()),
        Some((name, _, only)) => {
            let value = "beyond the reduced renderer, which draws on this device";
            wrong(name, value, only)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Kind;

    #[test]
    fn the_names_of_what_is_missing_are_those_of_the_list() {
        for stage in MISSING_STAGES {
            assert!(Settings::ALL.iter().any(|s| s.stage == stage), "{stage}");
        }
        for key in MISSING_KEYS {
            assert!(Settings::ALL.iter().any(|s| s.key == key), "{key}");
        }
        for (key, name) in MISSING_NAMES {
            let setting = Settings::ALL.iter().find(|s| s.key == key).expect(key);
            let Kind::Choice(names) = setting.kind else {
                panic!("{key} is no choice");
            };
            assert!(names().contains(&name), "{key} {name}");
            assert!(
                !setting.has_name_in_reduced_set(name) && setting.has_name_in_reduced_set("off")
            );
        }
    }

    #[test]
    fn what_only_shading_rates_ask_for_is_missing_as_they_are() {
        let offered: Vec<&str> = (Settings::ALL.iter())
            .filter(|setting| setting.is_in_reduced_set())
            .map(|setting| setting.key)
            .collect();
        for key in [
            "display",
            "quality",
            "gaze",
            "gaze-shift",
            "rate-stage",
            "force-rate",
            "eye-clipping",
        ] {
            assert!(!offered.contains(&key), "{key}");
        }
        for key in ["stereo", "ipd", "show", "lens", "culling", "exposure"] {
            assert!(offered.contains(&key), "{key}");
        }
    }

    #[test]
    fn devices_without_storage_buffers_refuse_what_needs_them() {
        let limits = crate::Gpu::reduced_limits();
        let mut settings = Settings::default().with(|s| {
            s.picture.width = 64;
            s.picture.height = 64;
            s.stereo.mode = crate::Stereo::Auto;
            s.culling.mode = crate::Culling::Occlusion;
        });
        settings.validate(&limits).expect("in the reduced set");
        settings.shading.mode = Shading::Coarse;
        let refused = settings.validate(&limits).expect_err("needs compute");
        assert_eq!(
            refused.to_string(),
            "the setting shading is beyond the reduced renderer, which draws on this device; it must be full"
        );
        settings.shading.mode = Shading::Full;
        settings.lighting.shadow_atlas = 2048;
        for (shadows, is_drawn) in [(Shadows::Soft, true), (Shadows::Contact, false)] {
            settings.lighting.shadows = shadows;
            assert_eq!(settings.validate(&limits).is_ok(), is_drawn);
        }
    }
}
