//! Occludees that come, move and go have the answers of a plain list.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Random, answers, assert_as_a_list, eye, occluders, scene, wrongly_culled};
use foveal_cull::{
    Aabb, CullError, Culler, OccludeeId, OccludeeSet, SingleThread, View, Visibility, testing,
};
use glam::{DVec3, Vec3};

fn moved(r: &mut Random, bounds: Aabb, reach: f64) -> Aabb {
    let by = r.vec(reach).as_vec3();
    Aabb::new(Vec3::from(bounds.min) + by, Vec3::from(bounds.max) + by)
}

#[test]
fn sets_that_change_have_the_answers_of_a_list() {
    let (mut culled, mut more, mut rebuilt) = (0, 0, 0);
    for seed in 0..24 {
        let mut r = Random::new(seed);
        let scene = scene(&mut r, 6, 600, DVec3::ZERO);
        let view = View::mono(eye(&mut r, DVec3::ZERO, seed % 4 == 3));
        let view = if seed % 6 == 1 {
            view.with_validity_radius(0.02)
        } else {
            view
        };
        let occluders = occluders(&scene, &[0, 1, 2, 3, 4, 5]);
        let mut culler = Culler::new(96, 64).unwrap();
        answers(&mut culler, &view, &occluders, &scene, &SingleThread);
        let mut set = OccludeeSet::new(DVec3::ZERO);
        let mut ids: Vec<OccludeeId> = Vec::new();
        let mut gone = Vec::new();
        let mut waiting = None;
        for step in 0..30 {
            let new = if step == 0 { 1200 } else { r.below(60) };
            for _ in 0..new {
                ids.push(set.insert(scene.boxes[r.below(600)]));
            }
            for _ in 0..r.below(80).min(ids.len()) {
                let id = ids[r.below(ids.len())];
                let bounds = match r.below(40) {
                    0 => Aabb::new([f32::NAN; 3], [1.0; 3]),
                    1 => scene.boxes[r.below(600)],
                    _ => moved(&mut r, set.bounds(id).unwrap(), 0.4),
                };
                set.set_bounds(id, bounds).unwrap();
            }
            for _ in 0..r.below(30).min(ids.len()) {
                let id = ids.swap_remove(r.below(ids.len()));
                set.remove(id).unwrap();
                gone.push(id);
            }
            // Without a refit too.
            if r.below(5) > 0 {
                set.refit();
            }
            // Built again at once, or while other things go on.
            match r.below(6) {
                0 => set.rebuild(),
                1 => waiting = Some(set.snapshot()),
                2 => {
                    if let Some(snapshot) = waiting.take() {
                        set.adopt(snapshot.build());
                        rebuilt += 1;
                    }
                }
                _ => {}
            }
            assert_eq!(
                (set.len(), set.is_empty()),
                (ids.len(), ids.is_empty()),
                "{step}"
            );
            let [c, m] = assert_as_a_list(&culler, &set, &ids);
            (culled, more) = (culled + c, more + m);
        }
        for id in gone {
            let unknown = CullError::UnknownOccludee;
            assert!(!set.contains(id));
            assert_eq!(set.remove(id), Err(unknown));
            assert_eq!(set.set_bounds(id, Aabb::EMPTY), Err(unknown));
            assert_eq!(set.bounds(id), Err(unknown));
        }
        let mut short = vec![Visibility::Visible; set.result_count() + 1];
        assert!(culler.query_set(&set, &mut short).is_err());
    }
    assert!(rebuilt > 20 && culled > 50_000, "{rebuilt} {culled}");
    assert!(more * 100 < culled, "{more} of {culled}");
}

/// Moves some objects far, and puts new ones into the slots of others.
fn churn(r: &mut Random, set: &mut OccludeeSet, ids: &mut [OccludeeId], boxes: &mut [Aabb]) {
    for (id, bounds) in ids.iter_mut().zip(boxes) {
        match r.below(4) {
            0 => {
                *bounds = moved(r, *bounds, 3.0);
                set.set_bounds(*id, *bounds).unwrap();
            }
            1 => {
                *bounds = moved(r, *bounds, 5.0);
                set.remove(*id).unwrap();
                *id = set.insert(*bounds);
            }
            _ => {}
        }
    }
}

