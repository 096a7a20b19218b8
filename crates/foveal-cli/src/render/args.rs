//! Arguments of `foveal render`, and which of them exclude each other.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

use foveal::Settings;
use foveal_host::camera::CameraArgs;
use foveal_host::failure::usage;
use foveal_host::import_args::ImportArgs;
use foveal_host::linear_picture::PictureFormat;
use foveal_host::settings::SettingsArgs;
use foveal_host::{atomic_file, scene_source, values};

use super::sharing::Part;

/// The name that means standard output.
const STDOUT: &str = "-";

/// The help of a setting that [`Args::settings`] switches on.
fn on_by_default(arg: clap::Arg) -> clap::Arg {
    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
    arg.help(help.replace(
        "[default: false]",
        "Whatever a settings file says [default: true]",
    ))
}

/// Arguments of `foveal render`.
#[derive(Debug, clap::Args)]
#[command(mut_arg("force-rate", on_by_default))]
pub(crate) struct Args {
    /// A glTF 2.0 file (.gltf or .glb), a mesh (.obj or .ply), a generated scene (demo,
    /// demo:INSTANCES, materials, materials2, cornell, materials-grid, alpha, lobes, yard), or -: a
    /// .glb or PLY file on standard input
    #[arg(default_value = scene_source::DEFAULT_SCENE)]
    pub(super) scene: String,

    /// Picture to write: FILE.png; FILE.exr or FILE.hdr with linear radiance before exposure and
    /// tone map; - for a PNG on standard output. With --frames the name has a place for the number:
    /// frame_####.png or {frame}.png. May be given once more to say how both eyes are shown, as
    /// --show does
    #[arg(
        short,
        long,
        value_name = "FILE|HOW",
        required_unless_present = "video"
    )]
    output: Vec<PathBuf>,

    /// Video of the frames, encoded by the program ffmpeg: FILE.mp4, FILE.webm or another ending
    /// that it knows
    #[arg(
        long,
        value_name = "FILE",
        requires = "frames",
        conflicts_with = "skip_existing"
    )]
    pub(super) video: Option<PathBuf>,

    #[command(flatten)]
    pub(super) settings: SettingsArgs,

    #[command(flatten)]
    pub(super) camera: CameraArgs,

    #[command(flatten)]
    pub(super) frames: FrameArgs,

    #[command(flatten)]
    pub(super) import: ImportArgs,

    /// Number of coloured point lights to add to the scene
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::point_lights)]
    pub(super) point_lights: u32,

    /// Seed of the added point lights; another one scatters them differently
    #[arg(long, value_name = "N", default_value_t = 0, requires = "point_lights")]
    pub(super) light_seed: u64,

    /// Graphics adapter: part of its name, or its number in `foveal adapters`
    #[arg(long, value_name = "NAME|NUMBER")]
    pub(super) adapter: Option<String>,

    /// Write times and counts as JSON (see docs/stats.schema.json). Not with --share, whose jobs
    /// would replace each other's file
    #[arg(long, value_name = "FILE.json", conflicts_with = "share")]
    pub(super) stats: Option<PathBuf>,

    /// Number of frames before the first that are drawn, but neither measured nor written: those
    /// 1 / fps, 2 / fps .. seconds earlier. Nothing is before the moment 0, which stands in for them
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::frame_count)]
    pub(super) warmup: u32,

    /// Print nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// Which moments are drawn.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct FrameArgs {
    /// Time of a single picture in seconds
    #[arg(long, help_heading = "Time", value_name = "S", value_parser = values::time_s, conflicts_with = "frames")]
    pub(super) time: Option<f32>,

    /// Nothing moves: the frame before, from which motion is taken, is the same as this one
    #[arg(long, help_heading = "Time", conflicts_with = "frames")]
    pub(super) still: bool,

    /// Range of frames to draw: A up to but not including B, or 0 up to N; frame n is at n / fps
    /// seconds
    #[arg(long, help_heading = "Time", value_name = "A..B|N", value_parser = values::frames)]
    pub(super) frames: Option<Range<u32>>,

    /// Frames per second; the frame before, from which motion is taken, is 1 / fps seconds earlier
    #[arg(long, help_heading = "Time", value_name = "N", value_parser = values::positive, default_value_t = 30.0)]
    pub(super) fps: f32,

    /// Skip frames whose file exists already
    #[arg(long, help_heading = "Time", requires = "frames")]
    pub(super) skip_existing: bool,

    /// Draw one of N equal parts of the range: I from 0 to N - 1; `auto`: the part of this job in a
    /// Slurm array, a Kubernetes indexed job or an AWS Batch array (see docs/program.md). Not with
    /// --video: each job's film would replace the others'
    #[arg(
        long,
        help_heading = "Time",
        value_name = "I/N|auto",
        requires = "frames",
        conflicts_with = "video"
    )]
    #[arg(value_parser = Part::parse)]
    part: Option<Part>,

    /// Share the frames with all jobs that run the same command in the same folder: each draws
    /// frames that are missing and that no other job is drawing, and ends when all are there
    #[arg(
        long,
        help_heading = "Time",
        requires = "frames",
        conflicts_with = "video"
    )]
    pub(super) share: bool,

    /// Time in seconds after which the frame of a shared job that gives no sign of life is drawn by
    /// another
    #[arg(long, help_heading = "Time", value_name = "S")]
    #[arg(requires = "share", value_parser = values::positive, default_value_t = 120.0)]
    share_expiry: f32,
}

