//! Receiver masks: where in a tile, and how far from the light, shadows may be seen. What lies
//! beyond everything that is seen behind it casts no shadow that anybody sees.
//!
//! Source: Bittner, Mattausch, Silvennoinen and Wimmer 2011, 'Shadow Caster Culling for Efficient
//! Shadow Mapping'; here on the CPU, from boxes.

use foveal_scene::Aabb;

use super::footprint::{Footprint, MOST_MOVED, texel_at};
use super::volume::Volume;

/// Most parts of a tile along each side, and texels that a part has at least.
const PARTS: usize = 32;
const TEXELS: f32 = 2.0;

/// What may be seen of a tile's shadows.
#[derive(Clone, Debug)]
pub(super) struct Mask {
    /// Texels of the tile along each side.
    side: f32,
    /// Parts along each side.
    parts: usize,
    /// The farthest receiver in each part, along the tile's axis in metres.
    farthest: Box<[f32]>,
}

impl Mask {
    /// The mask of a tile of `side` texels of which nothing is seen.
    pub(super) fn new(side: f32) -> Self {
        let parts = ((side / TEXELS) as usize).clamp(1, PARTS);
        Self {
            side,
            parts,
            farthest: vec![f32::NEG_INFINITY; parts * parts].into(),
        }
    }

    /// The part along a side that a texel coordinate lies in; lookups beyond the tile read its
    /// border.
    fn part(&self, at: f32) -> usize {
        let parts = self.parts as f32;
        (at * (parts / self.side)).clamp(0.0, parts - 1.0) as usize
    }

    /// The parts that a footprint touches, as rows of them.
    fn rows(
        &self,
        of: &Footprint,
    ) -> impl Iterator<Item = std::ops::RangeInclusive<usize>> + use<> {
        let [left, right] = [of.low.x, of.high.x].map(|at| self.part(at));
        let [low, high] = [of.low.y, of.high.y].map(|at| self.part(at));
        let parts = self.parts;
        (low..=high).map(move |y| y * parts + left..=y * parts + right)
    }

    /// A receiver that meets the tile may be seen; whether the mask is larger for it. `bias`: texels
    /// by which places are moved; `filter`: texels that are read beside a place.
    pub(super) fn receive(
        &mut self,
        volume: &Volume,
        b: &Aabb,
        (bias, filter): (f32, f32),
    ) -> bool {
        // Where places are moved farthest.
        let (deepest, reach) = match *volume {
            Volume::Pyramid {
                apex,
                axes,
                range,
                near,
                ..
            } => {
                let along = axes[2].dot(b.center() - apex) + axes[2].abs().dot(b.half_extent());
                (along.min(range).max(near), range)
            }
            Volume::Column { .. } => (0.0, f32::INFINITY),
        };
        let moved = texel_at(volume, self.side, deepest) * (MOST_MOVED * bias + 0.1);
        let around = Aabb::new(b.min - moved, b.max + moved);
        let Some(seen) = Footprint::new(volume, &around, self.side) else {
            return false;
        };
        let farthest = seen.farthest.min(reach + moved);
        let mut grows = false;
        for row in self.rows(&seen.grown(filter)) {
            for part in &mut self.farthest[row] {
                grows |= *part < farthest;
                *part = part.max(farthest);
            }
        }
        grows
    }

