//! Checks of coarse shading's settings.

use crate::COARSEST_LEVEL;
use crate::Error;
use crate::Shading;
use crate::settings::{DebugView, Settings};

/// Checks the settings of coarse shading.
pub(super) fn validate(s: &Settings) -> Result<(), Error> {
    let wrong = |name, value: String, expected| {
        Err(Error::Setting {
            name,
            value,
            expected,
        })
    };
    let shows_tiles = matches!(
        s.picture.view,
        DebugView::Rate | DebugView::Blocks | DebugView::Shaded
    );
    if shows_tiles && s.shading.mode == Shading::Full {
        let value = format!("{:?}", s.picture.view).to_lowercase();
        return wrong("view", value, "another one unless shading is coarse");
    }
    for (name, level) in [
        ("coarsest-level", s.coarse.coarsest_level),
        ("rate-level", s.coarse.constant_level),
    ] {
        if level > COARSEST_LEVEL {
            return wrong(name, level.to_string(), "between 0 and 8");
        }
    }
    if !s.eye.gaze.iter().all(|g| g.is_finite() && g.abs() <= 16.0) {
        let value = format!("{},{}", s.eye.gaze[0], s.eye.gaze[1]);
        return wrong("gaze", value, "two numbers between -16 and 16");
    }
    for (name, value) in [
        ("fovea-inner", s.coarse.fovea_inner),
        ("fovea-outer", s.coarse.fovea_outer),
    ] {
        if !(0.0..=1000.0).contains(&value) {
            return wrong(name, value.to_string(), "between 0 and 1000");
        }
    }
    if !(0.1..=10.0).contains(&s.coarse.fovea_curve) {
        return wrong(
            "fovea-curve",
            s.coarse.fovea_curve.to_string(),
            "between 0.1 and 10",
        );
    }
    Ok(())
}
