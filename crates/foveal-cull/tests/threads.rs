//! The pool of threads.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use foveal_cull::{SingleThread, Threads, WorkerThreads};

#[test]
fn whoever_is_woken_and_when_every_task_runs_once() {
    for threads in [1, 2, 5] {
        let pool = WorkerThreads::new(threads);
        let stop = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !stop.load(Ordering::Relaxed) {
                    pool.wake();
                }
            });
            for round in 0..300 {
                let ran: [AtomicU32; 7] = [const { AtomicU32::new(0) }; 7];
                // Long enough that threads go to sleep now and then.
                if round % 50 == 0 {
                    std::thread::sleep(core::time::Duration::from_millis(2));
                }
                pool.run(ran.len(), &|i| {
                    ran[i].fetch_add(1, Ordering::Relaxed);
                });
                let ran = ran.map(AtomicU32::into_inner);
                assert_eq!(ran, [1; 7], "{threads} threads, round {round}");
            }
            stop.store(true, Ordering::Relaxed);
        });
    }
    SingleThread.wake();
}
