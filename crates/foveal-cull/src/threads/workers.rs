//! Worker threads: the calling thread and helpers that wait for work.
//!
//! Sleeping and waking take as long as a part of a frame's culling. A waiting thread therefore
//! spins for about 40 microseconds before it sleeps, and only sleeping threads are woken. A caller
//! that knows that there will be work can wake them beforehand.
//!
//! A task lives on the caller's stack, so helpers reach it through a pointer. The caller does not
//! return before the last helper has let go of it.
#![allow(
    unsafe_code,
    reason = "helpers outlive the borrow of a task; see the SAFETY line"
)]

#[cfg(all(test, loom))]
mod model;

use super::run::Threads;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::PoisonError;
use sync::{
    Arc, AtomicU64, AtomicUsize, Condvar, JoinHandle, Mutex, MutexGuard, Ordering, ThreadId,
};

/// What threads and memory are; under `--cfg loom` the model checker's.
#[cfg(not(all(test, loom)))]
mod sync {
    pub(super) use core::hint::spin_loop;
    pub(super) use core::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
    pub(super) use std::sync::{Arc, Condvar, Mutex, MutexGuard};
    pub(super) use std::thread::{Builder, JoinHandle, ThreadId, current, yield_now};

    /// Times that a waiting thread looks for work before it sleeps, about ten nanoseconds each.
    pub(super) const LOOKS: u32 = 4000;
}
#[cfg(all(test, loom))]
mod sync {
    pub(super) use loom::hint::spin_loop;
    pub(super) use loom::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
    pub(super) use loom::sync::{Arc, Condvar, Mutex, MutexGuard};
    pub(super) use loom::thread::{Builder, JoinHandle, ThreadId, current, yield_now};

    /// Every further look makes the same choices possible once more.
    pub(super) const LOOKS: u32 = 1;
}

/// Threads of the culler's own, started once and joined when dropped.
///
/// One [`Threads::run`] at a time: a second one from another thread waits its turn. A task may call
/// `run` on the worker threads that run it: the tasks of that call run one by one on the task's own
/// thread. A task must not wait for another thread that calls `run` on them.
#[derive(Debug)]
pub struct WorkerThreads {
    shared: Arc<Shared>,
    helpers: Vec<JoinHandle<()>>,
    turn: Mutex<()>,
}

/// After this many looks another thread of the same core may run: it may be the one that is waited
/// for.
const LOOKS_IN_A_ROW: u32 = 64;

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
    next: AtomicUsize,
    /// `State::round` and `State::active`, to be read without the lock.
    round: AtomicU64,
    active: AtomicUsize,
}

#[derive(Debug, Default)]
struct State {
    task: Option<Task>,
    tasks: usize,
    /// The thread whose turn it is.
    caller: Option<ThreadId>,
    round: u64,
    /// Helpers that hold the task.
    active: usize,
    panicked: bool,
    stop: bool,
    /// Threads that sleep.
    sleepers: usize,
}

#[derive(Clone, Copy)]
struct Task(*const (dyn Fn(usize) + Sync));

impl core::fmt::Debug for Task {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Task")
    }
}

// SAFETY: what it points to is `Sync`, so it may be used from any thread while it lives.
unsafe impl Send for Task {}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, mut state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        state.sleepers += 1;
        let mut state = self
            .changed
            .wait(state)
            .unwrap_or_else(PoisonError::into_inner);
        state.sleepers -= 1;
        state
    }

    /// Releases the lock and wakes the threads that sleep.
    fn announce(&self, state: MutexGuard<'_, State>) {
        let sleepers = state.sleepers;
        drop(state);
        if sleepers > 0 {
            self.changed.notify_all();
        }
    }

    /// Spins for a while until something has happened.
    fn watch(&self, happened: impl Fn(&Self) -> bool) {
        for look in 1..=sync::LOOKS {
            if happened(self) {
                return;
            }
            if look % LOOKS_IN_A_ROW == 0 {
                sync::yield_now();
            } else {
                sync::spin_loop();
            }
        }
    }

    fn help(&self) {
        let mut seen = 0;
        loop {
            self.watch(|s| s.round.load(Ordering::Acquire) != seen);
            let mut state = self.lock();
            while !state.stop && state.round == seen {
                state = self.wait(state);
            }
            if state.stop {
                return;
            }
            seen = state.round;
            // None if all was done before this thread came, or if it was only woken.
            let (Some(task), tasks) = (state.task, state.tasks) else {
                continue;
            };
            state.active += 1;
            self.active.store(state.active, Ordering::Relaxed);
            drop(state);
            let ended = catch_unwind(AssertUnwindSafe(|| {
                // SAFETY: `active` was raised under the lock while the task was posted, and
                // `WorkerThreads::run` keeps the task alive until it is zero again.
                let task = unsafe { &*task.0 };
                self.work(tasks, task);
            }));
            let mut state = self.lock();
            state.active -= 1;
            state.panicked |= ended.is_err();
            self.active.store(state.active, Ordering::Release);
            self.announce(state);
        }
    }

    fn work(&self, tasks: usize, task: &(dyn Fn(usize) + Sync)) {
        loop {
            let i = self.next.fetch_add(1, Ordering::Relaxed);
            if i >= tasks {
                return;
            }
            task(i);
        }
    }
}

