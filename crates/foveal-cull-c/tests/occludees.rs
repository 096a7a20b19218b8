//! Sets of occludees through the border: every wrong call has its code and changes nothing.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

use core::ptr::{null, null_mut};

use foveal_cull::Aabb;
use foveal_cull_c::*;
use objects::{
    BEHIND, NONE, bounds, count, culler, insert, last_error, occludees, set, view, wall,
};

use FovealCullStatus as Status;

fn cube(x: f32) -> Aabb {
    Aabb::new([x, 0.0, -9.0], [x + 1.0, 1.0, -8.0])
}

#[test]
fn null_is_an_error_everywhere() {
    let (set, culler) = (occludees([0.0; 3]), culler());
    let null_pointer = Status::NullPointer;
    let boxes = BEHIND.as_ptr();
    let [id] = insert(set, &[cube(0.0)])[..] else {
        panic!("one id");
    };
    let (mut to, mut n, mut m, mut six, mut byte) = (NONE, 9u32, 9usize, [9.0f32; 6], 9u8);
    let mut rebuild = core::ptr::dangling_mut();
    // SAFETY: pointers are null or to variables of the right size.
    unsafe {
        let checks = [
            foveal_cull_occludees_create(null(), null_mut()),
            foveal_cull_occludees_insert(null_mut(), boxes, 1, &mut to),
            foveal_cull_occludees_insert(set, null(), 1, &mut to),
            foveal_cull_occludees_insert(set, boxes, 1, null_mut()),
            foveal_cull_occludees_move(null_mut(), &id, boxes, 1),
            foveal_cull_occludees_move(set, null(), boxes, 1),
            foveal_cull_occludees_move(set, &id, null(), 1),
            foveal_cull_occludees_remove(null_mut(), &id, 1),
            foveal_cull_occludees_remove(set, null(), 1),
            foveal_cull_occludees_contains(null(), id, &mut n),
            foveal_cull_occludees_contains(set, id, null_mut()),
            foveal_cull_occludees_bounds(null(), id, six.as_mut_ptr()),
            foveal_cull_occludees_bounds(set, id, null_mut()),
            foveal_cull_occludees_indices(null(), &id, 1, &mut n),
            foveal_cull_occludees_indices(set, null(), 1, &mut n),
            foveal_cull_occludees_indices(set, &id, 1, null_mut()),
            foveal_cull_occludees_count(null(), &mut m),
            foveal_cull_occludees_count(set, null_mut()),
            foveal_cull_occludees_result_count(null(), &mut m),
            foveal_cull_occludees_result_count(set, null_mut()),
            foveal_cull_occludees_refit(null_mut()),
            foveal_cull_occludees_wants_rebuild(null(), &mut n),
            foveal_cull_occludees_wants_rebuild(set, null_mut()),
            foveal_cull_occludees_rebuild(null_mut()),
            foveal_cull_occludees_snapshot(set, null_mut()),
            foveal_cull_occludees_snapshot(null(), &mut rebuild),
            foveal_cull_rebuild_build(null_mut()),
            foveal_cull_rebuild_is_built(null(), &mut n),
            foveal_cull_occludees_adopt(set, null_mut()),
            foveal_culler_test_occludees(null(), set, &mut byte, 1),
            foveal_culler_test_occludees(culler, null(), &mut byte, 1),
            foveal_culler_test_occludees(culler, set, null_mut(), 1),
        ];
        for (n, status) in checks.into_iter().enumerate() {
            assert_eq!(status, null_pointer, "{n}");
        }
        assert!(rebuild.is_null(), "a handle of a failure is null");
        assert_eq!((to, n, m, six, byte), (NONE, 9, 9, [9.0; 6], 9));
        // Nothing of nothing is allowed.
        let none = [
            foveal_cull_occludees_insert(set, null(), 0, null_mut()),
            foveal_cull_occludees_move(set, null(), null(), 0),
            foveal_cull_occludees_remove(set, null(), 0),
            foveal_cull_occludees_indices(set, null(), 0, null_mut()),
        ];
        assert_eq!(none, [Status::Ok; 4]);
        assert_eq!(count(set), 1);
        // Not aligned, and too many to be anywhere.
        let odd = boxes.cast::<u8>().wrapping_add(1).cast();
        let wrong = [
            foveal_cull_occludees_insert(set, odd, 1, &mut to),
            foveal_cull_occludees_move(set, &id, odd, 1),
            foveal_cull_occludees_insert(set, boxes, usize::MAX, &mut to),
            foveal_cull_occludees_insert(set, boxes, 1 << 28, &mut to),
            foveal_cull_occludees_move(set, &id, boxes, usize::MAX),
            foveal_cull_occludees_remove(set, &id, usize::MAX),
            foveal_cull_occludees_indices(set, &id, usize::MAX, &mut n),
        ];
        assert_eq!(wrong, [Status::BadArgument; 7]);
        let infinite = [0.0, f64::INFINITY, 0.0];
        let mut made = core::ptr::dangling_mut();
        let status = foveal_cull_occludees_create(infinite.as_ptr(), &mut made);
        assert_eq!((status, made.is_null()), (Status::NotFinite, true));
        foveal_cull_occludees_destroy(null_mut());
        foveal_cull_rebuild_destroy(null_mut());
        foveal_cull_occludees_destroy(set);
        foveal_culler_destroy(culler);
    }
}

