//! Threads that a frame runs on.

/// Runs the tasks of a frame on several threads.
///
/// Implement it for your own job system. The crate starts threads only in
/// [`WorkerThreads`](super::WorkerThreads). [`Culler::rasterize`](crate::Culler::rasterize) calls
/// `run` twice per frame.
pub trait Threads: Sync {
    /// Number of tasks that can run at once, at least 1.
    fn count(&self) -> usize;
    /// Calls `task(i)` once for every `i` below `tasks`, in any order and on any threads, and
    /// returns when all are done.
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