#[test]
fn nothing_that_the_reference_sees_is_culled_after_moves_and_rebuilds() {
    let mut hidden = [0; 3];
    for seed in 0..24 {
        let mut r = Random::new(seed + 500);
        let mut scene = scene(&mut r, 6, 1300, DVec3::ZERO);
        let eye = eye(&mut r, DVec3::ZERO, seed % 4 == 3);
        let occluders = occluders(&scene, &[0, 1, 2, 3, 4, 5]);
        let mut set = OccludeeSet::new(DVec3::ZERO);
        let mut ids: Vec<OccludeeId> = scene.boxes.iter().map(|b| set.insert(*b)).collect();
        set.rebuild();
        testing::prefer_tree(&mut set);
        let mut culler = Culler::new(64, 48).unwrap();
        answers(
            &mut culler,
            &View::mono(eye),
            &occluders,
            &scene,
            &SingleThread,
        );
        for (round, hidden) in hidden.iter_mut().enumerate() {
            if round == 0 {
                for (id, bounds) in ids.iter().zip(&mut scene.boxes) {
                    if r.below(2) == 0 {
                        *bounds = moved(&mut r, *bounds, 0.6);
                        set.set_bounds(*id, *bounds).unwrap();
                    }
                }
                set.refit();
                assert!(!set.wants_rebuild(), "the hierarchy is used");
            } else {
                // Built before what follows: by this set, or by another one with the same ids.
                let mut other = OccludeeSet::new(DVec3::ZERO);
                for bounds in &scene.boxes {
                    other.insert(moved(&mut r, *bounds, 8.0));
                }
                let from = if round == 1 { &set } else { &other };
                let rebuild = from.snapshot().build();
                churn(&mut r, &mut set, &mut ids, &mut scene.boxes);
                set.adopt(rebuild);
                set.refit();
            }
            let mut results = vec![Visibility::Visible; set.result_count()];
            culler.query_set(&set, &mut results).unwrap();
            let results: Vec<Visibility> = ids.iter().map(|id| results[id.index()]).collect();
            for n in [1, 4] {
                let wrong = wrongly_culled(&scene, &eye, (64, 48), n, &results);
                assert!(wrong.is_empty(), "{seed}, {round}, {n}x: {wrong:?}");
            }
            let culled = |v: &&Visibility| **v == Visibility::Occluded;
            *hidden += results.iter().filter(culled).count();
        }
    }
    assert!(hidden.iter().all(|hidden| *hidden > 200), "{hidden:?}");
}

#[test]
fn a_set_wants_to_be_built_again_when_much_is_new_or_has_spread() {
    let mut r = Random::new(3);
    let scene = scene(&mut r, 1, 600, DVec3::ZERO);
    let mut set = OccludeeSet::new(DVec3::ZERO);
    let ids: Vec<OccludeeId> = scene.boxes.iter().map(|b| set.insert(*b)).collect();
    assert!(set.wants_rebuild(), "all are new");
    set.rebuild();
    assert!(!set.wants_rebuild());
    for id in &ids {
        let bounds = set.bounds(*id).unwrap();
        set.set_bounds(*id, moved(&mut r, bounds, 0.05)).unwrap();
    }
    set.refit();
    assert!(!set.wants_rebuild(), "hardly anything has moved");
    for id in &ids {
        let bounds = set.bounds(*id).unwrap();
        set.set_bounds(*id, moved(&mut r, bounds, 40.0)).unwrap();
    }
    set.refit();
    assert!(set.wants_rebuild(), "groups have spread");
    set.rebuild();
    assert!(!set.wants_rebuild());
}

#[test]
fn a_huge_box_takes_nobody_out_of_the_hierarchy() {
    for size in [1e38, 2e38, f32::MAX] {
        for axes in [[1.0, 1.0, 1.0], [1.0, 0.0, 0.0]] {
            let mut r = Random::new(11);
            let scene = scene(&mut r, 6, 1500, DVec3::ZERO);
            let view = View::mono(eye(&mut r, DVec3::ZERO, false));
            let occluders = occluders(&scene, &[0, 1, 2, 3, 4, 5]);
            let mut culler = Culler::new(96, 64).unwrap();
            answers(&mut culler, &view, &occluders, &scene, &SingleThread);
            let mut set = OccludeeSet::new(DVec3::ZERO);
            let ids: Vec<OccludeeId> = scene.boxes.iter().map(|b| set.insert(*b)).collect();
            let half = axes.map(|axis| (axis * size).max(0.1));
            let huge = Aabb::new(half.map(|h| -h), half);
            let of_huge = |culler: &Culler, set: &OccludeeSet| {
                let mut results = vec![Visibility::Occluded; set.result_count()];
                culler.query_set(set, &mut results).unwrap();
                assert_as_a_list(culler, set, &ids);
                results[ids[700].index()]
            };
            // Built with it, and grown later.
            set.set_bounds(ids[700], huge).unwrap();
            set.rebuild();
            assert_eq!(of_huge(&culler, &set), Visibility::Visible);
            set.set_bounds(ids[700], scene.boxes[700]).unwrap();
            set.rebuild();
            set.set_bounds(ids[700], huge).unwrap();
            set.refit();
            assert_eq!(of_huge(&culler, &set), Visibility::Visible);
        }
    }
}

