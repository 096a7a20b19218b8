//! Usefulness through the border: a code for every wrong call, which changes nothing.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

use core::mem::MaybeUninit;
use core::ptr::{null, null_mut};
use foveal_cull_c::*;
use objects::{culler, set, view, wall};

use FovealCullStatus as Status;

/// A box behind the wall.
const BOX: [f32; 6] = [-0.5, -0.5, -9.0, 0.5, 0.5, -8.0];

fn usefulness() -> *mut FovealCullUsefulness {
    let mut usefulness = null_mut();
    // SAFETY: a place for the object.
    let status = unsafe { foveal_cull_usefulness_create(&mut usefulness) };
    assert_eq!(status, Status::Ok);
    usefulness
}

fn options(usefulness: *const FovealCullUsefulness) -> FovealCullFrameOptions {
    let mut options = MaybeUninit::uninit();
    let size = size_of::<FovealCullFrameOptions>();
    // SAFETY: a place for the options, of this size.
    let options = unsafe {
        let status = foveal_cull_frame_options_init_sized(options.as_mut_ptr(), size);
        assert_eq!(status, Status::Ok);
        options.assume_init()
    };
    FovealCullFrameOptions {
        usefulness,
        ..options
    }
}

#[test]
fn wrong_calls_give_codes() {
    let (mesh, set, culler, view) = (wall(), set(), culler(), view());
    let known = usefulness();
    let (boxes, hidden) = (BOX.as_ptr(), [3u8]);
    let mut occludees = null_mut();
    let mut id = FovealCullOccluderId {
        set: 0,
        occluder: 0,
    };
    // SAFETY: live handles or null, and pointers to variables of the right size.
    unsafe {
        assert_eq!(
            foveal_cull_occluders_add(set, mesh, null(), &mut id),
            Status::Ok
        );
        assert_eq!(
            foveal_cull_occludees_create(null(), &mut occludees),
            Status::Ok
        );
        let results = hidden.as_ptr();
        for status in [
            foveal_cull_usefulness_create(null_mut()),
            foveal_cull_usefulness_forget(null_mut()),
            foveal_cull_usefulness_observe(null_mut(), culler, boxes, 1, null(), results),
            foveal_cull_usefulness_observe(known, null(), boxes, 1, null(), results),
            foveal_cull_usefulness_observe(known, culler, null(), 1, null(), results),
            foveal_cull_usefulness_observe(known, culler, boxes, 1, null(), null()),
            foveal_cull_usefulness_observe_occludees(null_mut(), culler, occludees, results, 0),
            foveal_cull_usefulness_observe_occludees(known, null(), occludees, results, 0),
            foveal_cull_usefulness_observe_occludees(known, culler, null(), results, 0),
            foveal_cull_usefulness_learn(null_mut(), culler, set),
            foveal_cull_usefulness_learn(known, null(), set),
            foveal_cull_usefulness_learn(known, culler, null()),
        ] {
            assert_eq!(status, Status::NullPointer);
        }
        let unknown = [9u8];
        let status =
            foveal_cull_usefulness_observe(known, culler, boxes, 1, null(), unknown.as_ptr());
        assert_eq!(status, Status::BadArgument);
        let status = foveal_cull_usefulness_observe_occludees(known, culler, occludees, results, 1);
        assert_eq!(status, Status::WrongLength);
        let odd = FovealCullFrameOptions {
            usefulness: known.byte_add(1),
            ..options(known)
        };
        let status = foveal_culler_rasterize(culler, &view, set, &odd, null());
        assert_eq!(status, Status::BadArgument, "misaligned");
        foveal_cull_usefulness_destroy(null_mut());
        foveal_cull_usefulness_destroy(known);
        foveal_cull_occludees_destroy(occludees);
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(set);
        foveal_culler_destroy(culler);
    }
}

/// A program that was compiled with the first header has no such field.
#[test]
fn options_of_the_first_version_know_nothing() {
    let (mesh, set, culler, view) = (wall(), set(), culler(), view());
    let known = usefulness();
    let first = core::mem::offset_of!(FovealCullFrameOptions, usefulness) as u32;
    let mut id = FovealCullOccluderId {
        set: 0,
        occluder: 0,
    };
    let mut stats = FovealCullStats::default();
    // SAFETY: live handles, and pointers to variables of the right size.
    unsafe {
        assert_eq!(
            foveal_cull_occluders_add(set, mesh, null(), &mut id),
            Status::Ok
        );
        let mut frame = |options: &FovealCullFrameOptions| {
            let status = foveal_culler_rasterize(culler, &view, set, options, null());
            assert_eq!(status, Status::Ok);
            // Nothing is hidden that was asked for, so that the wall is of no use.
            let visible = [0u8];
            let observed = foveal_cull_usefulness_observe(
                known,
                culler,
                BOX.as_ptr(),
                1,
                null(),
                visible.as_ptr(),
            );
            assert_eq!(observed, Status::Ok);
            assert_eq!(foveal_cull_usefulness_learn(known, culler, set), Status::Ok);
            let size = size_of::<FovealCullStats>();
            let read = foveal_culler_stats_sized(culler, &mut stats, size);
            assert_eq!(read, Status::Ok);
            stats.clusters_not_useful
        };
        let old = FovealCullFrameOptions {
            size: first,
            ..options(known)
        };
        assert!((0..30).all(|_| frame(&old) == 0));
        assert!((0..30).any(|_| frame(&options(known)) == 1));
        assert_eq!(foveal_cull_usefulness_forget(known), Status::Ok);
        assert_eq!(frame(&options(known)), 0);
        foveal_cull_usefulness_destroy(known);
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(set);
        foveal_culler_destroy(culler);
    }
}
