//! Where a bench's figures go: the same for each that measures on a graphics adapter.

use std::path::{Path, PathBuf};

use foveal::Gpu;
use serde::Serialize;

use foveal_host::clock::now_ms;
use foveal_host::{atomic_file, console, gpu};

/// What every such bench is told.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct FigureArgs {
    /// Graphics adapter: part of its name, or its number in `foveal adapters`
    #[arg(long, value_name = "NAME|NUMBER")]
    adapter: Option<String>,

    /// Write the figures as JSON; `-`: print JSON instead of the table
    #[arg(long, value_name = "FILE.json", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
}

impl FigureArgs {
    fn file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|path| path.as_os_str() != "-")
    }

    /// Starts the clock and opens the device. Fails where the figures could not be written later;
    /// nothing shall be measured for nothing.
    pub(super) fn begin(&self) -> anyhow::Result<Gpu> {
        now_ms();
        self.file().map_or(Ok(()), atomic_file::check_writable)?;
        gpu::open(self.adapter.as_deref())
    }

    /// The flags by which other commands use the same adapter.
    pub(super) fn adapter_flags(&self) -> Vec<String> {
        let adapter = self.adapter.iter();
        adapter
            .flat_map(|name| ["--adapter".to_owned(), name.clone()])
            .collect()
    }

    /// Writes the report where it was asked for, and prints it or the table.
    pub(super) fn give(&self, report: &impl Serialize, table: &str) -> anyhow::Result<()> {
        let json = serde_json::to_string_pretty(report)? + "\n";
        match (self.file(), &self.json) {
            (Some(path), _) => {
                atomic_file::write(path, json.as_bytes())?;
                console::print_result(table)
            }
            (None, Some(_)) => console::print_result(&json),
            (None, None) => console::print_result(table),
        }
    }
}
