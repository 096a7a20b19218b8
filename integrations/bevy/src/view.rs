//! From Bevy's matrices to the culler's views and buffer sizes.

use crate::components::OcclusionBufferSize;
use bevy_math::{Affine3A, DMat4, DVec3, DVec4, Mat4, UVec2};
use foveal_cull::{Aabb, ClipDepth, CullError, MAX_SIDE_PX, View};

/// The size of a buffer, and how much of the buffer the picture takes per axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fit {
    pub(crate) size: (u32, u32),
    /// Above 0, at most 1: the rest of the buffer lies to the right of the picture and below it.
    share: [f64; 2],
    /// Whether the buffer has fewer samples than asked for.
    pub(crate) coarse: bool,
}

impl Fit {
    /// For a picture of so many pixels, with so many samples in each.
    pub(crate) fn new(mode: OcclusionBufferSize, picture: UVec2, samples: u32) -> Option<Self> {
        if picture.min_element() == 0 {
            return None;
        }
        // The sample positions of 1, 2, 4 and 8 samples lie on the centres of a grid of as many
        // cells per axis. A buffer pixel has a grid of 4.
        let mut per_picture_px = match mode {
            OcclusionBufferSize::Exact => f64::from(samples) / 4.0,
            OcclusionBufferSize::Quarter => 0.25,
            OcclusionBufferSize::Fixed(size) => {
                let size = size.clamp(UVec2::ONE, UVec2::splat(MAX_SIDE_PX));
                return Some(Self {
                    size: size.into(),
                    share: [1.0; 2],
                    coarse: false,
                });
            }
        };
        let mut coarse = false;
        while f64::from(picture.max_element()) * per_picture_px > f64::from(MAX_SIDE_PX) {
            per_picture_px *= 0.5;
            coarse = true;
        }
        let fit = |px: u32| {
            let exact = f64::from(px) * per_picture_px;
            (exact.ceil() as u32, exact / exact.ceil())
        };
        let ((width, x), (height, y)) = (fit(picture.x), fit(picture.y));
        Some(Self {
            size: (width, height),
            share: [x, y],
            coarse,
        })
    }

    /// For a square shadow map.
    #[cfg(feature = "bevy_light")]
    pub(crate) fn of_shadow_map(mode: OcclusionBufferSize, side: usize) -> Option<Self> {
        Self::new(mode, UVec2::splat(u32::try_from(side).ok()?), 1)
    }

    /// The view of a matrix, widened to whole pixels of the buffer.
    pub(crate) fn view(&self, clip_from_world: DMat4) -> Result<View, CullError> {
        let [x, y] = self.share;
        let widened = DMat4::from_cols(
            DVec4::new(x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, y, 0.0, 0.0),
            DVec4::Z,
            DVec4::new(x - 1.0, 1.0 - y, 0.0, 1.0),
        ) * clip_from_world;
        View::from_clip_from_world(widened.to_cols_array(), ClipDepth::OneToZero)
    }
}

/// The matrix of a pose and a projection, without the rounding of `f32`.
pub(crate) fn clip_from_world(clip_from_view: Mat4, world_from_view: Affine3A) -> DMat4 {
    clip_from_view.as_dmat4() * Mat4::from(world_from_view).as_dmat4().inverse()
}

/// Largest sine between the view direction and the normal of a near plane that is not oblique, as
/// foveal-cull has it.
const OBLIQUE: f64 = 1e-4;

/// The near plane of a mirror's or a portal's view and the far plane that belongs to it, which both
/// cut through what the view shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ObliquePlanes {
    near: DVec4,
    /// `None` where it cuts nothing that is in the picture, as with Bevy's `near_clip_plane`.
    far: Option<DVec4>,
}

