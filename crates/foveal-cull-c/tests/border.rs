//! What C can get wrong with objects: every call gives a code, and what was there before stays.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

use core::ffi::{CStr, c_char};
use core::ptr::{null, null_mut};
use foveal_cull_c::*;
use objects::{BEHIND, culler, last_error, set, test, view, wall};

use FovealCullStatus as Status;

#[test]
fn every_status_has_a_text_and_failures_have_one_of_their_own() {
    for status in -2..40 {
        // SAFETY: texts are constants.
        let text = unsafe { CStr::from_ptr(foveal_cull_status_text(status)) };
        assert_eq!(
            text == c"an unknown status",
            !(0..16).contains(&status),
            "{status}"
        );
    }
    let mut out = null_mut();
    // SAFETY: a place for the culler.
    let status = unsafe { foveal_culler_create(0, 8, &mut out) };
    assert_eq!((status, out.is_null()), (Status::BadSize, true));
    let whole = last_error();
    assert!(whole.contains("0 x 8"), "{whole}");
    // A short buffer gets the beginning and a zero.
    let mut short = [1 as c_char; 6];
    // SAFETY: six bytes.
    let text = unsafe {
        assert_eq!(
            foveal_cull_last_error(short.as_mut_ptr(), 6),
            whole.len() + 1
        );
        CStr::from_ptr(short.as_ptr())
    };
    assert_eq!(text.to_str().unwrap(), &whole[..5]);
    // However large a buffer is said to be, no more is written than the text.
    let mut exact = vec![1u8; whole.len() + 2];
    for size in [exact.len(), usize::MAX] {
        exact.fill(1);
        // SAFETY: there are more bytes than the text has.
        let needed = unsafe { foveal_cull_last_error(exact.as_mut_ptr().cast(), size) };
        assert_eq!(needed, whole.len() + 1);
        assert_eq!(exact, format!("{whole}\0\u{1}").as_bytes());
    }
    let other = std::thread::spawn(last_error).join().unwrap();
    assert_eq!(other, "", "another thread has not failed");
    // SAFETY: the text is a constant.
    let version = unsafe { CStr::from_ptr(foveal_cull_version_text()) };
    assert_eq!(version.to_str().unwrap(), env!("CARGO_PKG_VERSION"));
}

