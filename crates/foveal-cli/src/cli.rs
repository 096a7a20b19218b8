//! The command line's first level: which subcommand.

use clap::{Parser, Subcommand};

use crate::{adapters, bench, compare, render, scene_info};

/// Foveal renders scenes, and measures what rendering costs and how far two pictures are apart.
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

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw a scene into a PNG file, or a sequence of frames into many
    Render(Box<render::Args>),
    /// Measure what a technique gains against its reference
    #[command(subcommand)]
    Bench(bench::Bench),
    /// Measure how far two pictures of the same size are apart
    Compare(compare::Args),
    /// List the graphics adapters of this machine
    Adapters(adapters::Args),
    /// Look into a scene without drawing it
    #[command(subcommand)]
    Scene(SceneCommand),
}

/// What to do with a scene.
#[derive(Debug, Subcommand)]
pub(crate) enum SceneCommand {
    /// Counts, size, cameras and warnings
    Info(scene_info::Args),
}

impl Command {
    /// The words after `foveal` that lead to this command's help.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Render(_) => "render",
            Self::Bench(_) => "bench",
            Self::Compare(_) => "compare",
            Self::Adapters(_) => "adapters",
            Self::Scene(SceneCommand::Info(_)) => "scene info",
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_do_not_contradict_each_other() {
        super::Cli::command().debug_assert();
    }
}