impl ObliquePlanes {
    /// Takes them out of a perspective matrix of reversed depth. The matrix that is left shows more:
    /// it has a near plane before them, and no far plane. `None` where they are not oblique.
    pub(crate) fn take_from(clip_from_world: DMat4) -> Option<(Self, DMat4)> {
        let [x, y, z, w] = [0, 1, 2, 3].map(|row| clip_from_world.row(row));
        let forward = w.truncate();
        let (near, far) = (w - z, z);
        let across = near.truncate().reject_from(forward);
        if forward == DVec3::ZERO
            || !across.is_finite()
            || across.length() <= OBLIQUE * near.truncate().length()
        {
            return None;
        }
        // Half the distance at which the nearest corner of the picture begins.
        let world_from_clip = clip_from_world.inverse();
        let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let nearest = corners
            .map(|(x, y)| 1.0 / (world_from_clip * DVec4::new(x, y, 1.0, 1.0)).w)
            .into_iter()
            .filter(|distance| *distance > 0.0 && distance.is_finite())
            .fold(f64::INFINITY, f64::min);
        let least = 1e-3 * forward.length();
        let nearest = if nearest.is_finite() { nearest } else { 0.0 };
        let plain_near = DVec4::W * (0.5 * nearest).max(least);
        let plain = DMat4::from_cols(x, y, plain_near, w).transpose();
        // Depth along the picture's corners may not fall below the far plane's.
        let world_from_plain = plain.inverse();
        let cuts = corners.iter().any(|&(x, y)| {
            let direction = (world_from_plain * DVec4::new(x, y, 0.0, 1.0)).truncate();
            far.truncate().dot(direction) < -1e-5
        });
        let far = cuts.then_some(far);
        Some((Self { near, far }, plain))
    }

    /// Whether they leave a box as it is.
    pub(crate) fn spare(&self, bounds: &Aabb) -> bool {
        let mut planes = [Some(self.near), self.far].into_iter().flatten();
        planes.all(|plane| is_beyond(plane, bounds))
    }
}

/// The space before a view's near plane, in which nothing is drawn: from the eye to the near
/// rectangle. A mesh that reaches into it is open there, and shows what is behind a box inside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NearSpace {
    near: DVec4,
    /// The box around it.
    min: DVec3,
    max: DVec3,
}

impl NearSpace {
    /// Of a matrix of reversed depth whose near plane is not oblique.
    pub(crate) fn of(clip_from_world: DMat4) -> Self {
        let (z, w) = (clip_from_world.row(2), clip_from_world.row(3));
        let world_from_clip = clip_from_world.inverse();
        let point = |x, y, w| {
            let point = world_from_clip * DVec4::new(x, y, 1.0, w);
            point.truncate() / point.w
        };
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut add = |point: DVec3| {
            if point.is_finite() {
                min = min.min(point);
                max = max.max(point);
            } else {
                // Nothing lies beside it then.
                (min, max) = (DVec3::NEG_INFINITY, DVec3::INFINITY);
            }
        };
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            add(point(x, y, 1.0));
        }
        // An orthographic view has no eye: its rays begin at the rectangle.
        if w.truncate() != DVec3::ZERO {
            add(point(0.0, 0.0, 0.0));
        }
        // More than the rounding of matrices in `f32`.
        let rounding = 1e-5 * (max - min) + 1e-6 * min.abs().max(max.abs());
        Self {
            near: w - z,
            min: min - rounding,
            max: max + rounding,
        }
    }

    /// Whether a box lies wholly outside it. Unknown where the box is not valid.
    pub(crate) fn spares(&self, bounds: &Aabb) -> bool {
        let [min, max] = corners(bounds);
        let beside = min.cmpgt(self.max).any() || max.cmplt(self.min).any();
        bounds.is_valid() && (beside || is_beyond(self.near, bounds))
    }
}

fn corners(bounds: &Aabb) -> [DVec3; 2] {
    [bounds.min, bounds.max].map(|corner| DVec3::from(corner.map(f64::from)))
}

