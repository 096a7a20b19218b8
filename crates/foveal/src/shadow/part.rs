//! Where in an eye's picture the shadows of a tile may be seen.

use glam::{Vec2, Vec3};

use super::volume::Volume;
use crate::stereo::Eye;

/// What lies less than this part of a light's range before the eye is left out of the projection.
const LEAST_DEPTH: f32 = 1e-5;
/// The picture's border in normalized device coordinates, with room for a pixel's sub-samples.
const BORDER: f32 = 1.01;

/// A rectangle around all pixels of an eye's picture that may show what a tile's shadows fall on:
/// its least and greatest normalized device coordinates. `None` where there are none.
pub(super) fn part_of_picture(volume: &Volume, eye: &Eye) -> Option<[Vec2; 2]> {
    let picture = [Vec2::splat(-BORDER), Vec2::splat(BORDER)];
    let Volume::Pyramid { apex, range, .. } = *volume else {
        return Some(picture);
    };
    let view_from_world = eye.world_from_view.inverse();
    // Depth along the view in z.
    let in_view = |p: Vec3| view_from_world.transform_point3(p) * Vec3::new(1.0, 1.0, -1.0);
    let corners: Vec<Vec3> = volume.corners().into_iter().map(in_view).collect();
    let [a, b] = if eye.orthographic {
        let center = in_view(apex).truncate();
        meet(
            around(corners.iter().map(|p| p.truncate())),
            [center - range, center + range],
        )
    } else {
        let of_corners = around(projected(&corners, LEAST_DEPTH * range).into_iter());
        meet(of_corners, of_sphere(in_view(apex), range))
    };
    let [sx, sy, ox, oy] = eye.view_from_ndc();
    let ndc = |p: Vec2| (p - Vec2::new(ox, oy)) / Vec2::new(sx, sy);
    let [low, high] = meet([ndc(a), ndc(b)], picture);
    low.cmple(high).all().then_some([low, high])
}

fn around(points: impl Iterator<Item = Vec2>) -> [Vec2; 2] {
    points.fold([Vec2::INFINITY, Vec2::NEG_INFINITY], |[low, high], p| {
        [low.min(p), high.max(p)]
    })
}

fn meet([a, b]: [Vec2; 2], [c, d]: [Vec2; 2]) -> [Vec2; 2] {
    [a.max(c), b.min(d)]
}

/// Tangents of points whose hull, with those of all of them that lie before the eye, holds the part
/// of the points' hull that does.
fn projected(corners: &[Vec3], near: f32) -> Vec<Vec2> {
    let tangents = |p: Vec3| p.truncate() / p.z;
    let mut all: Vec<Vec2> = (corners.iter().filter(|p| p.z >= near))
        .map(|&p| tangents(p))
        .collect();
    // More than the edges, which does no harm.
    for (i, a) in corners.iter().enumerate() {
        for b in &corners[..i] {
            if (a.z < near) != (b.z < near) {
                let cut = a.lerp(*b, (near - a.z) / (b.z - a.z));
                all.push(cut.truncate() / near);
            }
        }
    }
    all
}

/// Tangents of a sphere's silhouette along both axes (Mara and McGuire 2013, '2D Polyhedral Bounds
/// of a Clipped, Perspective-Projected 3D Sphere').
fn of_sphere(center: Vec3, radius: f32) -> [Vec2; 2] {
    let axis = |across: f32| {
        let away = across.hypot(center.z);
        if away <= radius {
            return [f32::NEG_INFINITY, f32::INFINITY];
        }
        let (at, half) = (across.atan2(center.z), (radius / away).asin());
        let right_angle = std::f32::consts::FRAC_PI_2;
        // Behind the eye it has no silhouette before it.
        let low = if at - half <= -right_angle {
            f32::NEG_INFINITY
        } else {
            (at - half).min(right_angle).tan()
        };
        let high = if at + half >= right_angle {
            f32::INFINITY
        } else {
            (at + half).max(-right_angle).tan()
        };
        [low, high]
    };
    let (x, y) = (axis(center.x), axis(center.y));
    [Vec2::new(x[0], y[0]), Vec2::new(x[1], y[1])]
}

#[cfg(test)]
mod tests {
    use foveal_scene::Camera;

    use super::*;
    use crate::shadow::volume::cube_axes;
    use crate::testing::random;

    #[test]
    fn whatever_a_tile_holds_and_the_eye_sees_lies_in_its_part_of_the_picture() {
        let mut random = random(5);
        let (mut seen, mut small) = (0, 0);
        for trial in 0..400 {
            let mut place = |size: f32| size * (Vec3::new(random(), random(), random()) - 0.5);
            let (from, to, apex) = (place(12.0), place(12.0), place(12.0));
            let mut camera = Camera::look_at(from, to, Vec3::Y, 0.9);
            if trial % 4 == 0 {
                camera.projection = foveal_scene::Projection::Orthographic {
                    height_m: 6.0,
                    near_m: -100.0,
                    far_m: 100.0,
                };
            }
            let settings = crate::testing::small(160, 90);
            let eye = crate::stereo::eyes(&settings, &camera).unwrap()[0];
            let range = 0.5 + 5.0 * random();
            let axes = cube_axes(trial % 6);
            let volume = Volume::Pyramid {
                apex,
                axes,
                tangent: 1.0,
                range,
                near: 0.01,
            };
            let part = part_of_picture(&volume, &eye);
            small += u32::from(part.is_none_or(|[a, b]| (b - a).element_product() < 1.0));
            for _ in 0..100 {
                let [x, y] = [0; 2].map(|_| 2.0 * random() - 1.0);
                let direction = axes[2] + axes[0] * x + axes[1] * y;
                let p = apex + direction.normalize() * range * random();
                let clip = eye.clip_from_world() * p.extend(1.0);
                let ndc = clip.truncate() / clip.w;
                if clip.w > 1e-3 && ndc.truncate().abs().max_element() <= 1.0 {
                    seen += 1;
                    let [low, high] = part.expect("it is seen");
                    let at = ndc.truncate();
                    assert!(
                        at.cmpge(low - 1e-4).all() && at.cmple(high + 1e-4).all(),
                        "{trial}"
                    );
                }
            }
        }
        assert!(seen > 3_000 && small > 50, "{seen}, {small}");
    }
}
