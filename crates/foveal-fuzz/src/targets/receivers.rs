//! Receiver masks: no caster is left out whose shadow a receiver shows. The reference is lookups at
//! places: which texels they read, and which casters lie on those texels' rays before the places.

use foveal_cull::{Aabb, Eye, ReceiverMask, View, Visibility};
use glam::DVec3;

use super::scenes::{Random, Scene};
use crate::random::Choices;

/// Culls the boxes of a scene as casters that fall on themselves, and looks places up.
pub(super) fn shadows_stay(view: &View, scene: &Scene, choices: &mut Choices<'_>) {
    let map = ShadowMap {
        light: view.eye,
        side: choices.pick(&[1, 2, 7, 64, 100, 16_384]),
        texels: choices.pick(&[0.0, 2.0, 5.0, 1e9, f64::NAN]),
        metres: choices.pick(&[0.0, 0.1, -1.0, f64::INFINITY]),
    };
    let classes = [
        Visibility::Visible,
        Visibility::Outside,
        Visibility::Small,
        Visibility::Occluded,
    ];
    let few = choices.one_in(2);
    let mut some = || -> Vec<Visibility> {
        let mut class = |i: usize| {
            // A receiver in the way of all others would keep everything.
            let seen = if few {
                i.is_multiple_of(16)
            } else {
                i.is_multiple_of(2)
            };
            if seen {
                Visibility::Visible
            } else {
                choices.pick(&classes)
            }
        };
        (0..scene.boxes.len()).map(&mut class).collect()
    };
    let (mut received, before) = (some(), some());
    if few {
        let rest = received.iter_mut().enumerate();
        rest.filter(|(i, _)| !i.is_multiple_of(16))
            .for_each(|(_, v)| *v = Visibility::Occluded);
    }
    let Some((after, is_empty)) = map.cull(scene, &received, &before) else {
        return;
    };
    let bounds = |i: usize| &scene.boxes[i];
    let everywhere = |i: usize| received[i].is_visible() && !bounds(i).is_valid();
    let everywhere = (0..received.len()).any(everywhere);
    for (i, (before, after)) in before.iter().zip(&after).enumerate() {
        // A receiver falls on itself.
        let shades = everywhere || received[i].is_visible();
        let stays = if before.is_visible() {
            match after {
                Visibility::Visible => true,
                Visibility::Outside => bounds(i).is_valid(),
                Visibility::Occluded => bounds(i).is_valid() && !shades,
                Visibility::Small => false,
            }
        } else {
            before == after
        };
        assert!(stays, "{:?} was {before:?} and is {after:?}", bounds(i));
    }
    let left_out = LeftOut::new(&before, &after);
    let mut r = Random::new(choices.bits());
    let wrong = left_out.wrongly(&map, scene, &received, &mut r, 12);
    assert!(wrong.is_none(), "{map:?}: {}", wrong.unwrap_or_default());
    if is_empty {
        let looked = map.places(scene, &received, &left_out, &mut r, 12);
        assert!(looked.is_empty(), "{map:?} has no receiver at {looked:?}");
    }
}

/// A shadow map, and how far from a place lookups read it.
#[derive(Clone, Copy, Debug)]
struct ShadowMap {
    light: Eye,
    side: u32,
    texels: f64,
    metres: f64,
}

/// A place as the light sees it: texels from the map's left and upper edge, and metres along the
/// light's axis.
#[derive(Clone, Copy, Debug)]
struct Lookup {
    at: [f64; 2],
    along: f64,
}

/// A line through the middle of a texel: places `start + direction * along`.
struct Ray {
    start: DVec3,
    direction: DVec3,
}

impl ShadowMap {
    /// What the mask makes of results, and whether it is empty; None where there can be no mask.
    fn cull(
        &self,
        scene: &Scene,
        received: &[Visibility],
        before: &[Visibility],
    ) -> Option<(Vec<Visibility>, bool)> {
        let mask = ReceiverMask::new(&View::mono(self.light), self.side).ok()?;
        let mut mask = mask.with_reach(self.texels, self.metres);
        let mut after = before.to_vec();
        let entered = mask.receive(&scene.boxes, scene.origin, received);
        let culled = mask.cull(&scene.boxes, scene.origin, &mut after);
        assert!(entered.is_ok() && culled.is_ok());
        Some((after, mask.is_empty()))
    }

    /// The light's right, up and forward axis.
    fn axes(&self) -> [DVec3; 3] {
        let a = self.light.world_from_eye;
        let [right, up, back] = [a.x_axis, a.y_axis, a.z_axis].map(DVec3::from);
        [right, up, -back]
    }

