//! What a tile sees: the part of space whose shadows it holds, and the matrix that draws it.

use foveal_scene::Aabb;
use glam::{Mat4, Vec3, Vec4};

/// Texels around what a tile stands for that are drawn besides, so that filters find what lies
/// across its border.
pub(super) const BORDER: f32 = 4.0;

/// The part of space that a tile sees, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Volume {
    /// One side of the cube around a point light, or what a spot light's cone reaches.
    Pyramid {
        apex: Vec3,
        /// Unit axes across, up and along.
        axes: [Vec3; 3],
        /// Half its width at distance 1, without the border.
        tangent: f32,
        /// Light ends at this distance from the apex.
        range: f32,
        /// Nearer things cast no shadow.
        near: f32,
    },
    /// A column along a directional light's rays.
    Column {
        /// Unit axes across, up and along.
        axes: [Vec3; 3],
        /// Centre along the first two axes.
        center: [f32; 2],
        /// Half its width.
        radius: f32,
        /// Begin and end along the third axis.
        span: [f32; 2],
    },
}

/// By how much a tile of this side is wider than what it stands for.
pub(super) fn widening(side: f32) -> f32 {
    side / (side - 2.0 * BORDER)
}

impl Volume {
    /// Whether depths that were drawn for `held` can be looked up for this one: the light is as it
    /// was, and so is the scene along its rays. A cascade may have moved and grown with the eye.
    pub(super) fn can_look_into(&self, held: &Self) -> bool {
        match (*self, *held) {
            (
                Self::Column { axes, span, .. },
                Self::Column {
                    axes: axes_held,
                    span: span_held,
                    ..
                },
            ) => axes == axes_held && span == span_held,
            (now, held) => now == held,
        }
    }

    /// A sphere around it: centre and radius in metres, world space.
    pub(super) fn sphere(&self) -> [f32; 4] {
        match *self {
            Self::Pyramid { apex, range, .. } => apex.extend(range).to_array(),
            Self::Column {
                axes: [x, y, z],
                center,
                radius,
                span: [begin, end],
            } => {
                let middle = x * center[0] + y * center[1] + z * (0.5 * (begin + end));
                let around = (radius * std::f32::consts::SQRT_2).hypot(0.5 * (end - begin));
                middle.extend(around).to_array()
            }
        }
    }

    /// Clip space from world space for a tile of this side; reversed depth.
    pub(super) fn clip_from_world(&self, side: f32) -> Mat4 {
        match *self {
            Self::Pyramid {
                apex,
                axes: [x, y, z],
                tangent,
                near,
                ..
            } => {
                let scale = 1.0 / (tangent * widening(side));
                let row = |axis: Vec3, scale: f32| (axis * scale).extend(-axis.dot(apex) * scale);
                let depth = Vec4::new(0.0, 0.0, 0.0, near);
                Mat4::from_cols(row(x, scale), row(y, scale), depth, row(z, 1.0)).transpose()
            }
            Self::Column {
                axes: [x, y, z],
                center,
                radius,
                span: [begin, end],
            } => {
                let across = |axis: Vec3, center: f32| (axis / radius).extend(-center / radius);
                let length = end - begin;
                Mat4::from_cols(
                    across(x, center[0]),
                    across(y, center[1]),
                    (-z / length).extend(end / length),
                    Vec4::W,
                )
                .transpose()
            }
        }
    }

