//! The same scene elsewhere: larger, or turned about the vertical axis.

use foveal::Settings;
use foveal_scene::{Camera, LightKind, Projection, Scene};
use glam::{Mat3, Mat4, Vec3};

/// Where a scene is placed.
#[derive(Clone, Copy)]
pub(crate) struct Placement {
    /// How many times as large it is; a power of two, so that nothing is rounded.
    pub(crate) scale: f32,
    /// Whether it is turned by a quarter.
    pub(crate) turned: bool,
}

impl Placement {
    fn turn(self) -> Mat3 {
        if self.turned {
            Mat3::from_cols(Vec3::NEG_Z, Vec3::Y, Vec3::X)
        } else {
            Mat3::IDENTITY
        }
    }

    fn world(self) -> Mat4 {
        Mat4::from_mat3(self.turn() * self.scale)
    }

    pub(crate) fn scene(self, scene: &mut Scene) {
        let world = self.world();
        for instance in &mut scene.instances {
            instance.world_from_object = world * instance.world_from_object;
            instance.bounds = instance.bounds.transformed(world);
        }
        for object in &mut scene.objects {
            object.bounds = object.bounds.transformed(world);
        }
        for light in &mut scene.lights {
            light.position = world.transform_point3(light.position);
            light.direction = self.turn() * light.direction;
            if !matches!(light.kind, LightKind::Directional) {
                light.intensity *= self.scale * self.scale;
            }
            light.range_m = light.range_m.map(|range| range * self.scale);
        }
        for material in &mut scene.materials {
            if let Some(transmission) = &mut material.transmission {
                transmission.attenuation_distance_m *= self.scale;
            }
        }
    }

    pub(crate) fn camera(self, camera: &mut Camera) {
        let eye = self.world().transform_point3(camera.eye());
        camera.world_from_view = Mat4::from_mat3(self.turn()) * camera.world_from_view;
        camera.world_from_view.w_axis = eye.extend(1.0);
        match &mut camera.projection {
            Projection::Perspective { near_m, .. } => *near_m *= self.scale,
            Projection::Orthographic {
                height_m,
                near_m,
                far_m,
            } => {
                for length in [height_m, near_m, far_m] {
                    *length *= self.scale;
                }
            }
        }
    }

    /// Lengths among the settings.
    pub(crate) fn settings(self, settings: &mut Settings) {
        for length in [
            &mut settings.lighting.ambient_occlusion_radius_m,
            &mut settings.lighting.light_radius_m,
            &mut settings.culling.radius_m,
            &mut settings.stereo.ipd_m,
            &mut settings.stereo.convergence_m,
        ] {
            *length *= self.scale;
        }
    }
}
