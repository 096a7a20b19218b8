//! Arguments of `foveal cull`, and which of them make no sense together.

use std::path::PathBuf;

use glam::Vec3;

use super::occluders::Choice;
use crate::failure::usage;
use crate::import_args::ImportArgs;
use crate::values;

/// Arguments of `foveal cull`.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct Args {
    /// A glTF 2.0 file or a generated scene, as for `foveal render`; or recorded occluder draws (.mocrec)
    #[arg(default_value = crate::scene_source::DEFAULT_SCENE)]
    pub(super) scene: String,

    #[command(flatten)]
    pub(super) views: ViewArgs,

    #[command(flatten)]
    pub(super) culling: CullingArgs,

    #[command(flatten)]
    pub(super) import: ImportArgs,

    /// The depth buffer's size in pixels; coverage is sampled 4x4 times in each. Intel's sample has 320x192,
    /// 640x360, 1280x720 and 1920x1080
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "640x360")]
    pub(super) size: (u32, u32),

    /// How many threads work
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub(super) threads: u32,

    /// Repeat each frame N times; times are medians
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(super) frames: u32,

    /// Write the depth buffer as a picture: near is bright, dark blue is empty. With several cameras their
    /// number goes before the ending
    #[arg(long, value_name = "FILE.png")]
    pub(super) depth: Option<PathBuf>,

    /// Write the depth buffer with the projected boxes over it: green visible, red occluded, yellow small
    #[arg(long, value_name = "FILE.png")]
    pub(super) overlay: Option<PathBuf>,

    /// Write the figures and what became of each object as JSON (see docs/cull-schema.md); `-` prints it
    /// instead of the table
    #[arg(long, value_name = "FILE.json|-")]
    pub(super) json: Option<PathBuf>,

    /// Compare with an exact reference at the same resolution and at four times it; exit code 1 if anything
    /// visible was culled. Slow
    #[arg(long)]
    pub(super) check: bool,

    /// Show no progress
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// What occludes, and what is too small to count.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Culling")]
pub(crate) struct CullingArgs {
    /// What occludes: `auto` (what the file marks, else everything), `marked` (nodes with extras.occluder),
    /// `all`, or names of sets (extras.set) with commas between. Only opaque surfaces occlude
    #[arg(long, value_name = "auto|marked|all|SET,…", default_value = "auto")]
    pub(crate) occluders: Choice,

    /// Leave out occluders that look smaller than this (Intel's sample: 1.5)
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = values::non_negative)]
    pub(crate) occluder_size_threshold: f32,

    /// Leave out parts of occluders that can cover fewer pixels of the depth buffer than this per quadrilateral
    #[arg(long, value_name = "PX", default_value_t = 6.0, value_parser = values::non_negative)]
    pub(crate) occluder_pixels_per_quad: f32,

    /// Cull objects that look smaller than this (Intel's sample: 0.01)
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = values::non_negative)]
    pub(crate) occludee_size_threshold: f32,

    /// Cull for two eyes so many metres apart, with the camera between them: what is culled is hidden from both
    #[arg(long, value_name = "M", default_value_t = 0.0, value_parser = values::non_negative)]
    pub(crate) eyes_apart: f32,

    /// The result shall hold while each eye moves by less than this, metres
    #[arg(long, value_name = "M", default_value_t = 0.0, value_parser = values::non_negative)]
    pub(crate) validity_radius: f32,

    /// Begin no occluder later than this in a frame, milliseconds: near ones come first, and what is left out
    /// only makes more visible
    #[arg(long, value_name = "MS", value_parser = values::non_negative)]
    pub(crate) budget_ms: Option<f32>,
}

/// Where the scene is seen from.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Camera")]
pub(crate) struct ViewArgs {
    /// One camera of the scene, by name or by number from 0, or `overview`. Without: all of the scene's cameras
    #[arg(long, value_name = "NAME", conflicts_with_all = ["eye", "target", "cameras"])]
    pub(super) camera: Option<String>,

    /// The eye's position in metres
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vec3, allow_hyphen_values = true)]
    #[arg(requires = "target", conflicts_with = "cameras")]
    pub(super) eye: Option<Vec3>,

    /// The point to look at in metres
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vec3, allow_hyphen_values = true, requires = "eye")]
    pub(super) target: Option<Vec3>,

    /// The vertical field of view in degrees [default: the camera's own, else 60]
    #[arg(long, value_name = "DEG", value_parser = values::fov_deg, conflicts_with = "cameras")]
    pub(super) fov: Option<f32>,

    /// Cameras from a JSON list of {eye, target, up, fov_y_deg or ortho_height, aspect, near, far}; see
    /// docs/cull-schema.md
    #[arg(long, value_name = "FILE.json")]
    pub(super) cameras: Option<PathBuf>,
}

impl Args {
    /// Finds what clap cannot: contradictions between the values of several arguments.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        if self.views.eye.is_some() && self.views.eye == self.views.target {
            return usage(
                "--eye and --target are the same point: there is no direction to look in",
            );
        }
        for file in self.depth.iter().chain(&self.overlay) {
            if file
                .extension()
                .is_none_or(|e| !e.eq_ignore_ascii_case("png"))
            {
                return usage(format!(
                    "'{}' must end in .png: pictures are written as PNG",
                    file.display()
                ));
            }
        }
        if self.depth.is_some() && self.depth == self.overlay {
            return usage("--depth and --overlay name the same file");
        }
        if is_recording(&self.scene)
            && (self.views.camera.is_some()
                || self.views.eye.is_some()
                || self.views.fov.is_some()
                || self.views.cameras.is_some())
        {
            return usage("recorded draws have their own view: no camera can be chosen");
        }
        Ok(())
    }
}

/// Whether SCENE names recorded draws.
pub(super) fn is_recording(scene: &str) -> bool {
    std::path::Path::new(scene)
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("mocrec"))
}
