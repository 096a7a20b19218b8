//! Threads for a measurement: this one, or a pool of its own.

use std::sync::Mutex;

use foveal_cull::{
    Aabb, CullError, Culler, FrameOptions, OccluderSet, SingleThread, Threads, View, Visibility,
    WorkerThreads,
};
use glam::DVec3;

/// Who works.
#[derive(Debug)]
pub struct Workers {
    pool: Option<WorkerThreads>,
}

impl Workers {
    /// `count` threads; one is the calling thread itself.
    pub fn new(count: u32) -> Self {
        Self {
            pool: (count > 1).then(|| WorkerThreads::new(count as usize)),
        }
    }

    fn threads(&self) -> &dyn Threads {
        self.pool.as_ref().map_or(&SingleThread, |pool| pool)
    }

    /// Begins a frame.
    pub fn rasterize(
        &self,
        culler: &mut Culler,
        view: &View,
        set: &OccluderSet,
        options: &FrameOptions<'_>,
    ) -> Result<(), CullError> {
        culler.rasterize(view, set, options, self.threads())
    }

    /// Asks about world-space boxes.
    pub fn query(
        &self,
        culler: &Culler,
        boxes: &[Aabb],
        results: &mut [Visibility],
    ) -> Result<(), CullError> {
        let count = self.threads().count();
        if count == 1 {
            return culler.query(boxes, DVec3::ZERO, results);
        }
        let part = boxes.len().div_ceil(count * 4).next_multiple_of(8).max(8);
        let parts: Vec<_> = boxes
            .chunks(part)
            .zip(results.chunks_mut(part))
            .map(|part| Mutex::new((part, Ok(()))))
            .collect();
        self.threads().run(parts.len(), &|i| {
            if let Ok(mut part) = parts[i].lock() {
                let ((boxes, results), outcome) = &mut *part;
                *outcome = culler.query(boxes, DVec3::ZERO, results);
            }
        });
        parts
            .into_iter()
            .try_for_each(|part| part.into_inner().map_or(Ok(()), |(_, outcome)| outcome))
    }
}
