//! Checks of the eye's settings.

use crate::Error;
use crate::settings::Settings;
use crate::settings::eye::wrong;

/// Checks the settings of the eye.
pub(super) fn validate(s: &Settings) -> Result<(), Error> {
    if !s.eye.display.is_possible() {
        return Err(wrong(s.eye.display.to_string()));
    }
    if !(5.0..=10.0).contains(&s.eye.quality_jod) {
        return Err(Error::Setting {
            name: "quality",
            value: s.eye.quality_jod.to_string(),
            expected: "between 5 and 10",
        });
    }
    Ok(())
}