    /// A place relative to the light; None beside the map, before the near plane and beyond the far
    /// one.
    fn lookup(&self, place: DVec3) -> Option<Lookup> {
        let [x, y, along] = self.axes().map(|axis| axis.dot(place));
        let [left, right, bottom, top] = self.light.projection.extents();
        let [near, far] = self.light.projection.near_far_m();
        let w = if self.light.projection.is_orthographic() {
            1.0
        } else {
            along
        };
        let at = [
            (x / w - left) / (right - left),
            (top - y / w) / (top - bottom),
        ]
        .map(|v| v * f64::from(self.side));
        let on = at.iter().all(|v| (0.0..f64::from(self.side)).contains(v));
        (on && along >= near && along <= far).then_some(Lookup { at, along })
    }

    /// The ray through the middle of a texel.
    fn ray(&self, texel: [f64; 2]) -> Ray {
        let [left, right, bottom, top] = self.light.projection.extents();
        let [u, v] = texel.map(|t| (t + 0.5) / f64::from(self.side));
        let [x_axis, y_axis, forward] = self.axes();
        let beside = x_axis * (left + (right - left) * u) + y_axis * (top + (bottom - top) * v);
        if self.light.projection.is_orthographic() {
            Ray {
                start: beside,
                direction: forward,
            }
        } else {
            Ray {
                start: DVec3::ZERO,
                direction: beside + forward,
            }
        }
    }

    /// A texel that a lookup reads: any of them, or the nearest one to another place's texel.
    fn read(&self, lookup: Lookup, towards: Option<Lookup>, r: &mut Random) -> [f64; 2] {
        let last = f64::from(self.side - 1);
        // NaN is none.
        let reach = self.texels.max(0.0).min(last).floor();
        core::array::from_fn(|i| {
            let own = lookup.at[i].floor();
            let by = match towards {
                Some(other) => (other.at[i].floor() - own).clamp(-reach, reach),
                None => r.range(-reach, reach).round(),
            };
            (own + by).clamp(0.0, last)
        })
    }

    /// Places in the receivers, moved as far as lookups may be: some anywhere, some behind casters
    /// that were left out.
    fn places(
        &self,
        scene: &Scene,
        received: &[Visibility],
        left_out: &LeftOut,
        r: &mut Random,
        each: usize,
    ) -> Vec<Lookup> {
        let metres = self.metres.clamp(0.0, 3.0);
        let from = scene.origin - DVec3::from(self.light.world_from_eye.translation);
        let boxes = scene.boxes.iter().zip(received);
        let receivers = boxes.filter(|(bounds, v)| v.is_visible() && bounds.is_valid());
        let mut places = Vec::new();
        for (bounds, _) in receivers {
            let corners = corners(bounds, from);
            for n in 0..each {
                let mut place = point_in(corners, r);
                if n % 2 == 1 && !left_out.0.is_empty() {
                    let caster = left_out.0[r.below(left_out.0.len())];
                    let through = point_in(self::corners(&scene.boxes[caster], from), r);
                    let behind = self.lookup(through).and_then(|lookup| {
                        let ray = self.ray(lookup.at.map(|v| v - 0.5));
                        let [_, exit] = ray.meets(corners)?;
                        Some(ray.start + ray.direction * exit)
                    });
                    place = behind.unwrap_or(place);
                }
                // Within the ball.
                let moved = r.vec(1.0).normalize_or_zero() * metres * r.next();
                places.extend(self.lookup(place + moved));
            }
        }
        places
    }
}

/// A box relative to the light.
fn corners(bounds: &Aabb, from: DVec3) -> [DVec3; 2] {
    [bounds.min, bounds.max].map(|v| DVec3::from(v.map(f64::from)) + from)
}

/// A place in a box, often on its surface.
fn point_in([low, high]: [DVec3; 2], r: &mut Random) -> DVec3 {
    let part = [0, 1, 2].map(|_| match r.below(4) {
        0 => 0.0,
        1 => 1.0,
        _ => r.next(),
    });
    (low + (high - low) * DVec3::from(part)).clamp(low, high)
}

impl Ray {
    /// Where the ray enters and leaves a box, metres along the light's axis (the slab test).
    fn meets(&self, [low, high]: [DVec3; 2]) -> Option<[f64; 2]> {
        let (mut entry, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let (s, d) = (self.start[axis], self.direction[axis]);
            if d == 0.0 {
                if s < low[axis] || s > high[axis] {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low[axis] - s) / d, (high[axis] - s) / d);
            entry = entry.max(a.min(b));
            exit = exit.min(a.max(b));
        }
        (entry <= exit && exit.is_finite()).then_some([entry, exit])
    }
}