#[test]
fn null_is_an_error_everywhere_and_destroying_it_is_nothing() {
    let (mesh, set, culler, view) = (wall(), set(), culler(), view());
    let null_pointer = Status::NullPointer;
    let id = FovealCullOccluderId {
        set: 0,
        occluder: 0,
    };
    let mut count = 7;
    // SAFETY: pointers are null or to variables of the right size.
    unsafe {
        assert_eq!(foveal_cull_mesh_bake(null(), null_mut()), null_pointer);
        let mut out = null_mut();
        assert_eq!(foveal_cull_mesh_bake(null(), &mut out), null_pointer);
        assert_eq!(
            foveal_cull_mesh_source_init_sized(null_mut(), 56),
            null_pointer
        );
        let min = [0.0f32; 3];
        let (some, none) = (min.as_ptr(), null());
        assert_eq!(
            foveal_cull_mesh_from_box(none, some, &mut out),
            null_pointer
        );
        assert_eq!(
            foveal_cull_mesh_from_box(some, none, &mut out),
            null_pointer
        );
        assert_eq!(
            foveal_cull_mesh_from_box(some, some, null_mut()),
            null_pointer
        );
        let heights = foveal_cull_mesh_from_heights;
        assert_eq!(heights(null(), 2, 2, 1.0, 1.0, 1, &mut out), null_pointer);
        assert_eq!(heights(some, 1, 3, 1.0, 1.0, 1, null_mut()), null_pointer);
        // No rows, however long, or no columns.
        for (columns, rows) in [(usize::MAX, 0), (0, usize::MAX)] {
            let mut empty = null_mut();
            let baked = heights(null(), columns, rows, 1.0, 1.0, 1, &mut empty);
            assert_eq!(baked, Status::Ok);
            assert_eq!(foveal_cull_mesh_triangle_count(empty), 0);
            foveal_cull_mesh_destroy(empty);
        }
        assert_eq!(foveal_cull_mesh_triangle_count(null()), 0);
        assert_eq!(foveal_cull_mesh_to_bytes(null(), null_mut(), 8), 0);
        assert_eq!(
            foveal_cull_mesh_from_bytes(null(), 8, &mut out),
            null_pointer
        );
        let bytes = [0u8; 8];
        assert_eq!(
            foveal_cull_mesh_from_bytes(bytes.as_ptr(), 8, null_mut()),
            null_pointer
        );
        assert_eq!(foveal_cull_occluders_create(null_mut()), null_pointer);
        let mut given = id;
        let add = foveal_cull_occluders_add;
        assert_eq!(add(null_mut(), mesh, null(), &mut given), null_pointer);
        assert_eq!(add(set, null(), null(), &mut given), null_pointer);
        assert_eq!(add(set, mesh, null(), null_mut()), null_pointer);
        assert_eq!(
            foveal_cull_occluders_move(null_mut(), null(), null(), 0),
            null_pointer
        );
        assert_eq!(
            foveal_cull_occluders_move(set, null(), null(), 1),
            null_pointer
        );
        assert_eq!(
            foveal_cull_occluders_move(set, null(), null(), 0),
            Status::Ok
        );
        assert_eq!(
            foveal_cull_occluders_enable(null_mut(), id, 1),
            null_pointer
        );
        assert_eq!(foveal_cull_occluders_remove(null_mut(), id), null_pointer);
        let deform = foveal_cull_occluders_deform;
        assert_eq!(deform(null_mut(), id, some, 1, 12), null_pointer);
        assert_eq!(deform(set, id, null(), 1, 12), null_pointer);
        assert_eq!(deform(set, id, some, 1, 11), Status::BadArgument);
        assert_eq!(deform(set, id, some, usize::MAX, 12), Status::BadArgument);
        assert_eq!(
            foveal_cull_occluders_count(null(), &mut count),
            null_pointer
        );
        assert_eq!(foveal_cull_occluders_count(set, null_mut()), null_pointer);
        assert_eq!(foveal_cull_occluders_count(set, &mut count), Status::Ok);
        assert_eq!(count, 0, "what failed has added nothing");
        assert_eq!(
            foveal_cull_eye_from_matrix(null(), 0, null_mut()),
            null_pointer
        );
        assert_eq!(
            foveal_cull_eye_from_matrix_f32(null(), 0, null_mut()),
            null_pointer
        );
        let zero = [0.0f64; 3];
        let at = zero.as_ptr();
        let look_at = foveal_cull_eye_look_at;
        let mut eye = view.eyes[0];
        assert_eq!(
            look_at(null(), at, at, 1.0, 1.0, 0.1, &mut eye),
            null_pointer
        );
        assert_eq!(
            foveal_cull_view_init_sized(null(), null_mut(), 400),
            null_pointer
        );
        assert_eq!(foveal_cull_threads_create(2, null_mut()), null_pointer);
        assert_eq!(
            foveal_cull_threads_jobs_sized(null(), null_mut(), 32),
            null_pointer
        );
        let mut tree = null_mut();
        assert_eq!(
            foveal_cull_tree_build(null(), 1, null(), &mut tree),
            null_pointer
        );
        assert_eq!(
            foveal_cull_tree_build(null(), 0, null(), null_mut()),
            null_pointer
        );
        assert_eq!(foveal_cull_tree_refit(null_mut(), null(), 0), null_pointer);
        assert_eq!(
            foveal_cull_frame_options_init_sized(null_mut(), 48),
            null_pointer
        );
        assert_eq!(foveal_culler_create(8, 8, null_mut()), null_pointer);
        assert_eq!(
            foveal_culler_size(null(), null_mut(), null_mut()),
            null_pointer
        );
        let rasterize = foveal_culler_rasterize;
        assert_eq!(
            rasterize(null_mut(), &view, set, null(), null()),
            null_pointer
        );
        assert_eq!(rasterize(culler, null(), set, null(), null()), null_pointer);
        assert_eq!(
            rasterize(culler, &view, null(), null(), null()),
            null_pointer
        );
        let test = foveal_culler_test_boxes;
        let mut result = [9];
        let to = result.as_mut_ptr();
        assert_eq!(test(null(), BEHIND.as_ptr(), 1, null(), to), null_pointer);
        assert_eq!(test(culler, null(), 1, null(), to), null_pointer);
        assert_eq!(
            test(culler, BEHIND.as_ptr(), 1, null(), null_mut()),
            null_pointer
        );
        assert_eq!(test(culler, null(), 0, null(), null_mut()), Status::Ok);
        assert_eq!(foveal_culler_test_tree(culler, null(), to, 1), null_pointer);
        assert_eq!(
            foveal_culler_read_depth(culler, null_mut(), 64 * 64),
            null_pointer
        );
        assert_eq!(foveal_culler_stats(culler, null_mut()), null_pointer);
        let stats = foveal_culler_stats_sized(culler, null_mut(), 80);
        assert_eq!(stats, null_pointer);
        let create = foveal_culler_create_for_picture;
        assert_eq!(create(32, 32, null_mut()), null_pointer);
        let widened = foveal_cull_view_for_picture(null_mut(), 32, 32);
        assert_eq!(widened, null_pointer);
        foveal_cull_mesh_destroy(null_mut());
        foveal_cull_occluders_destroy(null_mut());
        foveal_cull_threads_destroy(null_mut());
        foveal_cull_tree_destroy(null_mut());
        foveal_culler_destroy(null_mut());
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_occluders_destroy(set);
        foveal_culler_destroy(culler);
    }
}

