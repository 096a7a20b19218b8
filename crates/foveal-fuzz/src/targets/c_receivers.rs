//! The C interface's receiver masks: random calls, and for each mask one of Rust's that is told the
//! same.
#![allow(
    unsafe_code,
    reason = "calls the functions as C does, with pointers to its own variables"
)]

use core::ptr::null_mut;
use foveal_cull::{Aabb, CullError, Eye, Projection, ReceiverMask, View, Visibility};
use foveal_cull_c::*;

use FovealCullStatus as Status;

use super::c_arguments::{Arguments, Calls, boxes};
use crate::random::Choices;

/// Masks, and Rust's.
#[derive(Default)]
pub(super) struct Receivers {
    masks: Vec<(*mut FovealCullReceiverMask, ReceiverMask)>,
    pub(super) calls: Calls,
}

/// A light: mostly one that is possible.
fn light(r: &mut Choices<'_>) -> (View, FovealCullView) {
    let [right, top, near, far] = [0; 4].map(|_| r.number().abs() * 0.2 + 0.01);
    let [left, bottom] = [r.number() * 0.02 - 0.3, r.number() * 0.02 - 0.3];
    let far_m = if r.one_in(3) {
        f64::INFINITY
    } else {
        near + 10.0 * far
    };
    let orthographic = r.one_in(3);
    let projection = if orthographic {
        Projection::Orthographic {
            left: 10.0 * left,
            right: 10.0 * right,
            bottom: 10.0 * bottom,
            top: 10.0 * top,
            near_m: near - 1.0,
            far_m,
        }
    } else {
        Projection::Perspective {
            left,
            right,
            bottom,
            top,
            near_m: near,
            far_m,
        }
    };
    let eye = Eye::look_at(r.numbers(), r.numbers(), r.numbers(), projection);
    let [left, right, bottom, top] = projection.extents();
    let [near_m, far_m] = projection.near_far_m();
    let a = eye.world_from_eye;
    let columns = [a.x_axis, a.y_axis, a.z_axis, a.translation];
    let c = FovealCullEye {
        world_from_eye: core::array::from_fn(|i| columns[i / 3][i % 3]),
        left,
        right,
        bottom,
        top,
        near_m,
        far_m,
        orthographic: orthographic.into(),
        reserved: 0,
    };
    let view = FovealCullView {
        size: size_of::<FovealCullView>() as u32,
        eye_count: 1,
        eyes: [c; 2],
        validity_radius_m: 0.0,
    };
    (View::mono(eye), view)
}

/// The code that a new mask, or one of another map, must give.
fn expected(of_rust: Result<(), CullError>) -> Status {
    match of_rust {
        Ok(()) => Status::Ok,
        Err(CullError::BadShadowMap { .. }) => Status::BadSize,
        Err(CullError::BadView(_)) => Status::BadView,
        Err(CullError::NotFinite(_)) => Status::NotFinite,
        Err(error) => panic!("{error}"),
    }
}

/// Boxes with results, as a call passes them, and the code that they must give.
struct Lists {
    boxes: Vec<f32>,
    results: Vec<u8>,
    origin: [f64; 3],
    from: *const f32,
    to: *mut u8,
    expected: Status,
}

impl Lists {
    fn new(r: &mut Choices<'_>) -> Self {
        let count = r.below(60);
        let mut boxes = boxes(r, count);
        let mut results: Vec<u8> = (0..count).map(|_| r.below(9) as u8 % 4).collect();
        if count > 0 && r.one_in(8) {
            results[r.below(count)] = r.bits() as u8;
        }
        let origin: [f64; 3] = r.numbers();
        let from = r.or_null(boxes.as_mut_ptr()).cast_const();
        let to = r.or_null(results.as_mut_ptr());
        let null = |null| null && count > 0;
        let expected = if null(from.is_null()) {
            Status::NullPointer
        } else if !origin.iter().all(|v| v.is_finite()) {
            Status::NotFinite
        } else if null(to.is_null()) {
            Status::NullPointer
        } else if results.iter().any(|v| *v > 3) {
            Status::BadArgument
        } else {
            Status::Ok
        };
        Self {
            boxes,
            results,
            origin,
            from,
            to,
            expected,
        }
    }

    /// As Rust takes them, where they are good.
    fn of_rust(&self) -> (Vec<Aabb>, Vec<Visibility>) {
        let (boxes, _) = self.boxes.as_chunks::<6>();
        let corners = |[a, b, c, d, e, f]: &[f32; 6]| Aabb::new([*a, *b, *c], [*d, *e, *f]);
        let class = |v: &u8| match v {
            0 => Visibility::Visible,
            1 => Visibility::Outside,
            2 => Visibility::Small,
            _ => Visibility::Occluded,
        };
        (
            boxes.iter().map(corners).collect(),
            self.results.iter().map(class).collect(),
        )
    }
}

impl Receivers {
    pub(super) fn create(&mut self, r: &mut Choices<'_>) {
        if self.masks.len() == 3 {
            return;
        }
        let (view, light) = light(r);
        let side = side(r);
        let mut mask = null_mut();
        // SAFETY: a view of this version and a place for the mask.
        let status = unsafe { foveal_cull_receiver_mask_create(&light, side, &mut mask) };
        let of_rust = ReceiverMask::new(&view, side);
        assert_eq!(self.calls.note(status), expected(of_rust.clone().map(drop)));
        assert_eq!(mask.is_null(), of_rust.is_err());
        self.masks
            .extend(of_rust.ok().map(|of_rust| (mask, of_rust)));
    }

