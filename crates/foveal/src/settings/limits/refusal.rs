//! Errors of settings that make no sense, and of what a device cannot draw.

use std::ops::RangeInclusive;

use crate::Error;

/// Refuses a setting; `expected` says what it may be.
pub(super) fn wrong(
    name: &'static str,
    value: impl ToString,
    expected: &'static str,
) -> Result<(), Error> {
    Err(Error::Setting {
        name,
        value: value.to_string(),
        expected,
    })
}

/// Refuses a number outside of `range`, which `expected` says in words.
pub(super) fn within<T: PartialOrd + ToString>(
    name: &'static str,
    value: T,
    range: RangeInclusive<T>,
    expected: &'static str,
) -> Result<(), Error> {
    if range.contains(&value) {
        return Ok(());
    }
    wrong(name, value, expected)
}

/// Refuses what is larger than the device's limit.
pub(super) fn check_limit(what: String, value: u32, limit: u32) -> Result<(), Error> {
    if value <= limit {
        return Ok(());
    }
    Err(Error::Limit {
        what,
        value: value.into(),
        limit: limit.into(),
        hint: String::new(),
    })
}
