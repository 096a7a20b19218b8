//! Receiver masks: where in a shadow map, and how far from the light, shadows may be seen. A caster
//! beyond everything that is seen behind it casts no shadow that anybody sees.
//!
//! Source: Bittner, Mattausch, Silvennoinen and Wimmer 2011, 'Shadow Caster Culling for Efficient
//! Shadow Mapping'; here on the CPU, from boxes.

use bevy_math::{DMat4, DVec3, DVec4};
use foveal_cull::Aabb;

/// Parts of a shadow map along each side.
const PARTS: usize = 32;

/// What a shadow map sees of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Footprint {
    /// Least and greatest clip coordinates across and up; may lie beyond the map.
    low: [f64; 2],
    high: [f64; 2],
    /// Distances along the map's axis: metres, or any unit where rays are parallel.
    nearest: f64,
    farthest: f64,
}

impl Footprint {
    const NOTHING: Self = Self {
        low: [f64::INFINITY; 2],
        high: [f64::NEG_INFINITY; 2],
        nearest: f64::INFINITY,
        farthest: f64::NEG_INFINITY,
    };

    fn take(&mut self, x: f64, y: f64, along: f64) {
        self.low = [self.low[0].min(x), self.low[1].min(y)];
        self.high = [self.high[0].max(x), self.high[1].max(y)];
        self.nearest = self.nearest.min(along);
        self.farthest = self.farthest.max(along);
    }

    /// Whether it reaches into the map.
    fn meets_map(&self) -> bool {
        self.low.iter().all(|&low| low <= 1.0) && self.high.iter().all(|&high| high >= -1.0)
    }

    /// The parts that it touches, as rows of them.
    fn rows(&self) -> impl Iterator<Item = core::ops::RangeInclusive<usize>> + use<> {
        let part = |at: f64| {
            let parts = PARTS as f64;
            ((0.5 + 0.5 * at) * parts).clamp(0.0, parts - 1.0) as usize
        };
        // More than the rounding of texel positions.
        let [left, low] = self.low.map(|at| part(at - 1e-3));
        let [right, high] = self.high.map(|at| part(at + 1e-3));
        (low..=high).map(move |y| y * PARTS + left..=y * PARTS + right)
    }
}

/// How a shadow map sees the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projector {
    x: DVec4,
    y: DVec4,
    /// The distance along the map's axis.
    along: DVec4,
    /// Nearer things cast no shadow; `None` where rays are parallel.
    near: Option<f64>,
    /// The edges of the map as planes, positive inside.
    edges: [DVec4; 4],
}

impl Projector {
    /// From a matrix of reversed depth: perspective with the far plane at infinity, or orthographic.
    pub(crate) fn new(clip_from_world: DMat4) -> Self {
        let [x, y, z, w] = [0, 1, 2, 3].map(|row| clip_from_world.row(row));
        let parallel = w.truncate() == DVec3::ZERO;
        Self {
            x,
            y,
            along: if parallel { -z } else { w },
            // Rounding may err, but never to the small side.
            near: (!parallel).then(|| (z.w * 0.999).max(1e-6)),
            edges: [w + x, w - x, w + y, w - y],
        }
    }

    /// Whether a box may reach into the map: quickly, and `true` where only its corners tell.
    fn may_meet(&self, bounds: &Aabb) -> bool {
        let corner = |corner: [f32; 3]| DVec3::from(corner.map(f64::from));
        let (min, max) = (corner(bounds.min), corner(bounds.max));
        let (center, half) = ((min + max) * 0.5, (max - min) * 0.5);
        self.edges.iter().all(|edge| {
            let normal = edge.truncate();
            normal.dot(center) + edge.w + normal.abs().dot(half) >= 0.0
        })
    }

