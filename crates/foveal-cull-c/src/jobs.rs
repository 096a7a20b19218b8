//! Who does the work: the caller's job system, or threads of the library.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border::{self, Plain};
use crate::status::{Fault, FovealCullStatus, guard};
use core::ffi::c_void;
use core::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use foveal_cull::{SingleThread, Threads, WorkerThreads};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A task of a batch: call it with the batch's context and a number.
pub type FovealCullTask = extern "C" fn(context: *mut c_void, index: u32);

/// Calls `task(context, i)` once for every `i` below `tasks`, in any order and on any threads, and
/// returns when all are done.
pub type FovealCullRun =
    extern "C" fn(user: *mut c_void, tasks: u32, task: FovealCullTask, context: *mut c_void);

/// Announces that there will be work soon. Returns at once.
pub type FovealCullWake = extern "C" fn(user: *mut c_void);

/// A job system.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct FovealCullJobs {
    /// sizeof(FovealCullJobs).
    pub size: u32,
    /// Number of tasks that can run at once, at least 1.
    pub count: u32,
    /// Passed to the functions.
    pub user: *mut c_void,
    /// Runs the tasks of a batch.
    pub run: Option<FovealCullRun>,
    /// May be null.
    pub wake: Option<FovealCullWake>,
}

// SAFETY: numbers and pointers; C writes functions or null.
unsafe impl Plain for FovealCullJobs {}

/// Size of the first version, which ends with the last field that it had.
const FIRST_JOBS: usize =
    core::mem::offset_of!(FovealCullJobs, wake) + size_of::<Option<FovealCullWake>>();

/// Threads of the library.
#[derive(Debug)]
pub struct FovealCullThreads(WorkerThreads);

/// Most threads.
const MAX_THREADS: u32 = 256;

/// Most tasks of a batch that are handed to the caller's job system.
const MAX_TASKS: usize = 256;

/// Jobs, checked.
pub(crate) struct CallerJobs {
    count: usize,
    user: *mut c_void,
    run: FovealCullRun,
    wake: Option<FovealCullWake>,
}

// SAFETY: `user` is only passed on, and the header asks for functions that may be called from the
// thread that calls the library.
unsafe impl Sync for CallerJobs {}

impl CallerJobs {
    /// Reads jobs; null is the calling thread alone.
    ///
    /// # Safety
    /// The pointer is null, or names as many bytes as the struct says.
    pub(crate) unsafe fn read(pointer: *const FovealCullJobs) -> Result<Option<Self>, Fault> {
        if pointer.is_null() {
            return Ok(None);
        }
        let default = FovealCullJobs {
            size: 0,
            count: 1,
            user: core::ptr::null_mut(),
            run: None,
            wake: None,
        };
        // SAFETY: the caller's word.
        let jobs = unsafe { border::sized(pointer, FIRST_JOBS, default, "jobs") }?;
        if !(1..=MAX_THREADS).contains(&jobs.count) {
            return Err(Fault::argument("'count' of the jobs is not 1 to 256"));
        }
        let run = jobs.run.ok_or_else(|| {
            Fault::new(FovealCullStatus::NullPointer, "'run' of the jobs is null")
        })?;
        Ok(Some(Self {
            count: jobs.count as usize,
            user: jobs.user,
            run,
            wake: jobs.wake,
        }))
    }

    /// These jobs, or the calling thread where there are none.
    pub(crate) fn threads(jobs: &Option<Self>) -> &dyn Threads {
        match jobs {
            Some(jobs) => jobs,
            None => &SingleThread,
        }
    }
}

/// A batch that is being run. Each task runs once, whatever the job system does.
struct Batch<'a> {
    task: &'a (dyn Fn(usize) + Sync),
    tasks: usize,
    /// Bit per task: somebody has it.
    claimed: [AtomicU64; MAX_TASKS / 64],
    done: AtomicU32,
    panicked: AtomicBool,
}

impl Batch<'_> {
    fn run_one(&self, index: usize) {
        if index >= self.tasks {
            return;
        }
        let bit = 1 << (index % 64);
        if self.claimed[index / 64].fetch_or(bit, Ordering::Relaxed) & bit != 0 {
            return;
        }
        if let Err(payload) = catch_unwind(AssertUnwindSafe(|| (self.task)(index))) {
            core::mem::forget(payload);
            self.panicked.store(true, Ordering::Relaxed);
        }
        // The last thing that this thread does with the batch.
        self.done.fetch_add(1, Ordering::Release);
    }
}

