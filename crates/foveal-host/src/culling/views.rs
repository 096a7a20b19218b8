//! Where a scene is culled from: its own cameras, one from the command line, or a file of them.

use anyhow::bail;
use foveal_cull::{Eye, Projection};
use foveal_scene::{Camera, Projection as SceneProjection, Scene};
use glam::{DAffine3, DMat3, Vec3};

use super::args::ViewArgs;
use super::camera_file::{self, Defaults};
use super::eye::NamedEye;
use crate::camera::{near_m, of_every_scene};

const DEFAULT_FOV_DEG: f32 = 60.0;

impl ViewArgs {
    /// The eyes that the arguments ask for, for a picture of `aspect` = width / height.
    pub fn choose(&self, scene: &Scene, aspect: f64) -> anyhow::Result<Vec<NamedEye>> {
        if let Some(path) = &self.cameras {
            return camera_file::read(path, defaults(scene, aspect));
        }
        let mut cameras = if let (Some(eye), Some(target)) = (self.eye, self.target) {
            let fov_y_deg = self.fov.unwrap_or(DEFAULT_FOV_DEG);
            let up = self.up.unwrap_or(Vec3::Y);
            let mut camera = Camera::look_at(eye, target, up, fov_y_deg.to_radians());
            if let SceneProjection::Perspective { near_m, .. } = &mut camera.projection {
                *near_m = crate::camera::near_m(scene);
            }
            vec![camera]
        } else if let Some(name) = &self.camera {
            vec![by_name(name, scene)?]
        } else {
            own_cameras(scene)
        };
        if let Some(fov) = self.fov {
            for camera in &mut cameras {
                match &mut camera.projection {
                    SceneProjection::Perspective { fov_y_rad, .. } => *fov_y_rad = fov.to_radians(),
                    SceneProjection::Orthographic { .. } => bail!(
                        "the camera '{}' is orthographic: it has no field of view that --fov could change",
                        camera.name
                    ),
                }
            }
        }
        Ok(cameras.iter().map(|c| named_eye(c, aspect)).collect())
    }
}

/// What a camera file may leave out.
pub fn defaults(scene: &Scene, aspect: f64) -> Defaults {
    Defaults {
        aspect,
        near: f64::from(near_m(scene)),
    }
}

/// The scene's cameras; the overview where it has none.
pub fn own_cameras(scene: &Scene) -> Vec<Camera> {
    if scene.cameras.is_empty() {
        vec![scene.overview_camera()]
    } else {
        scene.cameras.clone()
    }
}

fn by_name(name: &str, scene: &Scene) -> anyhow::Result<Camera> {
    let found = scene
        .cameras
        .iter()
        .find(|c| c.name == name)
        .or_else(|| name.parse().ok().and_then(|n: usize| scene.cameras.get(n)));
    if let Some(camera) = found {
        return Ok(camera.clone());
    }
    match of_every_scene(name, scene)? {
        Some(camera) => Ok(camera),
        None => {
            let names: Vec<String> = scene
                .cameras
                .iter()
                .map(|c| format!("'{}'", c.name))
                .chain(["'overview'".to_owned()])
                .collect();
            bail!(
                "the scene '{}' has no camera '{name}'; there are {}",
                scene.name,
                names.join(", ")
            )
        }
    }
}

/// A scene's camera as the culler takes it.
pub fn named_eye(camera: &Camera, aspect: f64) -> NamedEye {
    let projection = match camera.projection {
        SceneProjection::Perspective { fov_y_rad, near_m } => Projection::perspective(
            f64::from(fov_y_rad),
            aspect,
            f64::from(near_m),
            f64::INFINITY,
        ),
        SceneProjection::Orthographic {
            height_m,
            near_m,
            far_m,
        } => Projection::orthographic(
            f64::from(height_m),
            aspect,
            f64::from(near_m),
            f64::from(far_m),
        ),
    };
    // Rigid to f32 in the scene, to f64 here.
    let m = camera.world_from_view.as_dmat4();
    let back = m.z_axis.truncate().normalize();
    let right = m.y_axis.truncate().cross(back).normalize();
    let rotation = DMat3::from_cols(right, back.cross(right), back);
    NamedEye {
        name: camera.name.clone(),
        eye: Eye::new(
            DAffine3::from_mat3_translation(rotation, m.w_axis.truncate()),
            projection,
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{CameraArgs, Viewpoint};
    use clap::Parser;
    use foveal_generate as generate;
    use glam::DVec3;

    #[test]
    fn an_eye_looks_where_the_camera_looks() {
        let camera = Camera::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, Vec3::Y, 1.0);
        let eye = named_eye(&camera, 1.5).eye;
        assert!((DVec3::from(eye.position()) - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-6);
        let forward = -DVec3::from(eye.world_from_eye.z_axis);
        assert!((forward - DVec3::new(-1.0, -2.0, -3.0).normalize()).length() < 1e-6);
    }

    #[test]
    fn culling_sees_a_scene_from_where_pictures_show_it() {
        #[derive(Parser)]
        struct Line {
            #[command(flatten)]
            views: ViewArgs,
        }
        #[derive(Parser)]
        struct Drawn {
            #[command(flatten)]
            camera: CameraArgs,
        }
        let scene = generate::by_name("demo:1000").unwrap();
        for words in [
            "foveal --camera inside",
            "foveal --camera overview",
            "foveal --camera 0",
            "foveal --eye 1,2,3 --target -4,0,5 --up 1,0,0.5",
        ] {
            let words = words.split(' ');
            let culled = Line::try_parse_from(words.clone()).unwrap().views;
            let drawn = Drawn::try_parse_from(words.clone()).unwrap().camera;
            let eyes = culled.choose(&scene, 1.5).unwrap();
            let camera = Viewpoint::choose(&drawn, &scene, "demo:1000").unwrap();
            let expected = named_eye(&camera.at(&scene, 0.0), 1.5).eye;
            assert_eq!(eyes.len(), 1);
            assert_eq!(
                eyes[0].eye.world_from_eye, expected.world_from_eye,
                "{words:?}"
            );
            assert_eq!(eyes[0].eye.projection, expected.projection, "{words:?}");
        }
        // No place in an empty scene is walled in.
        let args = ViewArgs {
            camera: Some("inside".to_owned()),
            ..ViewArgs::default()
        };
        let error = args.choose(&Scene::default(), 1.5).unwrap_err();
        assert!(error.to_string().contains("no inside"), "{error}");
    }

    #[test]
    fn an_unknown_camera_lists_those_that_there_are() {
        let args = ViewArgs {
            camera: Some("cellar".to_owned()),
            ..ViewArgs::default()
        };
        let scene = generate::by_name("cornell").unwrap();
        let error = args.choose(&scene, 1.0).unwrap_err().to_string();
        assert!(
            error.contains("'cellar'") && error.contains("'overview'"),
            "{error}"
        );
    }
}
