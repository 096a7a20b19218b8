//! What is learned about occluders makes frames cheaper and never wrong.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::promise::size;
use common::{Random, eye, occluders, scene, wrongly_culled};
use core::sync::atomic::{AtomicU64, Ordering};
use foveal_cull::{
    Aabb, Affine, Budget, CullError, CullStats, Culler, FrameOptions, InstructionSet, OccludeeSet,
    OccluderMesh, OccluderSet, OccluderUsefulness, SingleThread, Threads, View, Visibility,
    WorkerThreads, testing,
};
use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::sync::Arc;

/// One camera, and what it has learned.
struct Learner {
    culler: Culler,
    usefulness: OccluderUsefulness,
}

impl Learner {
    fn new(width_px: u32, height_px: u32) -> Self {
        Self {
            culler: Culler::new(width_px, height_px).unwrap(),
            usefulness: OccluderUsefulness::new(),
        }
    }

    fn frame(
        &mut self,
        view: &View,
        set: &OccluderSet,
        boxes: &[Aabb],
        budget: Option<Budget<'_>>,
        threads: &dyn Threads,
    ) -> Vec<Visibility> {
        let options = FrameOptions::default()
            .with_occluder_pixels_per_quad(0.0)
            .with_usefulness(Some(&self.usefulness))
            .with_budget(budget);
        self.culler.rasterize(view, set, &options, threads).unwrap();
        let mut results = vec![Visibility::Visible; boxes.len()];
        self.culler.query(boxes, [0.0; 3], &mut results).unwrap();
        self.usefulness
            .observe(&self.culler, boxes, [0.0; 3], &results)
            .unwrap();
        self.usefulness.learn(&self.culler, set);
        results
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, rng_seed: RngSeed::Fixed(31), ..ProptestConfig::default() })]

    #[test]
    fn nothing_visible_is_culled_and_threads_and_instruction_sets_change_nothing(seed in any::<u64>()) {
        let mut r = Random::new(seed);
        let objects = 1 + r.below(9);
        let scene = scene(&mut r, objects, 60, DVec3::ZERO);
        let set = occluders(&scene, &(0..objects).collect::<Vec<_>>());
        let (w, h) = size(&mut r);
        let workers = WorkerThreads::new(2);
        let eyes: Vec<_> = (0..3).map(|_| eye(&mut r, DVec3::ZERO, seed % 4 == 0)).collect();
        let mut one = Learner::new(w, h);
        let mut two = Learner::new(w, h);
        let mut plain = Learner::new(w, h);
        plain.culler.set_instruction_set(InstructionSet::Portable);
        for frame in 0..90 {
            let eye = eyes[frame / 30];
            let view = View::mono(eye);
            let results = one.frame(&view, &set, &scene.boxes, None, &SingleThread);
            let by_two = two.frame(&view, &set, &scene.boxes, None, &workers);
            prop_assert_eq!(&results, &by_two);
            let by_plain = plain.frame(&view, &set, &scene.boxes, None, &SingleThread);
            prop_assert_eq!(&results, &by_plain);
            if frame % 15 == 14 {
                for n in [1, 4] {
                    prop_assert!(wrongly_culled(&scene, &eye, (w, h), n, &results).is_empty());
                }
            }
        }
    }
}

fn view() -> View {
    View::perspective([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], 1.2, 1.78, 0.1)
}

/// A wall, 4 m wide and 2 m high, at each of some places.
fn walls(places: &[[f64; 3]]) -> OccluderSet {
    let wall = Aabb::new([-2.0, -1.0, -0.1], [2.0, 1.0, 0.1]);
    let wall = Arc::new(OccluderMesh::from_box(wall).unwrap());
    let mut set = OccluderSet::new();
    for place in places {
        let place = Affine::from_translation(*place);
        set.add(wall.clone(), place).unwrap();
    }
    set
}

/// A box 8 m away that a wall 5 m away hides if it stands at `x_m`.
fn behind(x_m: f32) -> Aabb {
    let x = x_m * 1.6;
    Aabb::new([x - 0.5, -0.5, -8.5], [x + 0.5, 0.5, -7.5])
}

