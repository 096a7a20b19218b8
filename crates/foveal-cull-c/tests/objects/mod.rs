//! Objects that tests of the border use.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "shared by several test programs, each using a part"
)]

use core::ffi::{CStr, c_char};
use core::ptr::{null, null_mut};
use foveal_cull::Aabb;
use foveal_cull_c::*;

use FovealCullStatus as Status;

pub fn last_error() -> String {
    // SAFETY: a null text is allowed; the second call has room for as many bytes as it says.
    unsafe {
        let needed = foveal_cull_last_error(null_mut(), 0);
        let mut text = vec![1 as c_char; needed];
        assert_eq!(foveal_cull_last_error(text.as_mut_ptr(), needed), needed);
        CStr::from_ptr(text.as_ptr()).to_str().unwrap().to_owned()
    }
}

pub fn wall() -> *mut FovealCullMesh {
    let mut mesh = null_mut();
    let (min, max) = ([-2.0f32, -2.0, -5.2], [2.0f32, 2.0, -5.0]);
    // SAFETY: three numbers each, and a place for the mesh.
    let status = unsafe { foveal_cull_mesh_from_box(min.as_ptr(), max.as_ptr(), &mut mesh) };
    assert_eq!(status, Status::Ok);
    mesh
}

pub fn set() -> *mut FovealCullOccluders {
    let mut set = null_mut();
    assert_eq!(
        // SAFETY: a place for the set.
        unsafe { foveal_cull_occluders_create(&mut set) },
        Status::Ok
    );
    set
}

pub fn culler() -> *mut FovealCuller {
    let mut culler = null_mut();
    assert_eq!(
        // SAFETY: a place for the culler.
        unsafe { foveal_culler_create(64, 64, &mut culler) },
        Status::Ok
    );
    culler
}

pub fn view() -> FovealCullView {
    let (position, target, up) = ([0.0f64; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]);
    let mut eye = core::mem::MaybeUninit::uninit();
    let mut view = core::mem::MaybeUninit::uninit();
    // SAFETY: three numbers each, and places for the results, which are written.
    unsafe {
        let (position, target, up) = (position.as_ptr(), target.as_ptr(), up.as_ptr());
        let eye = eye.as_mut_ptr();
        let status = foveal_cull_eye_look_at(position, target, up, 1.0, 1.0, 0.1, eye);
        assert_eq!(status, Status::Ok);
        let size = size_of::<FovealCullView>();
        let status = foveal_cull_view_init_sized(eye, view.as_mut_ptr(), size);
        assert_eq!(status, Status::Ok);
        view.assume_init()
    }
}

pub const BEHIND: [f32; 6] = [-0.5, -0.5, -9.0, 0.5, 0.5, -8.0];

/// Tests the box behind the wall.
pub fn test(culler: *const FovealCuller) -> u8 {
    let mut result = [9];
    // SAFETY: one box, one result.
    let status = unsafe {
        foveal_culler_test_boxes(culler, BEHIND.as_ptr(), 1, null(), result.as_mut_ptr())
    };
    assert_eq!(status, Status::Ok);
    result[0]
}

pub const NONE: FovealCullOccludeeId = FovealCullOccludeeId {
    set: 0,
    occludee: 0,
};

pub fn occludees(origin: [f64; 3]) -> *mut FovealCullOccludees {
    let mut set = null_mut();
    // SAFETY: three numbers and a place for the set.
    let status = unsafe { foveal_cull_occludees_create(origin.as_ptr(), &mut set) };
    assert_eq!(status, Status::Ok);
    set
}

pub fn insert(set: *mut FovealCullOccludees, boxes: &[Aabb]) -> Vec<FovealCullOccludeeId> {
    let mut ids = vec![NONE; boxes.len()];
    // SAFETY: a live set; as many boxes and places for ids as are said.
    let status = unsafe {
        foveal_cull_occludees_insert(set, boxes.as_ptr().cast(), boxes.len(), ids.as_mut_ptr())
    };
    assert_eq!(status, Status::Ok);
    ids
}

pub fn count(set: *const FovealCullOccludees) -> usize {
    let mut count = usize::MAX;
    // SAFETY: a live set and a place for the count.
    let status = unsafe { foveal_cull_occludees_count(set, &mut count) };
    assert_eq!(status, Status::Ok);
    count
}

pub fn bounds(set: *const FovealCullOccludees, id: FovealCullOccludeeId) -> Result<Aabb, Status> {
    let mut bounds = Aabb::EMPTY;
    // SAFETY: a live set and a place for six numbers.
    let status = unsafe { foveal_cull_occludees_bounds(set, id, (&raw mut bounds).cast::<f32>()) };
    (status == Status::Ok).then_some(bounds).ok_or(status)
}
