//! Views that C makes: eyes that look at a place, and views of pictures of any size.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

use core::ptr::null_mut;
use foveal_cull_c::*;
use objects::{last_error, view};
use std::f64::consts::PI;

use FovealCullStatus as Status;

fn look_at(target: [f64; 3], fov_y_rad: f64, aspect: f64, near_m: f64) -> (Status, FovealCullEye) {
    let (at, up) = ([1.0, 2.0, 3.0], [0.0, 1.0, 0.0]);
    let mut eye = view().eyes[0];
    // SAFETY: three numbers each, and a place for the eye.
    let status = unsafe {
        let [at, target, up] = [&at, &target, &up].map(|numbers| numbers.as_ptr());
        foveal_cull_eye_look_at(at, target, up, fov_y_rad, aspect, near_m, &mut eye)
    };
    (status, eye)
}

#[test]
fn a_lens_that_no_camera_has_is_a_bad_view_and_the_text_names_its_number() {
    let ahead = [1.0, 2.0, 2.0];
    let untouched = view().eyes[0];
    for (name, fov, aspect, near) in [
        ("fov_y_rad", 45.0, 1.5, 0.1),
        ("fov_y_rad", 60.0, 1.5, 0.1),
        ("fov_y_rad", 90.0, 1.5, 0.1),
        ("fov_y_rad", PI, 1.5, 0.1),
        ("fov_y_rad", 0.0, 1.5, 0.1),
        ("fov_y_rad", -1.0, 1.5, 0.1),
        ("aspect", 1.0, 0.0, 0.1),
        ("aspect", 1.0, -1.5, 0.1),
        ("near_m", 1.0, 1.5, 0.0),
        ("near_m", 1.0, 1.5, -0.1),
    ] {
        let (status, eye) = look_at(ahead, fov, aspect, near);
        let lens = (fov, aspect, near);
        assert_eq!((status, eye), (Status::BadView, untouched), "{lens:?}");
        let text = last_error();
        assert!(text.contains(&format!("'{name}'")), "{lens:?}: {text}");
    }
    // Extents that `double` cannot hold.
    for (fov, aspect, expected) in [
        (PI.next_down(), 1e300, Status::NotFinite),
        (1e-320, 1e-9, Status::BadView),
    ] {
        assert_eq!(look_at(ahead, fov, aspect, 0.1).0, expected, "{fov}");
    }
    for (fov, aspect, near) in [(3.1, 1.5, 0.1), (1e-3, 100.0, 1e-9), (1.0, 0.01, 1e6)] {
        assert_eq!(look_at(ahead, fov, aspect, near).0, Status::Ok);
    }
}

#[test]
fn an_eye_whose_target_is_its_position_looks_along_minus_z() {
    let (status, eye) = look_at([1.0, 2.0, 3.0], 1.0, 1.5, 0.1);
    let (_, ahead) = look_at([1.0, 2.0, -9.0], 1.0, 1.5, 0.1);
    assert_eq!((status, eye), (Status::Ok, ahead));
    assert_eq!(&eye.world_from_eye[6..9], [0.0, 0.0, 1.0]);
}

#[test]
fn views_and_cullers_of_pictures_are_those_of_the_library() {
    let picture = (1366, 769);
    let (mut culler, mut size) = (null_mut(), (0, 0));
    let plain = FovealCullView {
        eye_count: 2,
        validity_radius_m: 0.5,
        ..view()
    };
    let mut wide = plain;
    wide.eyes[1].left = -3.0;
    wide.eyes[1].orthographic = 1;
    let plain = wide;
    // SAFETY: places for the results, a view of this version, and a culler that is used no more.
    unsafe {
        let made = foveal_culler_create_for_picture(picture.0, picture.1, &mut culler);
        assert_eq!(made, Status::Ok);
        let read = foveal_culler_size(culler, &mut size.0, &mut size.1);
        assert_eq!((read, size), (Status::Ok, (342, 193)));
        foveal_culler_destroy(culler);
        let widened = foveal_cull_view_for_picture(&mut wide, picture.0, picture.1);
        assert_eq!(widened, Status::Ok);
    }
    for (wide, plain) in wide.eyes.iter_mut().zip(plain.eyes) {
        let (width, height) = (plain.right - plain.left, plain.top - plain.bottom);
        assert_eq!(wide.right, plain.right + width * (2.0 / 1366.0));
        assert_eq!(wide.bottom, plain.bottom - height * (3.0 / 769.0));
        (wide.right, wide.bottom) = (plain.right, plain.bottom);
    }
    assert_eq!(wide, plain, "nothing else changes");
    // Of one eye the second stays.
    let mut one = FovealCullView {
        eye_count: 1,
        ..plain
    };
    // SAFETY: a view of this version.
    let widened = unsafe { foveal_cull_view_for_picture(&mut one, 3, 3) };
    assert_eq!((widened, one.eyes[1]), (Status::Ok, plain.eyes[1]));
    assert!(one.eyes[0].right > plain.eyes[0].right);
}

#[test]
fn pictures_that_no_buffer_fits_and_bad_views_are_refused_and_nothing_changes() {
    let good = view();
    let bad_count = FovealCullView {
        eye_count: 3,
        ..good
    };
    let small = FovealCullView { size: 8, ..good };
    for (view, width, height, expected) in [
        (good, 0, 9, Status::BadSize),
        (good, 9, 0, Status::BadSize),
        (good, 9, 16_385, Status::BadSize),
        (good, u32::MAX, 9, Status::BadSize),
        (bad_count, 9, 9, Status::BadArgument),
        (small, 9, 9, Status::BadStructSize),
    ] {
        let (mut changed, mut culler) = (view, null_mut());
        // SAFETY: a view of this version, or a size that is refused; a place for the culler.
        unsafe {
            let status = foveal_cull_view_for_picture(&mut changed, width, height);
            assert_eq!((status, changed), (expected, view));
            if expected == Status::BadSize {
                let made = foveal_culler_create_for_picture(width, height, &mut culler);
                assert_eq!((made, culler), (expected, null_mut()));
                assert!(last_error().contains("1 to 16384"), "{}", last_error());
            }
        }
    }
}