/// Casters that the mask left out.
struct LeftOut(Vec<usize>);

impl LeftOut {
    fn new(before: &[Visibility], after: &[Visibility]) -> Self {
        let gone = |i: &usize| before[*i].is_visible() && !after[*i].is_visible();
        Self((0..before.len()).filter(gone).collect())
    }

    /// A caster of these that shades a place in a receiver, in words. `each` places per receiver.
    fn wrongly(
        &self,
        map: &ShadowMap,
        scene: &Scene,
        received: &[Visibility],
        r: &mut Random,
        each: usize,
    ) -> Option<String> {
        let near = map.light.projection.near_far_m()[0];
        let from = scene.origin - DVec3::from(map.light.world_from_eye.translation);
        let casters: Vec<_> = self
            .0
            .iter()
            .map(|&i| (i, corners(&scene.boxes[i], from)))
            .collect();
        for lookup in map.places(scene, received, self, r, each) {
            // Depths as near to each other as `f64` rounds so far from the origin are one.
            let before = lookup.along - 1e-6 * (1.0 + lookup.along.abs() + from.length());
            for _ in 0..4 {
                let towards = casters
                    .get(r.below(2 * casters.len()))
                    .and_then(|(_, corners)| map.lookup(point_in(*corners, r)));
                let texel = map.read(lookup, towards, r);
                let ray = map.ray(texel);
                for (i, corners) in &casters {
                    let shades = |[entry, exit]: [f64; 2]| {
                        let first = entry.max(near);
                        first <= exit && first < before
                    };
                    if ray.meets(*corners).is_some_and(shades) {
                        let bounds = &scene.boxes[*i];
                        return Some(format!("{bounds:?} shades {lookup:?} in texel {texel:?}"));
                    }
                }
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::super::scenes::{eye, scene};
    use super::*;

    const PLACES: usize = 60;

    fn every(nth: usize, count: usize) -> Vec<Visibility> {
        let class = |i: usize| match i.is_multiple_of(nth) {
            true => Visibility::Visible,
            false => Visibility::Occluded,
        };
        (0..count).map(class).collect()
    }

    /// A reference that finds nothing in wrong results would prove nothing: the masks here miss a
    /// reach of texels or of metres, a receiver, or one caster that they should keep.
    #[test]
    fn casters_that_are_left_out_wrongly_are_found_and_others_are_not() {
        let (mut found, mut single, mut rightly) = ([0; 3], [0; 2], 0);
        for seed in 0..120 {
            let mut r = Random::new(seed);
            let scene = scene(&mut r, 1, 120, DVec3::ZERO);
            let map = ShadowMap {
                light: eye(&mut r, DVec3::ZERO, seed % 3 == 2),
                side: [64, 512][r.below(2)],
                texels: 8.0,
                metres: 0.5,
            };
            let count = scene.boxes.len();
            let (received, before) = (every(16, count), every(1, count));
            let (after, _) = map.cull(&scene, &received, &before).unwrap();
            let left_out = LeftOut::new(&before, &after);
            let wrong = left_out.wrongly(&map, &scene, &received, &mut r, PLACES);
            assert_eq!(wrong, None, "{seed}");
            rightly += left_out.0.len();

            let fewer_texels = ShadowMap { texels: 0.0, ..map };
            let fewer_metres = ShadowMap { metres: 0.0, ..map };
            let fewer = every(32, count);
            let masks = [
                (fewer_texels, &received),
                (fewer_metres, &received),
                (map, &fewer),
            ];
            for (found, (mask, entered)) in found.iter_mut().zip(masks) {
                let (after, _) = mask.cull(&scene, entered, &before).unwrap();
                let left_out = LeftOut::new(&before, &after);
                let wrong = left_out.wrongly(&map, &scene, &received, &mut r, PLACES);
                *found += usize::from(wrong.is_some());
            }
            for kept in (0..count).filter(|i| after[*i].is_visible()) {
                let one = LeftOut(vec![kept]);
                let wrong = one.wrongly(&map, &scene, &received, &mut r, PLACES);
                single[usize::from(wrong.is_some())] += 1;
            }
        }
        assert!(found.iter().all(|n| *n >= 6), "{found:?}");
        // What a mask keeps may shade nothing: it goes by rectangles of whole cells.
        assert!(single[1] > 600 && rightly > 10_000, "{single:?} {rightly}");
    }
}
