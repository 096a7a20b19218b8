//! Texts of failures: they say which number is wrong, and what is wanted.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

use core::ffi::CStr;
use core::ptr::{null, null_mut};
use foveal_cull_c::*;
use objects::{culler, last_error, set, view};

use FovealCullStatus as Status;

/// A culler, a set and a mask, which are dropped at the end.
struct Objects {
    culler: *mut FovealCuller,
    set: *mut FovealCullOccluders,
    mask: *mut FovealCullReceiverMask,
}

impl Objects {
    fn new() -> Self {
        let mut mask = null_mut();
        // SAFETY: a view of this version and a place for the mask.
        let made = unsafe { foveal_cull_receiver_mask_create(&view(), 64, &mut mask) };
        assert_eq!(made, Status::Ok);
        Self {
            culler: culler(),
            set: set(),
            mask,
        }
    }

    fn rasterize(&self, view: FovealCullView, change: fn(&mut FovealCullFrameOptions)) -> Status {
        let mut options = core::mem::MaybeUninit::uninit();
        let size = size_of::<FovealCullFrameOptions>();
        // SAFETY: a place for the options, which are written; live handles and structs of this
        // version.
        unsafe {
            let made = foveal_cull_frame_options_init_sized(options.as_mut_ptr(), size);
            assert_eq!(made, Status::Ok);
            let mut options = options.assume_init();
            change(&mut options);
            foveal_culler_rasterize(self.culler, &view, self.set, &options, null())
        }
    }
}

impl Drop for Objects {
    fn drop(&mut self) {
        // SAFETY: nothing uses them any more.
        unsafe {
            foveal_culler_destroy(self.culler);
            foveal_cull_occluders_destroy(self.set);
            foveal_cull_receiver_mask_destroy(self.mask);
        }
    }
}

#[test]
fn finite_numbers_out_of_their_range_have_a_code_and_a_text_that_say_so() {
    let objects = Objects::new();
    let back = FovealCullView {
        validity_radius_m: -1.0,
        ..view()
    };
    let (heights, mut hill) = ([0.0f32; 9], null_mut());
    let refused = |status: Status, text: &str| {
        assert_eq!(status, Status::NotFinite, "{text}");
        assert!(last_error().contains(text), "{}", last_error());
    };
    refused(
        objects.rasterize(back, |_| {}),
        "the validity radius must not be negative",
    );
    refused(
        objects.rasterize(view(), |o| o.occludee_size_threshold = -1.0),
        "'occludee_size_threshold' is -1, but must be finite and not negative",
    );
    // SAFETY: a live mask; nine heights and a place for the mesh.
    unsafe {
        refused(
            foveal_cull_receiver_mask_set_reach(objects.mask, -1.0, 0.0),
            "not negative",
        );
        refused(
            foveal_cull_mesh_from_heights(heights.as_ptr(), 3, 3, 0.0, 1.0, 1, &mut hill),
            "the spacing of heights must be above zero",
        );
    }
    assert!(hill.is_null());
    // SAFETY: texts are constants.
    let text = unsafe { CStr::from_ptr(foveal_cull_status_text(Status::NotFinite as i32)) };
    assert!(text.to_str().unwrap().contains("out of its range"));
}

#[test]
fn switches_that_are_refused_are_named_with_what_is_wanted() {
    let objects = Objects::new();
    let eye = |change: fn(&mut FovealCullEye)| {
        let mut view = view();
        change(&mut view.eyes[0]);
        view
    };
    let refused = |status: Status, text: &str| {
        assert_eq!((status, last_error().as_str()), (Status::BadArgument, text));
    };
    refused(
        objects.rasterize(view(), |o| o.occlusion = 2),
        "'occlusion' is neither 0 nor 1",
    );
    refused(
        objects.rasterize(view(), |o| o.reserved = 1),
        "'reserved' of the options is not 0",
    );
    refused(
        objects.rasterize(eye(|e| e.orthographic = 2), |_| {}),
        "'orthographic' is neither 0 nor 1",
    );
    refused(
        objects.rasterize(eye(|e| e.reserved = 1), |_| {}),
        "'reserved' of an eye is not 0",
    );
}
