//! What the atlas keeps from frame to frame.

use super::*;
use crate::shadow::volume::cube_axes;
use glam::Vec3;

fn want(slot: u32, level: u32) -> Wanted {
    let volume = Volume::Pyramid {
        apex: Vec3::new(slot as f32, 0.0, 0.0),
        axes: cube_axes(slot % 6),
        tangent: 1.0,
        range: 2.0,
        near: 0.01,
    };
    Wanted {
        slot,
        level,
        volume,
        follows_rate: false,
    }
}

/// A slot's tile, of whatever size.
fn get(kept: &KeptTiles, slot: u32) -> Option<&Kept> {
    let mut tiles = kept.tiles.range((slot, 0)..(slot + 1, 0));
    tiles.next().map(|(_, kept)| kept)
}

fn place_of(kept: &KeptTiles, slot: u32) -> Option<Tile> {
    get(kept, slot).map(|k| k.tile)
}

#[test]
fn a_tile_keeps_its_place_and_what_it_holds() {
    let mut kept = KeptTiles::new(8);
    kept.place(&[want(0, 6), want(7, 5)], false);
    let places = [0, 7].map(|slot| place_of(&kept, slot));
    kept.drawn(&want(0, 6), Vec::new());
    kept.drawn(&want(7, 5), Vec::new());
    // One frame does not want it, one wants others beside it.
    kept.place(&[want(7, 5)], false);
    kept.place(&[want(0, 6), want(7, 5), want(9, 5)], false);
    assert_eq!([0, 7].map(|slot| place_of(&kept, slot)), places);
    assert!(get(&kept, 0).unwrap().is_drawn && !get(&kept, 9).unwrap().is_drawn);
    kept.place(&[want(0, 5), want(7, 5)], false);
    assert!(!get(&kept, 0).unwrap().is_drawn, "its size has changed");
    assert!(get(&kept, 7).unwrap().is_drawn);
}

#[test]
fn a_tile_of_another_size_waits_for_a_frame_that_wants_it_again() {
    let mut kept = KeptTiles::new(6);
    kept.place(&[want(0, 5), want(7, 4)], true);
    kept.drawn(&want(0, 5), Vec::new());
    kept.place(&[want(0, 4), want(7, 4)], true);
    assert!(!kept.get(&want(0, 4)).unwrap().is_drawn, "new");
    kept.place(&[want(0, 5), want(7, 4)], true);
    assert!(kept.get(&want(0, 5)).unwrap().is_drawn, "as before");
    // Something moves meanwhile.
    kept.place(&[want(0, 4), want(7, 4)], true);
    let at = Vec3::new(1.5, 0.0, 0.0);
    kept.disturb(&[Aabb::new(at, at + 0.1)]);
    kept.place(&[want(0, 5), want(7, 4)], true);
    assert!(!kept.get(&want(0, 5)).unwrap().is_drawn);
    // Where room is needed it gives way.
    let all = [want(0, 4), want(1, 5), want(2, 5), want(3, 5)];
    kept.place(&all, true);
    assert!(all.iter().all(|w| kept.get(w).is_some()));
    assert!(kept.get(&want(0, 5)).is_none());
    kept.place(&[want(0, 5)], false);
    assert!(kept.get(&want(0, 4)).is_none(), "not kept");
}

#[test]
fn the_tile_that_was_wanted_last_of_all_gives_way_first() {
    let mut kept = KeptTiles::new(6);
    kept.place(&[want(0, 5), want(1, 5)], false);
    kept.place(&[want(1, 5), want(2, 5), want(3, 5)], false);
    kept.place(&[want(4, 5)], false);
    assert!(get(&kept, 0).is_none());
    assert!([1, 2, 3, 4].iter().all(|&slot| get(&kept, slot).is_some()));
}

#[test]
fn scattered_squares_are_put_together() {
    let mut kept = KeptTiles::new(6);
    let all: Vec<_> = (0..16).map(|slot| want(slot, 4)).collect();
    kept.place(&all, false);
    for want in &all {
        kept.drawn(want, Vec::new());
    }
    // Four small ones stay, one in each quarter: no large one fits beside them.
    let stay = [0, 4, 8, 12].map(|slot| want(slot, 4));
    let drawn = |kept: &KeptTiles| {
        let is_drawn = |w: &&Wanted| kept.get(w).is_some_and(|k| k.is_drawn);
        stay.iter().filter(is_drawn).count()
    };
    let mut more = stay.to_vec();
    for (slots, left) in [(20..21, 3), (20..22, 2), (20..23, 1)] {
        more.truncate(4);
        more.extend(slots.map(|slot| want(slot, 5)));
        kept.place(&more, false);
        assert!(more.iter().all(|w| kept.get(w).is_some()));
        assert_eq!(drawn(&kept), left, "as few as possible are drawn again");
    }
}