    /// Whether a box reaches into it, for a tile of this side; may say so of a box that does not.
    pub(super) fn meets(&self, b: &Aabb, side: f32) -> bool {
        let (center, half) = (b.center(), b.half_extent());
        match *self {
            Self::Pyramid {
                apex,
                axes: [x, y, z],
                tangent,
                range,
                ..
            } => {
                let nearest = apex.clamp(b.min, b.max);
                if nearest.distance_squared(apex) > range * range {
                    return false;
                }
                let to = center - apex;
                // Rounding may err, but never to the small side.
                let wide = tangent * widening(side) * 1.0001;
                let inside = |normal: Vec3| normal.dot(to) + normal.abs().dot(half) >= 0.0;
                inside(z)
                    && inside(z * wide - x)
                    && inside(z * wide + x)
                    && inside(z * wide - y)
                    && inside(z * wide + y)
            }
            Self::Column {
                axes: [x, y, z],
                center: [u, v],
                radius,
                span: [begin, end],
            } => {
                let radius = radius * 1.0001;
                let apart = |axis: Vec3, at: f32, reach: f32| {
                    (axis.dot(center) - at).abs() > axis.abs().dot(half) + reach
                };
                let middle = 0.5 * (begin + end);
                let half_length = 0.5 * (end - begin) * 1.0001;
                !(apart(x, u, radius) || apart(y, v, radius) || apart(z, middle, half_length))
            }
        }
    }

    /// Whether a box is as large as a texel of a tile of this side, so that a shadow of it could be
    /// seen.
    pub(super) fn resolves(&self, b: &Aabb, side: f32) -> bool {
        let texel = match *self {
            Self::Pyramid { apex, tangent, .. } => {
                let nearest = apex.clamp(b.min, b.max).distance(apex);
                2.0 * tangent * nearest / (side - 2.0 * BORDER)
            }
            Self::Column { radius, .. } => 2.0 * radius / side,
        };
        b.size().length() >= texel
    }

    /// Points whose convex hull holds all of it.
    pub(super) fn corners(&self) -> Vec<Vec3> {
        match *self {
            Self::Pyramid {
                apex,
                axes: [x, y, z],
                tangent,
                range,
                ..
            } => {
                let far = |i: f32, j: f32| apex + range * (z + tangent * (i * x + j * y));
                vec![
                    apex,
                    far(-1.0, -1.0),
                    far(1.0, -1.0),
                    far(-1.0, 1.0),
                    far(1.0, 1.0),
                ]
            }
            Self::Column {
                axes: [x, y, z],
                center: [u, v],
                radius,
                span,
            } => (0..8)
                .map(|i| {
                    let sign = |bit: u32| if i >> bit & 1 == 0 { -radius } else { radius };
                    x * (u + sign(0)) + y * (v + sign(1)) + z * span[i >> 2 & 1]
                })
                .collect(),
        }
    }

    /// Whether any of it may be in a frustum, given by its planes (inside is positive).
    pub(super) fn is_in_view(&self, planes: &[Vec4]) -> bool {
        let corners = self.corners();
        planes.iter().all(|plane| {
            let inside = |p: &Vec3| plane.truncate().dot(*p) + plane.w >= 0.0;
            corners.iter().any(inside)
        })
    }
}

/// The six sides of a cube around a light: axes across, up and along. Mirrored by `side_axes` in
/// `shadow/lookup.wgsl`.
pub(super) fn cube_axes(side: u32) -> [Vec3; 3] {
    const AXES: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];
    let axis = (side / 2) as usize;
    let sign = if side.is_multiple_of(2) { 1.0 } else { -1.0 };
    [
        AXES[(axis + 1) % 3],
        AXES[(axis + 2) % 3],
        AXES[axis] * sign,
    ]
}

/// Unit axes across, up and along a direction: as `axes_along` in `shadow/lookup.wgsl`.
pub(super) fn axes_along(direction: Vec3) -> [Vec3; 3] {
    let z = direction.normalize_or(Vec3::NEG_Y);
    let (x, y) = z.any_orthonormal_pair();
    [x, y, z]
}

