//! What C can get wrong with frames: views, options, jobs and structs of other versions.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

use core::ffi::c_void;
use core::ptr::{null, null_mut};
use core::sync::atomic::{AtomicU32, Ordering};
use foveal_cull_c::*;
use objects::{BEHIND, culler, last_error, set, test, view, wall};

use FovealCullStatus as Status;

#[test]
fn structs_of_other_versions_are_taken_if_nothing_is_lost() {
    /// The view of a later version, with one more field.
    #[repr(C)]
    struct Newer {
        view: FovealCullView,
        more: u64,
    }
    let (mesh, set, culler) = (wall(), set(), culler());
    let mut id = FovealCullOccluderId {
        set: 0,
        occluder: 0,
    };
    let mut newer = Newer {
        view: view(),
        more: 0,
    };
    newer.view.size = size_of::<Newer>() as u32;
    // SAFETY: live handles; structs are as long as they say.
    unsafe {
        assert_eq!(
            foveal_cull_occluders_add(set, mesh, null(), &mut id),
            Status::Ok
        );
        let rasterize = |newer: &Newer| {
            let view = core::ptr::from_ref(newer).cast();
            foveal_culler_rasterize(culler, view, set, null(), null())
        };
        assert_eq!(rasterize(&newer), Status::Ok);
        assert_eq!(test(culler), FovealCullVisibility::Occluded as u8);
        newer.more = 1;
        assert_eq!(rasterize(&newer), Status::BadStructSize);
        assert!(last_error().contains("does not know"), "{}", last_error());
        assert_eq!(
            test(culler),
            FovealCullVisibility::Visible as u8,
            "after a failed frame"
        );
        // Stats for a caller that knows more than the library.
        #[repr(C)]
        struct NewerStats {
            stats: FovealCullStats,
            more: u64,
        }
        let mut stats = NewerStats {
            stats: FovealCullStats::default(),
            more: 9,
        };
        let (to, size) = ((&raw mut stats).cast(), size_of::<NewerStats>());
        assert_eq!(foveal_culler_stats_sized(culler, to, size), Status::Ok);
        assert_eq!(
            (stats.stats.size, stats.more),
            (size_of::<NewerStats>() as u32, 0)
        );
        let mut small = FovealCullStats::default();
        assert_eq!(
            foveal_culler_stats_sized(culler, &mut small, 8),
            Status::BadStructSize
        );
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(set);
        foveal_culler_destroy(culler);
    }
}

#[test]
fn bad_views_options_and_jobs_are_refused_and_leave_everything_visible() {
    let (mesh, set, culler, good) = (wall(), set(), culler(), view());
    let mut id = FovealCullOccluderId {
        set: 0,
        occluder: 0,
    };
    let mut options = core::mem::MaybeUninit::uninit();
    // SAFETY: live handles; pointers to variables of the right size.
    let plain = unsafe {
        assert_eq!(
            foveal_cull_occluders_add(set, mesh, null(), &mut id),
            Status::Ok
        );
        assert_eq!(
            foveal_cull_frame_options_init_sized(
                options.as_mut_ptr(),
                size_of::<FovealCullFrameOptions>()
            ),
            Status::Ok
        );
        options.assume_init()
    };
    let check = |view: FovealCullView, options, jobs: Option<FovealCullJobs>, expected| {
        let jobs = jobs.as_ref().map_or(null(), core::ptr::from_ref);
        // SAFETY: as above.
        let status = unsafe {
            let ok = foveal_culler_rasterize(culler, &good, set, null(), null());
            assert_eq!((ok, test(culler)), (Status::Ok, 3));
            foveal_culler_rasterize(culler, &view, set, &options, jobs)
        };
        let visible = if expected == Status::Ok { 3 } else { 0 };
        assert_eq!(
            (status, test(culler)),
            (expected, visible),
            "{}",
            last_error()
        );
    };
    let eye = |change: fn(&mut FovealCullEye)| {
        let mut view = good;
        change(&mut view.eyes[0]);
        view
    };
    check(good, plain, None, Status::Ok);
    check(
        FovealCullView {
            eye_count: 0,
            ..good
        },
        plain,
        None,
        Status::BadArgument,
    );
    check(
        FovealCullView {
            eye_count: 3,
            ..good
        },
        plain,
        None,
        Status::BadArgument,
    );
    check(
        FovealCullView {
            eye_count: 2,
            ..good
        },
        plain,
        None,
        Status::BadView,
    );
    check(
        FovealCullView { size: 12, ..good },
        plain,
        None,
        Status::BadStructSize,
    );
    let radius = FovealCullView {
        validity_radius_m: -1.0,
        ..good
    };
    check(radius, plain, None, Status::NotFinite);
    check(
        eye(|e| e.orthographic = 2),
        plain,
        None,
        Status::BadArgument,
    );
    check(eye(|e| e.near_m = 0.0), plain, None, Status::BadView);
    check(eye(|e| e.left = f64::NAN), plain, None, Status::NotFinite);
    check(
        eye(|e| e.world_from_eye[4] = 3.0),
        plain,
        None,
        Status::BadView,
    );
    let small = FovealCullFrameOptions {
        occludee_size_threshold: f32::NAN,
        ..plain
    };
    check(good, small, None, Status::NotFinite);
    check(
        good,
        FovealCullFrameOptions {
            occlusion: 2,
            ..plain
        },
        None,
        Status::BadArgument,
    );
    check(
        good,
        FovealCullFrameOptions { size: 1, ..plain },
        None,
        Status::BadStructSize,
    );
    // Half of a pointer.
    let half = FovealCullFrameOptions {
        size: plain.size - 4,
        ..plain
    };
    check(good, half, None, Status::BadStructSize);
    let jobs = FovealCullJobs {
        size: size_of::<FovealCullJobs>() as u32,
        count: 4,
        user: null_mut(),
        run: Some(run_in_order),
        wake: None,
    };
    check(good, plain, Some(jobs), Status::Ok);
    check(
        good,
        plain,
        Some(FovealCullJobs { run: None, ..jobs }),
        Status::NullPointer,
    );
    check(
        good,
        plain,
        Some(FovealCullJobs { count: 0, ..jobs }),
        Status::BadArgument,
    );
    check(
        good,
        plain,
        Some(FovealCullJobs { count: 257, ..jobs }),
        Status::BadArgument,
    );
    check(
        good,
        plain,
        Some(FovealCullJobs { size: 4, ..jobs }),
        Status::BadStructSize,
    );
    // SAFETY: nothing uses them any more.
    unsafe {
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(set);
        foveal_culler_destroy(culler);
    }
}