proptest::proptest! {
    /// Whatever the frames want, all of it is placed without overlap where it fits by its area,
    /// and not all of it is placed anew.
    #[test]
    fn tiles_always_fit_and_most_stay(frames in proptest::collection::vec(
        proptest::collection::vec((0u32..60, 4u32..=7), 0..60), 1..20,
    )) {
        let mut kept = KeptTiles::new(8);
        kept.take_is_new();
        for wants in frames {
            let mut room = 1 << 16;
            let mut levels = BTreeMap::new();
            for (slot, level) in wants {
                let area = 1 << (2 * level);
                if area <= room && !levels.contains_key(&slot) {
                    room -= area;
                    levels.insert(slot, level);
                }
            }
            let wanted: Vec<_> = levels.iter().map(|(&slot, &level)| want(slot, level)).collect();
            kept.place(&wanted, false);
            let mut taken = std::collections::BTreeSet::new();
            for want in &wanted {
                let tile = kept.get(want).expect("placed").tile;
                proptest::prop_assert_eq!(tile.level, want.level);
                let cells = |at: u32| at / 16..(at + tile.side()) / 16;
                for cell in cells(tile.y).flat_map(|y| cells(tile.x).map(move |x| (x, y))) {
                    proptest::prop_assert!(taken.insert(cell));
                }
            }
            proptest::prop_assert!(!kept.take_is_new());
        }
    }
}

#[test]
fn what_moves_disturbs_the_tiles_that_see_it_alone() {
    let mut kept = KeptTiles::new(8);
    // Side 0 looks along x from 0, side 1 against it.
    kept.place(&[want(0, 5), want(1, 5)], false);
    kept.drawn(&want(0, 5), Vec::new());
    kept.drawn(&want(1, 5), Vec::new());
    let at = Vec3::new(1.5, 0.0, 0.0);
    kept.disturb(&[Aabb::new(at, at + 0.1)]);
    assert!(!get(&kept, 0).unwrap().is_drawn);
    assert!(get(&kept, 1).unwrap().is_drawn);
}

#[test]
fn frames_at_rest_end_restlessness() {
    let mut kept = KeptTiles::new(8);
    let at = Vec3::new(1.5, 0.0, 0.0);
    kept.place(&[want(0, 5)], false);
    kept.drawn(&want(0, 5), Vec::new());
    for (rests, is_restless) in [(0, false), (0, true), (2, false)] {
        (0..rests).for_each(|_| kept.rest());
        kept.disturb(&[Aabb::new(at, at + 0.1)]);
        kept.place(&[want(0, 5)], false);
        assert_eq!(get(&kept, 0).unwrap().is_restless, is_restless);
        kept.drawn(&want(0, 5), Vec::new());
    }
}

#[test]
fn what_a_tile_was_drawn_for_outlives_moves_of_casters_and_not_of_the_light() {
    let mut kept = KeptTiles::new(8);
    kept.place(&[want(0, 5)], false);
    kept.drawn(&want(0, 5), vec![3]);
    let received = Received::new(32.0, 1);
    kept.get_mut(&want(0, 5)).unwrap().received = Some(Box::new(received));
    let at = Vec3::new(1.5, 0.0, 0.0);
    let b = [Aabb::new(at, at + 0.1)];
    for (frame, is_restless) in [(1, false), (2, true), (3, true), (4, false)] {
        if frame == 4 {
            kept.place(&[want(0, 5)], false);
        }
        kept.disturb(&b);
        let tile = get(&kept, 0).unwrap();
        assert!(!tile.is_drawn && tile.received.is_some());
        assert!(!tile.light_moves);
        assert_eq!(tile.is_restless, is_restless, "frame {frame}");
        kept.place(&[want(0, 5)], false);
        kept.drawn(&want(0, 5), vec![3]);
    }
    let mut moved = want(0, 5);
    moved.volume = want(6, 5).volume;
    kept.place(&[moved], false);
    let tile = get(&kept, 0).unwrap();
    assert!(!tile.is_drawn && tile.received.is_none() && tile.light_moves);
}

#[test]
fn tiles_that_lack_casters_are_drawn_in_full_where_nobody_says_what_is_seen() {
    let mut kept = KeptTiles::new(8);
    kept.place(&[want(0, 5), want(1, 5)], false);
    kept.drawn(&want(0, 5), vec![3]);
    kept.drawn(&want(1, 5), Vec::new());
    kept.draw_in_full();
    assert!(!get(&kept, 0).unwrap().is_drawn && get(&kept, 0).unwrap().left_out.is_empty());
    assert!(get(&kept, 1).unwrap().is_drawn);
}

