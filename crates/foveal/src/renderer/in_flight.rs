//! A frame that the device has not finished.

use crate::FrameStats;
use crate::gpu::{Arriving, CpuTimer, Gpu, Handover, work_done};

/// What the device counts, each where the settings ask for it.
#[derive(Default)]
pub(super) struct Counts<T> {
    /// Tiles per level of coarse shading.
    pub(super) tiles: Option<T>,
    /// Pixels of coarse shading that no tile's sample speaks for.
    pub(super) unlit: Option<T>,
    /// The lists of light that is kept from frame to frame.
    pub(super) kept: Option<T>,
    /// Edge pixels and lighting evaluations of anti-aliasing.
    pub(super) edges: Option<T>,
    /// Samples of variable shading.
    pub(super) rates: Option<T>,
}

/// A frame that the device has not finished, or whose figures have not arrived.
pub(super) struct InFlight {
    pub(super) stats: FrameStats,
    pub(super) counts: Counts<Arriving>,
    /// The moment when it was done.
    pub(super) done: Handover<f64>,
}

impl std::fmt::Debug for InFlight {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("InFlight")
    }
}

impl InFlight {
    /// Follows the frame that was submitted last.
    pub(super) fn new(
        gpu: &Gpu,
        stats: FrameStats,
        counters: &Counts<&wgpu::Buffer>,
        cpu: CpuTimer,
    ) -> Self {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut record = |buffer: Option<&wgpu::Buffer>| {
            buffer.map(|buffer| Arriving::record(gpu, &mut encoder, buffer))
        };
        let counts = Counts {
            tiles: record(counters.tiles),
            unlit: record(counters.unlit),
            kept: record(counters.kept),
            edges: record(counters.edges),
            rates: record(counters.rates),
        };
        gpu.queue.submit([encoder.finish()]);
        let all = counts.tiles.iter().chain(&counts.unlit).chain(&counts.kept);
        for arriving in all.chain(&counts.edges).chain(&counts.rates) {
            arriving.submitted();
        }
        let done = work_done(gpu, move || cpu.since_start_ms());
        Self {
            stats,
            counts,
            done,
        }
    }
}
