//! Two videos, as folders of PNG files with the same names.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, bail};
use serde::Serialize;

use super::args::{Args, Findings, Measured};
use super::eye;
use foveal_host::difference::{ErrorMap, pixels};
use foveal_host::failure::usage;
use foveal_host::picture::Picture;

/// Frames per second without `--fps`.
const DEFAULT_FPS: f32 = 30.0;

/// The JSON's fields; docs/program.md describes them.
#[derive(Debug, PartialEq, Serialize)]
struct Comparison {
    width: u32,
    height: u32,
    frames: usize,
    fps: f32,
    #[serde(flatten)]
    eye: eye::Verdict,
    /// Change in the periphery by the reference's; `None` where there is none to compare.
    flicker: Option<f32>,
    /// Mean of all frames' FLIP.
    flip: f64,
    /// All thresholds are met, or none were given.
    passed: bool,
}

/// Compares, prints, and fails where a threshold is not met.
pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    if args.diff.is_some() || args.min_psnr.is_some() {
        return usage("--diff and --min-psnr are for pictures, not for folders".to_owned());
    }
    args.conclude(compare(args)?)
}

fn compare(args: &Args) -> anyhow::Result<Comparison> {
    let (names, others) = (frames(&args.a)?, frames(&args.b)?);
    let [a, b] = [&names, &others].map(|names| names.iter().collect::<BTreeSet<_>>());
    if let Some(name) = a.symmetric_difference(&b).next() {
        bail!(
            "'{}' and '{}' hold different frames: '{name}' is in one of them alone",
            args.a.display(),
            args.b.display()
        );
    }
    let Some(first) = names.first() else {
        bail!("'{}' holds no PNG files", args.a.display());
    };
    let size = Picture::read(&args.a.join(first))?;
    let display = args.eye.display(true).context("videos have a display")?;
    let metric = args.eye.metric(&display, &size);
    let metric = metric.with_context(|| args.not_seen())?;
    let fps = args.eye.fps.unwrap_or(DEFAULT_FPS);
    let mut video = metric.video(fps)?;
    let mut flip = 0.0;
    for name in &names {
        let read = |folder: &Path| {
            let picture = Picture::read(&folder.join(name))?;
            if (picture.width, picture.height) != (size.width, size.height) {
                bail!(
                    "frames of different sizes cannot be compared: '{}' is {}x{}, the first one {}x{}",
                    folder.join(name).display(),
                    picture.width,
                    picture.height,
                    size.width,
                    size.height
                );
            }
            Ok(picture)
        };
        let (a, b) = (read(&args.a)?, read(&args.b)?);
        video.push(pixels(&a), pixels(&b))?;
        flip += ErrorMap::between(&a, &b).mean();
    }
    let result = video.finish()?;
    args.eye.write_heat_map(&result.heat_map)?;
    Ok(Comparison {
        width: size.width,
        height: size.height,
        frames: result.frames,
        fps,
        eye: args.eye.verdict(&display, &metric, result.jod),
        flicker: result.flicker,
        flip: flip / result.frames as f64,
        passed: true,
    })
}

/// Names of a folder's PNG files, in the order of the video.
fn frames(folder: &Path) -> anyhow::Result<Vec<String>> {
    let cannot_read = || format!("cannot read the folder '{}'", folder.display());
    let mut names = Vec::new();
    for entry in folder.read_dir().with_context(cannot_read)? {
        let name = entry.with_context(cannot_read)?.file_name();
        let ending = Path::new(&name).extension();
        if ending.is_none_or(|ending| !ending.eq_ignore_ascii_case("png")) {
            continue;
        }
        // A frame that is passed over would be a shorter video.
        match name.into_string() {
            Ok(name) => names.push(name),
            Err(name) => bail!(
                "the name of the frame '{}' is not UTF-8",
                folder.join(name).display()
            ),
        }
    }
    names.sort_by(|a, b| parts(a).cmp(&parts(b)).then_with(|| a.cmp(b)));
    Ok(names)
}

/// A name as it is ordered: pieces of text, each with the number after it, which is ordered by how
/// many digits it has and then by them: `f_2.png` before `f_10.png`.
fn parts(name: &str) -> Vec<(&str, usize, &str)> {
    let mut parts = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let start = rest.find(|c: char| c.is_ascii_digit());
        let (text, after) = rest.split_at(start.unwrap_or(rest.len()));
        let end = after.find(|c: char| !c.is_ascii_digit());
        let (number, after) = after.split_at(end.unwrap_or(after.len()));
        let number = number.trim_start_matches('0');
        parts.push((text, number.len(), number));
        rest = after;
    }
    parts
}

impl Findings for Comparison {
    fn measured(&self) -> Measured {
        Measured {
            flip: self.flip,
            psnr_db: None,
            jod: Some(self.eye.jod),
        }
    }

    fn set_passed(&mut self, passed: bool) {
        self.passed = passed;
    }

    fn text(&self) -> String {
        let mut text = format!(
            "{} frames of {}x{}, {} per second\n",
            self.frames, self.width, self.height, self.fps
        );
        text += &self.eye.text();
        let _ = match self.flicker {
            Some(flicker) => writeln!(text, "flicker     {flicker:.3} of the reference's"),
            None => writeln!(text, "flicker     none: one frame, or no periphery"),
        };
        let _ = writeln!(text, "FLIP        {:.6} (mean)", self.flip);
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_in_the_order_of_their_numbers() {
        let folder = tempfile::tempdir().expect("a folder");
        let expected = [
            "f_0.png",
            "f_1.png",
            "f_2.PNG",
            "f_10.png",
            "f_010b.png",
            "g_1.png",
        ];
        for name in expected.iter().rev().chain(&["notes.txt"]) {
            std::fs::write(folder.path().join(name), "").expect("a file");
        }
        assert_eq!(frames(folder.path()).expect("names"), expected);
        #[cfg(target_os = "linux")]
        {
            use std::os::unix::ffi::OsStrExt;
            let other = std::ffi::OsStr::from_bytes(b"f_3\xff.png");
            std::fs::write(folder.path().join(other), "").expect("a file");
            let error = frames(folder.path()).expect_err("no name").to_string();
            assert!(error.contains("f_3"), "{error}");
        }
        // Numbers that no integer holds.
        let long = "9".repeat(60);
        assert!(parts(&format!("{long}8")) < parts(&format!("{long}9")));
        assert!(parts(&long) < parts(&format!("1{long}")));
    }
}
