//! Arguments of `foveal render`, and which of them exclude each other.

use std::ops::Range;
use std::path::{Path, PathBuf};

use foveal::Settings;
use foveal_host::camera::CameraArgs;
use foveal_host::failure::usage;
use foveal_host::import_args::ImportArgs;
use foveal_host::settings::SettingsArgs;
use foveal_host::values;

/// Arguments of `foveal render`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A glTF 2.0 file (.gltf or .glb), or a generated scene: demo, demo:INSTANCES, materials, materials2,
    /// cornell, materials-grid, alpha
    #[arg(default_value = foveal_host::scene_source::DEFAULT_SCENE)]
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
            settings.set("show", shown);
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
        self.camera.check()?;
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
