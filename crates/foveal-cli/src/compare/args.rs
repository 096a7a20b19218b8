//! Arguments of `foveal compare`, and what its thresholds say.

use std::path::{Path, PathBuf};

use anyhow::bail;
use foveal_host::failure::usage;
use foveal_host::{atomic_file, console, picture, values};
use serde::Serialize;

use super::eye::EyeArgs;

/// Arguments of `foveal compare`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The reference: a PNG file, or a folder of PNG files, the frames of a video in the order of
    /// their names, numbers in them by their value
    pub(super) a: PathBuf,

    /// The picture under test, a PNG file of the same size, or a folder with files of the same
    /// names
    pub(super) b: PathBuf,

    #[command(flatten)]
    pub(super) eye: EyeArgs,

    /// Write FLIP's error map: black for no visible difference, through magenta to yellow
    #[arg(long, value_name = "FILE.png")]
    pub(super) diff: Option<PathBuf>,

    /// Exit with code 1 if the mean FLIP error is above X (0: no visible difference, 1: the
    /// largest)
    #[arg(long, value_name = "X", value_parser = values::threshold)]
    max_flip: Option<f64>,

    /// Exit with code 1 if the PSNR is below X decibels
    #[arg(long, value_name = "X", value_parser = values::threshold)]
    pub(super) min_psnr: Option<f64>,

    /// Exit with code 1 if the quality is below X JOD (10: no visible difference)
    #[arg(long, value_name = "X", value_parser = values::threshold)]
    pub(super) min_jod: Option<f64>,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// What thresholds are held against.
pub(super) struct Measured {
    pub(super) flip: f64,
    pub(super) psnr_db: Option<f64>,
    pub(super) jod: Option<f32>,
}

/// A comparison of two pictures or videos, as it is printed.
pub(super) trait Findings: Serialize {
    /// What thresholds are held against.
    fn measured(&self) -> Measured;

    /// Notes whether all thresholds are met.
    fn set_passed(&mut self, passed: bool);

    /// Lines for the terminal.
    fn text(&self) -> String;
}

/// Whether a file, whether it exists or not, lies in a folder itself, however both are written.
fn is_in(folder: &Path, file: &Path) -> bool {
    let file = file.canonicalize().or_else(|_| std::path::absolute(file));
    let parent = file
        .ok()
        .and_then(|file| file.parent()?.canonicalize().ok());
    parent.is_some() && parent == folder.canonicalize().ok()
}

impl Args {
    /// Finds what clap cannot: files that would replace each other or what is compared.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        let (diff, heat_map) = (self.diff.as_deref(), self.eye.heat_map());
        for (flag, file) in [("--diff", diff), ("--heat-map", heat_map)] {
            file.map_or(Ok(()), picture::check_name)?;
            let replaces = |input| file.is_some_and(|file| atomic_file::any_twice([file, input]));
            if replaces(&self.a) || replaces(&self.b) {
                return usage(format!("{flag} names a picture that is compared"));
            }
            let is_among = |folder| file.is_some_and(|file| is_in(folder, file));
            if is_among(&self.a) || is_among(&self.b) {
                return usage(format!("{flag} lies in a folder whose frames are compared"));
            }
        }
        if atomic_file::any_twice(diff.into_iter().chain(heat_map)) {
            return usage("--diff and --heat-map name the same file");
        }
        Ok(())
    }

    /// What cannot be done where the eye's metric fails.
    pub(super) fn not_seen(&self) -> String {
        let [a, b] = [&self.a, &self.b].map(|path| path.display());
        format!("cannot compare '{a}' with '{b}' at a display")
    }

    /// The thresholds that are not met.
    fn failures(&self, measured: &Measured) -> Vec<String> {
        let mut failures = Vec::new();
        let Measured { flip, psnr_db, jod } = *measured;
        if let Some(most) = self.max_flip
            && flip > most
        {
            failures.push(format!("FLIP is {flip:.6}, --max-flip {most}"));
        }
        if let (Some(least), Some(psnr_db)) = (self.min_psnr, psnr_db)
            && psnr_db < least
        {
            failures.push(format!("PSNR is {psnr_db:.3} dB, --min-psnr {least}"));
        }
        if let (Some(least), Some(jod)) = (self.min_jod, jod)
            && f64::from(jod) < least
        {
            failures.push(format!("the quality is {jod:.3} JOD, --min-jod {least}"));
        }
        failures
    }

    /// Holds what was found against the thresholds, prints it as text or as JSON, and fails where
    /// one is not met.
    pub(super) fn conclude<F: Findings>(&self, mut found: F) -> anyhow::Result<()> {
        let failures = self.failures(&found.measured());
        found.set_passed(failures.is_empty());
        let text = if self.json {
            serde_json::to_string_pretty(&found)? + "\n"
        } else {
            found.text()
        };
        console::print_result(&text)?;
        if !failures.is_empty() {
            bail!(
                "'{}' differs too much from '{}': {}",
                self.b.display(),
                self.a.display(),
                failures.join(", ")
            );
        }
        Ok(())
    }
}
