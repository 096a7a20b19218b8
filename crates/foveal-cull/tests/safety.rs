//! What is culled is never visible, whatever the scene, the view, the resolution or the order.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::promise::{
    answers_to_all, culls_nothing_that_either_eye_sees, culls_nothing_visible,
    culls_nothing_visible_around, culls_nothing_visible_in, hidden, size,
};
use common::{Random, answers, eye, occluders, scene, wrongly_culled};
use foveal_cull::{
    Aabb, Culler, Eye, FrameOptions, InstructionSet, OccludeeTree, OccluderMesh, OccluderSet,
    Projection, SingleThread, View, Visibility, WorkerThreads,
};
use glam::{DAffine3, DVec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::sync::Arc;

proptest! {
    // The same scenes every time; other ones are for the fuzzers.
    #![proptest_config(ProptestConfig { cases: 1000, rng_seed: RngSeed::Fixed(20), ..ProptestConfig::default() })]

    #[test]
    fn perspective_views_cull_nothing_visible(seed in any::<u64>()) {
        culls_nothing_visible(seed, false, DVec3::ZERO).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn orthographic_views_cull_nothing_visible(seed in any::<u64>()) {
        culls_nothing_visible(seed, true, DVec3::ZERO).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn a_million_metres_from_the_origin_nothing_visible_is_culled(seed in any::<u64>()) {
        culls_nothing_visible(seed, seed % 4 == 0, DVec3::new(1e6, -2e5, 3e6)).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn order_threads_instruction_set_and_tree_change_nothing(seed in any::<u64>()) {
        let mut r = Random::new(seed);
        let objects = 1 + r.below(9);
        let scene = scene(&mut r, objects, 200, DVec3::ZERO);
        let view = View::mono(eye(&mut r, DVec3::ZERO, seed % 4 == 0));
        let (w, h) = size(&mut r);
        let mut order: Vec<usize> = (0..objects).collect();
        let mut culler = Culler::new(w, h).unwrap();
        let depth = |c: &Culler| { let mut d = vec![0.0; (w * h) as usize]; c.read_depth(&mut d).unwrap(); d };
        let reference = answers(&mut culler, &view, &occluders(&scene, &order), &scene, &SingleThread);
        let image = depth(&culler);
        order.reverse();
        let reversed = occluders(&scene, &order);
        prop_assert_eq!(&reference, &answers(&mut culler, &view, &reversed, &scene, &SingleThread));
        prop_assert_eq!(&image, &depth(&culler));
        prop_assert_eq!(&reference, &answers(&mut culler, &view, &reversed, &scene, &WorkerThreads::new(2)));
        prop_assert_eq!(&image, &depth(&culler));
        let tree = OccludeeTree::build(&scene.boxes, scene.origin);
        let mut by_tree = vec![Visibility::Outside; scene.boxes.len()];
        culler.query_tree(&tree, &mut by_tree).unwrap();
        for (flat, tree) in reference.iter().zip(&by_tree) {
            // A group may prove more than its member's own, slightly grown box; never less.
            prop_assert!(flat.is_visible() || !tree.is_visible());
        }
        for n in [1, 4] {
            prop_assert!(wrongly_culled(&scene, &view.eye, (w, h), n, &by_tree).is_empty());
        }
        for set in InstructionSet::available() {
            culler.set_instruction_set(set);
            prop_assert_eq!(&reference, &answers(&mut culler, &view, &reversed, &scene, &SingleThread));
            prop_assert_eq!(&image, &depth(&culler));
            let mut with_set = vec![Visibility::Outside; scene.boxes.len()];
            culler.query_tree(&tree, &mut with_set).unwrap();
            prop_assert_eq!(&by_tree, &with_set);
        }
    }

    #[test]
    fn a_tree_calls_small_what_is_small_and_nothing_visible_hidden(seed in any::<u64>()) {
        let mut r = Random::new(seed);
        let scene = scene(&mut r, 5, 300, DVec3::ZERO);
        let eye = eye(&mut r, DVec3::ZERO, seed % 4 == 0);
        let (w, h) = size(&mut r);
        let mut culler = Culler::new(w, h).unwrap();
        let set = occluders(&scene, &[0, 1, 2, 3, 4]);
        let tree = OccludeeTree::build(&scene.boxes, scene.origin);
        let mut by_tree = vec![Visibility::Outside; scene.boxes.len()];
        let mut flat = by_tree.clone();
        for threshold in [0.1, 0.5] {
            let options = FrameOptions::default().with_occludee_size_threshold(threshold);
            culler.rasterize(&View::mono(eye), &set, &options, &SingleThread).unwrap();
            culler.query_tree(&tree, &mut by_tree).unwrap();
            culler.query(&scene.boxes, scene.origin, &mut flat).unwrap();
            for (n, (flat, tree)) in flat.iter().zip(&by_tree).enumerate() {
                // A group that is hidden answers for members that lie beside the screen or are
                // small, and of a small box there is no knowing which comes first.
                let same = flat == tree || *tree == Visibility::Occluded;
                let either = |v: &Visibility| matches!(v, Visibility::Outside | Visibility::Small);
                prop_assert!(same || (either(flat) && either(tree)), "{n}: {flat:?} {tree:?}");
            }
        }
    }

    #[test]
    fn within_the_validity_radius_nothing_visible_is_culled(seed in any::<u64>()) {
        culls_nothing_visible_around(seed).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn what_either_eye_sees_is_not_culled(seed in any::<u64>()) {
        culls_nothing_that_either_eye_sees(seed).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn a_spent_budget_only_makes_more_visible(seed in any::<u64>()) {
        let mut r = Random::new(seed);
        let scene = scene(&mut r, 8, 100, DVec3::ZERO);
        let view = View::mono(eye(&mut r, DVec3::ZERO, false));
        let set = occluders(&scene, &(0..8).collect::<Vec<_>>());
        let mut culler = Culler::new(64, 48).unwrap();
        let all = answers(&mut culler, &view, &set, &scene, &SingleThread);
        let ticks = core::sync::atomic::AtomicU64::new(0);
        let clock = || ticks.fetch_add(1, core::sync::atomic::Ordering::Relaxed);
        let budget = Some(foveal_cull::Budget::new(&clock, seed % 3));
        culler.rasterize(&view, &set, &FrameOptions::default().with_budget(budget), &SingleThread).unwrap();
        let mut some = vec![Visibility::Visible; scene.boxes.len()];
        culler.query(&scene.boxes, scene.origin, &mut some).unwrap();
        for (all, some) in all.iter().zip(&some) {
            prop_assert!(!all.is_visible() || some.is_visible());
        }
    }
}

/// What a sample decides that lies within float rounding of an edge, in whose place `f64` has to
/// decide.
#[test]
fn samples_beside_a_border_are_not_covered() {
    for seed in [
        163_041_650_415_333_986,
        9_608_052_331_769_164_851,
        17_746_510_810_359_225_760,
        15_442_197_373_942_564_352,
        3_440_041_447_996_143_651,
        8_123_715_021_742_388_820,
        14_439_270_432_469_137_347,
        14_476_649_845_410_441_689,
    ] {
        culls_nothing_visible(seed, false, DVec3::ZERO).unwrap();
    }
    for seed in [17_824_462_219_250_879_956, 15_990_008_277_548_940_997] {
        culls_nothing_visible(seed, true, DVec3::ZERO).unwrap();
    }
}

#[test]
fn the_smallest_and_the_largest_buffers_cull_nothing_visible() {
    let sizes = [
        (1, 1),
        (3, 7),
        (9, 1),
        (4096, 5),
        (4081, 12),
        (6, 4096),
        (11, 4077),
    ];
    for (seed, size) in (0..70).zip(sizes.into_iter().cycle()) {
        culls_nothing_visible_in(Some(size), seed, seed % 3 == 0, DVec3::ZERO).unwrap();
    }
}

#[test]
fn random_scenes_do_hide_something() {
    let hidden: usize = (0..40)
        .map(|seed| culls_nothing_visible(seed, seed % 4 == 0, DVec3::ZERO).unwrap())
        .sum();
    assert!(hidden > 100, "{hidden}");
    let [one, both] = (0..40)
        .map(|seed| culls_nothing_that_either_eye_sees(seed).unwrap())
        .fold([0; 2], |[a, b], [c, d]| [a + c, b + d]);
    assert!(both > 100 && both > one / 2, "{both} of {one}");
}

/// The codes of depths end at 2^-32 of the near distance. What is farther had been behind pixels
/// that nothing covers.
#[test]
fn what_is_very_far_away_is_not_behind_nothing() {
    let mut culler = Culler::new(64, 64).unwrap();
    // Up to 1e9 m, as far as positions are exact.
    let places = [
        (1e-9, 4e9),
        (1e-9, 5e9),
        (1e-9, 1e15),
        (1e-3, 4e9),
        (1e-3, 1e12),
        (0.1, 5e9),
    ];
    for (near, times) in places {
        let eye = Projection::perspective(1.0, 1.0, near, f64::INFINITY);
        let view = View::mono(Eye::new(DAffine3::IDENTITY, eye));
        let far = (near * times) as f32;
        let at = |x: f32| {
            Aabb::new(
                [(x - 0.1) * far, 0.0, -1.1 * far],
                [x * far, 0.1 * far, -far],
            )
        };
        let boxes: Vec<Aabb> = (0..40).map(|i| at([-0.2, 0.3][i % 2])).collect();
        // A wall before every other one.
        let size = (near * 10.0) as f32;
        let wall = Aabb::new([-size, -size, -1.1 * size], [0.0, size, -size]);
        let mut set = OccluderSet::new();
        let mesh = Arc::new(OccluderMesh::from_box(wall).unwrap());
        set.add(mesh, DAffine3::IDENTITY).unwrap();
        let tree = OccludeeTree::build(&boxes, DVec3::ZERO);
        for isa in InstructionSet::available() {
            culler.set_instruction_set(isa);
            for radius in [0.0, 1e-3 * near] {
                let view = view.with_validity_radius(radius);
                let options = FrameOptions::default();
                culler
                    .rasterize(&view, &set, &options, &SingleThread)
                    .unwrap();
                let mut results = [[Visibility::Outside; 40]; 2];
                let [list, by_tree] = &mut results;
                culler.query(&boxes, DVec3::ZERO, list).unwrap();
                culler.query_tree(&tree, by_tree).unwrap();
                for results in results {
                    for pair in results.chunks(2) {
                        let expected = [Visibility::Occluded, Visibility::Visible];
                        assert_eq!(pair, expected, "{near} {times} {radius}");
                    }
                }
            }
        }
    }
}

/// A slit between two boxes, which holds a sample of the left eye and none of the frustum around
/// both eyes.
#[test]
fn two_frusta_at_one_place_have_the_samples_of_either() {
    let wall = |x0: f32, x1: f32| Aabb::new([x0, -4.0, -1.1], [x1, 4.0, -1.0]);
    let mut set = OccluderSet::new();
    for wall in [wall(-4.0, -0.0225), wall(-0.0165, 4.0)] {
        let mesh = Arc::new(OccluderMesh::from_box(wall).unwrap());
        set.add(mesh, DAffine3::IDENTITY).unwrap();
    }
    let boxes = [
        Aabb::new([-0.2, -0.2, -6.0], [0.2, 0.2, -5.0]),
        Aabb::new([0.5, -0.2, -6.0], [0.9, 0.2, -5.0]),
    ];
    let mut culler = Culler::new(64, 64).unwrap();
    let mut results_of = |view: &View| {
        let options = FrameOptions::default();
        culler
            .rasterize(view, &set, &options, &SingleThread)
            .unwrap();
        let mut results = [Visibility::Outside; 2];
        culler.query(&boxes, DVec3::ZERO, &mut results).unwrap();
        results
    };
    let seen = [Visibility::Visible, Visibility::Occluded];
    for near in [1e-9, 1e-3, 0.1, 0.9] {
        let eye = |left: f64| {
            let projection = Projection::Perspective {
                left,
                right: 1.0,
                bottom: -1.0,
                top: 1.0,
                near_m: near,
                far_m: f64::INFINITY,
            };
            Eye::new(DAffine3::IDENTITY, projection)
        };
        let (left, right) = (eye(-1.0), eye(-1.25));
        assert_eq!(results_of(&View::mono(left)), seen, "{near}");
        for both in [View::stereo(left, right), View::stereo(right, left)] {
            assert_eq!(results_of(&both), seen, "{near}");
            let far = both.with_validity_radius(1e-12 * near);
            assert_eq!(results_of(&far), seen, "{near}");
        }
        // Two eyes that are the same are one.
        for eye in [left, right] {
            let one = results_of(&View::mono(eye));
            assert_eq!(results_of(&View::stereo(eye, eye)), one, "{near}");
        }
    }
}

/// Where no sample of the buffer lies: pictures of three and seven times its size. A view of one
/// exact place promises nothing there; with any validity radius every point of the picture counts.
#[test]
fn with_a_small_validity_radius_nothing_is_culled_between_samples() {
    let (mut exactly_wrong, mut culled) = (0, [0; 2]);
    for seed in 0..300 {
        let mut r = Random::new(seed);
        let objects = 1 + r.below(7);
        let scene = scene(&mut r, objects, 150, DVec3::ZERO);
        let eye = eye(&mut r, DVec3::ZERO, seed % 5 == 0);
        let size = size(&mut r);
        let exact = View::mono(eye);
        let views = [exact, exact.with_validity_radius(1e-6)];
        let results = views.map(|v| answers_to_all(&scene, &v, size));
        for n in [3, 7] {
            exactly_wrong += wrongly_culled(&scene, &eye, size, n, &results[0]).len();
            let wrong = wrongly_culled(&scene, &eye, size, n, &results[1]);
            assert!(wrong.is_empty(), "seed {seed}, {n}x: {wrong:?}");
        }
        culled = [0, 1].map(|k| culled[k] + hidden(&results[k]));
    }
    println!("{exactly_wrong} boxes show between the samples of exact views; {culled:?} culled");
    assert!(exactly_wrong > 0, "the scenes show nothing between samples");
    assert!(culled[1] > 1000, "{culled:?}");
}
