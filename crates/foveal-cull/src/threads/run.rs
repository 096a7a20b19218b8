//! Threads that a frame runs on.

/// Runs the tasks of a frame, or of a bake, on several threads.
///
/// Implement it for your own job system. The crate starts threads only in
/// [`WorkerThreads`](super::WorkerThreads). [`Culler::rasterize`](crate::Culler::rasterize) calls
/// `run` twice per frame, [`OccluderMesh::bake_on`](crate::OccluderMesh::bake_on) several times per
/// mesh.
pub trait Threads: Sync {
    /// Number of tasks that can run at once, at least 1.
    fn count(&self) -> usize;
    /// Calls `task(i)` once for every `i` below `tasks`, in any order and on any threads, and
    /// returns when all are done. While a frame is rasterized, a task that is left out makes more
    /// visible and nothing hidden. Numbers from `tasks` on, as of whole batches, do nothing.
    fn run(&self, tasks: usize, task: &(dyn Fn(usize) + Sync));
    /// Announces that there will be work soon, for threads that sleep. Returns at once, and may do
    /// nothing.
    fn wake(&self) {}
}

/// The calling thread alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct SingleThread;

impl Threads for SingleThread {
    fn count(&self) -> usize {
        1
    }

    fn run(&self, tasks: usize, task: &(dyn Fn(usize) + Sync)) {
        (0..tasks).for_each(task);
    }
}

/// Threads by a closure, for instance one that hands tasks to an engine's job system.
///
/// ```
/// use foveal_cull::{Threads, ThreadsFn};
///
/// let scoped = ThreadsFn::new(4, |tasks, task| {
///     std::thread::scope(|scope| {
///         (0..tasks).for_each(|i| drop(scope.spawn(move || task(i))));
///     });
/// });
/// assert_eq!(scoped.count(), 4);
/// ```
#[derive(Clone, Copy)]
pub struct ThreadsFn<F> {
    count: usize,
    run: F,
}

impl<F: Fn(usize, &(dyn Fn(usize) + Sync)) + Sync> ThreadsFn<F> {
    /// `count` tasks can run at once. `run(tasks, task)` does what [`Threads::run`] says.
    pub fn new(count: usize, run: F) -> Self {
        Self { count, run }
    }
}

impl<F> core::fmt::Debug for ThreadsFn<F> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("ThreadsFn")
            .field("count", &self.count)
            .finish_non_exhaustive()
    }
}

impl<F: Fn(usize, &(dyn Fn(usize) + Sync)) + Sync> Threads for ThreadsFn<F> {
    fn count(&self) -> usize {
        self.count
    }

    fn run(&self, tasks: usize, task: &(dyn Fn(usize) + Sync)) {
        (self.run)(tasks, task);
    }
}

/// The current rayon thread pool. Needs the feature `rayon`.
#[cfg(feature = "rayon")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Rayon;

#[cfg(feature = "rayon")]
impl Threads for Rayon {
    fn count(&self) -> usize {
        rayon::current_num_threads()
    }

    fn run(&self, tasks: usize, task: &(dyn Fn(usize) + Sync)) {
        rayon::scope(|scope| {
            for i in 1..tasks {
                scope.spawn(move |_| task(i));
            }
            if tasks > 0 {
                task(0);
            }
        });
    }
}
