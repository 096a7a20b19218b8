//! Threads

/// Runs tasks on several threads. Implement it for your own pool; the crate never starts threads itself
/// unless you make a [`WorkerThreads`](super::WorkerThreads).
pub trait Threads: Sync {
    /// How many tasks can run at once (at least 1).
    fn count(&self) -> usize;
    /// Calls `task(i)` once for every `i` below `tasks`, in any order, on any threads, and returns when all
    /// are done.
    fn run(&self, tasks: usize, task: &(dyn Fn(usize) + Sync));
    /// Says that there will be work soon, for pools whose threads sleep. Returns at once; nothing need be done.
    fn wake(&self) {}
}

/// Everything on the calling thread.
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

/// The current rayon pool.
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
