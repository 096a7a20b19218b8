//! `foveal compare`: how far two pictures or videos are apart, as eyes and as numbers see it.

mod args;
mod eye;
mod numeric;
mod sequence;
mod ssim;

use std::fmt::Write;

use anyhow::{Context, bail};
use serde::Serialize;

pub(crate) use args::Args;
use args::{Findings, Measured};
use foveal_host::difference::ErrorMap;
use foveal_host::failure::usage;
use foveal_host::picture::Picture;
use foveal_host::{atomic_file, picture};

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
    args.check()?;
    let is_video = args.a.is_dir() && args.b.is_dir();
    if args.eye.fps.is_some() && !is_video {
        return usage("--fps is for folders, the frames of a video, not for pictures");
    }
    for file in args.diff.as_deref().into_iter().chain(args.eye.heat_map()) {
        atomic_file::check_writable(file)?;
    }
    if is_video {
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
        Some(display) => {
            let seen = args.eye.compare(&display, &a, &b);
            Some(seen.with_context(|| args.not_seen())?)
        }
        None => None,
    };
    if let Some(diff) = &args.diff {
        picture::write_rgb(diff, a.width, a.height, &map.heat_rgb())?;
    }
    args.conclude(comparison)
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

impl Findings for Comparison {
    fn measured(&self) -> Measured {
        Measured {
            flip: self.flip,
            psnr_db: self.psnr_db,
            jod: self.eye.as_ref().map(|eye| eye.jod),
        }
    }

    fn set_passed(&mut self, passed: bool) {
        self.passed = passed;
    }

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
