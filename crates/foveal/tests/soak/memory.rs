//! Memory of the process: Rust's own heap, counted as it is allocated, and all that is resident.
#![allow(
    unsafe_code,
    reason = "a counting allocator is the measurement; it passes everything on"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

static LIVE: AtomicU64 = AtomicU64::new(0);

struct Counting;

#[global_allocator]
static COUNTING: Counting = Counting;

// SAFETY: everything is passed on to the system's allocator, as the caller promised it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LIVE.fetch_add(layout.size() as u64, Ordering::Relaxed);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size() as u64, Ordering::Relaxed);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// Bytes that this program holds by Rust's allocator: the renderer's, wgpu's and the test's own.
/// What the driver allocates is not among them.
pub(crate) fn live() -> u64 {
    LIVE.load(Ordering::Relaxed)
}

/// Resident memory of this process in MiB; 0 where the system does not tell.
pub(crate) fn resident_mib() -> u64 {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = statm
        .split_whitespace()
        .nth(1)
        .and_then(|p| p.parse::<u64>().ok());
    (pages.unwrap_or(0) * 4096) >> 20
}
