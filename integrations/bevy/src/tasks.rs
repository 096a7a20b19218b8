//! The culler's work on Bevy's `ComputeTaskPool`.

use bevy_tasks::ComputeTaskPool;
use foveal_cull::Threads;

/// The compute task pool, or the calling thread where there is none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ComputeTasks;

impl Threads for ComputeTasks {
    fn count(&self) -> usize {
        ComputeTaskPool::try_get().map_or(1, |pool| pool.thread_num().max(1))
    }

    fn run(&self, tasks: usize, task: &(dyn Fn(usize) + Sync)) {
        for_each(0..tasks, task);
    }
}

/// Calls `work` once for each item, on any threads, and returns when all is done.
pub(crate) fn for_each<'env, T: Send + 'env>(
    items: impl ExactSizeIterator<Item = T>,
    work: impl Fn(T) + Copy + Send + Sync + 'env,
) {
    match ComputeTaskPool::try_get() {
        Some(pool) if items.len() > 1 && pool.thread_num() > 1 => {
            pool.scope(|scope| items.for_each(|item| scope.spawn(async move { work(item) })));
        }
        _ => items.for_each(work),
    }
}
