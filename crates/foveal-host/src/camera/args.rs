//! The flags that say where a frame is seen from.

use std::path::Path;

use foveal_scene::Camera;
use glam::Vec3;

use crate::failure::usage;
use crate::{command_line, scene_source, values};

/// Where the frame is seen from.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct CameraArgs {
    /// Camera of the scene, by name or by number from 0; `overview`: the whole scene from outside;
    /// `inside`: the longest view within it [default: the scene's first camera; without cameras
    /// `inside` where there is an inside, else `overview`]
    #[arg(long, help_heading = "Camera", value_name = "NAME", conflicts_with_all = ["eye", "target"])]
    pub(super) camera: Option<String>,

    /// Position of the eye in metres
    #[arg(long, help_heading = "Camera", value_name = "X,Y,Z", value_parser = values::vec3, allow_hyphen_values = true)]
    #[arg(requires = "target")]
    pub(super) eye: Option<Vec3>,

    /// Point to look at in metres
    #[arg(long, help_heading = "Camera", value_name = "X,Y,Z", value_parser = values::vec3, allow_hyphen_values = true)]
    #[arg(requires = "eye")]
    pub(super) target: Option<Vec3>,

    /// Direction that is up in the picture [default: 0,1,0]
    #[arg(long, help_heading = "Camera", value_name = "X,Y,Z", value_parser = values::vec3)]
    #[arg(allow_hyphen_values = true, requires = "eye")]
    pub(super) up: Option<Vec3>,

    /// Vertical field of view in degrees [default: the camera's own, else 60]
    #[arg(long, help_heading = "Camera", value_name = "DEG", value_parser = values::fov_deg)]
    pub(super) fov: Option<f32>,

    /// Exact camera, as the window copies it: perspective,FOV_RAD,NEAR_M or
    /// orthographic,HEIGHT_M,NEAR_M,FAR_M, then twelve numbers: right, up, back, eye
    #[arg(long, help_heading = "Camera", value_name = "NUMBERS", value_parser = values::exact_camera)]
    #[arg(allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["camera", "eye", "target", "fov"])]
    pub(super) exact_camera: Option<Camera>,

    /// Path of the camera: a JSON file of keyframes (see docs/program.md); `demo`: the demo scene's
    /// own; `sway`: to and fro around another camera, sideways by 5 cm at up to 5 cm a second, as a
    /// head moves; `turntable`: around the centre of the scene, from another camera or from
    /// `overview`, one turn in 12 seconds
    #[arg(
        long,
        help_heading = "Camera",
        value_name = "FILE.json|demo|sway|turntable"
    )]
    pub(super) path: Option<String>,
}

/// Refuses a place to look at where the eye itself is, and no direction that is up.
pub(crate) fn check_direction(
    eye: Option<Vec3>,
    target: Option<Vec3>,
    up: Option<Vec3>,
) -> anyhow::Result<()> {
    if eye.is_some() && eye == target {
        return usage("--eye and --target are the same point: there is no direction to look in");
    }
    if eye.is_some() && up == Some(Vec3::ZERO) {
        return usage("--up is 0,0,0: there is no direction that is up");
    }
    Ok(())
}

impl CameraArgs {
    /// Finds what clap cannot: contradictions between the values of several arguments.
    pub fn check(&self) -> anyhow::Result<()> {
        check_direction(self.eye, self.target, self.up)
    }

    /// The file of the path, where it is one.
    pub fn path_file(&self) -> Option<&Path> {
        let is_named = |path: &&str| !["demo", "sway", "turntable"].contains(path);
        self.path.as_deref().filter(is_named).map(Path::new)
    }

    /// The same along a path; one that is asked for already stays. Where the scene has a path of
    /// its own and no other place is asked for it is that one, else swaying.
    pub fn along_a_path(&self, scene_name: &str) -> Self {
        let is_placed = self.camera.is_some() || self.eye.is_some() || self.exact_camera.is_some();
        let has_own = scene_source::camera_path(scene_name).is_some();
        let path = if has_own && !is_placed {
            "demo"
        } else {
            "sway"
        };
        Self {
            path: self.path.clone().or_else(|| Some(path.to_owned())),
            ..self.clone()
        }
    }

    /// The flags that say the same.
    pub fn flags(&self) -> Vec<String> {
        let place = |p: Vec3| format!("{},{},{}", p.x, p.y, p.z);
        let exact = self.exact_camera.as_ref();
        [
            ("--camera", self.camera.clone()),
            ("--eye", self.eye.map(place)),
            ("--target", self.target.map(place)),
            ("--up", self.up.map(place)),
            ("--fov", self.fov.map(|fov| fov.to_string())),
            ("--exact-camera", exact.map(command_line::exact_camera)),
            ("--path", self.path.clone()),
        ]
        .into_iter()
        .filter_map(|(flag, value)| Some([flag.to_owned(), value?]))
        .flatten()
        .collect()
    }
}
