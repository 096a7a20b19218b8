//! `foveal bench`: what each technique costs and gains. One file per technique.

mod culling;

use clap::Subcommand;

/// What to measure.
#[derive(Debug, Subcommand)]
pub(crate) enum BenchCommand {
    /// Rasterizing occluders and testing boxes on the CPU
    Culling(Box<culling::Args>),
}

impl BenchCommand {
    /// The words after `foveal` that lead to this command's help.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Culling(_) => "bench culling",
        }
    }

    /// Measures, and prints or writes the figures.
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        match self {
            Self::Culling(args) => culling::run(args),
        }
    }
}
