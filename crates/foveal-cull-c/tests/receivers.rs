//! Receiver masks through the border: the results of Rust's, and a code for every wrong call, which
//! changes nothing.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

use core::ptr::{null, null_mut};

use foveal_cull::{Aabb, Eye, Projection, ReceiverMask, View, Visibility};
use foveal_cull_c::*;
use objects::{last_error, view};

use FovealCullStatus as Status;

const SIDE: u32 = 128;

fn mask(light: &FovealCullView, side: u32) -> *mut FovealCullReceiverMask {
    let mut mask = null_mut();
    // SAFETY: a view of this version and a place for the mask.
    let status = unsafe { foveal_cull_receiver_mask_create(light, side, &mut mask) };
    assert_eq!(status, Status::Ok);
    mask
}

fn is_empty(mask: *const FovealCullReceiverMask) -> bool {
    let mut empty = 9;
    // SAFETY: a live mask and a place for a number.
    let status = unsafe { foveal_cull_receiver_mask_is_empty(mask, &mut empty) };
    assert!(status == Status::Ok && empty < 2, "{status:?} {empty}");
    empty == 1
}

fn receive(
    mask: *mut FovealCullReceiverMask,
    boxes: &[Aabb],
    origin: [f64; 3],
    results: &[u8],
) -> Status {
    assert_eq!(boxes.len(), results.len());
    let (boxes, count) = (boxes.as_ptr().cast(), boxes.len());
    // SAFETY: a live mask, as many boxes and results as are said, and three numbers.
    unsafe {
        let results = results.as_ptr();
        foveal_cull_receiver_mask_receive(mask, boxes, count, origin.as_ptr(), results)
    }
}

fn cull(
    mask: *const FovealCullReceiverMask,
    boxes: &[Aabb],
    origin: [f64; 3],
    results: &mut [u8],
) -> Status {
    assert_eq!(boxes.len(), results.len());
    let (boxes, count) = (boxes.as_ptr().cast(), boxes.len());
    // SAFETY: a live mask, as many boxes and results as are said, and three numbers.
    unsafe {
        let results = results.as_mut_ptr();
        foveal_cull_receiver_mask_cull(mask, boxes, count, origin.as_ptr(), results)
    }
}

fn bytes(results: &[Visibility]) -> Vec<u8> {
    results.iter().map(|v| *v as u8).collect()
}

/// Lights, as Rust and as C has them: with a far plane, with parallel rays, without a far plane.
fn lights() -> [(View, FovealCullView); 3] {
    let projections = [
        Projection::perspective(1.5, 1.0, 0.2, 14.0),
        Projection::orthographic(12.0, 1.0, 0.0, 30.0),
        Projection::perspective(1.0, 1.0, 0.1, f64::INFINITY),
    ];
    projections.map(|projection| {
        let eye = Eye::look_at(
            [0.5, 1.0, 2.0],
            [0.0, 0.0, -6.0],
            [0.0, 1.0, 0.0],
            projection,
        );
        let [left, right, bottom, top] = projection.extents();
        let [near_m, far_m] = projection.near_far_m();
        let a = eye.world_from_eye;
        let columns = [a.x_axis, a.y_axis, a.z_axis, a.translation];
        let mut c = view();
        c.eyes[0] = FovealCullEye {
            world_from_eye: core::array::from_fn(|i| columns[i / 3][i % 3]),
            left,
            right,
            bottom,
            top,
            near_m,
            far_m,
            orthographic: projection.is_orthographic().into(),
            reserved: 0,
        };
        (View::mono(eye), c)
    })
}

