//! Checks of the eye's settings.

use super::refusal::within;
use crate::Error;
use crate::settings::Settings;
use crate::settings::eye::wrong;

/// Checks the settings of the eye.
pub(super) fn validate(s: &Settings) -> Result<(), Error> {
    if !s.eye.display.is_possible() {
        return Err(wrong(s.eye.display.to_string()));
    }
    within("quality", s.eye.quality_jod, 5.0..=10.0, "between 5 and 10")
}
