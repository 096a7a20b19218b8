//! `foveal bench culling`: what rasterizing occluders and testing boxes cost on the CPU.

/// Arguments of `foveal bench culling`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {}

/// Measures what the arguments ask for.
pub(crate) fn run(_: &Args) -> anyhow::Result<()> {
    anyhow::bail!("not measured yet")
}
