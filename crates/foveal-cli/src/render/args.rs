//! Arguments of `foveal render`, and which of them exclude each other.

use std::ops::Range;
use std::path::{Path, PathBuf};

use foveal::Settings;
use foveal_scene::Camera;
use glam::Vec3;

use super::settings_args::SettingsArgs;
use crate::failure::usage;
use crate::import_args::ImportArgs;
use crate::values;

/// Arguments of `foveal render`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A glTF 2.0 file (.gltf or .glb), or a generated scene: demo, demo:INSTANCES, materials, materials2,
    /// cornell, materials-grid, alpha
    #[arg(default_value = crate::scene_source::DEFAULT_SCENE)]
    pub(super) scene: String,

    /// The PNG file to write; for --frames with the number's place in it: frame_####.png or {frame}.png. Given once
    /// more: how the picture shows what both eyes see, as --show does
    #[arg(short, long, value_name = "FILE.png|HOW", required = true)]
    output: Vec<PathBuf>,

    #[command(flatten)]
    pub(super) settings: SettingsArgs,

    #[command(flatten)]
    pub(super) camera: CameraArgs,

    #[command(flatten)]
    pub(super) frames: FrameArgs,

    #[command(flatten)]
    pub(super) import: ImportArgs,

    /// Add N coloured point lights to the scene
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::point_lights)]
    pub(super) point_lights: u32,

    /// Another number scatters the added point lights differently
    #[arg(long, value_name = "N", default_value_t = 0, requires = "point_lights")]
    pub(super) light_seed: u64,

    /// The graphics adapter: part of its name, or its number in `foveal adapters`
    #[arg(long, value_name = "NAME|NUMBER")]
    pub(super) adapter: Option<String>,

    /// Write times and counts as JSON (see docs/stats.schema.json)
    #[arg(long, value_name = "FILE.json")]
    pub(super) stats: Option<PathBuf>,

    /// Draw the first frame N times before the one that is measured and written
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) warmup: u32,

    /// Print nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// Where the frame is seen from.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Camera")]
pub(crate) struct CameraArgs {
    /// A camera of the scene, by name or by number from 0; or `overview`: the whole scene from outside; or
    /// `inside`: the longest view within it. Without: the scene's first camera, else whichever of the two fits
    #[arg(long, value_name = "NAME", conflicts_with_all = ["eye", "target"])]
    pub(super) camera: Option<String>,

    /// The eye's position in metres
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vec3, allow_hyphen_values = true)]
    #[arg(requires = "target")]
    pub(super) eye: Option<Vec3>,

    /// The point to look at in metres
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vec3, allow_hyphen_values = true)]
    #[arg(requires = "eye")]
    pub(super) target: Option<Vec3>,

    /// The direction that is up in the picture [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vec3, allow_hyphen_values = true, requires = "eye")]
    pub(super) up: Option<Vec3>,

    /// The vertical field of view in degrees [default: the camera's own, else 60]
    #[arg(long, value_name = "DEG", value_parser = values::fov_deg)]
    pub(super) fov: Option<f32>,

    /// A camera to the last bit, as the window copies it: perspective,FOV_RAD,NEAR_M or
    /// orthographic,HEIGHT_M,NEAR_M,FAR_M, then twelve numbers: right, up, back, eye
    #[arg(long, value_name = "NUMBERS", value_parser = values::exact_camera, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["camera", "eye", "target", "fov"])]
    pub(super) exact_camera: Option<Camera>,

    /// Move along the keyframes in a JSON file (see docs/program.md), or along the demo scene's own path: demo; or to and
    /// fro around another camera, sideways by 5 cm at up to 5 cm a second, as a head does: sway
    #[arg(long, value_name = "FILE.json|demo|sway")]
    pub(super) path: Option<String>,
}

/// Which moments are drawn.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Time")]
pub(crate) struct FrameArgs {
    /// The moment of a single picture, in seconds
    #[arg(long, value_name = "S", value_parser = values::time_s, conflicts_with = "frames")]
    pub(super) time: Option<f32>,

