//! Views that C makes: eyes that look at a place.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

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