extern "C" fn run_in_order(_: *mut c_void, tasks: u32, task: FovealCullTask, context: *mut c_void) {
    (0..tasks).for_each(|i| task(context, i));
}

/// Runs every second task twice and forgets the others, calls numbers that there are not, and calls
/// the library from inside.
extern "C" fn run_badly(user: *mut c_void, tasks: u32, task: FovealCullTask, context: *mut c_void) {
    for i in (0..tasks + 500).step_by(2) {
        task(context, i);
        task(context, i);
    }
    task(null_mut(), 0);
    // SAFETY: the test passes the culler that is being used; a null count is not written.
    unsafe {
        let culler = user.cast::<FovealCuller>();
        let (mut w, mut h) = (0, 0);
        assert_eq!(foveal_culler_size(culler, &mut w, &mut h), Status::Busy);
        assert_eq!((w, h), (0, 0));
        let again = foveal_culler_rasterize(culler, null(), null(), null(), null());
        assert_eq!(again, Status::Busy);
        // Tests that fail leave what was there.
        let (mut results, mut pixels) = ([9u8], [9.0f32]);
        let to = results.as_mut_ptr();
        let status = foveal_culler_test_boxes(culler, BEHIND.as_ptr(), 1, null(), to);
        assert_eq!((status, results), (Status::Busy, [9]));
        let status = foveal_culler_read_depth(culler, pixels.as_mut_ptr(), 1);
        assert_eq!((status, pixels), (Status::Busy, [9.0]));
    }
    CALLS.fetch_add(1, Ordering::Relaxed);
}

static CALLS: AtomicU32 = AtomicU32::new(0);