#[test]
fn what_hides_nothing_is_left_out_until_it_would_hide_something() {
    let set = walls(&[[-2.5, 0.0, -5.0], [2.5, 0.0, -5.0]]);
    let mut learner = Learner::new(320, 180);
    let left = [behind(-2.5)];
    let mut drawn = Vec::new();
    for _ in 0..60 {
        let results = learner.frame(&view(), &set, &left, None, &SingleThread);
        assert_eq!(results, [Visibility::Occluded]);
        let stats = learner.culler.stats();
        drawn.push(stats.occluder_models_rasterized);
        let all = stats.clusters_rasterized + stats.clusters_not_useful;
        assert_eq!(all, 2, "{stats:?}");
    }
    assert!(drawn[..6].iter().all(|n| *n == 2), "{drawn:?}");
    assert!(
        drawn[6..].iter().filter(|n| **n == 1).count() > 45,
        "{drawn:?}"
    );
    assert!(
        drawn[6..].contains(&2),
        "it is never looked at again: {drawn:?}"
    );

    // Something comes behind the other wall.
    let both = [behind(-2.5), behind(2.5)];
    let hides = |learner: &mut Learner| {
        let results = learner.frame(&view(), &set, &both, None, &SingleThread);
        results == [Visibility::Occluded; 2]
    };
    let waited = (0..60).take_while(|_| !hides(&mut learner)).count();
    assert!((1..=28).contains(&waited), "{waited}");
    assert!((0..60).all(|_| hides(&mut learner)), "it stays");

    // All is forgotten.
    learner.usefulness.forget();
    learner.frame(&view(), &set, &left, None, &SingleThread);
    assert_eq!(learner.culler.stats().occluder_models_rasterized, 2);
}

#[test]
fn another_occluder_in_the_same_slot_is_not_known() {
    let mut set = walls(&[[-2.5, 0.0, -5.0]]);
    let other = set
        .add(
            Arc::new(
                OccluderMesh::from_box(Aabb::new([-2.0, -1.0, -0.1], [2.0, 1.0, 0.1])).unwrap(),
            ),
            Affine::from_translation([2.5, 0.0, -5.0]),
        )
        .unwrap();
    let mut learner = Learner::new(320, 180);
    let left = [behind(-2.5)];
    for _ in 0..30 {
        learner.frame(&view(), &set, &left, None, &SingleThread);
    }
    assert_eq!(learner.culler.stats().occluder_models_rasterized, 1);
    let mesh = set.mesh(other).unwrap().clone();
    set.remove(other).unwrap();
    // Learning about a frame whose occluders are gone by now does no harm.
    learner.frame(&view(), &set, &left, None, &SingleThread);
    set.add(mesh, Affine::from_translation([2.5, 0.0, -5.0]))
        .unwrap();
    learner.frame(&view(), &set, &left, None, &SingleThread);
    assert_eq!(learner.culler.stats().occluder_models_rasterized, 2);
    let empty = OccluderSet::new();
    learner.usefulness.learn(&learner.culler, &empty);
}

/// A clock that goes on by a microsecond whenever it is read: once for 16 clusters.
#[test]
fn within_a_budget_those_are_drawn_that_hide_most() {
    // A hundred walls in front that hide nothing, and one farther away that does.
    let mut places: Vec<[f64; 3]> = (0..100)
        .map(|i| [8.0, 0.04 * f64::from(i) - 2.0, -6.0])
        .collect();
    places.push([-4.5, 0.0, -9.0]);
    let set = walls(&places);
    let boxes = [Aabb::new([-7.0, -0.5, -15.0], [-6.0, 0.5, -14.0])];
    let time = AtomicU64::new(0);
    let clock = || time.fetch_add(1000, Ordering::Relaxed);
    let mut learner = Learner::new(320, 180);
    let budget = || Some(Budget::new(&clock, time.load(Ordering::Relaxed) + 3000));
    let mut most_left_out = 0;
    let results: Vec<Visibility> = (0..20)
        .map(|_| {
            let result = learner.frame(&view(), &set, &boxes, budget(), &SingleThread)[0];
            let stats = learner.culler.stats();
            most_left_out = most_left_out.max(stats.clusters_over_budget);
            result
        })
        .collect();
    assert_eq!(
        results[0],
        Visibility::Visible,
        "the nearest are drawn first"
    );
    assert!(most_left_out > 30, "{most_left_out}");
    let hidden = |r: &Visibility| *r == Visibility::Occluded;
    assert!(results[10..].iter().all(hidden), "{results:?}");
}

/// A frame that was held up for a quarter of an hour had ended all drawing for ever.
#[test]
fn a_frame_that_is_held_up_is_forgotten() {
    let set = walls(&[[-2.5, 0.0, -5.0], [2.5, 0.0, -5.0]]);
    let boxes = [behind(-2.5)];
    let (time, jump) = (AtomicU64::new(0), AtomicU64::new(0));
    let clock = || time.fetch_add(1000 + jump.swap(0, Ordering::Relaxed), Ordering::Relaxed);
    let mut learner = Learner::new(320, 180);
    let mut results = Vec::new();
    for frame in 0..60 {
        if frame % 20 == 0 {
            jump.store(1_000_000_000_000, Ordering::Relaxed);
        }
        let budget = Budget::new(&clock, time.load(Ordering::Relaxed) + 50_000);
        results.push(learner.frame(&view(), &set, &boxes, Some(budget), &SingleThread)[0]);
    }
    assert_eq!(results[59], Visibility::Occluded, "{results:?}");
}