    /// Changes a mask, or asks it.
    pub(super) fn change(&mut self, r: &mut Choices<'_>) {
        if self.masks.is_empty() {
            return;
        }
        let n = r.below(self.masks.len());
        match r.below(8) {
            0 => self.reset(r, n),
            1 => self.set_reach(r, n),
            2 => self.clear(r, n),
            3..5 => self.receive(r, n),
            _ => self.cull(r, n),
        }
        let Some((mask, of_rust)) = self.masks.get(n) else {
            return;
        };
        let mut empty = 9;
        // SAFETY: a live mask and a place for a number.
        let status = unsafe { foveal_cull_receiver_mask_is_empty(*mask, &mut empty) };
        let is_empty = of_rust.is_empty().into();
        assert_eq!((status, empty), (Status::Ok, is_empty));
    }

    fn reset(&mut self, r: &mut Choices<'_>, n: usize) {
        let (view, mut light) = light(r);
        let side = side(r);
        let (mask, of_rust) = &mut self.masks[n];
        let wanted = if r.one_in(8) {
            light.eye_count = 3;
            Status::BadArgument
        } else {
            expected(of_rust.reset(&view, side))
        };
        // SAFETY: a live mask and a view of this version.
        let status = unsafe { foveal_cull_receiver_mask_reset(*mask, &light, side) };
        assert_eq!(self.calls.note(status), wanted);
    }

    fn set_reach(&mut self, r: &mut Choices<'_>, n: usize) {
        let [texels, metres] = [r.number(), r.number() * 0.01].map(|v| v.max(-1.0));
        let (mask, of_rust) = &mut self.masks[n];
        // SAFETY: a live mask.
        let status = unsafe { foveal_cull_receiver_mask_set_reach(*mask, texels, metres) };
        let good = [texels, metres].iter().all(|v| v.is_finite() && *v >= 0.0);
        let wanted = if good { Status::Ok } else { Status::NotFinite };
        if good {
            of_rust.set_reach(texels, metres);
        }
        assert_eq!(self.calls.note(status), wanted);
    }

    /// Empties a mask, or drops it.
    fn clear(&mut self, r: &mut Choices<'_>, n: usize) {
        if r.one_in(2) {
            let (mask, _) = self.masks.swap_remove(n);
            // SAFETY: a live mask that is used no more.
            unsafe { foveal_cull_receiver_mask_destroy(mask) };
            return;
        }
        let (mask, of_rust) = &mut self.masks[n];
        let mask = r.or_null(*mask);
        // SAFETY: a live mask, or null.
        let status = unsafe { foveal_cull_receiver_mask_clear(mask) };
        assert_eq!(status == Status::Ok, !mask.is_null());
        if !mask.is_null() {
            of_rust.clear();
        }
        self.calls.note(status);
    }

    fn receive(&mut self, r: &mut Choices<'_>, n: usize) {
        let lists = Lists::new(r);
        let (mask, of_rust) = &mut self.masks[n];
        let (count, origin) = (lists.results.len(), lists.origin.as_ptr());
        // SAFETY: a live mask; lists as long as is said, or null; three numbers.
        let status = unsafe {
            foveal_cull_receiver_mask_receive(*mask, lists.from, count, origin, lists.to)
        };
        assert_eq!(self.calls.note(status), lists.expected);
        if status == Status::Ok {
            let (boxes, results) = lists.of_rust();
            let done = of_rust.receive(&boxes, lists.origin, &results);
            assert_eq!(done, Ok(()));
        }
    }

    fn cull(&mut self, r: &mut Choices<'_>, n: usize) {
        let mut lists = Lists::new(r);
        if !lists.results.is_empty() && r.one_in(20) {
            // Results in the middle of the boxes.
            lists.to = lists.boxes.as_mut_ptr().cast();
            if !lists.from.is_null() && lists.expected != Status::NotFinite {
                lists.expected = Status::BadArgument;
            }
        }
        let (mask, of_rust) = &mut self.masks[n];
        let (count, origin) = (lists.results.len(), lists.origin.as_ptr());
        let (boxes, before) = (lists.boxes.clone(), lists.results.clone());
        // SAFETY: a live mask; lists as long as is said, null, or refused; three numbers.
        let status =
            unsafe { foveal_cull_receiver_mask_cull(*mask, lists.from, count, origin, lists.to) };
        assert_eq!(self.calls.note(status), lists.expected);
        let bits = |boxes: &[f32]| -> Vec<u32> { boxes.iter().map(|v| v.to_bits()).collect() };
        assert_eq!(bits(&lists.boxes), bits(&boxes));
        if status == Status::Ok {
            let after = core::mem::replace(&mut lists.results, before);
            let (boxes, mut results) = lists.of_rust();
            let done = of_rust.cull(&boxes, lists.origin, &mut results);
            let of_rust: Vec<u8> = results.iter().map(|v| *v as u8).collect();
            assert_eq!((done, after), (Ok(()), of_rust));
        } else {
            assert_eq!(lists.results, before, "results of a failure");
        }
    }
}

/// A map's side, texels.
fn side(r: &mut Choices<'_>) -> u32 {
    if r.one_in(12) {
        return r.pick(&[0, 16_384, 16_385, u32::MAX]);
    }
    1 + r.below(200) as u32
}

impl Drop for Receivers {
    fn drop(&mut self) {
        for (mask, _) in &self.masks {
            // SAFETY: nothing uses it any more.
            unsafe { foveal_cull_receiver_mask_destroy(*mask) };
        }
    }
}
