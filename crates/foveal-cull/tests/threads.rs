//! Threads: the crate's own, the caller's, and queries from many at once.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Random, answers, eye, occluders, scene};
use core::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};
use foveal_cull::{
    Culler, OccludeeTree, SingleThread, Threads, ThreadsFn, View, Visibility, WorkerThreads,
};
use glam::DVec3;

#[test]
fn whoever_is_woken_and_when_every_task_runs_once() {
    for threads in [1, 2, 5] {
        let pool = WorkerThreads::new(threads);
        let stop = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !stop.load(Ordering::Relaxed) {
                    pool.wake();
                }
            });
            for round in 0..300 {
                let ran: [AtomicU32; 7] = [const { AtomicU32::new(0) }; 7];
                // Long enough that threads go to sleep now and then.
                if round % 50 == 0 {
                    std::thread::sleep(core::time::Duration::from_millis(2));
                }
                pool.run(ran.len(), &|i| {
                    ran[i].fetch_add(1, Ordering::Relaxed);
                });
                let ran = ran.map(AtomicU32::into_inner);
                assert_eq!(ran, [1; 7], "{threads} threads, round {round}");
            }
            stop.store(true, Ordering::Relaxed);
        });
    }
    SingleThread.wake();
}

#[test]
fn queries_from_many_threads_at_once_have_the_answers_of_one() {
    let mut r = Random::new(11);
    let scene = scene(&mut r, 8, 900, DVec3::ZERO);
    let view = View::mono(eye(&mut r, DVec3::ZERO, false));
    let set = occluders(&scene, &[0, 1, 2, 3, 4, 5, 6, 7]);
    let mut culler = Culler::new(160, 90).unwrap();
    let expected = answers(&mut culler, &view, &set, &scene, &SingleThread);
    let tree = OccludeeTree::build(&scene.boxes, DVec3::ZERO);
    let mut by_tree = vec![Visibility::Visible; 900];
    culler.query_tree(&tree, &mut by_tree).unwrap();
    let (culler, scene, tree) = (&culler, &scene, &tree);
    std::thread::scope(|scope| {
        for n in 0..8 {
            let (expected, by_tree) = (&expected, &by_tree);
            scope.spawn(move || {
                let mut results = vec![Visibility::Visible; 900];
                for round in 0..40 {
                    // Each thread asks about other boxes at the same time.
                    let first = (97 * n + 31 * round) % 800;
                    let part = first..first + 100;
                    let (boxes, results) = (&scene.boxes[part.clone()], &mut results[..]);
                    culler
                        .query(boxes, DVec3::ZERO, &mut results[..100])
                        .unwrap();
                    assert_eq!(results[..100], expected[part]);
                    culler.query_tree(tree, results).unwrap();
                    assert_eq!(results, by_tree);
                }
            });
        }
    });
}

#[test]
fn a_job_system_behind_a_closure_draws_the_same_in_whatever_order_it_runs_tasks() {
    let mut r = Random::new(5);
    let scene = scene(&mut r, 8, 300, DVec3::ZERO);
    let view = View::mono(eye(&mut r, DVec3::ZERO, false));
    let set = occluders(&scene, &[0, 1, 2, 3, 4, 5, 6, 7]);
    let mut culler = Culler::new(160, 90).unwrap();
    let expected = answers(&mut culler, &view, &set, &scene, &SingleThread);
    let runs = AtomicUsize::new(0);
    let backwards = ThreadsFn::new(5, |tasks, task| {
        runs.fetch_add(1, Ordering::Relaxed);
        (0..tasks).rev().for_each(task);
    });
    assert_eq!(
        answers(&mut culler, &view, &set, &scene, &backwards),
        expected
    );
    assert!(runs.load(Ordering::Relaxed) > 0);
    let spawning = ThreadsFn::new(3, |tasks, task| {
        std::thread::scope(|scope| {
            (0..tasks).for_each(|i| drop(scope.spawn(move || task(i))));
        });
    });
    assert_eq!(
        answers(&mut culler, &view, &set, &scene, &spawning),
        expected
    );
}

/// Rectangles of clusters with a corner so far away were rounded by more than they were grown, and
/// a thread whose rows they missed left out what one thread alone draws.
#[test]
fn with_a_corner_very_far_away_threads_change_nothing() {
    let pool = WorkerThreads::new(3);
    let mut covered = 0;
    for seed in 0..400 {
        let mut r = Random::new(seed);
        let mut scene = scene(&mut r, 4, 0, DVec3::ZERO);
        for object in &mut scene.objects {
            let at = r.below(object.positions.len());
            object.positions[at][r.below(3)] = [3e9, -1e9, 1e12, 1e20][r.below(4)];
        }
        let view = View::mono(eye(&mut r, DVec3::ZERO, seed % 2 == 0));
        let set = occluders(&scene, &[0, 1, 2, 3]);
        let mut culler = Culler::new(77, 36).unwrap();
        let mut depths = [vec![0.0; 77 * 36], vec![0.0; 77 * 36]];
        answers(&mut culler, &view, &set, &scene, &SingleThread);
        culler.read_depth(&mut depths[0]).unwrap();
        answers(&mut culler, &view, &set, &scene, &pool);
        culler.read_depth(&mut depths[1]).unwrap();
        assert!(depths[0] == depths[1], "seed {seed}");
        covered += depths[0].iter().filter(|d| **d > 0.0).count();
    }
    assert!(covered > 10_000, "{covered}");
}