#[test]
fn a_frame_of_which_nothing_is_known_teaches_nothing() {
    let set = walls(&[[-2.5, 0.0, -5.0], [2.5, 0.0, -5.0]]);
    let boxes = [behind(-2.5)];
    let mut culler = Culler::new(320, 180).unwrap();
    let mut usefulness = OccluderUsefulness::new();
    // Before any frame, and in frames without its option or without results.
    let hidden = [Visibility::Occluded];
    usefulness
        .observe(&culler, &boxes, [0.0; 3], &hidden)
        .unwrap();
    usefulness.learn(&culler, &set);
    for observes in [true, false] {
        for _ in 0..40 {
            let known = (!observes).then_some(&usefulness);
            let options = FrameOptions::default().with_usefulness(known);
            culler
                .rasterize(&view(), &set, &options, &SingleThread)
                .unwrap();
            if observes {
                usefulness
                    .observe(&culler, &boxes, [0.0; 3], &hidden)
                    .unwrap();
            }
            usefulness.learn(&culler, &set);
        }
    }
    let stats: CullStats = culler.stats();
    assert_eq!(
        (stats.occluder_models_rasterized, stats.clusters_not_useful),
        (2, 0)
    );
    let wrong = usefulness.observe(&culler, &boxes, [0.0; 3], &[]);
    assert!(
        matches!(wrong, Err(CullError::LengthMismatch { .. })),
        "{wrong:?}"
    );
}

#[test]
fn results_of_a_culler_of_another_size_teach_nothing_and_do_no_harm() {
    let set = walls(&[[-2.5, 0.0, -5.0], [2.5, 0.0, -5.0]]);
    let boxes = [behind(-2.5)];
    let mut one = Learner::new(320, 180);
    let mut other = Culler::new(150, 400).unwrap();
    for frame in 0..60 {
        let options = FrameOptions::default().with_usefulness(Some(&one.usefulness));
        other
            .rasterize(&view(), &set, &options, &SingleThread)
            .unwrap();
        one.culler
            .rasterize(&view(), &set, &options, &SingleThread)
            .unwrap();
        let hidden = [Visibility::Occluded];
        let [observed, learned] = if frame % 2 == 0 {
            [&one.culler, &other]
        } else {
            [&other, &one.culler]
        };
        one.usefulness
            .observe(observed, &boxes, [0.0; 3], &hidden)
            .unwrap();
        one.usefulness.learn(learned, &set);
        assert_eq!(one.culler.stats().clusters_not_useful, 0);
    }
}

#[test]
fn a_set_of_occludees_teaches_as_a_list_does() {
    let set = walls(&[[-2.5, 0.0, -5.0], [2.5, 0.0, -5.0]]);
    let mut objects = OccludeeSet::new([0.0; 3]);
    objects.insert(behind(-2.5));
    objects.rebuild();
    let mut culler = Culler::new(320, 180).unwrap();
    let mut usefulness = OccluderUsefulness::new();
    for _ in 0..30 {
        let options = FrameOptions::default().with_usefulness(Some(&usefulness));
        culler
            .rasterize(&view(), &set, &options, &SingleThread)
            .unwrap();
        let mut results = vec![Visibility::Visible; objects.result_count()];
        culler.query_set(&objects, &mut results).unwrap();
        usefulness.observe_set(&culler, &objects, &results).unwrap();
        usefulness.learn(&culler, &set);
    }
    assert_eq!(culler.stats().occluder_models_rasterized, 1);
}

/// Free places of a set have results too, which mean nothing. They had taken the turns of the box
/// that the wall hides.
#[test]
fn places_of_removed_occludees_teach_nothing() {
    let set = walls(&[[-2.5, 0.0, -5.0], [2.5, 0.0, -5.0]]);
    let mut objects = OccludeeSet::new([0.0; 3]);
    let ids: Vec<_> = (0..10_000).map(|_| objects.insert(behind(-2.5))).collect();
    for id in &ids[..8000] {
        objects.remove(*id).unwrap();
    }
    objects.rebuild();
    testing::prefer_tree(&mut objects);
    let mut culler = Culler::new(320, 180).unwrap();
    let mut usefulness = OccluderUsefulness::new();
    let mut results = vec![Visibility::Visible; objects.result_count()];
    for frame in 0..60 {
        let options = FrameOptions::default().with_usefulness(Some(&usefulness));
        culler
            .rasterize(&view(), &set, &options, &SingleThread)
            .unwrap();
        objects.refit();
        culler.query_set(&objects, &mut results).unwrap();
        let hidden = results[8000..].iter();
        let hidden = hidden.filter(|r| **r == Visibility::Occluded).count();
        assert_eq!(hidden, 2000, "frame {frame}");
        usefulness.observe_set(&culler, &objects, &results).unwrap();
        usefulness.learn(&culler, &set);
        // Stats have the objects that there are.
        culler.count_set(&objects, &results, None).unwrap();
        let stats = culler.stats();
        assert_eq!(
            (stats.occludees, stats.occludees_occluded),
            (2000, 2000),
            "frame {frame}"
        );
    }
}