    /// Show the moment at rest: the frame before, from which motion is taken, is the same
    #[arg(long, conflicts_with = "frames")]
    pub(super) still: bool,

    /// Draw the frames A up to but not including B, or 0 up to N; frame n is at n / fps seconds
    #[arg(long, value_name = "A..B|N", value_parser = values::frames)]
    pub(super) frames: Option<Range<u32>>,

    /// Frames per second; the frame before, from which motion is taken, is 1 / fps seconds earlier
    #[arg(long, value_name = "N", value_parser = values::positive, default_value_t = 30.0)]
    pub(super) fps: f32,

    /// Leave out frames whose file is there already
    #[arg(long, requires = "frames")]
    pub(super) skip_existing: bool,
}

impl CameraArgs {
    /// The same along a path; one that is asked for already stays. Where the scene has a path of its own and no other place
    /// is asked for it is that one, else swaying.
    pub(crate) fn along_a_path(&self, scene_name: &str) -> Self {
        let is_placed = self.camera.is_some() || self.eye.is_some() || self.exact_camera.is_some();
        let has_own = crate::scene_source::camera_path(scene_name).is_some();
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
    pub(crate) fn flags(&self) -> Vec<String> {
        let place = |p: Vec3| format!("{},{},{}", p.x, p.y, p.z);
        let exact = self.exact_camera.as_ref();
        [
            ("--camera", self.camera.clone()),
            ("--eye", self.eye.map(place)),
            ("--target", self.target.map(place)),
            ("--up", self.up.map(place)),
            ("--fov", self.fov.map(|fov| fov.to_string())),
            ("--exact-camera", exact.map(foveal_view::exact_camera)),
            ("--path", self.path.clone()),
        ]
        .into_iter()
        .filter_map(|(flag, value)| Some([flag.to_owned(), value?]))
        .flatten()
        .collect()
    }
}

impl Args {
    /// The file to write, and what else `--output` names.
    fn outputs(&self) -> (Option<&Path>, Option<&str>) {
        let names = foveal::variant_names::<foveal::Output>();
        let is_name = |output: &&PathBuf| names.iter().any(|name| output.as_os_str() == *name);
        let file = self.output.iter().find(|output| !is_name(output));
        let shown = self.output.iter().find(is_name);
        (file.map(PathBuf::as_path), shown.and_then(|s| s.to_str()))
    }

    /// The file to write; empty where none is given.
    pub(super) fn output(&self) -> &Path {
        self.outputs().0.unwrap_or(Path::new(""))
    }

    /// The settings that hold.
    pub(super) fn settings(&self) -> anyhow::Result<Settings> {
        let mut settings = self.settings.clone();
        if let Some(shown) = self.outputs().1 {
            settings.given.insert("show".to_owned(), shown.into());
        }
        settings.resolve()
    }

    /// Finds what clap cannot: contradictions between the values of several arguments.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        let (file, shown) = self.outputs();
        if self.output.len() != usize::from(file.is_some()) + usize::from(shown.is_some()) {
            return usage("--output names one PNG file, and at most one way to show it");
        }
        if self
            .output()
            .extension()
            .is_none_or(|e| !e.eq_ignore_ascii_case("png"))
        {
            return usage(format!(
                "'{}' must end in .png: pictures are written as PNG",
                self.output().display()
            ));
        }
        if let (Some(eye), Some(target)) = (self.camera.eye, self.camera.target) {
            if eye == target {
                return usage(
                    "--eye and --target are the same point: there is no direction to look in",
                );
            }
            let up = self.camera.up.unwrap_or(Vec3::Y);
            if up == Vec3::ZERO {
                return usage("--up is 0,0,0: there is no direction that is up");
            }
        }
        if self
            .stats
            .as_ref()
            .is_some_and(|stats| stats == self.output())
        {
            return usage("--stats and --output name the same file");
        }
        Ok(())
    }
}
