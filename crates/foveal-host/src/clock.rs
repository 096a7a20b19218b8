//! The program's clock, which the renderer borrows.

use std::sync::OnceLock;
use std::time::Instant;

/// Milliseconds since the first call.
pub fn now_ms() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64() * 1e3
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