    /// `None` where the box is nearer than all that casts a shadow.
    fn footprint(&self, bounds: &Aabb) -> Option<Footprint> {
        let corner = |corner: [f32; 3]| DVec3::from(corner.map(f64::from));
        let (min, size) = (corner(bounds.min), corner(bounds.max) - corner(bounds.min));
        // Of the corner of least coordinates, and by how much the box's sides change it.
        let at_min = |row: DVec4| (row.truncate().dot(min) + row.w, row.truncate() * size);
        let rows = [self.x, self.y, self.along].map(at_min);
        let mut found = Footprint::NOTHING;
        let corners: [DVec3; 8] = core::array::from_fn(|i| {
            let far = |axis: usize| (i >> axis & 1) as f64;
            DVec3::from(rows.map(|(at, by)| at + far(0) * by.x + far(1) * by.y + far(2) * by.z))
        });
        let Some(near) = self.near else {
            corners.iter().for_each(|c| found.take(c.x, c.y, c.z));
            return Some(found);
        };
        let mut all = true;
        for c in corners {
            if c.z >= near {
                let by_distance = c.z.recip();
                found.take(c.x * by_distance, c.y * by_distance, c.z);
            } else {
                all = false;
            }
        }
        if !all {
            // Where edges cross the near plane.
            for (axis, i) in (0..3).flat_map(|axis| (0..8).map(move |i| (axis, i))) {
                let (a, b) = (corners[i], corners[i | 1 << axis]);
                if i >> axis & 1 == 0 && (a.z < near) != (b.z < near) {
                    let cut = a.lerp(b, (near - a.z) / (b.z - a.z));
                    found.take(cut.x / near, cut.y / near, near);
                }
            }
        }
        (found.nearest <= found.farthest).then_some(found)
    }
}

/// What may be seen of a shadow map's shadows.
#[derive(Clone, Debug)]
pub(crate) struct Mask {
    projector: Projector,
    /// The farthest receiver in each part.
    lit: Box<[f64]>,
    /// The same with receivers that occluders hide from the light.
    all: Box<[f64]>,
}

impl Mask {
    /// The mask of a shadow map of which nothing is seen.
    pub(crate) fn new(projector: Projector) -> Self {
        let nothing = || vec![f64::NEG_INFINITY; PARTS * PARTS].into();
        Self {
            projector,
            lit: nothing(),
            all: nothing(),
        }
    }

    /// Adds a receiver, whose box holds all places at which its shadows are looked up. `reach`: the
    /// distance at which light ends. Returns what the map sees of it; `None` where it lies beside the
    /// map.
    pub(crate) fn receive(&mut self, bounds: &Aabb, reach: f64) -> Option<Footprint> {
        // Most receivers lie beside most faces of a cube map.
        if !self.projector.may_meet(bounds) {
            return None;
        }
        let mut seen = self.projector.footprint(bounds)?;
        if !seen.meets_map() {
            return None;
        }
        if self.projector.near.is_some() {
            seen.farthest = seen.farthest.min(reach);
        }
        add(&mut self.all, &seen);
        Some(seen)
    }

    /// Light may fall on a receiver: no occluder hides it.
    pub(crate) fn light(&mut self, receiver: &Footprint) {
        add(&mut self.lit, receiver);
    }

    /// Whether a caster's shadow may be seen. `occludes`: whether it is an occluder of this map, by
    /// which receivers may be hidden.
    pub(crate) fn shows(&self, bounds: &Aabb, occludes: bool) -> bool {
        // It may be anywhere.
        if !bounds.is_valid() {
            return true;
        }
        let Some(cast) = self.projector.footprint(bounds) else {
            return true;
        };
        let parts = if occludes { &self.all } else { &self.lit };
        let slack = 1e-4 * cast.nearest.abs().max(1.0);
        cast.rows().any(|row| {
            parts[row]
                .iter()
                .any(|&receiver| receiver >= cast.nearest - slack)
        })
    }
}