#[test]
fn ids_of_removed_occludees_and_of_other_sets_are_errors_and_nothing_changes() {
    let (set, other) = (occludees([0.0; 3]), occludees([0.0; 3]));
    let ids = insert(set, &[cube(0.0), cube(1.0), cube(2.0)]);
    let foreign = insert(other, &[cube(7.0)])[0];
    let occluder = FovealCullOccludeeId {
        set: objects_id().set,
        ..ids[0]
    };
    // SAFETY: live sets; lists as long as is said; places for results.
    unsafe {
        let calls = |id: FovealCullOccludeeId| {
            let (three, boxes) = ([ids[0], id, ids[2]], [cube(50.0); 3]);
            let mut indices = [9u32; 3];
            let results = [
                foveal_cull_occludees_move(set, three.as_ptr(), boxes.as_ptr().cast(), 3),
                foveal_cull_occludees_indices(set, three.as_ptr(), 3, indices.as_mut_ptr()),
                foveal_cull_occludees_remove(set, three.as_ptr(), 3),
            ];
            let text = last_error();
            assert!(text.starts_with("'ids'[1]: the"), "{text}");
            assert_eq!(indices, [9; 3]);
            assert_eq!(bounds(set, id), Err(results[0]));
            let mut contains = 9;
            let status = foveal_cull_occludees_contains(set, id, &mut contains);
            assert_eq!((status, contains), (Status::Ok, 0));
            for (x, id) in [(0.0, ids[0]), (2.0, ids[2])] {
                assert_eq!(bounds(set, id), Ok(cube(x)), "all or nothing");
            }
            results
        };
        assert_eq!(calls(foreign), [Status::OtherSet; 3]);
        assert_eq!(calls(occluder), [Status::OtherSet; 3]);
        for odd in [0, 1, 7 << 32, u64::MAX, ids[1].occludee ^ 1 << 40] {
            let id = FovealCullOccludeeId {
                occludee: odd,
                ..ids[1]
            };
            assert_eq!(calls(id), [Status::UnknownOccludee; 3], "{odd:x}");
        }
        assert_eq!(calls(NONE), [Status::UnknownOccludee; 3]);
        // Removing is all or nothing, and an id that is listed twice is a mistake.
        let twice = [ids[0], ids[1], ids[0]];
        let removed = foveal_cull_occludees_remove(set, twice.as_ptr(), 3);
        assert_eq!((removed, count(set)), (Status::BadArgument, 3));
        // Of a move the last box counts.
        let places = [cube(10.0), cube(11.0), cube(12.0), cube(0.0)];
        let moved = foveal_cull_occludees_move(set, twice.as_ptr(), places.as_ptr().cast(), 3);
        assert_eq!(moved, Status::Ok);
        assert_eq!(bounds(set, ids[0]), Ok(cube(12.0)));
        assert_eq!(bounds(set, ids[1]), Ok(cube(11.0)));
        let back = foveal_cull_occludees_move(set, &ids[0], places[3..].as_ptr().cast(), 1);
        assert_eq!(back, Status::Ok);
        let removed = foveal_cull_occludees_remove(set, &ids[1], 1);
        assert_eq!((removed, count(set)), (Status::Ok, 2));
        assert_eq!(calls(ids[1]), [Status::UnknownOccludee; 3]);
        // Its place is used again, its id is not.
        let next = insert(set, &[cube(5.0)])[0];
        assert_ne!(next, ids[1]);
        assert_eq!(calls(ids[1]), [Status::UnknownOccludee; 3]);
        let all = [ids[0], next, ids[2]];
        let mut indices = [9u32; 3];
        let status = foveal_cull_occludees_indices(set, all.as_ptr(), 3, indices.as_mut_ptr());
        assert_eq!((status, indices), (Status::Ok, [0, 1, 2]));
        let removed = foveal_cull_occludees_remove(set, all.as_ptr(), 3);
        assert_eq!((removed, count(set)), (Status::Ok, 0));
        foveal_cull_occludees_destroy(set);
        foveal_cull_occludees_destroy(other);
    }
}

