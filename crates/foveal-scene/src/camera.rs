//! Cameras: where the frame is seen from.

use glam::{Mat4, Vec3};

/// How a camera maps its view space (looking down −z, y up) to the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A pinhole.
    Perspective {
        /// Full vertical field of view in radians, in (0, π).
        fov_y_rad: f32,
        /// Distance of the near plane in metres, > 0. There is no far plane: depth is reversed and
        /// infinite.
        near_m: f32,
    },
    /// A parallel projection.
    Orthographic {
        /// Full height of the visible slab in metres, > 0.
        height_m: f32,
        /// Distance of the near plane in metres.
        near_m: f32,
        /// Distance of the far plane in metres, > `near_m`.
        far_m: f32,
    },
}

/// A camera with its place in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Its name in the file, or a generated one (`camera 0`). Several cameras may share a name.
    pub name: String,
    /// Rigid transform from view space (x right, y up, looking down −z) to the world.
    pub world_from_view: Mat4,
    /// The projection; the aspect ratio is the target's.
    pub projection: Projection,
}

impl Camera {
    /// A perspective camera at `eye` that looks at `target` with `up` upwards, near plane at 5 cm.
    ///
    /// Where `up` is parallel to the view direction another up vector is chosen.
    #[must_use]
    pub fn look_at(eye: Vec3, target: Vec3, up: Vec3, fov_y_rad: f32) -> Self {
        let forward = (target - eye).try_normalize().unwrap_or(Vec3::NEG_Z);
        let right = forward
            .cross(up)
            .try_normalize()
            .unwrap_or_else(|| forward.any_orthonormal_vector());
        let up = right.cross(forward);
        let world_from_view = Mat4::from_cols(
            right.extend(0.0),
            up.extend(0.0),
            (-forward).extend(0.0),
            eye.extend(1.0),
        );
        Self {
            name: "look-at".to_owned(),
            world_from_view,
            projection: Projection::Perspective {
                fov_y_rad,
                near_m: 0.05,
            },
        }
    }

    /// The eye's position in the world.
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        self.world_from_view.w_axis.truncate()
    }

    /// Clip space from view space for a target of `aspect` = width / height; depth reversed in [0,
    /// 1] (1 at the near plane; 0 at infinity for perspective, at the far plane for orthographic).
    #[must_use]
    pub fn clip_from_view(&self, aspect: f32) -> Mat4 {
        match self.projection {
            Projection::Perspective { fov_y_rad, near_m } => {
                let f = 1.0 / (0.5 * fov_y_rad).tan();
                Mat4::from_cols_array_2d(&[
                    [f / aspect, 0.0, 0.0, 0.0],
                    [0.0, f, 0.0, 0.0],
                    [0.0, 0.0, 0.0, -1.0],
                    [0.0, 0.0, near_m, 0.0],
                ])
            }
            Projection::Orthographic {
                height_m,
                near_m,
                far_m,
            } => {
                let depth = far_m - near_m;
                Mat4::from_cols_array_2d(&[
                    [2.0 / (height_m * aspect), 0.0, 0.0, 0.0],
                    [0.0, 2.0 / height_m, 0.0, 0.0],
                    [0.0, 0.0, 1.0 / depth, 0.0],
                    [0.0, 0.0, far_m / depth, 1.0],
                ])
            }
        }
    }

    /// Clip space from world space; see [`Camera::clip_from_view`].
    #[must_use]
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        self.clip_from_view(aspect) * self.world_from_view.inverse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_and_far_planes_and_the_pictures_corners_are_those_of_clip_space() {
        let aspect = 1.5;
        let perspective = Projection::Perspective {
            fov_y_rad: std::f32::consts::FRAC_PI_2,
            near_m: 0.5,
        };
        let parallel = Projection::Orthographic {
            height_m: 4.0,
            near_m: 0.5,
            far_m: 8.5,
        };
        // A distance in metres, half the picture's height there, and the depth.
        for (projection, places) in [
            (perspective, [(0.5, 0.5, 1.0), (4.0, 4.0, 0.125)]),
            (parallel, [(0.5, 2.0, 1.0), (8.5, 2.0, 0.0)]),
        ] {
            let camera = Camera {
                projection,
                ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0)
            };
            for (distance, half, depth) in places {
                let corner = Vec3::new(aspect * half, half, -distance);
                let found = camera.clip_from_world(aspect).project_point3(corner);
                let expected = Vec3::new(1.0, 1.0, depth);
                assert!(found.abs_diff_eq(expected, 1e-6), "{projection:?}: {found}");
            }
        }
    }
}