#[test]
fn ids_of_removed_occluders_and_of_other_sets_are_errors() {
    let (mesh, sets) = (wall(), [set(), set()]);
    let mut ids = [FovealCullOccluderId {
        set: 0,
        occluder: 0,
    }; 2];
    let place = [
        1.0f64, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
    ];
    // SAFETY: live handles; pointers to variables of the right size.
    unsafe {
        for (set, id) in sets.into_iter().zip(&mut ids) {
            assert_eq!(foveal_cull_occluders_add(set, mesh, null(), id), Status::Ok);
        }
        foveal_cull_mesh_destroy(mesh);
        let [set, other] = sets;
        let [own, foreign] = ids;
        let calls = |id: FovealCullOccluderId| {
            [
                foveal_cull_occluders_move(set, &id, place.as_ptr(), 1),
                foveal_cull_occluders_enable(set, id, 0),
                foveal_cull_occluders_enable(set, id, 1),
            ]
        };
        assert_eq!(calls(own), [Status::Ok; 3]);
        assert_eq!(calls(foreign), [Status::OtherSet; 3]);
        assert_eq!(foveal_cull_occluders_remove(set, foreign), Status::OtherSet);
        for odd in [0, 1, u64::MAX, own.occluder + 1, own.occluder ^ 1 << 40] {
            let id = FovealCullOccluderId {
                occluder: odd,
                ..own
            };
            assert_eq!(calls(id), [Status::UnknownOccluder; 3], "{odd:x}");
        }
        assert_eq!(
            foveal_cull_occluders_enable(set, own, 2),
            Status::BadArgument
        );
        // Moving is all or nothing.
        let two = [own, foreign];
        let mut far = [place, place];
        far[0][9] = 1000.0;
        let moved = foveal_cull_occluders_move(set, two.as_ptr(), far.as_ptr().cast(), 2);
        assert_eq!(moved, Status::OtherSet);
        far[1][3] = f64::NAN;
        let twice = [own, own];
        let moved = foveal_cull_occluders_move(set, twice.as_ptr(), far.as_ptr().cast(), 2);
        assert_eq!(moved, Status::NotFinite);
        let (culler, view) = (culler(), view());
        let rasterize = || foveal_culler_rasterize(culler, &view, set, null(), null());
        assert_eq!(rasterize(), Status::Ok);
        assert_eq!(test(culler), FovealCullVisibility::Occluded as u8);
        assert_eq!(foveal_cull_occluders_remove(set, own), Status::Ok);
        assert_eq!(
            foveal_cull_occluders_remove(set, own),
            Status::UnknownOccluder
        );
        assert_eq!(calls(own), [Status::UnknownOccluder; 3]);
        assert_eq!(rasterize(), Status::Ok);
        assert_eq!(test(culler), FovealCullVisibility::Visible as u8);
        foveal_culler_destroy(culler);
        foveal_cull_occluders_destroy(set);
        foveal_cull_occluders_destroy(other);
    }
}

static CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
static INDICES: [u16; 3] = [0, 1, 2];

#[test]
fn meshes_with_wrong_sizes_or_numbers_are_refused() {
    let mut source = core::mem::MaybeUninit::uninit();
    // SAFETY: a place for the source, which is written.
    let good = unsafe {
        assert_eq!(
            foveal_cull_mesh_source_init_sized(
                source.as_mut_ptr(),
                size_of::<FovealCullMeshSource>()
            ),
            Status::Ok
        );
        FovealCullMeshSource {
            positions: CORNERS.as_ptr(),
            position_count: 3,
            indices: INDICES.as_ptr().cast(),
            index_count: 3,
            index_bytes: 2,
            ..source.assume_init()
        }
    };
    let nan = [f32::NAN; 9];
    let bake = |source: FovealCullMeshSource| {
        let mut mesh = core::ptr::dangling_mut();
        // SAFETY: arrays are as long as the source says, or it is refused before they are read.
        unsafe {
            let status = foveal_cull_mesh_bake(&source, &mut mesh);
            assert_eq!(mesh.is_null(), status != Status::Ok);
            let count = foveal_cull_mesh_triangle_count(mesh);
            foveal_cull_mesh_destroy(mesh);
            (status, count)
        }
    };
    assert_eq!(bake(good), (Status::Ok, 1));
    let wrong = [
        (
            FovealCullMeshSource { size: 0, ..good },
            Status::BadStructSize,
        ),
        (
            FovealCullMeshSource {
                size: 70_000,
                ..good
            },
            Status::BadStructSize,
        ),
        (
            FovealCullMeshSource {
                index_bytes: 3,
                ..good
            },
            Status::BadArgument,
        ),
        (
            FovealCullMeshSource {
                position_stride: 8,
                ..good
            },
            Status::BadArgument,
        ),
        (
            FovealCullMeshSource {
                two_sided: 2,
                ..good
            },
            Status::BadArgument,
        ),
        (
            FovealCullMeshSource {
                adjacency: 9,
                ..good
            },
            Status::BadArgument,
        ),
        (
            FovealCullMeshSource {
                deformable: 2,
                ..good
            },
            Status::BadArgument,
        ),
        (
            FovealCullMeshSource {
                inner_shape: 2,
                ..good
            },
            Status::BadArgument,
        ),
        (
            FovealCullMeshSource {
                position_count: usize::MAX,
                ..good
            },
            Status::BadArgument,
        ),
        (
            FovealCullMeshSource {
                index_count: usize::MAX,
                ..good
            },
            Status::BadArgument,
        ),
        (
            FovealCullMeshSource {
                positions: null(),
                ..good
            },
            Status::NullPointer,
        ),
        (
            FovealCullMeshSource {
                indices: null(),
                ..good
            },
            Status::NullPointer,
        ),
        (
            FovealCullMeshSource {
                index_count: 2,
                ..good
            },
            Status::BadIndices,
        ),
        (
            FovealCullMeshSource {
                position_count: 2,
                ..good
            },
            Status::BadIndices,
        ),
        (
            FovealCullMeshSource {
                positions: nan.as_ptr(),
                ..good
            },
            Status::NotFinite,
        ),
    ];
    for (n, (source, status)) in wrong.into_iter().enumerate() {
        assert_eq!(bake(source), (status, 0), "{n}");
        assert!(!last_error().is_empty());
    }
    // Vertices among other data, and nothing aligned.
    let mut bytes = [0u8; 1 + 3 * 17];
    let points = [[0.0f32; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for (i, point) in points.iter().enumerate() {
        for (k, v) in point.iter().enumerate() {
            let at = 1 + 17 * i + 4 * k;
            bytes[at..at + 4].copy_from_slice(&v.to_ne_bytes());
        }
    }
    let strided = FovealCullMeshSource {
        positions: bytes[1..].as_ptr().cast(),
        position_stride: 17,
        ..good
    };
    assert_eq!(bake(strided), (Status::Ok, 1));
    let empty = FovealCullMeshSource {
        positions: null(),
        position_count: 0,
        indices: null(),
        index_count: 0,
        ..good
    };
    assert_eq!(bake(empty), (Status::Ok, 0));
}

#[test]
fn results_of_calls_that_fail_stay_as_they_were() {
    let culler = culler();
    let mut tree = null_mut();
    let (mut results, mut pixels) = ([9u8; 2], [9.0f32; 2]);
    let mut width = 9;
    // SAFETY: live handles; pointers are null or to variables of the right size.
    unsafe {
        let built = foveal_cull_tree_build(BEHIND.as_ptr(), 1, null(), &mut tree);
        assert_eq!(built, Status::Ok);
        let status = foveal_culler_test_tree(culler, tree, results.as_mut_ptr(), 2);
        assert_eq!((status, results), (Status::WrongLength, [9; 2]));
        let status = foveal_culler_read_depth(culler, pixels.as_mut_ptr(), 2);
        assert_eq!((status, pixels), (Status::WrongLength, [9.0; 2]));
        let nan = [f64::NAN; 3];
        let to = results.as_mut_ptr();
        let status = foveal_culler_test_boxes(culler, BEHIND.as_ptr(), 1, nan.as_ptr(), to);
        assert_eq!((status, results), (Status::NotFinite, [9; 2]));
        let status = foveal_culler_size(culler, &mut width, null_mut());
        assert_eq!((status, width), (Status::NullPointer, 9));
        foveal_cull_tree_destroy(tree);
        foveal_culler_destroy(culler);
    }
}

#[test]
fn meshes_go_through_bytes_and_other_bytes_are_refused() {
    let mesh = wall();
    // SAFETY: a live mesh, and as many bytes as are said.
    let bytes = unsafe {
        let needed = foveal_cull_mesh_to_bytes(mesh, null_mut(), 0);
        let mut bytes = vec![7u8; needed];
        let short = foveal_cull_mesh_to_bytes(mesh, bytes.as_mut_ptr(), needed - 1);
        assert_eq!(short, needed);
        assert!(bytes.iter().all(|b| *b == 7), "too few: nothing is written");
        let all = foveal_cull_mesh_to_bytes(mesh, bytes.as_mut_ptr(), needed);
        assert_eq!(all, needed);
        bytes
    };
    let read = |bytes: &[u8]| {
        let mut again = core::ptr::dangling_mut();
        // SAFETY: as many bytes as are said, and a place for the mesh.
        let status =
            unsafe { foveal_cull_mesh_from_bytes(bytes.as_ptr(), bytes.len(), &mut again) };
        assert_eq!(again.is_null(), status != Status::Ok);
        (status, again)
    };
    let (status, again) = read(&bytes);
    assert_eq!(status, Status::Ok);
    // SAFETY: live meshes.
    unsafe {
        let count = foveal_cull_mesh_triangle_count(again);
        assert_eq!(count, foveal_cull_mesh_triangle_count(mesh));
        foveal_cull_mesh_destroy(mesh);
        foveal_cull_mesh_destroy(again);
    }
    let mut wrong = bytes.clone();
    wrong[100] ^= 1;
    for wrong in [&wrong[..], &bytes[1..], &[], b"a picture"] {
        assert_eq!(read(wrong).0, Status::BadMeshBytes);
    }
    assert_eq!(read(&wrong).0, Status::BadMeshBytes);
    let text = last_error();
    assert!(text.contains("checksum"), "{text}");
}