impl FrameArgs {
    /// The frames of this job.
    pub(super) fn range(&self) -> anyhow::Result<Option<Range<u32>>> {
        match (&self.frames, self.part) {
            (Some(range), Some(part)) => {
                let variable = |name: &str| std::env::var(name).ok();
                Ok(Some(part.of(range, variable)?))
            }
            (range, _) => Ok(range.clone()),
        }
    }

    pub(super) fn share_expiry(&self) -> Duration {
        Duration::from_secs_f32(self.share_expiry.clamp(0.1, 1e6))
    }
}

impl Args {
    /// The file to write, and what else `--output` names.
    pub(super) fn outputs(&self) -> (Option<&Path>, Option<&str>) {
        let names = foveal::variant_names::<foveal::Output>();
        let is_name = |output: &&PathBuf| names.iter().any(|name| output.as_os_str() == *name);
        let file = self.output.iter().find(|output| !is_name(output));
        let shown = self.output.iter().find(is_name);
        (file.map(PathBuf::as_path), shown.and_then(|s| s.to_str()))
    }

    /// The picture to write, or the pattern of pictures; `None` where only a video is written.
    pub(super) fn output(&self) -> Option<&Path> {
        self.outputs().0
    }

    /// What is written, as the figures name it.
    pub(super) fn output_name(&self) -> String {
        let path = self.output().or(self.video.as_deref());
        path.map(|path| path.display().to_string())
            .unwrap_or_default()
    }

    /// Whether the picture goes to standard output.
    pub(super) fn is_piped(&self) -> bool {
        self.output().is_some_and(|file| file == Path::new(STDOUT))
    }

    /// The settings that hold.
    pub(super) fn settings(&self) -> anyhow::Result<Settings> {
        let mut settings = self.settings.clone();
        // What is in files hangs on the settings, not on how long frames took.
        settings.switch_on_by_default("force-rate");
        if let Some(shown) = self.outputs().1 {
            settings.set("show", shown);
        }
        settings.resolve()
    }

