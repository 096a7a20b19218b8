//! Threads: the crate's own, the caller's, and queries from many at once.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Random, answers, eye, occluders, scene};
use core::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};
use foveal_cull::{
    Aabb, Affine, BakeOptions, Culler, Eye, FrameOptions, OccludeeTree, OccluderMesh, OccluderSet,
    Projection, SingleThread, Threads, ThreadsFn, View, Visibility, WorkerThreads,
};
use glam::DVec3;
use std::sync::Arc;

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

/// The panic reaches the caller, whichever thread it happened on, and not before all threads have
/// let go of the task; the threads work on afterwards.
#[test]
fn a_task_that_panics_is_the_callers_panic_and_the_threads_go_on() {
    // Helpers would print theirs past the test's own output.
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !panic.to_string().contains("as it should") {
            usual(panic);
        }
    }));
    for threads in [1, 2, 4] {
        let pool = WorkerThreads::new(threads);
        for round in 0..100 {
            let (started, ended) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let run = || {
                pool.run(9, &|i| {
                    started.fetch_add(1, Ordering::Relaxed);
                    assert_ne!(i, round % 9, "as it should");
                    std::thread::yield_now();
                    ended.fetch_add(1, Ordering::Relaxed);
                });
            };
            let ran = std::panic::catch_unwind(std::panic::AssertUnwindSafe(run));
            assert!(ran.is_err(), "{threads} threads, round {round}");
            // What was begun has ended: nobody holds the task any more.
            let [started, ended] = [started, ended].map(AtomicUsize::into_inner);
            assert_eq!(started, ended + 1, "{threads} threads, round {round}");
            let ran: [AtomicU32; 7] = [const { AtomicU32::new(0) }; 7];
            pool.run(ran.len(), &|i| {
                ran[i].fetch_add(1, Ordering::Relaxed);
            });
            assert_eq!(ran.map(AtomicU32::into_inner), [1; 7]);
        }
    }
}

/// Tasks that run tasks on the same threads, directly and through other threads on the way; and from
/// a second caller.
#[test]
fn tasks_may_run_tasks_on_the_threads_that_run_them() {
    for threads in [1, 2, 4] {
        let [pool, other] = [threads, 1].map(WorkerThreads::new);
        let ran = AtomicUsize::new(0);
        let count = |_| {
            ran.fetch_add(1, Ordering::Relaxed);
        };
        let twice = || pool.run(6, &|_| other.run(2, &|_| pool.run(5, &count)));
        std::thread::scope(|scope| {
            scope.spawn(twice);
            twice();
        });
        assert_eq!(ran.into_inner(), 2 * 6 * 2 * 5, "{threads} threads");
    }
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
    // Batches of four, the last one in full.
    let in_batches = ThreadsFn::new(5, |tasks, task| {
        (0..tasks.next_multiple_of(4)).for_each(task);
        task(usize::MAX);
    });
    assert_eq!(
        answers(&mut culler, &view, &set, &scene, &in_batches),
        expected
    );
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

/// A triangle with a corner 1e20 m away, which was clipped at a wrong place: one thread drew where
/// nothing is, and others saw that nothing is there.
#[test]
fn a_triangle_that_is_nearly_endless_is_drawn_where_it_is() {
    let positions = [
        [0.751_321_26, -1.149_981_9, -0.602_543_2],
        [1.147_489_8, -0.893_126_8, -0.368_228_23],
        [0.795_318_07, -1.217_323_8, 1e20],
    ];
    let mesh = OccluderMesh::bake(&positions, &[0, 1, 2], BakeOptions::default()).unwrap();
    let place = Affine {
        x_axis: [
            3.125_498_022_208_103_2,
            -0.685_003_564_601_177_1,
            -0.015_063_422_401_635_49,
        ],
        y_axis: [
            0.549_736_126_118_158_8,
            2.512_214_842_103_764_2,
            -0.177_711_737_415_148_7,
        ],
        z_axis: [
            -0.099_122_576_169_181_4,
            -0.339_873_678_046_077_4,
            -5.111_237_854_480_743,
        ],
        translation: [
            1.577_363_133_411_797_2,
            0.984_121_404_176_945_7,
            -2.785_604_670_938_541_4,
        ],
    };
    let mut set = OccluderSet::new();
    set.add(Arc::new(mesh), place).unwrap();
    let eye = Eye {
        world_from_eye: Affine {
            x_axis: [0.864_757_978_931_249_2, -0.0, 0.502_188_846_824_321_3],
            y_axis: [
                -0.161_893_670_602_782_98,
                0.946_611_675_744_917_2,
                0.278_777_285_233_495_54,
            ],
            z_axis: [
                -0.475_377_825_832_778_04,
                -0.322_376_077_498_625_96,
                0.818_589_999_549_897_3,
            ],
            translation: [
                2.509_955_680_025_163,
                1.235_345_971_368_758_2,
                -1.198_908_800_871_088_4,
            ],
        },
        projection: Projection::Orthographic {
            left: -1.357_552_692_820_332_3,
            right: 2.602_824_798_388_635,
            bottom: -4.994_131_289_045_437,
            top: 6.542_053_089_894_359,
            near_m: -1.155_102_507_980_675_6,
            far_m: 30.0,
        },
    };
    let mut first: Option<Vec<f32>> = None;
    for threads in 1..6 {
        let mut culler = Culler::new(19, 30).unwrap();
        let all = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
        let pool = WorkerThreads::new(threads);
        culler
            .rasterize(&View::mono(eye), &set, &all, &pool)
            .unwrap();
        let mut depth = vec![0.0; 19 * 30];
        culler.read_depth(&mut depth).unwrap();
        // It lies below sample 98 of 120.
        assert!(depth[..24 * 19].iter().all(|d| *d == 0.0));
        match &first {
            Some(first) => assert!(*first == depth, "{threads} threads"),
            None => first = Some(depth),
        }
    }
    let first = first.unwrap();
    assert!(first.iter().any(|d| *d > 0.0), "it is seen");
}

/// A wavy plate of 2 by 2 metres, across z.
fn plate() -> Arc<OccluderMesh> {
    let n = 120u32;
    let positions: Vec<[f32; 3]> = (0..=n)
        .flat_map(|y| (0..=n).map(move |x| [x, y].map(|v| 2.0 * v as f32 / n as f32 - 1.0)))
        .map(|[x, y]| [x, y, 0.01 * (40.0 * x).sin()])
        .collect();
    let indices: Vec<u32> = (0..n)
        .flat_map(|y| (0..n).map(move |x| y * (n + 1) + x))
        .flat_map(|i| [i, i + 1, i + n + 2, i, i + n + 2, i + n + 1])
        .collect();
    Arc::new(OccluderMesh::bake(&positions, &indices, BakeOptions::default()).unwrap())
}

/// A job system that leaves out a task had drawn what the task found in the frame before, where it
/// was then.
#[test]
fn a_task_that_is_left_out_hides_nothing_visible() {
    // Many clusters, in several parts of the selection.
    let plate = plate();
    let view = View::perspective([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], 1.2, 1.5, 0.1);
    let at = |x: f64| Affine::from_translation([x, 0.0, -3.0]);
    let behind = |x: f32| Aabb::new([x - 0.2, -0.2, -4.2], [x + 0.2, 0.2, -4.0]);
    let boxes = [behind(-1.8), behind(1.8)];
    let (frame, run) = (AtomicUsize::new(0), AtomicUsize::new(0));
    for (left_out_run, left_out) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1)] {
        let threads = ThreadsFn::new(2, |tasks, task| {
            let leaves_out = frame.load(Ordering::Relaxed) % 2 == 1
                && run.fetch_add(1, Ordering::Relaxed) == left_out_run;
            (0..tasks)
                .filter(|i| !(leaves_out && *i == left_out))
                .for_each(task);
        });
        let mut set = OccluderSet::new();
        let id = set.add(plate.clone(), at(-1.35)).unwrap();
        let mut culler = Culler::new(150, 100).unwrap();
        let mut hidden = 0;
        for n in 0..8 {
            frame.store(n, Ordering::Relaxed);
            run.store(0, Ordering::Relaxed);
            // It is on the other side in the frames of which a task is left out.
            let side = n % 2;
            set.set_transform(id, at([-1.35, 1.35][side])).unwrap();
            let all = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
            culler.rasterize(&view, &set, &all, &threads).unwrap();
            let mut results = [Visibility::Outside; 2];
            culler.query(&boxes, DVec3::ZERO, &mut results).unwrap();
            assert_eq!(results[1 - side], Visibility::Visible, "{left_out}: {n}");
            hidden += usize::from(results[side] == Visibility::Occluded);
        }
        assert!(hidden >= 4, "{hidden}");
    }
}

