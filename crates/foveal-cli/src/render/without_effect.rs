//! Flags of two eyes and of anti-aliasing that have no effect beside the other settings.

use foveal::{Antialiasing, EyeFrusta, Output, Settings};

use super::Args;

const ONE_EYE: &str = "there is one eye; --stereo gives two";

impl Args {
    /// A warning for each such flag that is given.
    pub(super) fn without_effect(&self, settings: &Settings) -> Vec<String> {
        let mut warnings = Vec::new();
        let mut warn_of = |keys: &[&str], why: &str| {
            let given = keys.iter().filter(|key| self.settings.gives(key));
            warnings.extend(given.map(|key| format!("--{key} has no effect: {why}")));
        };
        let stereo = &settings.stereo;
        if settings.is_stereo() {
            if stereo.output != Output::Headset {
                warn_of(&["lens"], "it is for --show headset");
            }
            if stereo.frusta != EyeFrusta::Camera {
                let why = "the frusta of --eye-tangents have their own";
                warn_of(&["convergence"], why);
            }
        } else {
            let keys = [
                "ipd",
                "convergence",
                "eye-tangents",
                "gaze-shift",
                "eye-clipping",
                "lens",
            ];
            warn_of(&keys, ONE_EYE);
            if stereo.output != Output::Flat {
                warn_of(&["show"], ONE_EYE);
            }
        }
        match settings.antialiasing.mode {
            Antialiasing::None => {
                let why = "it is for --aa ssaa or msaa";
                warn_of(&["samples", "pattern", "edge-test"], why);
            }
            Antialiasing::Ssaa => warn_of(&["edge-test"], "it is for --aa msaa"),
            Antialiasing::Msaa => {}
        }
        let shown = self.outputs().1.filter(|shown| *shown != "flat");
        if let Some(shown) = shown.filter(|_| !settings.is_stereo()) {
            warnings.push(format!("--output {shown} has no effect: {ONE_EYE}"));
        }
        warnings
    }
}
