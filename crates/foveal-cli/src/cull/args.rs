//! Arguments of `foveal cull`, and which of them make no sense together.

use std::path::PathBuf;

use foveal_host::culling::{CullingArgs, ViewArgs};
use foveal_host::failure::usage;
use foveal_host::import_args::ImportArgs;
use foveal_host::{atomic_file, picture, scene_source, values};

/// Arguments of `foveal cull`.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct Args {
    /// A glTF 2.0, OBJ or PLY file, or a generated scene, as for `foveal render`; or recorded
    /// occluder draws (.mocrec)
    #[arg(default_value = scene_source::DEFAULT_SCENE)]
    pub(super) scene: String,

    #[command(flatten)]
    pub(super) views: ViewArgs,

    #[command(flatten)]
    pub(super) culling: CullingArgs,

    #[command(flatten)]
    pub(super) import: ImportArgs,

    /// Size of the occlusion buffer in pixels; each has 4x4 samples of coverage. Intel's sample has
    /// 320x192, 640x360, 1280x720 and 1920x1080
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "640x360")]
    pub(super) size: (u32, u32),

    /// Number of worker threads
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub(super) threads: u32,

    /// Repetitions of each frame; times are their medians
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(super) frames: u32,

    /// Write the occlusion buffer as a picture: near is bright, dark blue is empty. With several
    /// cameras the number of each goes before .png
    #[arg(long, value_name = "FILE.png")]
    pub(super) depth: Option<PathBuf>,

    /// Write the occlusion buffer with the projected boxes over it: green visible, red occluded,
    /// yellow too small
    #[arg(long, value_name = "FILE.png")]
    pub(super) overlay: Option<PathBuf>,

    /// Write the stats and the visibility of each object as JSON (see docs/cull-schema.md); `-`
    /// prints it instead of the table
    #[arg(long, value_name = "FILE.json|-")]
    pub(super) json: Option<PathBuf>,

    /// Compare with the exact reference at the same resolution and at four times it (slow). Exit
    /// code 1 if anything visible was culled
    #[arg(long)]
    pub(super) check: bool,

    /// Show no progress
    #[arg(short, long)]
    pub(super) quiet: bool,
}

impl Args {
    /// Finds what clap cannot: contradictions between the values of several arguments.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        self.views.check()?;
        for file in self.depth.iter().chain(&self.overlay) {
            picture::check_name(file)?;
        }
        let written = self.depth.iter().chain(&self.overlay).chain(&self.json);
        let written = written.map(PathBuf::as_path);
        if atomic_file::any_twice(written.clone()) {
            return usage("--depth, --overlay and --json name the same file");
        }
        if (written.clone()).any(|file| scene_source::is_replaced_by(&self.scene, file)) {
            return usage("--depth, --overlay or --json names the scene's own file");
        }
        let cameras = self.views.file();
        if cameras.is_some_and(|read| { written }.any(|file| atomic_file::replaces(file, read))) {
            return usage("--depth, --overlay or --json names the file of cameras");
        }
        if is_recording(&self.scene) && self.views.is_given() {
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