/// A panic after the tasks of a frame had left depth that the frame after took for its own.
#[test]
fn a_frame_that_panics_hides_nothing_in_the_next() {
    let mut walls = OccluderSet::new();
    let at = Affine::from_translation([0.0, 0.0, -3.0]);
    walls.add(plate(), at).unwrap();
    let view = View::perspective([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], 1.2, 1.5, 0.1);
    let boxes = [Aabb::new([-0.2, -0.2, -4.2], [0.2, 0.2, -4.0])];
    let run = AtomicUsize::new(0);
    let threads = ThreadsFn::new(2, |tasks, task| {
        (0..tasks).for_each(task);
        // The second run of a frame draws.
        assert_eq!(run.fetch_add(1, Ordering::Relaxed), 0, "as it should");
    });
    let options = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    let mut culler = Culler::new(150, 100).unwrap();
    let asked = |culler: &mut Culler| {
        let mut result = [Visibility::Outside];
        culler.query(&boxes, DVec3::ZERO, &mut result).unwrap();
        result[0]
    };
    culler
        .rasterize(&view, &walls, &options, &SingleThread)
        .unwrap();
    assert_eq!(asked(&mut culler), Visibility::Occluded);
    let mut culler = Culler::new(150, 100).unwrap();
    let frame = || culler.rasterize(&view, &walls, &options, &threads);
    assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(frame)).is_err());
    assert_eq!(asked(&mut culler), Visibility::Visible);
    culler
        .rasterize(&view, &OccluderSet::new(), &options, &SingleThread)
        .unwrap();
    assert_eq!(asked(&mut culler), Visibility::Visible);
}

#[test]
fn numbers_of_threads_without_an_end_have_one() {
    let pool = WorkerThreads::new(usize::MAX);
    assert!((2..=256).contains(&pool.count()), "{}", pool.count());
    let ran = AtomicUsize::new(0);
    pool.run(1000, &|_| {
        ran.fetch_add(1, Ordering::Relaxed);
    });
    assert_eq!(ran.into_inner(), 1000);
}