/// Whether a box lies wholly on the drawn side of a plane.
fn is_beyond(plane: DVec4, bounds: &Aabb) -> bool {
    let [min, max] = corners(bounds);
    let (center, half) = ((min + max) * 0.5, (max - min) * 0.5);
    let normal = plane.truncate();
    let (middle, reach) = (normal.dot(center) + plane.w, normal.abs().dot(half));
    // More than the rounding of matrices in `f32`.
    middle - reach > 1e-5 * (normal.abs().dot(center.abs()) + plane.w.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_math::{Vec3, Vec4};
    use core::f32::consts::FRAC_PI_2;

    fn around(x: f32, z: f32, half: f32) -> Aabb {
        let at = Vec3::new(x, 0.0, z);
        Aabb::new(at - half, at + half)
    }

    #[test]
    fn a_picture_of_odd_size_keeps_its_pixel_centres() {
        let picture = UVec2::new(317, 181);
        let fit = Fit::new(OcclusionBufferSize::Exact, picture, 1).unwrap();
        assert_eq!(fit.size, (80, 46));
        let clip_from_view = Mat4::perspective_infinite_reverse_rh(1.0, 317.0 / 181.0, 0.1);
        let pose = Affine3A::look_at_rh(Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, Vec3::Y).inverse();
        let matrix = clip_from_world(clip_from_view, pose);
        let view = fit.view(matrix).unwrap();
        let [left, right, bottom, top] = view.eye.projection.extents();
        // The centre of pixel (10, 20), by the matrix and by the buffer's sample of that number.
        let (x, y) = (10.5 / 317.0 * 2.0 - 1.0, 1.0 - 20.5 / 181.0 * 2.0);
        let world = matrix.inverse().project_point3(DVec3::new(x, y, 0.5));
        let eye =
            DMat4::from_cols_array_2d(&Mat4::from(pose).as_dmat4().inverse().to_cols_array_2d())
                .transform_point3(world);
        let sample_x = left + 10.5 / 320.0 * (right - left);
        let sample_y = top - 20.5 / 184.0 * (top - bottom);
        assert!((eye.x / -eye.z - sample_x).abs() < 1e-6, "{eye} {sample_x}");
        assert!((eye.y / -eye.z - sample_y).abs() < 1e-6, "{eye} {sample_y}");
    }

    #[test]
    fn buffers_follow_the_samples_and_stay_within_the_limit() {
        let size = |mode, w, h, samples| Fit::new(mode, UVec2::new(w, h), samples).unwrap().size;
        use OcclusionBufferSize::{Exact, Fixed, Quarter};
        assert_eq!(size(Exact, 640, 360, 1), (160, 90));
        assert_eq!(size(Exact, 640, 360, 2), (320, 180));
        assert_eq!(size(Exact, 640, 360, 4), (640, 360));
        assert_eq!(size(Exact, 640, 360, 8), (1280, 720));
        assert_eq!(size(Quarter, 640, 360, 4), (160, 90));
        assert_eq!(size(Exact, 7680, 4320, 4), (3840, 2160));
        let coarse = |samples| {
            Fit::new(Exact, UVec2::new(7680, 4320), samples)
                .unwrap()
                .coarse
        };
        assert!(coarse(4) && !coarse(2));
        assert_eq!(size(Fixed(UVec2::new(0, 9999)), 640, 360, 1), (1, 4096));
        assert_eq!(Fit::new(Exact, UVec2::new(0, 5), 1), None);
    }

    #[test]
    fn oblique_planes_are_taken_out_and_spare_what_lies_beyond_both() {
        use bevy_camera::{CameraProjection, PerspectiveProjection};
        let view = |near_clip_plane| {
            let projection = PerspectiveProjection {
                near_clip_plane,
                ..Default::default()
            };
            projection.get_clip_from_view().as_dmat4()
        };
        let plain = view(Vec4::new(0.0, 0.0, -1.0, -0.1));
        assert_eq!(ObliquePlanes::take_from(plain), None);

        // Beyond 3 m straight ahead, turned to the right.
        let normal = Vec3::new(0.4, 0.0, -1.0).normalize();
        let oblique = view(normal.extend(3.0 * normal.z));
        let fit = Fit::new(OcclusionBufferSize::Exact, UVec2::new(64, 64), 1).unwrap();
        assert!(fit.view(oblique).is_err());
        let (planes, left) = ObliquePlanes::take_from(oblique).unwrap();
        let [left_view, plain_view] = [left, plain].map(|m| fit.view(m).unwrap().eye.projection);
        let [a, b] = [left_view, plain_view].map(|p| p.extents());
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6));
        assert!(left_view.near_far_m()[0] < 3.0);
        assert!(planes.spare(&around(0.0, -4.0, 0.1)));
        assert!(!planes.spare(&around(0.0, -2.0, 0.1)), "before it");
        assert!(!planes.spare(&around(0.0, -3.0, 0.5)), "on it");
        assert!(planes.spare(&around(2.0, -3.0, 0.1)), "it is turned");
        assert!(!planes.spare(&around(-2.0, -3.0, 0.1)));
    }

    #[test]
    fn the_space_before_a_near_plane_reaches_from_the_eye_to_the_corners_of_its_rectangle() {
        // A right angle, from (5, 0, 5) towards -z.
        let pose = Affine3A::from_translation(Vec3::new(5.0, 0.0, 5.0));
        let of = |projection| NearSpace::of(clip_from_world(projection, pose));
        let near = of(Mat4::perspective_infinite_reverse_rh(FRAC_PI_2, 1.0, 1.0));
        assert!((near.min - DVec3::new(4.0, -1.0, 4.0)).length() < 1e-3);
        assert!((near.max - DVec3::new(6.0, 1.0, 5.0)).length() < 1e-3);
        assert!(near.spares(&around(5.0, 2.0, 1.9)), "beyond it");
        assert!(!near.spares(&around(5.0, 2.0, 2.1)), "cut by the plane");
        assert!(!near.spares(&around(5.0, 5.0, 0.1)), "around the eye");
        assert!(!near.spares(&around(5.0, 0.0, 50.0)), "around all of it");
        assert!(near.spares(&around(5.0, 6.0, 0.9)), "behind the eye");
        assert!(near.spares(&around(8.0, 4.5, 1.9)), "beside it");
        assert!(!near.spares(&Aabb::EMPTY));
        let finite = of(Mat4::perspective_rh(FRAC_PI_2, 1.0, 100.0, 1.0));
        assert!((finite.min - near.min).length() < 1e-3 && (finite.max - near.max).length() < 1e-3);
        assert!(!NearSpace::of(DMat4::ZERO).spares(&around(0.0, 0.0, 1.0)));
    }

    #[test]
    fn orthographic_views_have_no_space_between_an_eye_and_the_near_plane() {
        // From above and aside, 20 m wide: the box around the rectangle holds much of the scene.
        let pose = Affine3A::look_at_rh(Vec3::splat(5.0), Vec3::ZERO, Vec3::Y).inverse();
        let projection = Mat4::orthographic_rh(-10.0, 10.0, -10.0, 10.0, 100.0, 0.0);
        let near = NearSpace::of(clip_from_world(projection, pose));
        assert!(near.spares(&around(0.0, 0.0, 1.0)), "beyond the plane");
        assert!(!near.spares(&around(5.0, 5.0, 6.0)), "cut by it");
        assert!(!near.spares(&around(15.0, 0.0, 1.0)), "on it");
        assert!(near.spares(&around(40.0, 40.0, 1.0)), "far before it");
        // With the near plane far before the eye, the eye is as any other place.
        let projection = Mat4::orthographic_rh(-10.0, 10.0, -10.0, 10.0, 100.0, -50.0);
        let near = NearSpace::of(clip_from_world(projection, pose));
        assert!(near.spares(&around(5.0, 5.0, 6.0)));
    }
}