/// The id of an occluder, whose set has a number of its own.
fn objects_id() -> FovealCullOccluderId {
    let (mesh, set) = (wall(), set());
    let mut id = FovealCullOccluderId {
        set: 0,
        occluder: 0,
    };
    // SAFETY: live handles, which are used no more afterwards, and a place for the id.
    unsafe {
        assert_eq!(
            foveal_cull_occluders_add(set, mesh, null(), &mut id),
            Status::Ok
        );
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(set);
    }
    id
}

#[test]
fn hierarchies_are_built_once_adopted_once_and_only_by_their_set() {
    let (set, other) = (occludees([0.0; 3]), occludees([0.0; 3]));
    let boxes: Vec<Aabb> = (0..200).map(|i| cube(i as f32)).collect();
    let ids = insert(set, &boxes);
    insert(other, &boxes);
    let snapshot = |set| {
        let mut rebuild = null_mut();
        // SAFETY: a live set and a place for the snapshot.
        let status = unsafe { foveal_cull_occludees_snapshot(set, &mut rebuild) };
        assert_eq!(status, Status::Ok);
        rebuild
    };
    let wants = || {
        let mut wants = 9;
        // SAFETY: a live set and a place for the answer.
        let status = unsafe { foveal_cull_occludees_wants_rebuild(set, &mut wants) };
        assert_eq!(status, Status::Ok);
        wants
    };
    // SAFETY: live handles, which are destroyed once.
    unsafe {
        assert_eq!(wants(), 1, "all are new");
        let rebuild = snapshot(set);
        let adopt = |set| foveal_cull_occludees_adopt(set, rebuild);
        assert_eq!(adopt(set), Status::BadArgument);
        assert!(last_error().contains("not built"), "{}", last_error());
        assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Ok);
        assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Ok, "is built");
        // The other set has the same ids but for its number.
        assert_eq!(adopt(other), Status::OtherSet);
        assert_eq!(wants(), 1);
        let removed = foveal_cull_occludees_remove(set, ids[..50].as_ptr(), 50);
        assert_eq!(removed, Status::Ok);
        assert_eq!(adopt(set), Status::Ok, "what was refused is still there");
        assert_eq!((wants(), count(set)), (0, 150));
        assert_eq!(adopt(set), Status::BadArgument);
        assert_eq!(foveal_cull_rebuild_build(rebuild), Status::BadArgument);
        assert!(last_error().contains("adopted"), "{}", last_error());
        assert_eq!(adopt(other), Status::OtherSet);
        foveal_cull_rebuild_destroy(rebuild);
        // A snapshot outlives its set, and no set that is made later takes it.
        let rebuild = snapshot(other);
        foveal_cull_occludees_destroy(other);
        assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Ok);
        let later = occludees([0.0; 3]);
        insert(later, &boxes);
        let adopted = foveal_cull_occludees_adopt(later, rebuild);
        assert_eq!(adopted, Status::OtherSet);
        foveal_cull_rebuild_destroy(rebuild);
        foveal_cull_occludees_destroy(later);
        // Dropped without being built or adopted.
        foveal_cull_rebuild_destroy(snapshot(set));
        foveal_cull_occludees_destroy(set);
    }
}