#[test]
fn a_job_system_that_forgets_repeats_and_invents_tasks_gives_the_same_frame() {
    let (mesh, set, culler, view) = (wall(), set(), culler(), view());
    let mut id = FovealCullOccluderId {
        set: 0,
        occluder: 0,
    };
    let mut depths = [
        vec![0.0f32; 64 * 64],
        vec![0.0; 64 * 64],
        vec![0.0; 64 * 64],
    ];
    let mut threads = null_mut();
    let mut own = core::mem::MaybeUninit::uninit();
    // SAFETY: live handles; pointers to variables of the right size.
    unsafe {
        assert_eq!(
            foveal_cull_occluders_add(set, mesh, null(), &mut id),
            Status::Ok
        );
        assert_eq!(
            foveal_cull_threads_create(0, &mut threads),
            Status::BadArgument
        );
        assert_eq!(foveal_cull_threads_create(3, &mut threads), Status::Ok);
        assert_eq!(
            foveal_cull_threads_jobs_sized(threads, own.as_mut_ptr(), size_of::<FovealCullJobs>()),
            Status::Ok
        );
        let badly = FovealCullJobs {
            size: size_of::<FovealCullJobs>() as u32,
            count: 5,
            user: culler.cast(),
            run: Some(run_badly),
            wake: None,
        };
        let own = own.assume_init();
        let jobs: [*const FovealCullJobs; 3] = [null(), &badly, &own];
        for (depth, jobs) in depths.iter_mut().zip(jobs) {
            let done = foveal_culler_rasterize(culler, &view, set, null(), jobs);
            assert_eq!(done, Status::Ok);
            let pixels = depth.as_mut_ptr();
            assert_eq!(
                foveal_culler_read_depth(culler, pixels, 64),
                Status::WrongLength
            );
            assert_eq!(
                foveal_culler_read_depth(culler, pixels, 64 * 64),
                Status::Ok
            );
        }
        foveal_cull_threads_destroy(threads);
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(set);
        foveal_culler_destroy(culler);
    }
    assert!(CALLS.load(Ordering::Relaxed) > 0);
    assert!(depths[0].iter().any(|d| *d > 0.0));
    assert_eq!(depths[0], depths[1]);
    assert_eq!(depths[0], depths[2]);
}

#[test]
fn a_clock_that_has_run_out_draws_nothing_and_hides_nothing() {
    extern "C" fn late(user: *mut c_void) -> u64 {
        // SAFETY: the test passes a number that lives.
        unsafe { &*user.cast::<AtomicU32>() }.fetch_add(1, Ordering::Relaxed);
        100
    }
    let (mesh, set, culler, view) = (wall(), set(), culler(), view());
    let mut id = FovealCullOccluderId {
        set: 0,
        occluder: 0,
    };
    let readings = AtomicU32::new(0);
    let mut options = core::mem::MaybeUninit::uninit();
    // SAFETY: live handles; pointers to variables of the right size.
    unsafe {
        assert_eq!(
            foveal_cull_occluders_add(set, mesh, null(), &mut id),
            Status::Ok
        );
        assert_eq!(
            foveal_cull_frame_options_init_sized(
                options.as_mut_ptr(),
                size_of::<FovealCullFrameOptions>()
            ),
            Status::Ok
        );
        let options = FovealCullFrameOptions {
            clock: Some(late),
            clock_user: (&raw const readings).cast_mut().cast(),
            deadline_ns: 50,
            ..options.assume_init()
        };
        let done = foveal_culler_rasterize(culler, &view, set, &options, null());
        assert_eq!((done, test(culler)), (Status::Ok, 0));
        let (mut stats, size) = (FovealCullStats::default(), size_of::<FovealCullStats>());
        let read = foveal_culler_stats_sized(culler, &mut stats, size);
        assert_eq!(read, Status::Ok);
        assert_eq!((stats.occluder_models, stats.clusters_over_budget), (1, 1));
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(set);
        foveal_culler_destroy(culler);
    }
    assert!(readings.into_inner() > 0);
}

#[test]
fn matrices_and_origins_pass_the_border() {
    let culler = culler();
    let mut eye = view().eyes[0];
    let mut m = [0.0f64; 16];
    (m[0], m[5], m[11], m[14]) = (1.0, 1.0, -1.0, 0.5);
    // SAFETY: 16 numbers, a place for the eye, one box, three numbers, one result.
    unsafe {
        assert_eq!(
            foveal_cull_eye_from_matrix(m.as_ptr(), 1, &mut eye),
            Status::Ok
        );
        assert_eq!(
            (eye.near_m, eye.far_m, eye.left),
            (0.5, f64::INFINITY, -1.0)
        );
        let float = m.map(|v| v as f32);
        let mut same = view().eyes[0];
        assert_eq!(
            foveal_cull_eye_from_matrix_f32(float.as_ptr(), 1, &mut same),
            Status::Ok
        );
        assert_eq!(same, eye);
        assert_eq!(
            foveal_cull_eye_from_matrix(m.as_ptr(), 3, &mut eye),
            Status::BadArgument
        );
        assert_eq!(
            foveal_cull_eye_from_matrix(m.as_ptr(), 0, &mut eye),
            Status::BadView
        );
        m[3] = f64::NAN;
        assert_eq!(
            foveal_cull_eye_from_matrix(m.as_ptr(), 1, &mut eye),
            Status::NotFinite
        );
        let odd = [0.0, f64::INFINITY, 0.0];
        let (at, target, up) = ([0.0f64; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]);
        for (odd_one, bad) in [(0, f64::NAN), (1, f64::INFINITY), (2, f64::NAN)] {
            let mut lens = [1.0, 1.0, 0.1];
            lens[odd_one] = bad;
            let [fov, aspect, near] = lens;
            let [at, target, up] = [&at, &target, &up].map(|p| p.as_ptr());
            let status = foveal_cull_eye_look_at(at, target, up, fov, aspect, near, &mut same);
            assert_eq!((status, same), (Status::NotFinite, eye), "{lens:?}");
        }
        let mut result = [9];
        let test = foveal_culler_test_boxes;
        let status = test(
            culler,
            BEHIND.as_ptr(),
            1,
            odd.as_ptr(),
            result.as_mut_ptr(),
        );
        assert_eq!(status, Status::NotFinite);
        // Not aligned.
        let off = BEHIND.as_ptr().cast::<u8>().wrapping_add(1).cast();
        let status = test(culler, off, 1, null(), result.as_mut_ptr());
        assert_eq!(status, Status::BadArgument);
        foveal_culler_destroy(culler);
    }
}

