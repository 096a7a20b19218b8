//! Where each frame is seen from: a camera of the scene, a place on the command line, or a path.

use std::f32::consts::TAU;
use std::path::Path;

use anyhow::bail;
use foveal_scene::{Camera, Projection, Scene};
use glam::{Mat3, Vec3};

use super::args::CameraArgs;
use super::inside;
use super::path::CameraPath;
use crate::failure::usage;
use crate::scene_source::{self, TimedCamera};

const DEFAULT_FOV_DEG: f32 = 60.0;

/// A camera for every moment.
pub struct Viewpoint {
    kind: Kind,
    /// Takes the place of the camera's own field of view.
    fov_y_rad: Option<f32>,
}

enum Kind {
    /// Index into the scene's cameras, which animation may move.
    OfScene(usize),
    Still(Camera),
    Path(CameraPath, f32),
    Generated(TimedCamera),
    /// Another one, moved.
    Moved(Motion, Box<Kind>),
}

/// Movements of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    /// To and fro, sideways.
    Sway,
    /// Around a point, counter-clockwise seen from above.
    Turntable(Vec3),
}

/// How far [`Motion::Sway`] moves to either side in metres; in a radian per second, so that it is
/// the speed too.
const SWAY_M: f32 = 0.05;

/// Seconds of one turn of [`Motion::Turntable`].
const TURN_S: f32 = 12.0;

impl Motion {
    /// The movement that `--path` names.
    fn by_name(name: &str, scene: &Scene) -> Option<Self> {
        match name {
            "sway" => Some(Self::Sway),
            "turntable" => Some(Self::Turntable(scene.bounds().center())),
            _ => None,
        }
    }

    /// Moves the camera to its place at `time_s`.
    fn apply(self, camera: &mut Camera, time_s: f32) {
        match self {
            Self::Sway => {
                let sideways = camera.world_from_view.x_axis * (SWAY_M * time_s.sin());
                camera.world_from_view.w_axis += sideways;
            }
            Self::Turntable(center) => turn_around(camera, center, time_s),
        }
    }
}

/// Turns a camera around the vertical axis through `center`. Whole turns give the same camera to
/// the bit.
fn turn_around(camera: &mut Camera, center: Vec3, time_s: f32) {
    let turn = Mat3::from_rotation_y(TAU * (time_s / TURN_S).fract());
    let axes = &mut camera.world_from_view;
    for axis in [&mut axes.x_axis, &mut axes.y_axis, &mut axes.z_axis] {
        *axis = (turn * axis.truncate()).extend(0.0);
    }
    let eye = axes.w_axis.truncate();
    axes.w_axis = (eye + (turn * (eye - center) - (eye - center))).extend(1.0);
}

impl Viewpoint {
    /// Follows the arguments; `scene` is posed at time 0, so that the choice does not depend on the
    /// frame.
    pub fn choose(args: &CameraArgs, scene: &Scene, scene_name: &str) -> anyhow::Result<Self> {
        let fov_y_deg = args.fov.unwrap_or(DEFAULT_FOV_DEG);
        let fov_y_rad = args.fov.map(f32::to_radians);
        let motion = args.path.as_deref();
        let motion = motion.and_then(|name| Motion::by_name(name, scene));
        let is_placed = args.camera.is_some() || args.eye.is_some() || args.exact_camera.is_some();
        if args.path.is_some() && motion.is_none() && is_placed {
            return usage(
                "--path says where the camera is, as --camera, --eye and --exact-camera do: only --path sway and --path \
                 turntable go with one of them",
            );
        }
        let kind = if let Some(camera) = &args.exact_camera {
            Kind::Still(camera.clone())
        } else if let (Some(eye), Some(target)) = (args.eye, args.target) {
            let up = args.up.unwrap_or(Vec3::Y);
            let camera = Camera::look_at(eye, target, up, fov_y_deg.to_radians());
            Kind::Still(with_near_plane(camera, near_m(scene)))
        } else if let Some(path) = args.path.as_ref().filter(|_| motion.is_none()) {
            Self::path(path, fov_y_deg, scene, scene_name)?
        } else if let Some(name) = &args.camera {
            by_name(name, scene)?
        } else if matches!(motion, Some(Motion::Turntable(_))) {
            Kind::Still(scene.overview_camera())
        } else if !scene.cameras.is_empty() {
            Kind::OfScene(0)
        } else {
            Kind::Still(inside_camera(scene).unwrap_or_else(|| scene.overview_camera()))
        };
        let kind = match motion {
            Some(motion) => Kind::Moved(motion, Box::new(kind)),
            None => kind,
        };
        let viewpoint = Self { kind, fov_y_rad };
        let camera = viewpoint.at(scene, 0.0);
        if fov_y_rad.is_some() && matches!(camera.projection, Projection::Orthographic { .. }) {
            bail!(
                "the camera '{}' is orthographic: it has no field of view that --fov could change",
                camera.name
            );
        }
        Ok(viewpoint)
    }

