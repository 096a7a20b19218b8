//! The program's clock, which the renderer borrows.

use std::sync::OnceLock;
use std::time::Instant;

/// Nanoseconds since the first call.
pub fn now_ns() -> u64 {
    static START: OnceLock<Instant> = OnceLock::new();
    u64::try_from(START.get_or_init(Instant::now).elapsed().as_nanos()).unwrap_or(u64::MAX)
}

/// Milliseconds since the first call.
pub fn now_ms() -> f64 {
    now_ns() as f64 * 1e-6
}

/// Runs `stage` and adds its milliseconds to `timings` under `name`.
pub fn timed<T>(timings: &mut Vec<foveal::Timing>, name: &str, stage: impl FnOnce() -> T) -> T {
    let start_ms = now_ms();
    let result = stage();
    timings.push(foveal::Timing {
        name: name.to_owned(),
        ms: now_ms() - start_ms,
    });
    result
}