/// The planes of a frustum, of which those of a perspective's far plane hold everything.
pub(super) fn frustum_planes(clip_from_world: Mat4) -> [Vec4; 6] {
    let [x, y, z, w] = [0, 1, 2, 3].map(|row| clip_from_world.row(row));
    [w + x, w - x, w + y, w - y, w - z, z]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(side: u32) -> Volume {
        Volume::Pyramid {
            apex: Vec3::new(1.0, 2.0, 3.0),
            axes: cube_axes(side),
            tangent: 1.0,
            range: 5.0,
            near: 0.05,
        }
    }

    #[test]
    fn each_direction_lies_in_one_side_of_the_cube() {
        let apex = Vec3::new(1.0, 2.0, 3.0);
        for direction in [
            Vec3::new(0.9, 0.2, -0.4),
            Vec3::new(-0.9, 0.5, 0.1),
            Vec3::new(0.3, 0.8, 0.1),
            Vec3::new(0.3, -0.8, 0.1),
            Vec3::new(0.1, 0.2, 0.7),
            Vec3::new(0.1, 0.2, -0.7),
        ] {
            let at = apex + 3.0 * direction;
            let small = Aabb::new(at - 1e-3, at + 1e-3);
            let sides: Vec<u32> = (0..6).filter(|&s| cube(s).meets(&small, 256.0)).collect();
            assert_eq!(sides.len(), 1, "{direction}");
            let clip = cube(sides[0]).clip_from_world(256.0) * at.extend(1.0);
            assert!(clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && clip.z <= clip.w);
            assert!((clip.z / clip.w - 0.05 / (3.0 * direction.abs().max_element())).abs() < 1e-6);
        }
    }

    #[test]
    fn what_lies_beyond_the_range_or_behind_meets_no_side() {
        let far = Vec3::new(1.0, 2.0, 9.0);
        assert!(!cube(4).meets(&Aabb::new(far, far + 1.0), 64.0));
        let behind = Vec3::new(0.9, 1.9, 1.0);
        assert!(!cube(4).meets(&Aabb::new(behind, behind + 0.1), 64.0));
        let all = Aabb::new(Vec3::splat(-9.0), Vec3::splat(9.0));
        assert!((0..6).all(|side| cube(side).meets(&all, 64.0)));
    }

    #[test]
    fn what_is_smaller_than_a_texel_is_not_resolved() {
        let at = |distance: f32| Vec3::new(1.0, 2.0, 3.0 + distance);
        let ball = |distance: f32| Aabb::new(at(distance) - 0.01, at(distance) + 0.01);
        assert!(cube(4).resolves(&ball(1.0), 128.0));
        assert!(!cube(4).resolves(&ball(4.0), 128.0));
        assert!(cube(4).resolves(&ball(4.0), 512.0));
        let wire = Aabb::new(at(4.0), at(4.0) + Vec3::X);
        assert!(cube(4).resolves(&wire, 128.0));
    }

    #[test]
    fn a_column_holds_what_its_matrix_holds() {
        let column = Volume::Column {
            axes: axes_along(Vec3::new(0.3, -0.9, 0.2)),
            center: [0.5, -1.5],
            radius: 4.0,
            span: [-10.0, 10.0],
        };
        let m = column.clip_from_world(128.0);
        let mut inside = 0;
        for i in 0..1000 {
            let part = |k: i32| ((i * k) % 101) as f32 / 5.0 - 10.0;
            let p = Vec3::new(part(7), part(13), part(29));
            let clip = m * p.extend(1.0);
            let is_in =
                clip.x.abs() < 0.999 && clip.y.abs() < 0.999 && clip.z > 0.001 && clip.z < 0.999;
            if is_in {
                assert!(column.meets(&Aabb::new(p, p), 128.0), "{p}");
                inside += 1;
            }
        }
        assert!(inside > 20, "{inside}");
    }

    #[test]
    fn a_camera_sees_the_sides_before_it_alone() {
        let camera = foveal_scene::Camera::look_at(
            Vec3::new(1.0, 2.0, 13.0),
            Vec3::new(1.0, 2.0, 3.0),
            Vec3::Y,
            0.3,
        );
        let planes = frustum_planes(camera.clip_from_world(1.0));
        assert!(cube(4).is_in_view(&planes));
        let beside = Volume::Pyramid {
            apex: Vec3::new(30.0, 2.0, 3.0),
            axes: cube_axes(0),
            tangent: 1.0,
            range: 5.0,
            near: 0.05,
        };
        assert!(!beside.is_in_view(&planes));
    }
}
