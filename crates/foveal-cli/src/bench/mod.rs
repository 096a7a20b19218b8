//! `foveal bench`: what a technique gains, and what it costs in likeness.

mod coarse;

/// Which technique.
#[derive(Debug, clap::Subcommand)]
pub(crate) enum Bench {
    /// Coarse shading against shading every pixel
    Coarse(coarse::Args),
}

pub(crate) fn run(bench: &Bench) -> anyhow::Result<()> {
    match bench {
        Bench::Coarse(args) => coarse::run(args),
    }
}
