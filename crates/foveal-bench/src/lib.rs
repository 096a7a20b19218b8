//! `foveal bench`: what each technique costs and gains against its plain reference. One file per
//! technique.
//!
//! Modes are measured in turn, round after round, and compared within each round, so that a machine
//! that is busy with something else slows all of them alike.

mod antialiasing;
mod changes;
mod coarse;
mod culling;
mod culling_frames;
mod eye;
mod figures;
mod report;
mod shared;
mod stereo;
mod subject;
mod svg;
mod table;
mod variable;
mod verdict;

pub use report::diff::diff_of_texts;
pub use report::planned_commands;

use clap::Subcommand;

/// The benches.
#[derive(Debug, Subcommand)]
pub enum BenchCommand {
    /// The settings that make this scene faster on this machine, and their error
    Verdict(Box<verdict::Args>),
    /// Occlusion culling on the CPU: rasterizing occluders, testing boxes
    Culling(Box<culling::Args>),
    /// Whole frames by each way of culling, against all objects
    CullingFrames(culling_frames::Args),
    /// Coarse shading against shading every pixel
    Coarse(coarse::Args),
    /// Anti-aliasing: none, MSAA and SSAA by time, edges, and distance from many samples
    Antialiasing(antialiasing::Args),
    /// Visible difference of each way of shading on displays: JOD, lit samples, time, flicker
    Eye(eye::Args),
    /// Variable-rate shading, by content, against shading every pixel
    Variable(variable::Args),
    /// Stereo by each way of submission, against one eye and against two passes
    Stereo(stereo::Args),
    /// All benches and the verdict as one report: a page with pictures and plots, JSON, CSV
    All(report::Args),
    /// Differences between two reports: what became slower, what faster
    Diff(report::diff::Args),
}

impl BenchCommand {
    /// The words after `foveal` that lead to this command's help.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Verdict(_) => "bench verdict",
            Self::Culling(_) => "bench culling",
            Self::CullingFrames(_) => "bench culling-frames",
            Self::Coarse(_) => "bench coarse",
            Self::Eye(_) => "bench eye",
            Self::Antialiasing(_) => "bench antialiasing",
            Self::Variable(_) => "bench variable",
            Self::Stereo(_) => "bench stereo",
            Self::All(_) => "bench all",
            Self::Diff(_) => "bench diff",
        }
    }

    /// Measures, and prints or writes the figures.
    pub fn run(&self) -> anyhow::Result<()> {
        match self {
            Self::Verdict(args) => verdict::run(args),
            Self::Culling(args) => culling::run(args),
            Self::CullingFrames(args) => culling_frames::run(args),
            Self::Coarse(args) => coarse::run(args),
            Self::Eye(args) => eye::run(args),
            Self::Antialiasing(args) => antialiasing::run(args),
            Self::Variable(args) => variable::run(args),
            Self::Stereo(args) => stereo::run(args),
            Self::All(args) => report::run(args),
            Self::Diff(args) => report::diff::run(args),
        }
    }
}
