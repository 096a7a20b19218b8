//! The flags of culling: what occludes, and where it is seen from.

use std::path::{Path, PathBuf};

use glam::Vec3;

use super::occluders::Choice;
use crate::camera::check_direction;
use crate::values;

/// What occludes, and what is too small to count.
#[derive(Debug, Clone, clap::Args)]
pub struct CullingArgs {
    /// Occluders: `auto` (those that the file marks, else all objects), `marked` (nodes with
    /// extras.occluder), `all`, or names of sets (extras.set) with commas between. Only opaque
    /// surfaces occlude
    #[arg(
        long,
        help_heading = "Culling",
        value_name = "auto|marked|all|SET,…",
        default_value = "auto"
    )]
    pub occluders: Choice,

    /// Leave out occluders whose apparent size is below this (Intel's sample: 1.5)
    #[arg(long, help_heading = "Culling", value_name = "X", default_value_t = 0.0, value_parser = values::non_negative)]
    pub occluder_size_threshold: f32,

    /// Leave out parts of occluders that cover fewer pixels of the occlusion buffer than this per
    /// quadrilateral
    #[arg(
        long,
        help_heading = "Culling",
        value_name = "PX",
        default_value_t = 6.0
    )]
    #[arg(value_parser = values::non_negative)]
    pub occluder_pixels_per_quad: f32,

    /// Cull objects whose apparent size is below this (Intel's sample: 0.01)
    #[arg(long, help_heading = "Culling", value_name = "X", default_value_t = 0.0, value_parser = values::non_negative)]
    pub occludee_size_threshold: f32,

    /// Distance of two eyes in metres, with the camera between them: what is culled is hidden from
    /// both. 0: one eye
    #[arg(long, help_heading = "Culling", value_name = "M", default_value_t = 0.0, value_parser = values::non_negative)]
    pub eyes_apart: f32,

    /// Radius in metres around each eye within which the result holds
    #[arg(long, help_heading = "Culling", value_name = "M", default_value_t = 0.0, value_parser = values::non_negative)]
    pub validity_radius: f32,

    /// Time after which no further occluder is begun in a frame, in milliseconds. Near ones come
    /// first; leaving some out only makes more visible
    #[arg(long, help_heading = "Culling", value_name = "MS", value_parser = values::non_negative)]
    pub budget_ms: Option<f32>,
}

/// Where the scene is seen from.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ViewArgs {
    /// Camera of the scene, by name or by number from 0; `overview`: the whole scene from outside;
    /// `inside`: the longest view within it [default: all of the scene's cameras; without cameras
    /// `overview`]
    #[arg(long, help_heading = "Camera", value_name = "NAME", conflicts_with_all = ["eye", "target", "cameras"])]
    pub(super) camera: Option<String>,

    /// Position of the eye in metres
    #[arg(long, help_heading = "Camera", value_name = "X,Y,Z", value_parser = values::vec3, allow_hyphen_values = true)]
    #[arg(requires = "target", conflicts_with = "cameras")]
    pub(super) eye: Option<Vec3>,

    /// Point to look at in metres
    #[arg(long, help_heading = "Camera", value_name = "X,Y,Z", value_parser = values::vec3)]
    #[arg(allow_hyphen_values = true, requires = "eye")]
    pub(super) target: Option<Vec3>,

    /// Direction that is up in the picture [default: 0,1,0]
    #[arg(long, help_heading = "Camera", value_name = "X,Y,Z", value_parser = values::vec3)]
    #[arg(allow_hyphen_values = true, requires = "eye")]
    pub(super) up: Option<Vec3>,

    /// Vertical field of view in degrees [default: the camera's own, else 60]
    #[arg(long, help_heading = "Camera", value_name = "DEG", value_parser = values::fov_deg)]
    #[arg(conflicts_with = "cameras")]
    pub(super) fov: Option<f32>,

    /// Cameras from a JSON list of {eye, target, up, fov_y_deg or ortho_height, aspect, near, far};
    /// see docs/cull-schema.md
    #[arg(long, help_heading = "Camera", value_name = "FILE.json")]
    pub(super) cameras: Option<PathBuf>,
}

impl ViewArgs {
    /// Whether any place is asked for.
    pub fn is_given(&self) -> bool {
        let is_placed = self.camera.is_some() || self.eye.is_some();
        is_placed || self.fov.is_some() || self.cameras.is_some()
    }

    /// The file of cameras, where there is one.
    pub fn file(&self) -> Option<&Path> {
        self.cameras.as_deref()
    }

    /// Finds what clap cannot: contradictions between the values of several arguments.
    pub fn check(&self) -> anyhow::Result<()> {
        check_direction(self.eye, self.target, self.up)
    }
}
