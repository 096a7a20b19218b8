//! `foveal compare`: how far two pictures or videos are apart, as eyes and as numbers see it.

mod eye;
mod numeric;
mod sequence;
mod ssim;

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::bail;
use serde::Serialize;

use foveal_host::difference::ErrorMap;
use foveal_host::picture::Picture;
use foveal_host::{atomic_file, console, picture, values};

/// Arguments of `foveal compare`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The reference: a PNG file, or a folder of PNG files, the frames of a video in the order of their names
    a: PathBuf,

    /// The picture under test, a PNG file of the same size, or a folder with files of the same names
    b: PathBuf,

    #[command(flatten)]
    eye: eye::EyeArgs,

    /// Write FLIP's error map: black where no eye sees a difference, through magenta to yellow
    #[arg(long, value_name = "FILE.png")]
    diff: Option<PathBuf>,

    /// Exit with code 1 where the mean FLIP error is above X (0: equal to the eye, 1: as different as can be)
    #[arg(long, value_name = "X", value_parser = values::threshold)]
    max_flip: Option<f64>,

    /// Exit with code 1 where the PSNR is below X decibels
    #[arg(long, value_name = "X", value_parser = values::threshold)]
    min_psnr: Option<f64>,

    /// Exit with code 1 where the quality is below X JOD (10: no visible difference)
    #[arg(long, value_name = "X", value_parser = values::threshold)]
    min_jod: Option<f64>,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// The JSON's fields; docs/program.md describes them.
#[derive(Debug, PartialEq, Serialize)]
struct Comparison {
    width: u32,
    height: u32,
    /// Mean of FLIP's error map, 0 to 1.
    flip: f64,
    /// Decibels; `None` for equal colours, where it is infinite.
    psnr_db: Option<f64>,
    /// Mean structural similarity; `None` for pictures smaller than its window.
    ssim: Option<f64>,
    max_difference: u8,
    differing_pixels: u64,
    /// What an eye sees at a display; `None` where no display is named.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    eye: Option<eye::Verdict>,
    /// All thresholds are met, or none were given.
    passed: bool,
}

/// Compares, prints, and fails where a threshold is not met.
pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    for file in args.diff.iter().chain(args.eye.heat_map()) {
        atomic_file::check_writable(file)?;
    }
    if args.a.is_dir() && args.b.is_dir() {
        return sequence::run(args);
    }
    let (a, b) = (Picture::read(&args.a)?, Picture::read(&args.b)?);
    if (a.width, a.height) != (b.width, b.height) {
        bail!(
            "pictures of different sizes cannot be compared: '{}' is {}x{}, '{}' is {}x{}",
            args.a.display(),
            a.width,
            a.height,
            args.b.display(),
            b.width,
            b.height,
        );
    }
    let (map, mut comparison) = compare(&a, &b);
    comparison.eye = match args.eye.display(args.min_jod.is_some()) {
        Some(display) => Some(args.eye.compare(&display, &a, &b)?),
        None => None,
    };
    let failures = args.failures(&Measured {
        flip: comparison.flip,
        psnr_db: comparison.psnr_db,
        jod: comparison.eye.as_ref().map(|eye| eye.jod),
    });
    comparison.passed = failures.is_empty();

    if let Some(diff) = &args.diff {
        picture::write_rgb(diff, a.width, a.height, &map.heat_rgb())?;
    }
    args.conclude(&comparison, &comparison.text(), &failures)
}

fn compare(a: &Picture, b: &Picture) -> (ErrorMap, Comparison) {
    let map = ErrorMap::between(a, b);
    let comparison = Comparison {
        width: a.width,
        height: a.height,
        flip: map.mean(),
        psnr_db: numeric::psnr_db(&a.pixels, &b.pixels),
        ssim: ssim::mean_ssim(a, b),
        max_difference: numeric::max_difference(&a.pixels, &b.pixels),
        differing_pixels: numeric::differing_pixels(&a.pixels, &b.pixels),
        eye: None,
        passed: true,
    };
    (map, comparison)
}

/// What thresholds are held against.
struct Measured {
    flip: f64,
    psnr_db: Option<f64>,
    jod: Option<f32>,
}

impl Args {
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

    /// Prints what was found, as text or as JSON, and fails where a threshold is not met.
    fn conclude(
        &self,
        found: &impl Serialize,
        text: &str,
        failures: &[String],
    ) -> anyhow::Result<()> {
        if self.json {
            console::print_result(&(serde_json::to_string_pretty(found)? + "\n"))?;
        } else {
            console::print_result(text)?;
        }
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

impl Comparison {
    fn text(&self) -> String {
        let pixels = u64::from(self.width) * u64::from(self.height);
        let share = 100.0 * self.differing_pixels as f64 / pixels as f64;
        let mut text = String::new();
        let _ = writeln!(text, "FLIP        {:.6}", self.flip);
        let _ = match self.psnr_db {
            Some(psnr_db) => writeln!(text, "PSNR        {psnr_db:.3} dB"),
            None => writeln!(text, "PSNR        infinite"),
        };
        let _ = match self.ssim {
            Some(ssim) => writeln!(text, "SSIM        {ssim:.6}"),
            None => writeln!(
                text,
                "SSIM        none: smaller than its window of {0}x{0}",
                ssim::WINDOW
            ),
        };
        let _ = writeln!(text, "largest     {} of 255", self.max_difference);
        let _ = writeln!(
            text,
            "differing   {} of {pixels} pixels ({share:.3} %)",
            self.differing_pixels
        );
        if let Some(eye) = &self.eye {
            text += &eye.text();
        }
        text
    }
}
