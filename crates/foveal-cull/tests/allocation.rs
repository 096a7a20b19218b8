//! After warm-up a frame allocates nothing. Without the test harness, whose own thread allocates
//! too.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "a counting allocator is the measurement"
)]

mod common;

use common::{Random, eye, occluders, scene};
use foveal_cull::{
    Culler, FrameOptions, OccludeeTree, OccluderUsefulness, SingleThread, Threads, View,
    Visibility, WorkerThreads,
};
use glam::DVec3;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Barrier;
use std::sync::atomic::{AtomicU64, Ordering};

struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: everything is passed on to the system allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, p: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise, passed on.
        unsafe { System.dealloc(p, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn main() {
    let mut r = Random::new(7);
    let scene = scene(&mut r, 12, 300, DVec3::ZERO);
    let view = View::mono(eye(&mut r, DVec3::ZERO, false));
    let set = occluders(&scene, &(0..12).collect::<Vec<_>>());
    let mut tree = OccludeeTree::build(&scene.boxes, DVec3::ZERO);
    let mut culler = Culler::new(160, 90).unwrap();
    let mut results = vec![Visibility::Visible; scene.boxes.len()];
    let mut usefulness = OccluderUsefulness::new();
    let pool = WorkerThreads::new(2);
    for threads in [&SingleThread as &dyn Threads, &pool] {
        let mut frame = || {
            culler
                .rasterize(&view, &set, &FrameOptions::default(), threads)
                .unwrap();
            culler
                .query(&scene.boxes, DVec3::ZERO, &mut results)
                .unwrap();
            tree.refit(&scene.boxes).unwrap();
            culler.query_tree(&tree, &mut results).unwrap();
        };
        // Every thread has begun, and made what it makes once.
        let all = Barrier::new(threads.count());
        threads.run(threads.count(), &|_| {
            all.wait();
        });
        // Which band draws what is fixed, so a few frames reach the final capacity; a
        // thread that first has to wait makes its handle then, so there are many.
        (0..300).for_each(|_| frame());
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        (0..10).for_each(|_| frame());
        assert_eq!(ALLOCATIONS.load(Ordering::Relaxed), before);
        let mut frame = || {
            let options = FrameOptions::default().with_usefulness(Some(&usefulness));
            culler.rasterize(&view, &set, &options, threads).unwrap();
            culler
                .query(&scene.boxes, DVec3::ZERO, &mut results)
                .unwrap();
            usefulness
                .observe(&culler, &scene.boxes, DVec3::ZERO, &results)
                .unwrap();
            usefulness.learn(&culler, &set);
        };
        (0..100).for_each(|_| frame());
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        (0..100).for_each(|_| frame());
        assert_eq!(ALLOCATIONS.load(Ordering::Relaxed), before, "learning");
    }
}
