//! Uploads in bounded pieces: what is written waits in buffers of its own until it is submitted, and
//! they until they have been read and someone looks. Without a bound there would be a second copy of all of it.

use crate::gpu::Gpu;

/// Bytes that wait at a time, about.
const WAITING_BYTES: u64 = 8 << 20;

/// What has been written and not yet submitted.
#[derive(Debug)]
pub(super) struct Uploads<'a> {
    gpu: &'a Gpu,
    waiting: u64,
    may_wait: bool,
}

impl<'a> Uploads<'a> {
    /// Uploads that wait for the device. (A page must not: its browser frees what has been read.)
    pub(super) fn new(gpu: &'a Gpu) -> Self {
        Self {
            gpu,
            waiting: 0,
            may_wait: !cfg!(target_arch = "wasm32"),
        }
    }

    /// Uploads between two frames, which wait for nothing.
    pub(super) fn in_passing(gpu: &'a Gpu) -> Self {
        Self {
            may_wait: false,
            ..Self::new(gpu)
        }
    }

    /// Counts bytes that have been written to the queue, and submits once they are many.
    pub(super) fn add(&mut self, bytes: usize) {
        self.waiting += bytes as u64;
        if self.waiting >= WAITING_BYTES {
            self.gpu.queue.submit([]);
            let poll = if self.may_wait {
                wgpu::PollType::wait_indefinitely()
            } else {
                wgpu::PollType::Poll
            };
            // What fails is found again by the next frame.
            let _ = self.gpu.poll(poll);
            self.waiting = 0;
        }
    }

    /// Writes to a buffer, in pieces of at most the bound.
    pub(super) fn write(&mut self, to: &wgpu::Buffer, offset: u64, bytes: &[u8]) {
        let pieces = bytes.chunks(WAITING_BYTES as usize);
        for (at, piece) in (offset..).step_by(WAITING_BYTES as usize).zip(pieces) {
            self.gpu.queue.write_buffer(to, at, piece);
            self.add(piece.len());
        }
    }
}