    /// Whether a box may cast a shadow that is seen.
    pub(super) fn shows(&self, volume: &Volume, b: &Aabb) -> bool {
        let Some(cast) = Footprint::new(volume, b, self.side) else {
            return false;
        };
        let span = match *volume {
            Volume::Pyramid { .. } => cast.nearest,
            Volume::Column { span, .. } => span[1] - span[0],
        };
        let nearest = cast.nearest - 1e-4 * span;
        self.rows(&cast.grown(1.0)).any(|row| {
            self.farthest[row]
                .iter()
                .any(|&receiver| receiver >= nearest)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::volume::{axes_along, cube_axes};
    use crate::testing::random;
    use glam::Vec3;

    fn around(at: Vec3, half: f32) -> Aabb {
        Aabb::new(at - half, at + half)
    }

    fn side_of_a_cube() -> Volume {
        Volume::Pyramid {
            apex: Vec3::new(1.0, 2.0, 3.0),
            axes: cube_axes(4),
            tangent: 1.0,
            range: 8.0,
            near: 0.01,
        }
    }

    fn column() -> Volume {
        Volume::Column {
            axes: axes_along(Vec3::NEG_Y),
            center: [0.0, 0.0],
            radius: 8.0,
            span: [-10.0, 10.0],
        }
    }

    #[test]
    fn casters_before_a_receiver_count_and_those_behind_or_beside_it_do_not() {
        let tile = side_of_a_cube();
        let at = |x: f32, z: f32| around(Vec3::new(1.0 + x, 2.0, 3.0 + z), 0.2);
        let mut mask = Mask::new(256.0);
        assert!(!mask.shows(&tile, &at(0.0, 2.0)), "nothing is seen");
        assert!(mask.receive(&tile, &at(0.0, 4.0), (1.5, 3.0)));
        assert!(!mask.receive(&tile, &at(0.0, 4.0), (1.5, 3.0)), "known");
        assert!(mask.shows(&tile, &at(0.0, 2.0)));
        assert!(mask.shows(&tile, &at(0.0, 4.0)), "itself");
        assert!(!mask.shows(&tile, &at(0.0, 6.0)), "behind");
        assert!(!mask.shows(&tile, &at(1.0, 2.0)), "beside");
        assert!(
            mask.shows(&tile, &around(Vec3::new(1.0, 2.0, 3.0), 0.1)),
            "around the light"
        );
    }

    #[test]
    fn the_sun_has_masks_too() {
        let tile = column();
        let mut mask = Mask::new(512.0);
        assert!(mask.receive(&tile, &around(Vec3::new(2.0, 0.0, 1.0), 0.5), (1.5, 3.0)));
        assert!(mask.shows(&tile, &around(Vec3::new(2.0, 3.0, 1.0), 0.1)));
        assert!(!mask.shows(&tile, &around(Vec3::new(2.0, -3.0, 1.0), 0.1)));
        assert!(!mask.shows(&tile, &around(Vec3::new(-2.0, 3.0, 1.0), 0.1)));
    }

    /// Every lookup for a place in a receiver's box reads a part that the mask has, at a depth that
    /// the mask reaches.
    #[test]
    fn every_lookup_in_a_receiver_lies_within_its_mask() {
        let mut random = random(7);
        for (tile, filter) in [
            (side_of_a_cube(), 3.0),
            (column(), 3.0),
            (side_of_a_cube(), 14.0),
            (column(), 14.0),
        ] {
            for side in [16.0, 64.0, 512.0] {
                for _ in 0..200 {
                    let at =
                        Vec3::new(random(), random(), random()) * 16.0 - Vec3::new(7.0, 6.0, 4.0);
                    let half = 2.0 * Vec3::new(random(), random(), random());
                    let b = Aabb::new(at - half, at + half);
                    if !tile.meets(&b, side) {
                        continue;
                    }
                    let bias = 3.0;
                    let mut mask = Mask::new(side);
                    mask.receive(&tile, &b, (bias, filter));
                    for _ in 0..50 {
                        let place = b.min + b.size() * Vec3::new(random(), random(), random());
                        // Without the border.
                        if !tile.meets(&Aabb::new(place, place), 1e6) {
                            continue;
                        }
                        let along = match tile {
                            Volume::Pyramid { axes, apex, .. } => axes[2].dot(place - apex),
                            Volume::Column { axes, .. } => axes[2].dot(place),
                        };
                        let away = (Vec3::new(random(), random(), random()) - 0.5).normalize();
                        let offset = texel_at(&tile, side, along) * bias * MOST_MOVED;
                        let moved = place + away * offset;
                        let clip = tile.clip_from_world(side) * moved.extend(1.0);
                        let depth = match tile {
                            Volume::Pyramid { axes, apex, .. } => axes[2].dot(moved - apex),
                            Volume::Column { axes, .. } => axes[2].dot(moved),
                        };
                        if matches!(tile, Volume::Pyramid { near, .. } if depth < near) {
                            continue;
                        }
                        let inside = |ndc: f32| ((0.5 + 0.5 * ndc) * side).clamp(2.0, side - 2.0);
                        let texel = [inside(clip.x / clip.w), inside(clip.y / clip.w)];
                        for i in 0..16 {
                            let step = (filter - 1.0) / 2.0;
                            let read = [
                                texel[0] + ((i % 4) as f32 - 2.0) * step,
                                texel[1] + ((i / 4) as f32 - 2.0) * step,
                            ];
                            let part = read.map(|t| mask.part(t));
                            let reached = mask.farthest[part[1] * mask.parts + part[0]];
                            assert!(
                                reached >= depth * 0.9999 - 1e-4,
                                "{tile:?} {b:?} {place} {side}"
                            );
                        }
                    }
                }
            }
        }
    }

    /// Whatever lies between the light and a place of a receiver is shown, as is all that covers a
    /// texel that a lookup there reads.
    #[test]
    fn every_caster_that_a_lookup_may_find_is_shown() {
        let mut random = random(11);
        let mut shown = 0;
        for tile in [side_of_a_cube(), column()] {
            for side in [16.0, 64.0, 512.0] {
                for _ in 0..2_000 {
                    let mut place = || Vec3::new(random(), random(), random());
                    let at = place() * 16.0 - Vec3::new(7.0, 6.0, 4.0);
                    let half = 0.5 * place();
                    let receiver = Aabb::new(at - half, at + half);
                    let seen = receiver.min + receiver.size() * place();
                    // Without the border.
                    if !tile.meets(&Aabb::new(seen, seen), 1e6) {
                        continue;
                    }
                    let [x, y, z] = match tile {
                        Volume::Pyramid { axes, .. } | Volume::Column { axes, .. } => axes,
                    };
                    // A place of the caster: before what is seen, or beside that by up to two texels
                    // and by what places are moved by.
                    let part = random();
                    let (before, along) = match tile {
                        Volume::Pyramid { apex, near, .. } => {
                            let along = z.dot(seen - apex);
                            let part = (near / along).max(part).min(1.0);
                            (apex + (seen - apex) * part, along * part)
                        }
                        Volume::Column { span, .. } => {
                            let along = z.dot(seen);
                            let back = (along - span[0]) * part;
                            (seen - z * back, along - back)
                        }
                    };
                    let bias = 1.5;
                    let most = texel_at(&tile, side, along) * (2.0 + 0.7 * bias);
                    let beside = |by: f32| (2.0 * by - 1.0) * most;
                    let cast = before + x * beside(random()) + y * beside(random());
                    let mut place = || Vec3::new(random(), random(), random());
                    let (low, high) = (0.3 * place(), 0.3 * place());
                    let caster = Aabb::new(cast - low, cast + high);
                    let mut mask = Mask::new(side);
                    mask.receive(&tile, &receiver, (bias, 3.0));
                    assert!(
                        mask.shows(&tile, &caster),
                        "{tile:?} {side} {receiver:?} {seen} {cast}"
                    );
                    shown += 1;
                }
            }
        }
        assert!(shown > 1_000, "{shown}");
    }

    /// Where the light is in the receiver's box, and all of it is nearer than what casts a shadow.
    #[test]
    fn a_receiver_that_is_moved_beyond_the_nearest_casters_counts() {
        let tile = side_of_a_cube();
        let apex = Vec3::new(1.0, 2.0, 3.0);
        let mut mask = Mask::new(64.0);
        let near = around(apex + 0.0095 * Vec3::Z, 0.0004);
        assert!(mask.receive(&tile, &near, (1.5, 3.0)));
        assert!(mask.shows(&tile, &around(apex + 0.01 * Vec3::Z, 0.0001)));
    }
}