    fn path(path: &str, fov_y_deg: f32, scene: &Scene, scene_name: &str) -> anyhow::Result<Kind> {
        if path != "demo" {
            return Ok(Kind::Path(
                CameraPath::read(Path::new(path), fov_y_deg)?,
                near_m(scene),
            ));
        }
        match scene_source::camera_path(scene_name) {
            Some(path) => Ok(Kind::Generated(path)),
            None => usage(format!(
                "--path demo leads through the demo scene; '{scene_name}' is another one"
            )),
        }
    }

    /// The camera at `time_s`, to which `scene` is posed.
    pub fn at(&self, scene: &Scene, time_s: f32) -> Camera {
        let mut camera = self.kind.at(scene, time_s);
        if let (Some(fov), Projection::Perspective { fov_y_rad, .. }) =
            (self.fov_y_rad, &mut camera.projection)
            && !matches!(self.kind, Kind::Path(..))
        {
            *fov_y_rad = fov;
        }
        camera
    }
}

impl Kind {
    fn at(&self, scene: &Scene, time_s: f32) -> Camera {
        match self {
            Self::OfScene(index) => scene.cameras[*index].clone(),
            Self::Still(camera) => camera.clone(),
            Self::Path(path, near_m) => with_near_plane(path.at(time_s), *near_m),
            Self::Generated(path) => path(time_s),
            Self::Moved(motion, from) => {
                let mut camera = from.at(scene, time_s);
                motion.apply(&mut camera, time_s);
                camera
            }
        }
    }
}

/// A camera of the scene by name or number, or one of the two that every scene has.
fn by_name(name: &str, scene: &Scene) -> anyhow::Result<Kind> {
    if let Some(index) = scene.cameras.iter().position(|camera| camera.name == name) {
        return Ok(Kind::OfScene(index));
    }
    if let Ok(index) = name.parse::<usize>()
        && index < scene.cameras.len()
    {
        return Ok(Kind::OfScene(index));
    }
    match of_every_scene(name, scene)? {
        Some(camera) => Ok(Kind::Still(camera)),
        None => {
            let names: Vec<String> = scene
                .cameras
                .iter()
                .map(|camera| format!("'{}'", camera.name))
                .collect();
            let there = if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            };
            bail!(
                "the scene '{}' has no camera '{name}'; its cameras are: {there}; every scene has 'overview'",
                scene.name
            )
        }
    }
}

/// A camera that a scene has without naming it: `overview`, and `inside` where some place is walled in.
pub(crate) fn of_every_scene(name: &str, scene: &Scene) -> anyhow::Result<Option<Camera>> {
    match name {
        "overview" => Ok(Some(scene.overview_camera())),
        "inside" => match inside_camera(scene) {
            Some(camera) => Ok(Some(camera)),
            None => bail!(
                "the scene '{}' has no inside: no place in it is walled in",
                scene.name
            ),
        },
        _ => Ok(None),
    }
}

fn inside_camera(scene: &Scene) -> Option<Camera> {
    let camera = inside::camera(scene, DEFAULT_FOV_DEG.to_radians())?;
    Some(with_near_plane(camera, near_m(scene)))
}

/// Distance of the near plane in metres for cameras that a scene does not bring along: 5 cm, and less
/// in scenes that are small themselves; depth is reversed and loses nothing by it.
#[must_use]
pub fn near_m(scene: &Scene) -> f32 {
    let diagonal = scene.bounds().size().length();
    if diagonal > 0.0 {
        (1e-3 * diagonal).clamp(1e-6, 0.05)
    } else {
        0.05
    }
}

