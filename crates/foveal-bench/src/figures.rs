//! Where a bench's figures go: the same for each that measures on a graphics adapter.

use std::path::{Path, PathBuf};

use foveal::Gpu;
use serde::Serialize;

use foveal_host::camera::CameraArgs;
use foveal_host::clock::now_ms;
use foveal_host::failure::usage;
use foveal_host::{atomic_file, console, gpu, scene_source};

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

/// Fails where figures cannot be written to `file`, or would replace the file of cameras or a scene: one
/// of `scenes`, or one that was meant to be measured and not to be written, as after a `--json` that
/// stands before it.
pub(super) fn check_figures(
    file: &Path,
    scenes: &[String],
    cameras: Option<&Path>,
) -> anyhow::Result<()> {
    let replaces = |scene: &String| scene_source::is_replaced_by(scene, file);
    if scenes.iter().any(replaces) {
        return usage("--json names the scene's own file");
    }
    if cameras.is_some_and(|read| atomic_file::replaces(file, read)) {
        return usage("--json names the camera's own file");
    }
    if file
        .extension()
        .is_none_or(|ending| !ending.eq_ignore_ascii_case("json"))
    {
        return usage(format!(
            "--json writes to '{}', which must end in .json; a scene comes before --json",
            file.display()
        ));
    }
    atomic_file::check_writable(file)
}

impl FigureArgs {
    fn file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|path| path.as_os_str() != "-")
    }

    /// Starts the clock and opens the device. Fails where the figures could not be written later, as
    /// nothing shall be measured for nothing, or would replace one of `scenes` or the camera's path.
    pub(super) fn begin(&self, scenes: &[String], camera: &CameraArgs) -> anyhow::Result<Gpu> {
        now_ms();
        if let Some(file) = self.file() {
            check_figures(file, scenes, camera.path_file())?;
        }
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
