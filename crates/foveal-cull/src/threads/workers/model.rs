//! Worker threads in every order in which their steps can happen, by loom (Norris and Demsky 2013).
//!
//! `RUSTFLAGS="--cfg loom" cargo test -p foveal-cull --lib model` tries them; steps of threads that
//! are interrupted more than three times are left out.

use super::WorkerThreads;
use crate::threads::Threads;
use loom::sync::Arc;
use loom::sync::atomic::{AtomicU32, Ordering};

fn in_every_order(what: impl Fn() + Sync + Send + 'static) {
    let mut model = loom::model::Builder::new();
    model.preemption_bound = Some(3);
    model.check(what);
}

/// Runs two tasks and says how often each was run.
fn run(threads: &WorkerThreads) -> [u32; 2] {
    let ran = [AtomicU32::new(0), AtomicU32::new(0)];
    threads.run(2, &|i| {
        ran[i].fetch_add(1, Ordering::Relaxed);
    });
    // Read without an order of its own: `run` gives it.
    [0, 1].map(|i| ran[i].load(Ordering::Relaxed))
}

#[test]
fn tasks_run_once_and_are_done_when_the_run_ends() {
    in_every_order(|| {
        let threads = WorkerThreads::new(2);
        assert_eq!(run(&threads), [1, 1]);
    });
}

#[test]
fn a_second_run_has_nothing_of_the_first() {
    in_every_order(|| {
        let threads = WorkerThreads::new(2);
        assert_eq!(run(&threads), [1, 1]);
        assert_eq!(run(&threads), [1, 1]);
    });
}

#[test]
fn tasks_run_tasks_on_the_threads_that_run_them() {
    in_every_order(|| {
        let threads = WorkerThreads::new(2);
        threads.run(2, &|_| assert_eq!(run(&threads), [1, 1]));
    });
}

#[test]
fn a_wake_without_work_changes_nothing() {
    in_every_order(|| {
        let threads = WorkerThreads::new(2);
        threads.wake();
        assert_eq!(run(&threads), [1, 1]);
        threads.wake();
    });
}

#[test]
fn threads_end_without_ever_having_worked() {
    in_every_order(|| drop(WorkerThreads::new(2)));
}

/// What tasks write without atomics is seen by the caller, and nobody else writes it then.
#[test]
fn results_of_tasks_are_the_callers_after_the_run() {
    in_every_order(|| {
        let threads = WorkerThreads::new(2);
        let places = Arc::new([
            loom::cell::UnsafeCell::new(0),
            loom::cell::UnsafeCell::new(0),
        ]);
        let shared = Shared(Arc::clone(&places));
        let shared = &shared;
        threads.run(2, &|i| shared.0[i].with_mut(|_| ()));
        for place in places.iter() {
            place.with_mut(|_| ());
        }
    });
}

/// Each task has its own place.
struct Shared(Arc<[loom::cell::UnsafeCell<u32>; 2]>);

// SAFETY: no two tasks use the same place, which the model checks.
unsafe impl Sync for Shared {}