fn with_near_plane(mut camera: Camera, near: f32) -> Camera {
    if let Projection::Perspective { near_m, .. } = &mut camera.projection {
        *near_m = near;
    }
    camera
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args() -> CameraArgs {
        CameraArgs {
            camera: None,
            eye: None,
            exact_camera: None,
            target: None,
            up: None,
            fov: None,
            path: None,
        }
    }

    fn scene() -> Scene {
        let camera = |name: &str, eye| Camera {
            name: name.to_owned(),
            ..Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 1.0)
        };
        Scene {
            cameras: vec![camera("door", Vec3::X), camera("roof", Vec3::Y * 9.0)],
            ..Scene::default()
        }
    }

    fn chosen(args: &CameraArgs, scene: &Scene) -> anyhow::Result<Camera> {
        Viewpoint::choose(args, scene, "x.glb").map(|viewpoint| viewpoint.at(scene, 0.0))
    }

    #[test]
    fn cameras_are_found_by_name_and_by_number() {
        let scene = scene();
        assert_eq!(chosen(&args(), &scene).unwrap().name, "door");
        for name in ["roof", "1"] {
            let args = CameraArgs {
                camera: Some(name.to_owned()),
                ..args()
            };
            assert_eq!(chosen(&args, &scene).unwrap().eye(), Vec3::Y * 9.0);
        }
    }

    #[test]
    fn swaying_begins_at_the_camera_and_moves_sideways() {
        let scene = scene();
        let args = CameraArgs {
            camera: Some("roof".to_owned()),
            path: Some("sway".to_owned()),
            ..args()
        };
        let viewpoint = Viewpoint::choose(&args, &scene, "x.glb").unwrap();
        let start = viewpoint.at(&scene, 0.0);
        assert_eq!(start.eye(), Vec3::Y * 9.0);
        let moved = viewpoint.at(&scene, 0.5).eye() - start.eye();
        let sideways = start.world_from_view.x_axis.truncate();
        assert!((moved - sideways * 0.05 * 0.5f32.sin()).length() < 1e-6);
        // Another path says where the camera is by itself.
        let args = CameraArgs {
            path: Some("demo".to_owned()),
            ..args
        };
        let error = chosen(&args, &scene).unwrap_err().to_string();
        assert!(error.contains("--path"), "{error}");
    }

    #[test]
    fn a_turntable_goes_around_the_scene_and_comes_back() {
        let mut scene = scene();
        scene.cameras.clear();
        let args = CameraArgs {
            eye: Some(Vec3::new(2.0, 5.0, 8.0)),
            target: Some(Vec3::splat(2.0)),
            path: Some("turntable".to_owned()),
            ..args()
        };
        let camera = Camera::look_at(Vec3::new(2.0, 5.0, 8.0), Vec3::splat(2.0), Vec3::Y, 1.0);
        let center = Vec3::splat(2.0);
        let at = |time_s| {
            let mut camera = camera.clone();
            turn_around(&mut camera, center, time_s);
            camera
        };
        assert_eq!(at(0.0).world_from_view, camera.world_from_view);
        assert_eq!(at(2.0 * TURN_S).world_from_view, camera.world_from_view);
        let quarter = at(0.25 * TURN_S);
        assert!((quarter.eye() - Vec3::new(8.0, 5.0, 2.0)).length() < 1e-5);
        let forward = -quarter.world_from_view.z_axis.truncate();
        let to_center = (center - quarter.eye()).normalize();
        assert!(
            (forward - to_center).length() < 1e-5,
            "it looks at the centre"
        );
        assert!(chosen(&args, &scene).is_ok());
    }

    #[test]
    fn an_unknown_name_lists_those_that_there_are() {
        let args = CameraArgs {
            camera: Some("cellar".to_owned()),
            ..args()
        };
        let error = chosen(&args, &scene()).unwrap_err().to_string();
        assert!(
            error.contains("'cellar'") && error.contains("'door', 'roof'"),
            "{error}"
        );
    }

    #[test]
    fn the_field_of_view_can_be_changed_where_there_is_one() {
        let mut scene = scene();
        let args = CameraArgs {
            fov: Some(30.0),
            ..args()
        };
        let camera = chosen(&args, &scene).unwrap();
        assert!(
            matches!(camera.projection, Projection::Perspective { fov_y_rad, .. }
            if (fov_y_rad.to_degrees() - 30.0).abs() < 1e-4)
        );
        scene.cameras[0].projection = Projection::Orthographic {
            height_m: 1.0,
            near_m: 0.0,
            far_m: 9.0,
        };
        assert!(chosen(&args, &scene).is_err());
    }
}