#[test]
fn invalid_boxes_and_rebuilds_of_other_sets_do_no_harm() {
    let mut set = OccludeeSet::new(DVec3::ZERO);
    for _ in 0..300 {
        set.insert(Aabb::EMPTY);
    }
    set.rebuild();
    assert!(
        !set.wants_rebuild(),
        "building again would place none of them"
    );
    let mut other = OccludeeSet::new(DVec3::ZERO);
    for i in 0..2000 {
        let at = [i as f32, 0.0, 0.0];
        other.insert(Aabb::new(at, at.map(|v| v + 1.0)));
    }
    set.adopt(other.snapshot().build());
    assert_eq!(set.len(), 300);
}

#[test]
fn the_hierarchy_of_another_set_changes_no_answer() {
    let mut r = Random::new(17);
    let scene = scene(&mut r, 6, 3000, DVec3::ZERO);
    let view = View::mono(eye(&mut r, DVec3::ZERO, false));
    let occluders = occluders(&scene, &[0, 1, 2, 3, 4, 5]);
    let mut culler = Culler::new(96, 64).unwrap();
    answers(&mut culler, &view, &occluders, &scene, &SingleThread);
    let of = |boxes: &[Aabb]| {
        let mut set = OccludeeSet::new(DVec3::ZERO);
        let ids: Vec<OccludeeId> = boxes.iter().map(|b| set.insert(*b)).collect();
        (set, ids)
    };
    let (mut set, mut ids) = of(&scene.boxes[..1500]);
    set.rebuild();
    // The same ids for other boxes, some of them removed or used again in either set.
    let (mut other, others) = of(&scene.boxes[1500..2900]);
    for (k, id) in others.iter().enumerate().step_by(3) {
        other.remove(*id).unwrap();
        if k % 2 == 0 {
            other.insert(scene.boxes[k]);
        }
    }
    for _ in 0..200 {
        let id = ids.swap_remove(r.below(ids.len()));
        set.remove(id).unwrap();
        ids.extend((r.below(2) == 0).then(|| set.insert(scene.boxes[2900])));
    }
    set.adopt(other.snapshot().build());
    assert_eq!(set.len(), ids.len());
    assert_as_a_list(&culler, &set, &ids);
    for id in &ids {
        let bounds = set.bounds(*id).unwrap();
        set.set_bounds(*id, moved(&mut r, bounds, 0.4)).unwrap();
    }
    set.refit();
    assert_as_a_list(&culler, &set, &ids);
}

#[test]
fn ids_go_through_numbers_and_those_from_elsewhere_name_nothing() {
    let mut set = OccludeeSet::new([0.0; 3]);
    let first = set.insert(Aabb::new([0.0; 3], [1.0; 3]));
    set.remove(first).unwrap();
    let second = set.insert(Aabb::new([0.0; 3], [1.0; 3]));
    assert_eq!(first.index(), second.index(), "the slot is used again");
    assert_ne!(first.to_bits(), second.to_bits());
    assert_eq!(OccludeeId::from_bits(second.to_bits()), Some(second));
    assert_eq!(OccludeeId::from_bits(7), None, "no generation");
    for bits in [
        first.to_bits(),
        1 << 32 | 1,
        u64::MAX,
        2 << 32 | 0xffff_ffff,
    ] {
        let id = OccludeeId::from_bits(bits).unwrap();
        let unknown = CullError::UnknownOccludee;
        assert!(!set.contains(id), "{bits:x}");
        assert_eq!(set.bounds(id), Err(unknown));
        assert_eq!(set.set_bounds(id, Aabb::EMPTY), Err(unknown));
        assert_eq!(set.remove(id), Err(unknown));
    }
    assert!(set.contains(second));
}
