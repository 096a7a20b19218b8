//! What is culled is never visible, whatever the scene, the view, the resolution or the order.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Random, Scene, answers, eye, farthest_in_pixels, occluders, scene, wrongly_culled};
use foveal_cull::{
    Culler, Eye, FrameOptions, InstructionSet, OccludeeTree, SingleThread, View, Visibility,
    WorkerThreads,
};
use glam::{DAffine3, DVec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn size(r: &mut Random) -> (u32, u32) {
    (8 + r.below(90) as u32, 8 + r.below(60) as u32)
}

fn culls_nothing_visible(
    seed: u64,
    orthographic: bool,
    origin: DVec3,
) -> Result<usize, TestCaseError> {
    culls_nothing_visible_in(None, seed, orthographic, origin)
}

/// In a buffer of this size, or of any.
fn culls_nothing_visible_in(
    buffer: Option<(u32, u32)>,
    seed: u64,
    orthographic: bool,
    origin: DVec3,
) -> Result<usize, TestCaseError> {
    let mut r = Random::new(seed);
    let objects = 1 + r.below(7);
    let scene = scene(&mut r, objects, 150, origin);
    let eye = eye(&mut r, origin, orthographic);
    let of_any = size(&mut r);
    let (w, h) = buffer.unwrap_or(of_any);
    let set = occluders(&scene, &(0..objects).collect::<Vec<_>>());
    let mut culler = Culler::new(w, h).unwrap();
    let all = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    culler
        .rasterize(&View::mono(eye), &set, &all, &SingleThread)
        .unwrap();
    let mut results = vec![Visibility::Visible; scene.boxes.len()];
    culler
        .query(&scene.boxes, scene.origin, &mut results)
        .unwrap();
    let mut depth = vec![0.0; (w * h) as usize];
    culler.read_depth(&mut depth).unwrap();
    for n in [1, 4] {
        let farthest = farthest_in_pixels(&scene, &eye, (w, h), n);
        for (i, (claimed, farthest)) in depth.iter().zip(farthest).enumerate() {
            prop_assert!(
                *claimed <= farthest,
                "seed {seed}, {n}x: pixel {i} of {w} x {h} claims {claimed}, the reference has {farthest}"
            );
        }
        let wrong = wrongly_culled(&scene, &eye, (w, h), n, &results);
        prop_assert!(
            wrong.is_empty(),
            "seed {}, {}x: {:?} {:?}",
            seed,
            n,
            &wrong,
            wrong
                .iter()
                .map(|&i| (scene.boxes[i], results[i]))
                .collect::<Vec<_>>()
        );
    }
    Ok(hidden(&results))
}

fn see_nothing_culled(
    scene: &Scene,
    eyes: &[Eye],
    size: (u32, u32),
    results: &[Visibility],
) -> Result<(), TestCaseError> {
    for (eye, n) in eyes.iter().flat_map(|e| [(e, 1), (e, 4)]) {
        let wrong = wrongly_culled(scene, eye, size, n, results);
        prop_assert!(
            wrong.is_empty(),
            "{}x: {:?} {:?}",
            n,
            &wrong,
            wrong
                .iter()
                .map(|&i| (scene.boxes[i], results[i]))
                .collect::<Vec<_>>()
        );
    }
    Ok(())
}

fn hidden(results: &[Visibility]) -> usize {
    results
        .iter()
        .filter(|r| **r == Visibility::Occluded)
        .count()
}

fn culls_nothing_visible_around(seed: u64) -> Result<(), TestCaseError> {
    let mut r = Random::new(seed);
    let objects = 1 + r.below(6);
    let scene = scene(&mut r, objects, 150, DVec3::ZERO);
    let center = eye(&mut r, DVec3::ZERO, seed.is_multiple_of(5));
    let size = size(&mut r);
    let radius = [0.005, 0.03, 0.2][r.below(3)];
    let view = View::mono(center).with_validity_radius(radius);
    let results = answers_to_all(&scene, &view, size);
    let eyes = [0, 1, 2].map(|k| {
        let far = if k == 0 { 1.0 } else { r.next() };
        let step = r.vec(1.0).normalize() * (radius * far);
        let pose = DAffine3::from_translation(step) * DAffine3::from(center.world_from_eye);
        Eye::new(pose, center.projection)
    });
    see_nothing_culled(&scene, &eyes, size, &results)
}

/// Gives how many boxes are hidden from one eye, and from both.
fn culls_nothing_that_either_eye_sees(seed: u64) -> Result<[usize; 2], TestCaseError> {
    let mut r = Random::new(seed);
    let objects = 1 + r.below(6);
    let scene = scene(&mut r, objects, 150, DVec3::ZERO);
    let left = eye(&mut r, DVec3::ZERO, false);
    // The other eye: beside it, turned a little outwards, with its own asymmetric frustum.
    let cant = DAffine3::from_rotation_y(r.range(-0.15, 0.15));
    let apart = DAffine3::from_translation(DVec3::new(0.063, 0.0, 0.0));
    let mut right = eye(&mut r, DVec3::ZERO, false);
    right.world_from_eye = (DAffine3::from(left.world_from_eye) * apart * cant).into();
    let size = size(&mut r);
    let results = answers_to_all(&scene, &View::stereo(left, right), size);
    see_nothing_culled(&scene, &[left, right], size, &results)?;
    let of_one = answers_to_all(&scene, &View::mono(left), size);
    Ok([hidden(&of_one), hidden(&results)])
}

/// Answers where fine detail is not left out.
fn answers_to_all(scene: &Scene, view: &View, (w, h): (u32, u32)) -> Vec<Visibility> {
    let all = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    let set = occluders(scene, &(0..scene.objects.len()).collect::<Vec<_>>());
    let mut culler = Culler::new(w, h).unwrap();
    culler.rasterize(view, &set, &all, &SingleThread).unwrap();
    let mut results = vec![Visibility::Visible; scene.boxes.len()];
    culler
        .query(&scene.boxes, scene.origin, &mut results)
        .unwrap();
    results
}

proptest! {
    // The same scenes every time; other ones are for `soak`.
    #![proptest_config(ProptestConfig { cases: 1000, rng_seed: RngSeed::Fixed(20), ..ProptestConfig::default() })]

    #[test]
    fn perspective_views_cull_nothing_visible(seed in any::<u64>()) {
        culls_nothing_visible(seed, false, DVec3::ZERO)?;
    }

    #[test]
    fn orthographic_views_cull_nothing_visible(seed in any::<u64>()) {
        culls_nothing_visible(seed, true, DVec3::ZERO)?;
    }

    #[test]
    fn a_million_metres_from_the_origin_nothing_visible_is_culled(seed in any::<u64>()) {
        culls_nothing_visible(seed, seed % 4 == 0, DVec3::new(1e6, -2e5, 3e6))?;
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
        culls_nothing_visible_around(seed)?;
    }

    #[test]
    fn what_either_eye_sees_is_not_culled(seed in any::<u64>()) {
        culls_nothing_that_either_eye_sees(seed)?;
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

/// `SCENES=100000 FIRST=0 cargo test -p foveal-cull --test safety soak -- --ignored`: about 2 ms
/// each.
#[test]
#[ignore = "as long as one likes"]
fn soak() {
    let number = |name: &str, default: u64| {
        std::env::var(name).map_or(default, |v| v.parse().expect("a whole number"))
    };
    let first = number("FIRST", 0);
    for i in first..first + number("SCENES", 10_000) {
        let seed = (i + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        culls_nothing_visible(seed, false, DVec3::ZERO).unwrap();
        culls_nothing_visible(seed, true, DVec3::ZERO).unwrap();
        culls_nothing_visible(seed, i % 4 == 0, DVec3::new(1e6, -2e5, 3e6)).unwrap();
        culls_nothing_visible_around(seed).unwrap();
        culls_nothing_that_either_eye_sees(seed).unwrap();
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
