//! `foveal adapters`: what there is to draw with.

use std::fmt::Write;

use anyhow::bail;
use foveal::{AdapterStats, Gpu};

/// Arguments of `foveal adapters`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Print a JSON array of {number, name, backend, kind, driver} instead of a table
    #[arg(long)]
    json: bool,
}

/// Prints the adapters in the order in which `--adapter NUMBER` counts them.
pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let adapters = pollster::block_on(Gpu::adapters());
    let text = if args.json {
        json(&adapters)?
    } else {
        table(&adapters)
    };
    foveal_host::console::print_result(&text)?;
    if adapters.is_empty() {
        bail!(foveal_host::gpu::install_a_driver());
    }
    Ok(())
}

#[derive(serde::Serialize)]
struct Row<'a> {
    number: usize,
    #[serde(flatten)]
    adapter: &'a AdapterStats,
}

fn json(adapters: &[AdapterStats]) -> anyhow::Result<String> {
    let rows: Vec<Row<'_>> = adapters
        .iter()
        .enumerate()
        .map(|(number, adapter)| Row { number, adapter })
        .collect();
    Ok(serde_json::to_string_pretty(&rows)? + "\n")
}

fn table(adapters: &[AdapterStats]) -> String {
    let width = adapters
        .iter()
        .map(|a| a.name.chars().count())
        .max()
        .unwrap_or(0);
    let mut text = String::new();
    for (number, a) in adapters.iter().enumerate() {
        let AdapterStats {
            name,
            backend,
            kind,
            driver,
        } = a;
        let _ = writeln!(
            text,
            "{number:>2}  {name:width$}  {backend:6}  {kind:14}  {driver}"
        );
    }
    text
}
