//! `foveal bench`: what each technique costs and gains against its plain reference.
//!
//! Modes are drawn in turn, round after round, and compared within each round, so that a machine that is busy
//! with something else slows all of them alike.

mod antialiasing;
mod table;

use clap::Subcommand;

/// Which technique.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// No anti-aliasing, MSAA and SSAA: time, edges, and how near each comes to many samples
    Antialiasing(antialiasing::Args),
}

impl Command {
    /// The words after `foveal` that lead to this command's help.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Antialiasing(_) => "bench antialiasing",
        }
    }
}

/// Runs one benchmark.
pub(crate) fn run(command: &Command) -> anyhow::Result<()> {
    match command {
        Command::Antialiasing(args) => antialiasing::run(args),
    }
}
