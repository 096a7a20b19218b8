//! Threads for a measurement: this one, or a pool of its own.

use anyhow::Context;
use foveal_cull::{
    Aabb, CullError, Culler, FrameOptions, OccluderSet, Rayon, SingleThread, Threads, View,
    Visibility,
};
use glam::DVec3;
use rayon::prelude::*;

/// Who works.
#[derive(Debug)]
pub(crate) struct Workers {
    pool: Option<rayon::ThreadPool>,
    count: usize,
}

impl Workers {
    /// `count` threads; one is the calling thread itself.
    pub(crate) fn new(count: u32) -> anyhow::Result<Self> {
        let count = count.max(1) as usize;
        let pool = (count > 1)
            .then(|| rayon::ThreadPoolBuilder::new().num_threads(count).build())
            .transpose()
            .context("cannot start the threads")?;
        Ok(Self { pool, count })
    }

    /// Runs `work` where [`rasterize`](Self::rasterize) and [`query`](Self::query) find the threads awake: on
    /// one of them.
    pub(crate) fn enter<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// Begins a frame.
    pub(crate) fn rasterize(
        &self,
        culler: &mut Culler,
        view: &View,
        set: &OccluderSet,
        options: &FrameOptions<'_>,
    ) -> Result<(), CullError> {
        let threads: &dyn Threads = if self.pool.is_some() {
            &Rayon
        } else {
            &SingleThread
        };
        culler.rasterize(view, set, options, threads)
    }

    /// Asks about world-space boxes.
    pub(crate) fn query(
        &self,
        culler: &Culler,
        boxes: &[Aabb],
        results: &mut [Visibility],
    ) -> Result<(), CullError> {
        if self.pool.is_none() {
            return culler.query(boxes, DVec3::ZERO, results);
        }
        let part = boxes
            .len()
            .div_ceil(self.count * 4)
            .next_multiple_of(8)
            .max(8);
        boxes
            .par_chunks(part)
            .zip(results.par_chunks_mut(part))
            .try_for_each(|(boxes, results)| culler.query(boxes, DVec3::ZERO, results))
    }
}
