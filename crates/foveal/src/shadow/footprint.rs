//! What a tile sees of a box: a rectangle of its texels, and distances from the light.

use foveal_scene::Aabb;
use glam::{Vec2, Vec3};

use super::volume::{BORDER, Volume, widening};

/// As `shadow_offset` in `shadow/lookup.wgsl`: places are moved by up to so many texels, times the
/// bias.
pub(super) const MOST_MOVED: f32 = 1.4;

/// A vertex is drawn beside its place by up to this part of the greatest coordinates that it is found
/// from: far from the origin that is more than a texel.
const ROUNDING: f32 = 1.0 / (1 << 21) as f32;

/// Part of a tile that a box covers, as seen from the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Footprint {
    /// Least and greatest coordinates in texels from the tile's lower left corner, up as y is; may lie
    /// beyond the tile.
    pub(super) low: Vec2,
    pub(super) high: Vec2,
    /// Distances along the tile's axis, metres.
    pub(super) nearest: f32,
    pub(super) farthest: f32,
}

/// Corners that share an edge with a corner, by bits of their numbers.
const EDGES: [(usize, usize); 12] = [
    (0, 1),
    (2, 3),
    (4, 5),
    (6, 7),
    (0, 2),
    (1, 3),
    (4, 6),
    (5, 7),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
];

impl Footprint {
    /// What a tile of `side` texels sees of a box; `None` where it is nearer than all that casts a
    /// shadow.
    pub(super) fn new(volume: &Volume, b: &Aabb, side: f32) -> Option<Self> {
        let exact = Self::without_rounding(volume, b, side)?;
        let origin = match *volume {
            Volume::Pyramid { apex, .. } => apex,
            Volume::Column { .. } => Vec3::ZERO,
        };
        let greatest = (b.min.abs().max(b.max.abs()).max(origin.abs())).max_element();
        Some(exact.grown(ROUNDING * greatest / texel_at(volume, side, exact.nearest)))
    }

    fn without_rounding(volume: &Volume, b: &Aabb, side: f32) -> Option<Self> {
        let corner = |i: usize| {
            let pick = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            Vec3::new(
                pick(0, b.min.x, b.max.x),
                pick(1, b.min.y, b.max.y),
                pick(2, b.min.z, b.max.z),
            )
        };
        match *volume {
            Volume::Pyramid {
                apex,
                axes,
                tangent,
                near,
                ..
            } => {
                let local = |i: usize| Vec3::from(axes.map(|axis| axis.dot(corner(i) - apex)));
                let corners: [Vec3; 8] = std::array::from_fn(local);
                let half = 0.5 * side;
                let scale = half / (tangent * widening(side));
                // Rounding may err, but never to the small side.
                let near = 0.999 * near;
                let mut around = Around::NOTHING;
                let mut take = |p: Vec3| around.take(p.truncate() * (scale / p.z) + half, p.z);
                for p in corners.iter().filter(|p| p.z >= near) {
                    take(*p);
                }
                if corners.iter().any(|p| p.z < near) {
                    for (a, c) in EDGES.map(|(i, j)| (corners[i], corners[j])) {
                        if (a.z < near) != (c.z < near) {
                            let cut = a.lerp(c, (near - a.z) / (c.z - a.z));
                            take(cut.truncate().extend(near));
                        }
                    }
                }
                around.found()
            }
            Volume::Column {
                axes: [x, y, z],
                center,
                radius,
                ..
            } => {
                let (middle, half) = (b.center(), b.half_extent());
                let scale = 0.5 * side / radius;
                let at = Vec2::new(x.dot(middle) - center[0], y.dot(middle) - center[1]) * scale;
                let reach = Vec2::new(x.abs().dot(half), y.abs().dot(half)) * scale;
                let (along, deep) = (z.dot(middle), z.abs().dot(half));
                Some(Self {
                    low: at - reach + 0.5 * side,
                    high: at + reach + 0.5 * side,
                    nearest: along - deep,
                    farthest: along + deep,
                })
            }
        }
    }

    /// The same, grown by texels on all sides.
    pub(super) fn grown(self, texels: f32) -> Self {
        Self {
            low: self.low - texels,
            high: self.high + texels,
            ..self
        }
    }
}

/// A rectangle and a range around points.
struct Around(Footprint);

impl Around {
    const NOTHING: Self = Self(Footprint {
        low: Vec2::INFINITY,
        high: Vec2::NEG_INFINITY,
        nearest: f32::INFINITY,
        farthest: f32::NEG_INFINITY,
    });

    fn take(&mut self, at: Vec2, distance: f32) {
        let all = &mut self.0;
        all.low = all.low.min(at);
        all.high = all.high.max(at);
        all.nearest = all.nearest.min(distance);
        all.farthest = all.farthest.max(distance);
    }

    fn found(self) -> Option<Footprint> {
        (self.0.nearest <= self.0.farthest).then_some(self.0)
    }
}

/// Metres that a texel of a tile spans at a distance along its axis.
pub(super) fn texel_at(volume: &Volume, side: f32, distance: f32) -> f32 {
    match *volume {
        Volume::Pyramid { tangent, .. } => 2.0 * tangent * distance / (side - 2.0 * BORDER),
        Volume::Column { radius, .. } => 2.0 * radius / side,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::volume::{axes_along, cube_axes};
    use crate::testing::random;

    /// Corners of boxes as the device draws them, from the origin to ten kilometres away.
    #[test]
    fn a_footprint_holds_what_is_drawn_however_far_the_origin_is() {
        let mut random = random(5);
        let side = 512.0;
        let mut compared = 0;
        for away in [0.0, 300.0, 1e3, 1e4] {
            for tangent in [1.0, 0.087] {
                for _ in 0..2_000 {
                    let mut place = || Vec3::new(random(), random(), random()) - 0.5;
                    let apex = 2.0 * away * place();
                    let axes = if tangent == 1.0 {
                        cube_axes(3)
                    } else {
                        axes_along(place().normalize())
                    };
                    let lamp = Volume::Pyramid {
                        apex,
                        axes,
                        tangent,
                        range: 8.0,
                        near: 0.01,
                    };
                    let sun = Volume::Column {
                        axes,
                        center: [axes[0].dot(apex), axes[1].dot(apex)],
                        radius: 8.0,
                        span: [axes[2].dot(apex) - 50.0, axes[2].dot(apex) + 50.0],
                    };
                    let (aside, distance) = (place(), 0.05 + 4.0 * (place().x + 0.5));
                    let [x, y, z] = axes.map(|axis| axis * distance);
                    let at = apex + z + (x * aside.x + y * aside.y) * (2.2 * tangent);
                    let half = 0.1 * tangent * distance * (place() + 0.5);
                    let b = Aabb::new(at - half, at + half);
                    let corner = Vec3::select(place().cmplt(Vec3::ZERO), b.min, b.max);
                    for volume in [lamp, sun] {
                        let clip = volume.clip_from_world(side) * corner.extend(1.0);
                        let texel = (0.5 + 0.5 * clip.truncate().truncate() / clip.w) * side;
                        let is_in_tile = texel.min_element() > 0.0 && texel.max_element() < side;
                        if clip.w < 0.02 || !is_in_tile {
                            continue;
                        }
                        let held = Footprint::new(&volume, &b, side).map(|f| f.grown(1.0));
                        assert!(
                            held.is_some_and(|f| {
                                texel.cmpge(f.low).all() && texel.cmple(f.high).all()
                            }),
                            "{volume:?} {b:?} {texel} {held:?}"
                        );
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 10_000, "{compared}");
    }
}
