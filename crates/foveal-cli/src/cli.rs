//! The command line's first level: which subcommand.

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::{adapters, compare, completions, cull, render, scene_info, view};
use foveal_bench::BenchCommand;

/// Foveal renders scenes and measures what each technique costs, gains and changes in the picture.
#[derive(Debug, Parser)]
#[command(
    name = "foveal",
    version,
    propagate_version = true,
    max_term_width = 100
)]
#[command(after_help = "Exit codes: 0 done, 1 failed, 2 wrong usage.")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Cli {
    /// Reads the command line; ends the program where it is wrong, or asks for help.
    pub(crate) fn read() -> Self {
        let mut command = with_negative_numbers(Self::command());
        let matches = command.get_matches_mut();
        Self::from_arg_matches(&matches).unwrap_or_else(|error| error.format(&mut command).exit())
    }
}

/// Takes numbers below zero for the values of flags, which say themselves why they are none, and not
/// for unknown flags.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command
        .mut_args(|arg| {
            let is_value = arg.get_action().takes_values() && !arg.is_positional();
            arg.allow_negative_numbers(is_value)
        })
        .mut_subcommands(with_negative_numbers)
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw a scene into a picture (PNG, EXR or HDR), or a sequence of frames into numbered files
    /// or a video
    Render(Box<render::Args>),
    /// Open a window on a scene: fly, switch every setting, see what it costs
    View(Box<view::Args>),
    /// Measure the difference of two pictures, or of two videos
    Compare(compare::Args),
    /// List the graphics adapters of this machine
    Adapters(adapters::Args),
    /// Describe a scene without drawing it
    #[command(subcommand)]
    Scene(SceneCommand),
    /// Cull a scene on the CPU: what is visible, occluded, outside or too small, and what that
    /// costs
    Cull(Box<cull::Args>),
    /// Measure what each technique costs and gains
    #[command(subcommand)]
    Bench(Box<BenchCommand>),
    /// Print completions for a shell
    Completions(completions::Args),
    /// Write manual pages, one per command
    Man(completions::ManArgs),
}

/// What to do with a scene.
#[derive(Debug, Subcommand)]
pub(crate) enum SceneCommand {
    /// Print counts, size, cameras and warnings
    Info(scene_info::Args),
}

impl Command {
    /// The words after `foveal` that lead to this command's help.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Render(_) => "render",
            Self::View(_) => "view",
            Self::Compare(_) => "compare",
            Self::Adapters(_) => "adapters",
            Self::Scene(SceneCommand::Info(_)) => "scene info",
            Self::Cull(_) => "cull",
            Self::Bench(command) => command.name(),
            Self::Completions(_) => "completions",
            Self::Man(_) => "man",
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::{Args, Command, CommandFactory, Parser};
    use foveal_host::camera::CameraArgs;
    use foveal_host::culling::{CullingArgs, ViewArgs};
    use foveal_host::import_args::ImportArgs;
    use foveal_host::settings::SettingsArgs;

    use crate::render::FrameArgs;

    #[test]
    fn the_arguments_do_not_contradict_each_other() {
        super::with_negative_numbers(super::Cli::command()).debug_assert();
    }

    /// A heading holds for the flags of its group alone, not for those that come after it.
    #[test]
    fn the_help_has_each_flag_under_the_heading_of_its_group() {
        fn names<A: Args>() -> Vec<String> {
            let command = A::augment_args(Command::new("group"));
            command
                .get_arguments()
                .map(|arg| arg.get_id().to_string())
                .collect()
        }
        fn check(command: &Command, groups: &[(&str, Vec<String>)]) -> usize {
            let mut grouped = 0;
            for arg in command.get_arguments() {
                let heading = arg.get_help_heading();
                if let Some((_, names)) = groups.iter().find(|(group, _)| heading == Some(*group)) {
                    let name = arg.get_id().as_str();
                    assert!(
                        names.iter().any(|own| own == name),
                        "{}: {name}",
                        command.get_name()
                    );
                    grouped += 1;
                }
            }
            grouped
                + command
                    .get_subcommands()
                    .map(|c| check(c, groups))
                    .sum::<usize>()
        }
        let groups = [
            (
                "Camera",
                [names::<CameraArgs>(), names::<ViewArgs>()].concat(),
            ),
            (
                "Culling",
                [names::<CullingArgs>(), names::<SettingsArgs>()].concat(),
            ),
            ("Scene files", names::<ImportArgs>()),
            ("Time", names::<FrameArgs>()),
        ];
        assert!(check(&super::Cli::command(), &groups) > 50);
    }

    #[test]
    fn the_report_runs_commands_that_there_are() {
        for words in foveal_bench::planned_commands("cornell") {
            let line = std::iter::once("foveal").chain(words.iter().map(String::as_str));
            let parsed = super::Cli::try_parse_from(line);
            assert!(parsed.is_ok(), "{words:?}: {:?}", parsed.err());
        }
    }
}