extern "C" fn run_task(context: *mut c_void, index: u32) {
    if context.is_null() {
        return;
    }
    // SAFETY: `CallerJobs::run` passes a batch and keeps it until all tasks are done; the header
    // asks that no task is called later.
    let batch = unsafe { &*context.cast::<Batch<'_>>() };
    batch.run_one(index as usize);
}

impl Threads for CallerJobs {
    fn count(&self) -> usize {
        self.count
    }

    fn run(&self, tasks: usize, task: &(dyn Fn(usize) + Sync)) {
        let batch = Batch {
            task,
            tasks: tasks.min(MAX_TASKS),
            claimed: [const { AtomicU64::new(0) }; MAX_TASKS / 64],
            done: AtomicU32::new(0),
            panicked: AtomicBool::new(false),
        };
        let context = core::ptr::from_ref(&batch).cast_mut().cast();
        (self.run)(self.user, batch.tasks as u32, run_task, context);
        // What the job system has forgotten, and what it has not waited for.
        (0..batch.tasks).for_each(|i| batch.run_one(i));
        while (batch.done.load(Ordering::Acquire) as usize) < batch.tasks {
            std::thread::yield_now();
        }
        (MAX_TASKS..tasks).for_each(task);
        assert!(!batch.panicked.into_inner(), "a task panicked");
    }

    fn wake(&self) {
        if let Some(wake) = self.wake {
            wake(self.user);
        }
    }
}

/// Starts `count - 1` threads; the calling thread is the last one.
///
/// # Safety
/// `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_threads_create(
    count: u32,
    out: *mut *mut FovealCullThreads,
) -> FovealCullStatus {
    guard(|| {
        let make = || {
            if !(1..=MAX_THREADS).contains(&count) {
                return Err(Fault::argument("'count' is not 1 to 256"));
            }
            Ok(FovealCullThreads(WorkerThreads::new(count as usize)))
        };
        // SAFETY: the caller's word.
        unsafe { border::give(out, make) }
    })
}

/// Joins the threads. Null is nothing.
///
/// # Safety
/// `threads` is null or comes from this library, and is used no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_threads_destroy(threads: *mut FovealCullThreads) {
    // SAFETY: the caller's word.
    unsafe { border::take(threads) };
}

/// The threads as a job system. `size` is the caller's sizeof(FovealCullJobs).
///
/// # Safety
/// `threads` is null or lives as long as `out` is used; `out` is null, or `size` bytes can be written
/// to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_threads_jobs_sized(
    threads: *const FovealCullThreads,
    out: *mut FovealCullJobs,
    size: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let workers = border::object(threads, "threads")?;
            let jobs = FovealCullJobs {
                size: size_of::<FovealCullJobs>() as u32,
                count: workers.0.count() as u32,
                user: threads.cast_mut().cast(),
                run: Some(run_on_workers),
                wake: Some(wake_workers),
            };
            border::init_sized(out, size, FIRST_JOBS, &jobs, "out")
        }
    })
}

/// A context that crosses threads.
struct Context(*mut c_void);

// SAFETY: it is the batch's, which is made to be used from many threads.
unsafe impl Sync for Context {}

extern "C" fn run_on_workers(
    user: *mut c_void,
    tasks: u32,
    task: FovealCullTask,
    context: *mut c_void,
) {
    guard(|| {
        // SAFETY: `user` is what `foveal_cull_threads_jobs_sized` wrote, and the header asks that the
        // threads live as long.
        let workers = unsafe { border::object(user.cast::<FovealCullThreads>(), "threads") }?;
        let context = Context(context);
        let context = &context;
        workers
            .0
            .run(tasks as usize, &|i| task(context.0, i as u32));
        Ok(())
    });
}

extern "C" fn wake_workers(user: *mut c_void) {
    guard(|| {
        // SAFETY: as in `run_on_workers`.
        let workers = unsafe { border::object(user.cast::<FovealCullThreads>(), "threads") }?;
        workers.0.wake();
        Ok(())
    });
}