    /// Finds what clap cannot: contradictions between the values of several arguments.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        let (file, shown) = self.outputs();
        if self.output.len() != usize::from(file.is_some()) + usize::from(shown.is_some()) {
            return usage("--output names one picture, and at most one way to show it");
        }
        if shown.is_some() && self.settings.gives("show") {
            return usage("--output and --show both say how eyes are shown: give one of them");
        }
        if file.is_none() && self.video.is_none() {
            return usage(
                "--output says how both eyes are shown; name a picture too: --output FILE.png",
            );
        }
        if let Some(file) = file {
            let format = PictureFormat::of(file);
            if self.is_piped() {
                if self.frames.frames.is_some() {
                    return usage(
                        "standard output takes one picture; --frames needs --output frame_####.png or --video",
                    );
                }
            } else if format.is_none() {
                return usage(format!(
                    "'{}' must end in .png, .exr or .hdr, or be - for a PNG on standard output",
                    file.display()
                ));
            }
        }
        self.camera.check()?;
        if atomic_file::any_twice(self.written()) {
            return usage("--output, --video and --stats name the same file");
        }
        let replaces = |file| scene_source::is_replaced_by(&self.scene, file);
        if self.written().any(replaces) {
            return usage("--output, --video or --stats names the scene's own file");
        }
        Ok(())
    }

    /// The files that are written.
    fn written(&self) -> impl Iterator<Item = &Path> {
        let files = [self.output(), self.video.as_deref(), self.stats.as_deref()];
        files.into_iter().flatten()
    }

    /// Finds what the settings contradict, which are read once: they may come through a pipe.
    pub(super) fn check_beside(&self, settings: &Settings) -> anyhow::Result<()> {
        let images = [
            &settings.lighting.environment_image,
            &settings.coarse.image_name,
        ];
        let read = [self.settings.file(), self.camera.path_file()];
        let read = (read.into_iter().flatten()).chain(images.map(Path::new));
        for read in read {
            if (self.written()).any(|file| atomic_file::replaces(file, read)) {
                return usage(format!(
                    "--output, --video or --stats names '{}', which is read",
                    read.display()
                ));
            }
        }
        match self.output() {
            Some(file) if PictureFormat::of(file).is_some_and(PictureFormat::is_linear) => {
                self.check_linear(file, settings)
            }
            _ => Ok(()),
        }
    }

    /// Files of radiance hold what is there before tone map, lenses and colour glasses.
    fn check_linear(&self, file: &Path, settings: &Settings) -> anyhow::Result<()> {
        let refuse = |setting: &str| {
            usage(format!(
                "'{}' holds radiance, which {setting} does not change or has none of: write a .png, or leave it out",
                file.display()
            ))
        };
        if settings.picture.view != foveal::DebugView::Final {
            return refuse("--view");
        }
        let is_shown_so = match settings.stereo.output {
            foveal::Output::SideBySide => true,
            foveal::Output::Flat => self.outputs().1.is_none() && !self.settings.gives("show"),
            _ => false,
        };
        if settings.is_stereo() && !is_shown_so {
            return refuse("--show");
        }
        if settings.picture.render_scale != 1.0 {
            return refuse("--render-scale");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Args;
    use clap::{CommandFactory, Parser};

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        args: Args,
    }

    #[test]
    fn what_is_in_files_does_not_hang_on_times_unless_asked_to() {
        let forced = |words: &[&str]| {
            let words = ["render", "cornell", "-o", "a.png", "--shading", "coarse"]
                .iter()
                .chain(words);
            let command = Command::try_parse_from(words).unwrap();
            command.args.settings().unwrap().rate.force
        };
        assert!(forced(&[]));
        assert!(forced(&["--force-rate", "true"]));
        assert!(!forced(&["--force-rate", "false"]));
    }

    #[test]
    fn the_help_names_the_default_of_what_is_switched_on() {
        let command = Command::command();
        let flag = command
            .get_arguments()
            .find(|arg| arg.get_id() == "force-rate");
        let help = flag.and_then(clap::Arg::get_help).unwrap().to_string();
        assert!(help.ends_with("[default: true]"), "{help}");
    }
}