/// Takes the task back, whatever happens.
struct Posted<'a>(&'a Shared);

impl Drop for Posted<'_> {
    fn drop(&mut self) {
        {
            let mut state = self.0.lock();
            (state.task, state.caller) = (None, None);
        }
        self.0.watch(|s| s.active.load(Ordering::Acquire) == 0);
        let mut state = self.0.lock();
        while state.active > 0 {
            state = self.0.wait(state);
        }
    }
}

/// More threads than any frame has work for.
const MOST_THREADS: usize = 256;

impl WorkerThreads {
    /// Starts `threads - 1` threads, 255 at most; the caller's is the last one. Threads that the system
    /// refuses are left out.
    #[must_use]
    pub fn new(threads: usize) -> Self {
        let shared = Arc::new(Shared::default());
        let helpers = (1..threads.min(MOST_THREADS))
            .map_while(|_| {
                let shared = Arc::clone(&shared);
                sync::Builder::new()
                    .name("foveal-cull".into())
                    .spawn(move || shared.help())
                    .ok()
            })
            .collect();
        Self {
            shared,
            helpers,
            turn: Mutex::new(()),
        }
    }

    /// Whether this thread is running a task of these threads.
    fn is_within_run(&self) -> bool {
        let this = sync::current().id();
        let mut helpers = self.helpers.iter();
        helpers.any(|h| h.thread().id() == this) || self.shared.lock().caller == Some(this)
    }
}

impl Threads for WorkerThreads {
    fn count(&self) -> usize {
        self.helpers.len() + 1
    }

    fn run(&self, tasks: usize, task: &(dyn Fn(usize) + Sync)) {
        if self.is_within_run() {
            // The turn ends only after this task.
            return (0..tasks).for_each(task);
        }
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let pointer: *const (dyn Fn(usize) + Sync + '_) = task;
        // SAFETY: only the lifetime changes; `Posted` ends every use before `task` does.
        let pointer: *const (dyn Fn(usize) + Sync + 'static) =
            unsafe { core::mem::transmute(pointer) };
        {
            let mut state = self.shared.lock();
            self.shared.next.store(0, Ordering::Relaxed);
            (state.task, state.tasks, state.panicked) = (Some(Task(pointer)), tasks, false);
            state.caller = Some(sync::current().id());
            state.round += 1;
            self.shared.round.store(state.round, Ordering::Release);
            self.shared.announce(state);
        }
        let posted = Posted(&self.shared);
        self.shared.work(tasks, task);
        drop(posted);
        let panicked = self.shared.lock().panicked;
        assert!(!panicked, "a task panicked");
    }

    /// Wakes the threads. They look for work for about 40 microseconds before they sleep again.
    fn wake(&self) {
        let mut state = self.shared.lock();
        if state.sleepers > 0 && state.task.is_none() {
            state.round += 1;
            self.shared.round.store(state.round, Ordering::Release);
            self.shared.announce(state);
        }
    }
}

impl Drop for WorkerThreads {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.stop = true;
        self.shared.announce(state);
        for helper in self.helpers.drain(..) {
            let _ = helper.join();
        }
    }
}
