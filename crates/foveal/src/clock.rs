//! The clock of the host.

/// The caller's clock: milliseconds since any fixed moment.
pub type Clock = fn() -> f64;
