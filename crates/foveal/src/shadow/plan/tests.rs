//! Which tiles a frame wants.

use super::*;
use crate::ShadowSizes;
use foveal_scene::Camera;

fn lamp(x: f32, range: f32) -> LightUniform {
    LightUniform {
        position: [x, 0.0, 0.0],
        range,
        seen_m: range,
        radiant: [1.0; 3],
        kind: 1,
        ..LightUniform::default()
    }
}

fn view_from(x: f32, y: f32, z: f32) -> ViewOfPlan {
    let camera = Camera::look_at(Vec3::new(x, y, z), Vec3::ZERO, Vec3::Y, 1.0);
    let settings = crate::testing::small(1280, 720);
    let eyes = crate::stereo::eyes(&settings, &camera).expect("a camera that makes sense");
    ViewOfPlan::new(&eyes, &settings, None)
}

fn room() -> Aabb {
    Aabb::new(Vec3::splat(-20.0), Vec3::splat(20.0))
}

fn area(plan: &Plan) -> u64 {
    plan.wanted.iter().map(|w| unit_area(w.level)).sum()
}

#[test]
fn a_light_has_larger_tiles_the_nearer_it_is() {
    let level = |z| {
        let plan = Plan::new(&[lamp(0.0, 4.0)], &view_from(0.0, 0.0, z), &room(), 12);
        plan.wanted.iter().map(|w| w.level).max().unwrap()
    };
    assert!(level(6.0) > level(24.0));
    assert!(level(24.0) > level(96.0));
    assert!(level(1e5) == LEAST_LEVEL);
}

#[test]
fn all_tiles_fit_whatever_the_number_of_lights() {
    for count in [1, 10, 200, 3_000, 16_000] {
        let lights: Vec<_> = (0..count).map(|i| lamp(i as f32 * 1e-3, 6.0)).collect();
        for atlas_level in [8, 12] {
            let plan = Plan::new(&lights, &view_from(0.0, 0.0, 5.0), &room(), atlas_level);
            assert!(area(&plan) <= unit_area(atlas_level), "{count} lights");
            assert!(plan.wanted.is_sorted_by_key(|w| w.slot));
            let least = count as usize * 4 * usize::from(plan.left_out.is_empty());
            assert!(plan.wanted.len() >= least, "{count} lights");
            let is_full = area(&plan) == unit_area(atlas_level);
            assert!(plan.left_out.is_empty() || is_full);
        }
    }
}

#[test]
fn all_lights_shrink_alike() {
    let lights: Vec<_> = (0..400).map(|i| lamp(i as f32 * 1e-3, 6.0)).collect();
    let plan = Plan::new(&lights, &view_from(0.0, 0.0, 5.0), &room(), 11);
    let levels = || plan.wanted.iter().map(|w| w.level);
    assert_eq!(levels().min(), levels().max());
    assert!(plan.shrunk_by > 0.0);
}

#[test]
fn in_a_full_atlas_a_step_changes_few_sizes() {
    let lights: Vec<_> = (0..400)
        .map(|i| lamp(0.05 * i as f32 - 10.0, 1.0 + 0.01 * i as f32))
        .collect();
    let levels = |z| {
        let plan = Plan::new(&lights, &view_from(0.0, 0.0, z), &room(), 11);
        assert!(plan.shrunk_by > 0.5);
        let levels = plan.wanted.iter().map(|w| (w.slot, w.level));
        levels.collect::<BTreeSet<_>>()
    };
    let mut before = levels(6.0);
    for step in 1..40 {
        let now = levels(6.0 + 0.1 * step as f32);
        let new = now.difference(&before).count();
        assert!(new * 5 < now.len(), "{new} of {}", now.len());
        before = now;
    }
}

#[test]
fn cascades_shrink_after_the_tiles_of_lamps() {
    let sun = LightUniform {
        kind: 0,
        direction: [0.0, -1.0, 0.0],
        radiant: [1.0; 3],
        ..LightUniform::default()
    };
    let plan = |count: usize| {
        let lamps = (0..count).map(|i| lamp(i as f32 * 1e-3, 6.0));
        let lights: Vec<_> = std::iter::once(sun).chain(lamps).collect();
        Plan::new(&lights, &view_from(0.0, 0.0, 5.0), &room(), 12)
    };
    let sizes = |plan: &Plan| [0, 4].map(|tile| plan.wanted[tile].level);
    let halved = plan(40);
    assert!(halved.shrunk_by >= CASCADES_LAST);
    let [cascade, side] = sizes(&halved);
    assert!(cascade == LARGEST_CASCADE && side < LARGEST_SIDE);
    let much = plan(800);
    assert!(sizes(&much)[0] < LARGEST_CASCADE);
}

/// Wants of 40 lights in a wall, seen with the gaze at a place of the picture.
fn wanted_at(gaze: [f32; 2], sizes: ShadowSizes) -> Vec<Wanted> {
    let lights: Vec<_> = (0..40)
        .map(|i| lamp((i % 20) as f32 - 9.5, 1.0 + (i / 20) as f32))
        .collect();
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 9.0), Vec3::ZERO, Vec3::Y, 1.0);
    let settings = crate::testing::small(1280, 720).with(|s| {
        s.eye.gaze = gaze;
        s.eye.quality_jod = 9.0;
    });
    let eyes = crate::stereo::eyes(&settings, &camera).expect("a camera that makes sense");
    let rates = FinestRate::new(&settings, &eyes).filter(|_| sizes == ShadowSizes::Rate);
    let view = ViewOfPlan::new(&eyes, &settings, rates);
    Plan::new(&lights, &view, &room(), 12).wanted
}

