//! The list of targets.

use super::{c_calls, culler, mesh_bytes, world};
#[cfg(feature = "renderer")]
use super::{cameras, environment, import, records, report, settings};

/// One thing that is fuzzed.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// On the command line, and the name of the file in `fuzz/fuzz_targets`.
    pub name: &'static str,
    /// Tries an input; panics at what must not be.
    pub run: fn(&[u8]),
    /// Good inputs, made on the spot.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Most bytes of memory that an input may have at one time.
    pub max_bytes: u64,
}

/// What bombs may take, too.
const USUAL: u64 = 300_000_000;

/// All targets, by name.
pub const TARGETS: &[Target] = &[
    Target {
        name: "c_calls",
        run: c_calls,
        seeds: c_calls::seeds,
        max_bytes: USUAL,
    },
    #[cfg(feature = "renderer")]
    Target {
        name: "cameras",
        run: cameras,
        seeds: cameras::seeds,
        max_bytes: USUAL,
    },
    Target {
        name: "culler",
        run: culler,
        seeds: culler::seeds,
        max_bytes: USUAL,
    },
    #[cfg(feature = "renderer")]
    Target {
        name: "environment",
        run: environment,
        seeds: environment::seeds,
        max_bytes: USUAL,
    },
    #[cfg(feature = "renderer")]
    Target {
        name: "import",
        run: import,
        seeds: import::seeds,
        max_bytes: USUAL,
    },
    Target {
        name: "mesh_bytes",
        run: mesh_bytes,
        seeds: mesh_bytes::seeds,
        max_bytes: USUAL,
    },
    #[cfg(feature = "renderer")]
    Target {
        name: "records",
        run: records,
        seeds: records::seeds,
        max_bytes: USUAL,
    },
    #[cfg(feature = "renderer")]
    Target {
        name: "report",
        run: report,
        seeds: report::seeds,
        max_bytes: USUAL,
    },
    #[cfg(feature = "renderer")]
    Target {
        name: "settings",
        run: settings,
        seeds: settings::seeds,
        max_bytes: USUAL,
    },
    Target {
        name: "world",
        run: world,
        seeds: world::seeds,
        max_bytes: USUAL,
    },
];
