//! The clock of the host.

/// The host's clock: nanoseconds since any fixed moment, as the culler's budget counts them. It
/// never goes back.
pub type Clock = fn() -> u64;

/// A reading of a clock; 0 without one.
pub(crate) fn read(clock: Option<Clock>) -> u64 {
    clock.map_or(0, |clock| clock())
}

/// Milliseconds from one reading to a later one.
pub(crate) fn ms_between(start_ns: u64, end_ns: u64) -> f64 {
    end_ns.saturating_sub(start_ns) as f64 * 1e-6
}