#[test]
fn tiles_are_coarser_where_samples_are_and_as_fine_as_ever_at_the_gaze() {
    let at = |gaze| wanted_at(gaze, ShadowSizes::Rate);
    let by_view = wanted_at([0.5, 0.5], ShadowSizes::View);
    assert!(by_view.iter().all(|w| !w.follows_rate));
    let area = |wanted: &[Wanted]| wanted.iter().map(|w| unit_area(w.level)).sum::<u64>();
    for gaze in [[0.5, 0.5], [0.1, 0.5]] {
        let by_rate = at(gaze);
        assert!(2 * area(&by_rate) < area(&by_view), "{gaze:?}");
        for (rate, view) in by_rate.iter().zip(&by_view) {
            assert_eq!(rate.slot, view.slot);
            assert!(rate.level <= view.level);
            assert_eq!(rate.follows_rate, rate.level < view.level);
            // The light that the eye looks at.
            let Volume::Pyramid { apex, .. } = rate.volume else {
                panic!("{:?}", rate.volume);
            };
            let ndc = apex.x / (9.0 * 0.5_f32.tan() * 1280.0 / 720.0);
            if (0.5 + 0.5 * ndc - gaze[0]).abs() < 0.03 {
                assert_eq!(rate.level, view.level, "{apex}");
            }
        }
    }
}

#[test]
fn few_tiles_change_where_the_gaze_moves_a_little() {
    let at = |x: f32| wanted_at([x, 0.5], ShadowSizes::Rate);
    let mut changes = 0;
    let steps = 100;
    for step in 0..steps {
        // About a fifth of a degree.
        let (a, b) = (at(0.4 + step as f32 * 2e-3), at(0.402 + step as f32 * 2e-3));
        assert_eq!(a, at(0.4 + step as f32 * 2e-3));
        changes += a.iter().zip(&b).filter(|(a, b)| a.level != b.level).count();
    }
    let tiles = at(0.5).len();
    assert!(
        changes > 0 && changes * 50 < tiles * steps,
        "{changes} of {tiles}"
    );
}

#[test]
fn cascades_hold_the_scene_and_stay_while_the_eye_moves_a_little() {
    let sun = LightUniform {
        kind: 0,
        direction: Vec3::new(0.3, -0.8, 0.2).normalize().to_array(),
        ..lamp(0.0, 0.0)
    };
    let plan = |x| Plan::new(&[sun], &view_from(x, 1.0, 9.0), &room(), 12).wanted;
    let wanted = plan(0.0);
    assert_eq!(wanted.len(), CASCADES);
    let last = wanted[CASCADES - 1].volume.clip_from_world(1024.0);
    for corner in room().corners() {
        let clip = last * corner.extend(1.0);
        assert!(clip.truncate().truncate().abs().max_element() < 1.0);
        assert!(clip.z > 0.0 && clip.z < 1.0);
    }
    let moves = (0..100).filter(|&i| plan(i as f32 * 1e-3) != plan((i + 1) as f32 * 1e-3));
    assert!(moves.count() <= 3);
}

#[test]
fn an_eye_outside_the_scene_has_the_cascades_of_the_place_nearest_to_it() {
    let sun = LightUniform {
        kind: 0,
        direction: [0.0, -1.0, 0.0],
        radiant: [1.0; 3],
        ..LightUniform::default()
    };
    let plan = |z| Plan::new(&[sun], &view_from(0.0, 1.0, z), &room(), 12).wanted;
    let there = plan(20.0);
    for z in [30.0, 100.0, 1e4] {
        assert_eq!(plan(z), there, "{z}");
    }
}

#[test]
fn wide_points_beside_the_picture_have_shadows_where_they_reach_into_it() {
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 10.0), Vec3::ZERO, Vec3::Y, 0.5);
    let wanted = |point_size_px| {
        let settings = crate::testing::small(400, 400).with(|s| {
            s.geometry.point_size_px = point_size_px;
        });
        let eyes = crate::stereo::eyes(&settings, &camera).expect("a camera that makes sense");
        let view = ViewOfPlan::new(&eyes, &settings, None);
        // The picture ends at 2.55 metres, and a pixel is 13 mm wide.
        let plan = Plan::new(&[lamp(2.8, 0.1)], &view, &room(), 12);
        plan.wanted.len()
    };
    assert!(wanted(1.0) == 0 && wanted(32.0) > 0);
}

#[test]
fn tiles_that_lose_or_find_room_are_known() {
    let lamps = |near: i32| -> Vec<_> {
        let range = |i: i32| if i / 50 == near { 2.0 } else { 1.0 };
        (0..100).map(|i| lamp(1e-3 * i as f32, range(i))).collect()
    };
    // Room for 256 tiles.
    let plan = |near| Plan::new(&lamps(near), &view_from(0.0, 0.0, 9.0), &room(), 8);
    let (before, after) = (plan(0), plan(1));
    let slots = |of: &Plan, wanted: &[Wanted]| -> Vec<u32> {
        of.left_out_of(wanted).map(|want| want.slot).collect()
    };
    let (lost, found) = (slots(&after, &before.wanted), slots(&before, &after.wanted));
    assert!(!lost.is_empty() && lost.len() == found.len());
    assert!(lost.iter().all(|slot| slot / 6 < 50) && found.iter().all(|slot| slot / 6 >= 50));
    assert!(slots(&before, &before.wanted).is_empty());
    assert!(before.lights_left_out() > 0);
}
