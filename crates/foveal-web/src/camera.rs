//! Where the page stands, as it says it.

use foveal_scene::{Camera, Projection};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A perspective view, y up.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Place {
    /// The eye in metres.
    eye: [f32; 3],
    /// What it looks at.
    target: [f32; 3],
    /// Full vertical field of view in degrees.
    fov_y_deg: f32,
}

impl Place {
    /// The camera, or why there is none.
    pub(crate) fn camera(&self) -> Result<Camera, String> {
        let numbers = self.eye.iter().chain(&self.target);
        if !numbers.copied().all(f32::is_finite) {
            return Err("the camera's place is not finite".to_owned());
        }
        if !(1.0..=170.0).contains(&self.fov_y_deg) {
            return Err(format!("a field of view of {} degrees", self.fov_y_deg));
        }
        Ok(Camera::look_at(
            self.eye.into(),
            self.target.into(),
            Vec3::Y,
            self.fov_y_deg.to_radians(),
        ))
    }

    /// Where `camera` stands; it looks at a point `distance_m` ahead.
    pub(crate) fn of(camera: &Camera, distance_m: f32) -> Self {
        let forward = -camera.world_from_view.z_axis.truncate();
        let fov_y_rad = match camera.projection {
            Projection::Perspective { fov_y_rad, .. } => fov_y_rad,
            Projection::Orthographic { .. } => std::f32::consts::FRAC_PI_4,
        };
        Self {
            eye: camera.eye().to_array(),
            target: (camera.eye() + distance_m * forward).to_array(),
            fov_y_deg: fov_y_rad.to_degrees(),
        }
    }
}