/// Adds a receiver to the farthest ones in each part.
fn add(parts: &mut [f64], receiver: &Footprint) {
    for row in receiver.rows() {
        for part in &mut parts[row] {
            *part = part.max(receiver.farthest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_math::{Mat4, Vec3};

    /// At (1, 2, 3), towards -z, 90 degrees wide.
    fn face() -> Projector {
        let view = Mat4::from_translation(Vec3::new(-1.0, -2.0, -3.0));
        let clip = Mat4::perspective_infinite_reverse_rh(core::f32::consts::FRAC_PI_2, 1.0, 0.1);
        Projector::new(clip.as_dmat4() * view.as_dmat4())
    }

    /// Along -y, 16 m wide.
    fn sun() -> Projector {
        let view = Mat4::look_at_rh(Vec3::Y * 10.0, Vec3::ZERO, Vec3::X);
        let clip = Mat4::orthographic_rh(-8.0, 8.0, -8.0, 8.0, 20.0, 0.0);
        Projector::new((clip * view).as_dmat4())
    }

    /// Adds a receiver on which light may fall; returns whether the map sees it.
    fn receive_lit(mask: &mut Mask, bounds: &Aabb, reach: f64) -> bool {
        let seen = mask.receive(bounds, reach);
        seen.iter().for_each(|seen| mask.light(seen));
        seen.is_some()
    }

    fn around(at: Vec3, half: f32) -> Aabb {
        Aabb::new(at - half, at + half)
    }

    #[test]
    fn casters_before_a_receiver_count_and_those_behind_or_beside_it_do_not() {
        let at = |x: f32, z: f32| around(Vec3::new(1.0 + x, 2.0, 3.0 - z), 0.2);
        let mut mask = Mask::new(face());
        assert!(!mask.shows(&at(0.0, 2.0), true), "nothing is seen");
        assert!(receive_lit(&mut mask, &at(0.0, 4.0), 10.0));
        assert!(mask.shows(&at(0.0, 2.0), false));
        assert!(mask.shows(&at(0.0, 4.0), false), "itself");
        assert!(!mask.shows(&at(0.0, 6.0), false), "behind");
        assert!(!mask.shows(&at(1.0, 2.0), false), "beside");
        assert!(
            mask.shows(&around(Vec3::new(1.0, 2.0, 3.0), 0.3), false),
            "around the light"
        );
        let behind_the_light = at(0.0, -4.0);
        assert!(!receive_lit(&mut mask, &behind_the_light, 10.0));
    }

    #[test]
    fn of_receivers_in_shadow_occluders_alone_count() {
        let at = |z: f32| around(Vec3::new(1.0, 2.0, 3.0 - z), 0.2);
        let mut mask = Mask::new(face());
        assert!(mask.receive(&at(4.0), 10.0).is_some());
        assert!(mask.shows(&at(2.0), true));
        assert!(!mask.shows(&at(2.0), false));
    }

    #[test]
    fn casters_that_may_be_anywhere_are_shown() {
        for map in [face(), sun()] {
            let mask = Mask::new(map);
            for half in [f32::INFINITY, f32::NAN] {
                assert!(mask.shows(&around(Vec3::ZERO, half), true), "{half}");
            }
        }
    }

    #[test]
    fn the_sun_has_masks_too() {
        let mut mask = Mask::new(sun());
        let receiver = around(Vec3::new(2.0, 0.0, 1.0), 0.5);
        assert!(receive_lit(&mut mask, &receiver, 0.0));
        let shows = |x: f32, y: f32| mask.shows(&around(Vec3::new(x, y, 1.0), 0.1), false);
        assert!(shows(2.0, 3.0));
        assert!(shows(2.0, 30.0), "before the near plane");
        assert!(!shows(2.0, -3.0));
        assert!(!shows(-2.0, 3.0));
    }

    /// Whatever lies between the light and a place of a receiver is shown.
    #[test]
    fn every_caster_before_a_receiver_is_shown() {
        let mut state = 11_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let mut shown = 0;
        for (map, light) in [(face(), Some(Vec3::new(1.0, 2.0, 3.0))), (sun(), None)] {
            for _ in 0..5_000 {
                let mut place = || Vec3::new(random(), random(), random());
                let at = place() * 16.0 - Vec3::new(7.0, 6.0, 12.0);
                let half = 2.0 * place();
                let receiver = Aabb::new(at - half, at + half);
                let seen = at - half + 2.0 * half * place();
                let before = match light {
                    Some(light) => light.lerp(seen, 0.05 + 0.95 * place().x),
                    None => seen + Vec3::Y * 20.0 * place().x,
                };
                let caster = around(before, 0.3 * place().x);
                let point = Aabb::new(seen, seen);
                let inside = map.footprint(&point).is_some_and(|f| f.meets_map());
                let casts = map.footprint(&Aabb::new(before, before)).is_some();
                if inside && casts {
                    let mut mask = Mask::new(map);
                    assert!(receive_lit(&mut mask, &receiver, 1e3));
                    assert!(mask.shows(&caster, false), "{receiver:?} {seen} {caster:?}");
                    shown += 1;
                }
            }
        }
        assert!(shown > 1_000, "{shown}");
    }
}
