//! A frame that the device has not finished.

use crate::gpu::{Arriving, CpuTimer, Gpu, Handover, work_done};
use crate::{Error, FrameStats};

/// What the device counters, each where the settings ask for it.
#[derive(Default)]
pub(super) struct Counters<T> {
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

/// A frame that the device has not finished, or whose counters have not arrived.
pub(super) struct InFlight {
    pub(super) stats: FrameStats,
    pub(super) counters: Counters<Arriving>,
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
        buffers: &Counters<&wgpu::Buffer>,
        cpu: CpuTimer,
    ) -> Self {
        let mut encoder = None;
        let mut record = |buffer: Option<&wgpu::Buffer>| {
            let begin = || gpu.device.create_command_encoder(&Default::default());
            buffer.map(|buffer| Arriving::record(gpu, encoder.get_or_insert_with(begin), buffer))
        };
        let counters = Counters {
            tiles: record(buffers.tiles),
            unlit: record(buffers.unlit),
            kept: record(buffers.kept),
            edges: record(buffers.edges),
            rates: record(buffers.rates),
        };
        if let Some(encoder) = encoder {
            gpu.queue.submit([encoder.finish()]);
        }
        let all = counters
            .tiles
            .iter()
            .chain(&counters.unlit)
            .chain(&counters.kept);
        for arriving in all.chain(&counters.edges).chain(&counters.rates) {
            arriving.submitted();
        }
        let done = work_done(gpu, move || cpu.since_start_ms());
        Self {
            stats,
            counters,
            done,
        }
    }

    /// Waits until it is done: what the CPU knew of it, what the device counted, and how long it
    /// took.
    pub(super) async fn wait(
        self,
        gpu: &Gpu,
    ) -> Result<(FrameStats, Counters<Vec<u8>>, f64), Error> {
        let frame_ms = self.done.take(gpu).await?;
        let counters = Counters {
            tiles: bytes(self.counters.tiles, gpu).await?,
            unlit: bytes(self.counters.unlit, gpu).await?,
            kept: bytes(self.counters.kept, gpu).await?,
            edges: bytes(self.counters.edges, gpu).await?,
            rates: bytes(self.counters.rates, gpu).await?,
        };
        Ok((self.stats, counters, frame_ms))
    }
}

async fn bytes(arriving: Option<Arriving>, gpu: &Gpu) -> Result<Option<Vec<u8>>, Error> {
    match arriving {
        Some(arriving) => arriving.bytes(gpu).await.map(Some),
        None => Ok(None),
    }
}