/// Boxes around and beside the lights, a few of them no volumes.
fn boxes(count: usize, seed: u64) -> Vec<Aabb> {
    let mut state = seed;
    let mut next = move || {
        // Knuth's multiplicative generator.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    let mut boxes: Vec<Aabb> = (0..count)
        .map(|_| {
            let min = [
                next() * 16.0 - 8.0,
                next() * 8.0 - 4.0,
                next() * 24.0 - 20.0,
            ];
            Aabb::new(min, min.map(|v| v + next() * 0.5))
        })
        .collect();
    boxes[count / 3].min[1] = f32::NAN;
    boxes[count / 2] = Aabb::EMPTY;
    boxes
}

#[test]
fn results_are_those_of_rust_byte_by_byte() {
    let (receivers, casters) = (boxes(60, 1), boxes(4000, 2));
    let origin = [0.25, -0.5, 1.0];
    let classes = [
        Visibility::Visible,
        Visibility::Outside,
        Visibility::Small,
        Visibility::Occluded,
    ];
    // None that is everywhere.
    let seen: Vec<Visibility> = (0..receivers.len())
        .map(|i| {
            if receivers[i].is_valid() {
                classes[i % 4]
            } else {
                Visibility::Small
            }
        })
        .collect();
    let before: Vec<Visibility> = (0..casters.len()).map(|i| classes[i / 2 % 4]).collect();
    let lights = lights();
    let reused = mask(&lights[1].1, 3);
    for (light, c_light) in &lights {
        let mut rust = ReceiverMask::new(light, SIDE).unwrap().with_reach(5.0, 0.1);
        let new = mask(c_light, SIDE);
        // SAFETY: live masks and a view of this version.
        unsafe {
            let status = foveal_cull_receiver_mask_reset(reused, c_light, SIDE);
            assert_eq!(status, Status::Ok);
            for c in [new, reused] {
                let status = foveal_cull_receiver_mask_set_reach(c, 5.0, 0.1);
                assert_eq!(status, Status::Ok);
            }
        }
        assert!(rust.is_empty() && is_empty(new) && is_empty(reused));
        rust.receive(&receivers, origin, &seen).unwrap();
        let mut expected = before.clone();
        rust.cull(&casters, origin, &mut expected).unwrap();
        for class in classes {
            let count = expected
                .iter()
                .zip(&before)
                .filter(|(a, b)| **a == class && a != b);
            let changed = matches!(class, Visibility::Outside | Visibility::Occluded);
            assert_eq!(count.count() > 20, changed, "{class:?}");
        }
        assert!(expected.iter().filter(|v| v.is_visible()).count() > 20);
        for c in [new, reused] {
            assert_eq!(receive(c, &receivers, origin, &bytes(&seen)), Status::Ok);
            assert!(!is_empty(c));
            let mut results = bytes(&before);
            assert_eq!(cull(c, &casters, origin, &mut results), Status::Ok);
            assert_eq!(results, bytes(&expected));
        }
        // SAFETY: a live mask, which is used no more after that.
        unsafe {
            assert_eq!(foveal_cull_receiver_mask_clear(new), Status::Ok);
            assert!(is_empty(new) && !is_empty(reused));
            foveal_cull_receiver_mask_destroy(new);
        }
    }
    // SAFETY: it is used no more.
    unsafe { foveal_cull_receiver_mask_destroy(reused) };
}

#[test]
fn null_is_an_error_everywhere() {
    let light = view();
    let mask = mask(&light, SIDE);
    let bounds = [0.0f32, 0.0, -5.0, 1.0, 1.0, -4.0];
    let (boxes, mut result, mut n) = (bounds.as_ptr(), 0u8, 9u32);
    let mut out = core::ptr::dangling_mut();
    // SAFETY: pointers are null or to variables of the right size.
    unsafe {
        let to = &raw mut result;
        let checks = [
            foveal_cull_receiver_mask_create(&light, SIDE, null_mut()),
            foveal_cull_receiver_mask_create(null(), SIDE, &mut out),
            foveal_cull_receiver_mask_reset(null_mut(), &light, SIDE),
            foveal_cull_receiver_mask_reset(mask, null(), SIDE),
            foveal_cull_receiver_mask_set_reach(null_mut(), 2.0, 0.0),
            foveal_cull_receiver_mask_clear(null_mut()),
            foveal_cull_receiver_mask_is_empty(null(), &mut n),
            foveal_cull_receiver_mask_is_empty(mask, null_mut()),
            foveal_cull_receiver_mask_receive(null_mut(), boxes, 1, null(), to),
            foveal_cull_receiver_mask_receive(mask, null(), 1, null(), to),
            foveal_cull_receiver_mask_receive(mask, boxes, 1, null(), null()),
            foveal_cull_receiver_mask_cull(null(), boxes, 1, null(), to),
            foveal_cull_receiver_mask_cull(mask, null(), 1, null(), to),
            foveal_cull_receiver_mask_cull(mask, boxes, 1, null(), null_mut()),
        ];
        for (i, status) in checks.into_iter().enumerate() {
            assert_eq!(status, Status::NullPointer, "{i}");
        }
        assert!(out.is_null(), "a handle of a failure is null");
        assert!(is_empty(mask));
        assert_eq!((result, n), (0, 9));
        // Nothing of nothing is allowed.
        let none = [
            foveal_cull_receiver_mask_receive(mask, null(), 0, null(), null()),
            foveal_cull_receiver_mask_cull(mask, null(), 0, null(), null_mut()),
        ];
        assert_eq!(none, [Status::Ok; 2]);
        foveal_cull_receiver_mask_destroy(null_mut());
        foveal_cull_receiver_mask_destroy(mask);
    }
}

#[test]
fn bad_lights_sizes_and_reaches_are_refused_and_leave_the_mask_as_it_was() {
    let good = view();
    let mask = mask(&good, SIDE);
    let receiver = [Aabb::new([-1.0, -1.0, -9.0], [1.0, 1.0, -8.0])];
    assert_eq!(receive(mask, &receiver, [0.0; 3], &[0]), Status::Ok);
    let check = |light: FovealCullView, side: u32, expected: Status, said: &str| {
        let mut out = core::ptr::dangling_mut();
        // SAFETY: a live mask, a view that is as long as it says, a place for a mask.
        unsafe {
            let status = foveal_cull_receiver_mask_create(&light, side, &mut out);
            assert_eq!((status, out.is_null()), (expected, true));
            assert!(last_error().contains(said), "{}", last_error());
            let status = foveal_cull_receiver_mask_reset(mask, &light, side);
            assert_eq!(status, expected);
            assert!(last_error().contains(said), "{}", last_error());
        }
        assert!(!is_empty(mask));
    };
    let eye = |change: fn(&mut FovealCullEye)| {
        let mut light = good;
        change(&mut light.eyes[0]);
        light
    };
    check(good, 0, Status::BadSize, "shadow map of 0 texels");
    check(good, 16_385, Status::BadSize, "1 to 16384");
    let none = FovealCullView {
        eye_count: 0,
        ..good
    };
    check(none, SIDE, Status::BadArgument, "'eye_count'");
    let short = FovealCullView { size: 12, ..good };
    check(short, SIDE, Status::BadStructSize, "too small");
    check(
        eye(|e| e.left = f64::NAN),
        SIDE,
        Status::NotFinite,
        "extents",
    );
    check(
        eye(|e| e.near_m = 0.0),
        SIDE,
        Status::BadView,
        "near distance",
    );
    check(
        eye(|e| e.world_from_eye[4] = 3.0),
        SIDE,
        Status::BadView,
        "pose",
    );
    for [texels, metres] in [
        [f64::NAN, 0.0],
        [0.0, f64::NAN],
        [-1.0, 0.0],
        [2.0, -0.1],
        [f64::INFINITY, 0.0],
        [2.0, f64::INFINITY],
    ] {
        // SAFETY: a live mask.
        let status = unsafe { foveal_cull_receiver_mask_set_reach(mask, texels, metres) };
        assert_eq!(status, Status::NotFinite, "{texels} {metres}");
    }
    // The largest map there may be.
    // SAFETY: a live mask and a view of this version; it is used no more after that.
    unsafe {
        let status = foveal_cull_receiver_mask_reset(mask, &good, 16_384);
        assert_eq!(status, Status::Ok);
        assert!(is_empty(mask));
        foveal_cull_receiver_mask_destroy(mask);
    }
}

#[test]
fn bad_lists_are_refused_and_change_nothing() {
    let mask = mask(&view(), SIDE);
    let two = [Aabb::new([-1.0, -1.0, -9.0], [1.0, 1.0, -8.0]); 2];
    let first = two.as_ptr().cast::<f32>();
    for (at, bad) in [(0, 4), (1, 255)] {
        let mut results = [0u8; 2];
        results[at] = bad;
        assert_eq!(receive(mask, &two, [0.0; 3], &results), Status::BadArgument);
        let said = last_error();
        assert!(
            said.contains(&format!("'results'[{at}] is {bad}")),
            "{said}"
        );
        let before = results;
        assert_eq!(
            cull(mask, &two, [0.0; 3], &mut results),
            Status::BadArgument
        );
        assert_eq!(results, before);
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let (origin, mut results) = ([0.0, bad, 0.0], [0u8; 2]);
        assert_eq!(receive(mask, &two, origin, &results), Status::NotFinite);
        assert_eq!(cull(mask, &two, origin, &mut results), Status::NotFinite);
        assert_eq!(results, [0; 2]);
    }
    let many = usize::MAX / 8;
    let mut results = [0u8; 2];
    let off = first.cast::<u8>().wrapping_add(1).cast::<f32>();
    let mut shared = two;
    // SAFETY: a live mask; lists that are refused before they are read, or as long as said.
    unsafe {
        let to = results.as_mut_ptr();
        let overlapping = (&raw mut shared).cast::<u8>();
        let checks = [
            foveal_cull_receiver_mask_receive(mask, first, many, null(), to),
            foveal_cull_receiver_mask_cull(mask, first, many, null(), to),
            foveal_cull_receiver_mask_receive(mask, off, 1, null(), to),
            foveal_cull_receiver_mask_cull(mask, off, 1, null(), to),
            foveal_cull_receiver_mask_cull(mask, overlapping.cast(), 2, null(), overlapping),
            foveal_cull_receiver_mask_cull(
                mask,
                overlapping.cast(),
                2,
                null(),
                overlapping.add(47),
            ),
        ];
        for (i, status) in checks.into_iter().enumerate() {
            assert_eq!(status, Status::BadArgument, "{i}");
        }
    }
    assert_eq!(shared, two);
    assert!(is_empty(mask));
    // Two lists that are only read may be one.
    let empty = [Aabb::new([0.0; 3], [0.0; 3]); 1];
    // SAFETY: a live mask, used no more; 24 bytes are six numbers, and the first one a result.
    unsafe {
        let (boxes, results) = (empty.as_ptr().cast(), empty.as_ptr().cast());
        let status = foveal_cull_receiver_mask_receive(mask, boxes, 1, null(), results);
        assert_eq!(status, Status::Ok);
        foveal_cull_receiver_mask_destroy(mask);
    }
}