#[test]
fn occluders_that_deform_and_terrains_hide_what_is_behind_them() {
    // A wall 5 m in front of the eye, and one beside it.
    let wall = |x: f32| {
        [(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)].map(|(dx, y)| [x + dx, y, -5.0])
    };
    let (before, after) = (wall(40.0), wall(0.0));
    let indices = [0u16, 1, 2, 0, 2, 3];
    let culler = culler();
    // SAFETY: live handles, structs as long as they say, lists as long as is said.
    unsafe {
        let mut source = core::mem::zeroed::<FovealCullMeshSource>();
        let size = size_of::<FovealCullMeshSource>();
        assert_eq!(
            foveal_cull_mesh_source_init_sized(&mut source, size),
            Status::Ok
        );
        source.index_bytes = 2;
        source.positions = before.as_ptr().cast();
        source.position_count = 4;
        source.indices = indices.as_ptr().cast();
        source.index_count = 6;
        source.deformable = 1;
        let mut mesh = null_mut();
        assert_eq!(foveal_cull_mesh_bake(&source, &mut mesh), Status::Ok);
        let set = set();
        let mut id = FovealCullOccluderId {
            set: 0,
            occluder: 0,
        };
        let added = foveal_cull_occluders_add(set, mesh, null(), &mut id);
        assert_eq!(added, Status::Ok);
        let seen = |set: *mut FovealCullOccluders| {
            let drawn = foveal_culler_rasterize(culler, &view(), set, null(), null());
            assert_eq!(drawn, Status::Ok);
            test(culler)
        };
        assert_eq!(seen(set), FovealCullVisibility::Visible as u8);
        let deform = |set, positions: &[[f32; 3]]| {
            let (first, count) = (positions.as_ptr().cast(), positions.len());
            foveal_cull_occluders_deform(set, id, first, count, 12)
        };
        assert_eq!(deform(set, &after[..3]), Status::WrongLength);
        assert_eq!(seen(set), FovealCullVisibility::Visible as u8);
        assert_eq!(deform(set, &after), Status::Ok);
        assert_eq!(seen(set), FovealCullVisibility::Occluded as u8);
        let other = self::set();
        assert_eq!(deform(other, &after), Status::OtherSet);

        // A hill whose ridge is across the view.
        let heights: Vec<f32> = (0..9 * 9)
            .map(|i| 12.0 - 4.0 * f32::abs((i / 9) as f32 - 4.0))
            .collect();
        let mut hill = null_mut();
        let bake = foveal_cull_mesh_from_heights;
        let of =
            |columns, rows, spacing, to| bake(heights.as_ptr(), columns, rows, spacing, 0.5, 2, to);
        assert_eq!(of(9, 9, 0.0, &mut hill), Status::NotFinite);
        assert_eq!(of(usize::MAX, 9, 2.0, &mut hill), Status::BadArgument);
        assert_eq!(of(9, 9, 2.0, &mut hill), Status::Ok);
        assert_eq!(foveal_cull_mesh_triangle_count(hill), 2 * 4 * 4);
        let place = [
            1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -8.0, -4.0, -6.0,
        ];
        let added = foveal_cull_occluders_add(other, hill, place.as_ptr(), &mut id);
        assert_eq!(added, Status::Ok);
        assert_eq!(seen(other), FovealCullVisibility::Occluded as u8);
        foveal_cull_mesh_destroy(hill);
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(other);
        foveal_cull_occluders_destroy(set);
        foveal_culler_destroy(culler);
    }
}