#[test]
fn everything_is_visible_after_a_failed_frame_and_failed_tests_write_nothing() {
    let (mesh, walls, culler, view) = (wall(), set(), culler(), view());
    let set = occludees([0.0, 0.0, 4.0]);
    let mut id = FovealCullOccluderId {
        set: 0,
        occluder: 0,
    };
    let behind = Aabb::new([-0.5, -0.5, -13.0], [0.5, 0.5, -12.0]);
    let beside = Aabb::new([40.0, -0.5, -13.0], [41.0, 0.5, -12.0]);
    let invalid = Aabb::new([f32::NAN, -0.5, -13.0], [0.5, 0.5, -12.0]);
    insert(set, &[behind, beside, invalid]);
    // SAFETY: live handles; lists as long as is said.
    unsafe {
        assert_eq!(
            foveal_cull_occluders_add(walls, mesh, null(), &mut id),
            Status::Ok
        );
        let test = |count| {
            let mut results = [9u8; 4];
            let to = results.as_mut_ptr();
            let status = foveal_culler_test_occludees(culler, set, to, count);
            (status, results)
        };
        let visible = (Status::Ok, [0, 0, 0, 9]);
        assert_eq!(test(3), visible, "before the first frame");
        let rasterize = |view| foveal_culler_rasterize(culler, view, walls, null(), null());
        assert_eq!(rasterize(&view), Status::Ok);
        assert_eq!(test(3), (Status::Ok, [3, 1, 0, 9]));
        for count in [0, 2, 4] {
            assert_eq!(test(count), (Status::WrongLength, [9; 4]));
        }
        assert_eq!(rasterize(null()), Status::NullPointer);
        assert_eq!(test(3), visible, "after a failed frame");
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(walls);
        foveal_cull_occludees_destroy(set);
        foveal_culler_destroy(culler);
    }
}

#[test]
fn results_that_overlap_what_is_read_are_refused_before_anything_is_written() {
    let (set, culler) = (occludees([0.0; 3]), culler());
    let mut memory = [0x0707_0707_0707_0707_u64; 32];
    let base = (&raw mut memory).cast::<u8>();
    // SAFETY: live handles; all lists are within the memory, which is used by this pointer alone.
    unsafe {
        let bytes = || base.cast::<[u8; 256]>().read();
        // Two boxes, 64 to 112.
        let list = base.add(64);
        list.cast::<[Aabb; 2]>().write([cube(0.0), cube(1.0)]);
        let before = bytes();
        let insert_to = |at| foveal_cull_occludees_insert(set, list.cast(), 2, base.add(at).cast());
        let test_to = |at| foveal_culler_test_boxes(culler, list.cast(), 2, null(), base.add(at));
        for at in (40..=104).step_by(8) {
            assert_eq!(insert_to(at), Status::BadArgument, "{at}");
        }
        assert_eq!(last_error(), "'out' overlaps 'boxes'");
        for at in 63..=111 {
            assert_eq!(test_to(at), Status::BadArgument, "{at}");
        }
        assert_eq!(last_error(), "'results' overlaps 'boxes'");
        assert_eq!((bytes(), count(set)), (before, 0));
        // Right before it and right behind it.
        assert_eq!([62, 112].map(test_to), [Status::Ok; 2]);
        assert_eq!([32, 112].map(insert_to), [Status::Ok; 2]);
        assert_eq!(count(set), 4);
        // Two ids, 64 to 96.
        let ids = [cube(0.0), cube(1.0)].map(|bounds| insert(set, &[bounds])[0]);
        list.cast::<[FovealCullOccludeeId; 2]>().write(ids);
        let before = bytes();
        let indices_to =
            |at| foveal_cull_occludees_indices(set, list.cast(), 2, base.add(at).cast());
        for at in (60..=92).step_by(4) {
            assert_eq!(indices_to(at), Status::BadArgument, "{at}");
        }
        assert_eq!(last_error(), "'out' overlaps 'ids'");
        assert_eq!(bytes(), before);
        assert_eq!([56, 96].map(indices_to), [Status::Ok; 2]);
        assert_eq!(base.add(96).cast::<[u32; 2]>().read(), [4, 5]);
        foveal_cull_occludees_destroy(set);
        foveal_culler_destroy(culler);
    }
}
