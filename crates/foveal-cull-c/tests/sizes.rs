//! Structs of programs that were compiled with another version of the header.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

use core::ptr::null_mut;
use foveal_cull_c::*;
use objects::{culler, view};

use FovealCullStatus as Status;

/// Memory of the caller's, aligned as structs are.
#[repr(C, align(8))]
struct Memory([u8; 8192]);

const UNTOUCHED: u8 = 0xa5;

/// Calls an init function with sizes around that of the first version, which is `first` for ever.
fn check<T>(first: usize, init: impl Fn(*mut T, usize) -> Status) {
    let filled = |size: usize| {
        let mut memory = Memory([UNTOUCHED; 8192]);
        let status = init(memory.0.as_mut_ptr().cast(), size);
        let from = if status == Status::Ok { size } else { 0 };
        assert!(
            memory.0[from..].iter().all(|b| *b == UNTOUCHED),
            "{size}: written beyond the caller's struct"
        );
        (status, memory)
    };
    // No struct ends within a field.
    for size in [0, 4, first - 1, first + 1, first + 4, 4097, usize::MAX] {
        assert_eq!(filled(size).0, Status::BadStructSize, "{size}");
    }
    // The library's own struct is at least as large; that of a newer header may be larger.
    assert!(size_of::<T>() >= first);
    for size in [first, first + 8, size_of::<T>(), size_of::<T>() + 8, 4096] {
        let (status, memory) = filled(size);
        assert_eq!(status, Status::Ok, "{size}");
        let stored: [u8; 4] = memory.0[..4].try_into().unwrap();
        assert_eq!(u32::from_ne_bytes(stored) as usize, size);
        // What this version does not know is zero, by which it takes the struct back.
        let unknown = size_of::<T>().min(size);
        assert!(memory.0[unknown..size].iter().all(|b| *b == 0), "{size}");
    }
}

#[test]
#[cfg(target_pointer_width = "64")]
fn no_more_is_written_than_the_caller_s_struct_has() {
    let view = view();
    let mut threads = null_mut();
    // SAFETY: a place for the threads.
    let started = unsafe { foveal_cull_threads_create(1, &mut threads) };
    assert_eq!(started, Status::Ok);
    // SAFETY: 8192 bytes that can be written, or a size that is refused; the eye and the threads live.
    unsafe {
        check(56, |to, size| foveal_cull_mesh_source_init_sized(to, size));
        check(48, |to, size| {
            foveal_cull_frame_options_init_sized(to, size)
        });
        check(VIEW, |to, size| {
            foveal_cull_view_init_sized(&view.eyes[0], to, size)
        });
        check(32, |to, size| {
            foveal_cull_threads_jobs_sized(threads, to, size)
        });
        foveal_cull_threads_destroy(threads);
        let culler = culler();
        check(72, |to, size| foveal_culler_stats_sized(culler, to, size));
        foveal_culler_destroy(culler);
    }
}

/// A view of two eyes of 152 bytes.
#[cfg(target_pointer_width = "64")]
const VIEW: usize = 8 + 2 * 152 + 8;

#[test]
fn stats_of_earlier_headers_write_no_more_than_their_structs_had_whatever_size_they_say() {
    let culler = culler();
    for size in [72u32, 80, 88, 200, 4096, 4097, u32::MAX] {
        let mut memory = Memory([UNTOUCHED; 8192]);
        memory.0[..4].copy_from_slice(&size.to_ne_bytes());
        // SAFETY: a live culler and 8192 bytes that can be written.
        let status = unsafe { foveal_culler_stats(culler, memory.0.as_mut_ptr().cast()) };
        let expected = if size <= 80 {
            Status::Ok
        } else {
            Status::BadStructSize
        };
        assert!(memory.0[80..].iter().all(|b| *b == UNTOUCHED), "{size}");
        assert_eq!(status, expected, "{size}");
    }
    // SAFETY: it is used no more.
    unsafe { foveal_culler_destroy(culler) };
}