#[test]
fn a_tile_that_waits_shows_what_it_held_or_what_another_size_holds() {
    let mut kept = KeptTiles::new(8);
    assert!(kept.take_is_new() && !kept.take_is_new());
    let (small, large, other) = (want(0, 4), want(0, 6), want(1, 5));
    kept.place(&[small, other], true);
    assert_eq!(kept.urgency(&small), Urgency::Waits(AHEAD));
    assert!(!kept.drawn(&small, Vec::new()));
    kept.place(&[large, other], true);
    // Nobody looks into it, unless it waits.
    assert_eq!(kept.shown(&large), None);
    for frame in 0..3 {
        assert_eq!(kept.urgency(&large), Urgency::Waits(frame));
        assert_eq!(kept.urgency(&other), Urgency::Waits(AHEAD + frame));
        kept.wait(&large);
        kept.wait(&other);
        let of_small = Some((kept.get(&small).unwrap().tile, small.volume));
        assert_eq!(kept.shown(&large), of_small);
        assert_eq!(kept.shown(&other), None);
        kept.place(&[large, other], true);
    }
    // Another size of the slot has waited as long.
    assert_eq!(kept.waited(&want(0, 5)), 3);
    assert!(kept.drawn(&large, Vec::new()));
    let of_large = Some((kept.get(&large).unwrap().tile, large.volume));
    assert_eq!(kept.shown(&large), of_large);
    // Something has moved: another size that holds it is shown sooner than what it held itself.
    kept.get_mut(&large).unwrap().disturb(2, None);
    kept.place(&[large], true);
    assert_eq!(kept.urgency(&large), Urgency::Waits(0));
    kept.wait(&large);
    let of_small = Some((kept.get(&small).unwrap().tile, small.volume));
    assert_eq!(kept.shown(&large), of_small);
    kept.get_mut(&small).unwrap().disturb(2, None);
    assert_eq!(kept.shown(&large), of_large);
    // Frames that do not see it end its wait.
    kept.place(&[large], true);
    kept.place(&[large], true);
    assert_eq!((kept.waited(&large), kept.shown(&large)), (0, None));
    assert!(kept.drawn(&large, Vec::new()), "what was lit meanwhile");
}

#[test]
fn a_tile_of_a_light_that_has_moved_is_drawn_now_whatever_its_size() {
    let mut kept = KeptTiles::new(8);
    kept.place(&[want(0, 5)], true);
    kept.drawn(&want(0, 5), Vec::new());
    for level in [5, 6] {
        let moved = Wanted {
            volume: want(6, level).volume,
            ..want(0, level)
        };
        kept.place(&[moved], true);
        assert_eq!(kept.urgency(&moved), Urgency::Now);
        assert_eq!(kept.shown(&moved), None);
    }
}

#[test]
fn what_stands_in_keeps_its_place_while_it_does() {
    let mut kept = KeptTiles::new(6);
    let (small, large) = (want(0, 4), want(0, 5));
    kept.place(&[small, want(1, 5)], true);
    kept.drawn(&small, Vec::new());
    kept.drawn(&want(1, 5), Vec::new());
    kept.place(&[large], true);
    kept.wait(&large);
    kept.place(&[large], true);
    kept.wait(&large);
    // One of the other two must go: what nobody has looked at for longer.
    kept.place(&[large, want(2, 5), want(3, 5)], true);
    kept.wait(&large);
    assert!(kept.get(&want(1, 5)).is_none());
    assert!(kept.shown(&large).is_some());
}

#[test]
fn a_cascade_that_has_moved_with_the_eye_can_be_looked_into() {
    let [x, y, z] = cube_axes(0);
    let column = |center, radius, span| Volume::Column {
        axes: [x, y, z],
        center,
        radius,
        span,
    };
    let here = column([0.0, 1.0], 2.0, [0.0, 8.0]);
    assert!(column([0.5, 1.0], 2.0, [0.0, 8.0]).can_look_into(&here));
    assert!(column([0.0, 1.0], 4.0, [0.0, 8.0]).can_look_into(&here));
    assert!(!column([0.0, 1.0], 2.0, [0.0, 9.0]).can_look_into(&here));
    assert!(!want(0, 4).volume.can_look_into(&here));
    let [cx, cy, cz, r] = here.sphere();
    let middle = Vec3::new(cx, cy, cz);
    for (s, t, u) in [(-2.0, -2.0, 0.0), (2.0, 2.0, 8.0), (-2.0, 2.0, 8.0)] {
        let corner = x * s + y * (1.0 + t) + z * u;
        assert!((corner.distance(middle) - r).abs() < 1e-4, "{corner}");
    }
}
