//! Where the page stands, as it says it.

use foveal_scene::{Camera, Projection};
use serde::{Deserialize, Serialize};

/// A perspective view.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Place {
    /// The eye in metres.
    eye: [f32; 3],
    /// What it looks at.
    target: [f32; 3],
    /// What lies upwards in the picture; need not be at a right angle to the view.
    up: [f32; 3],
    /// Full vertical field of view in degrees.
    fov_y_deg: f32,
    /// Distance of the near plane in metres.
    near_m: f32,
}

/// Fields of view that the page draws, in degrees.
const FOV_Y_DEG: std::ops::RangeInclusive<f32> = 1.0..=170.0;

/// The near plane's distance where the camera of the scene has none for a perspective, by the
/// distance of what it looks at; as that of the overview camera.
const NEAR_BY_DISTANCE: f32 = 0.002;

impl Place {
    /// The camera, or why there is none.
    pub(crate) fn camera(&self) -> Result<Camera, String> {
        let numbers = self.eye.iter().chain(&self.target).chain(&self.up);
        if !numbers.copied().all(f32::is_finite) {
            return Err("the camera's place is not finite".to_owned());
        }
        if !FOV_Y_DEG.contains(&self.fov_y_deg) {
            return Err(format!("a field of view of {} degrees", self.fov_y_deg));
        }
        if !(self.near_m > 0.0 && self.near_m.is_finite()) {
            return Err(format!("a near plane at {} m", self.near_m));
        }
        let fov_y_rad = self.fov_y_deg.to_radians();
        let camera = Camera::look_at(
            self.eye.into(),
            self.target.into(),
            self.up.into(),
            fov_y_rad,
        );
        Ok(Camera {
            projection: Projection::Perspective {
                fov_y_rad,
                near_m: self.near_m,
            },
            ..camera
        })
    }

    /// Where `camera` stands; it looks at a point `distance_m` ahead. Its field of view becomes one
    /// that the page draws.
    pub(crate) fn of(camera: &Camera, distance_m: f32) -> Self {
        let forward = -camera.world_from_view.z_axis.truncate();
        let (fov_y_rad, near_m) = match camera.projection {
            Projection::Perspective { fov_y_rad, near_m } => (fov_y_rad, near_m),
            Projection::Orthographic { .. } => {
                let near_m = NEAR_BY_DISTANCE * distance_m;
                (std::f32::consts::FRAC_PI_4, near_m)
            }
        };
        Self {
            eye: camera.eye().to_array(),
            target: (camera.eye() + distance_m * forward).to_array(),
            up: camera.world_from_view.y_axis.truncate().to_array(),
            fov_y_deg: fov_y_rad
                .to_degrees()
                .clamp(*FOV_Y_DEG.start(), *FOV_Y_DEG.end()),
            near_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// What the page draws of a scene's camera.
    fn drawn(of_scene: &Camera) -> Camera {
        let text = serde_json::to_string(&Place::of(of_scene, 0.04)).unwrap();
        let place: Place = serde_json::from_str(&text).unwrap();
        let camera = place.camera().unwrap();
        assert!(
            (camera.world_from_view - of_scene.world_from_view).abs_diff_eq(glam::Mat4::ZERO, 1e-6),
            "{} became {}",
            of_scene.world_from_view,
            camera.world_from_view
        );
        camera
    }

    /// A camera 4 cm in front of the origin that looks at it.
    fn in_front(projection: Projection) -> Camera {
        let eye = Vec3::new(0.0, 0.0, 0.04);
        Camera {
            projection,
            ..Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 1.0)
        }
    }

    #[test]
    fn cameras_that_look_straight_down_or_lean_stay_as_they_are() {
        for (eye, up) in [
            (Vec3::Y, Vec3::X),
            (Vec3::Y, Vec3::new(0.6, 0.0, 0.8)),
            (Vec3::NEG_Y, Vec3::Z),
            (Vec3::Z, Vec3::X),
            (Vec3::new(0.5, 0.7, -1.0), Vec3::new(0.3, -1.0, 0.2)),
        ] {
            drawn(&Camera::look_at(0.04 * eye, Vec3::ZERO, up, 1.0));
        }
    }

    #[test]
    fn small_things_lie_behind_the_near_plane() {
        for projection in [
            Projection::Perspective {
                fov_y_rad: 0.9,
                near_m: 8e-5,
            },
            Projection::Orthographic {
                height_m: 0.02,
                near_m: 0.01,
                far_m: 0.1,
            },
        ] {
            let clip_from_world = drawn(&in_front(projection)).clip_from_world(1.0);
            // The front of an object of 2 cm.
            let depth = clip_from_world.project_point3(Vec3::Z * 0.01).z;
            assert!((0.0..1.0).contains(&depth), "{projection:?}: {depth}");
        }
    }

    #[test]
    fn any_field_of_view_of_a_file_is_drawn_nearly_so() {
        for (of_file, most_near) in [(0.1f32, 1.0f32), (60.0, 60.0), (179.0, 170.0)] {
            let Projection::Perspective { fov_y_rad, near_m } =
                drawn(&in_front(Projection::Perspective {
                    fov_y_rad: of_file.to_radians(),
                    near_m: 0.3,
                }))
                .projection
            else {
                panic!("the page draws perspectives")
            };
            assert!((fov_y_rad.to_degrees() - most_near).abs() < 1e-3);
            assert_eq!(near_m, 0.3);
        }
    }

    #[test]
    fn a_place_that_cannot_be_drawn_is_refused() {
        let place = Place {
            eye: [0.0; 3],
            target: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            fov_y_deg: 60.0,
            near_m: 0.1,
        };
        assert!(place.camera().is_ok());
        for near_m in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(Place { near_m, ..place }.camera().is_err(), "{near_m}");
        }
        for fov_y_deg in [0.0, 180.0, f32::NAN] {
            assert!(
                Place { fov_y_deg, ..place }.camera().is_err(),
                "{fov_y_deg}"
            );
        }
        let up = [0.0, f32::NAN, 0.0];
        assert!(Place { up, ..place }.camera().is_err());
    }
}
