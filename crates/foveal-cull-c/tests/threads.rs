//! The library's threads as a job system that runs the caller's own tasks too.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

use core::ffi::c_void;
use core::ptr::null;
use core::sync::atomic::{AtomicU32, Ordering};
use foveal_cull_c::*;
use objects::{culler, set, test, view, wall};

use FovealCullStatus as Status;

struct Scene {
    set: *mut FovealCullOccluders,
    jobs: FovealCullJobs,
    hidden: AtomicU32,
}

/// Rasterizes with a culler of its own on the threads that run the task.
extern "C" fn draw(context: *mut c_void, _: u32) {
    // SAFETY: the test passes its scene, which lives; live handles.
    unsafe {
        let scene = &*context.cast::<Scene>();
        let culler = culler();
        let drawn = foveal_culler_rasterize(culler, &view(), scene.set, null(), &scene.jobs);
        if (drawn, test(culler)) == (Status::Ok, FovealCullVisibility::Occluded as u8) {
            scene.hidden.fetch_add(1, Ordering::Relaxed);
        }
        foveal_culler_destroy(culler);
    }
}

/// Draws whenever the time of a frame is asked for.
extern "C" fn clock(user: *mut c_void) -> u64 {
    draw(user, 0);
    0
}

#[test]
fn tasks_and_clocks_may_rasterize_on_the_threads_that_run_them() {
    let (mesh, set, outer) = (wall(), set(), culler());
    let mut id = FovealCullOccluderId {
        set: 0,
        occluder: 0,
    };
    let (mut threads, mut jobs) = (core::ptr::null_mut(), core::mem::MaybeUninit::uninit());
    let mut options = core::mem::MaybeUninit::uninit();
    // SAFETY: live handles; pointers to variables of the right size; a batch that lives until all
    // of its tasks are done.
    unsafe {
        let added = foveal_cull_occluders_add(set, mesh, null(), &mut id);
        assert_eq!(added, Status::Ok);
        assert_eq!(foveal_cull_threads_create(3, &mut threads), Status::Ok);
        let size = size_of::<FovealCullJobs>();
        let made = foveal_cull_threads_jobs_sized(threads, jobs.as_mut_ptr(), size);
        assert_eq!(made, Status::Ok);
        let mut scene = Scene {
            set,
            jobs: jobs.assume_init(),
            hidden: AtomicU32::new(0),
        };
        let (user, run) = (scene.jobs.user, scene.jobs.run.unwrap());
        run(user, 8, draw, (&raw mut scene).cast());
        assert_eq!(scene.hidden.load(Ordering::Relaxed), 8);
        let size = size_of::<FovealCullFrameOptions>();
        let made = foveal_cull_frame_options_init_sized(options.as_mut_ptr(), size);
        assert_eq!(made, Status::Ok);
        let options = FovealCullFrameOptions {
            clock: Some(clock),
            clock_user: (&raw mut scene).cast(),
            deadline_ns: 1,
            ..options.assume_init()
        };
        let drawn = foveal_culler_rasterize(outer, &view(), set, &options, &scene.jobs);
        assert_eq!((drawn, test(outer)), (Status::Ok, 3));
        assert!(scene.hidden.load(Ordering::Relaxed) > 8);
        foveal_cull_threads_destroy(threads);
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(set);
        foveal_culler_destroy(outer);
    }
}
