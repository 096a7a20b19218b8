//! What the window captures, on its way to files: a folder of PNGs, or a video by `ffmpeg`.

use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use anyhow::{Context, bail};
use foveal_host::picture::Picture;
use foveal_view::{Format, Recording};

/// Why videos cannot be made; `None` where they can.
pub(super) fn no_video() -> Option<String> {
    let found = Command::new("ffmpeg")
        .arg("-version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    match found {
        Ok(status) if status.success() => None,
        _ => Some("Needs the program ffmpeg, which is not there".to_owned()),
    }
}

/// Starts a recording in the current folder under the next free name.
pub(super) fn start(
    format: Format,
    (width, height): (u32, u32),
    per_second: f32,
) -> anyhow::Result<Box<dyn Recording>> {
    start_in(Path::new(""), format, (width, height), per_second)
}

fn start_in(
    folder: &Path,
    format: Format,
    size: (u32, u32),
    per_second: f32,
) -> anyhow::Result<Box<dyn Recording>> {
    Ok(match format {
        Format::Pictures => Box::new(Pictures::new(folder, size)?),
        Format::Video => Box::new(Video::new(folder, size, per_second)?),
    })
}

/// `capture-001` and so on.
fn names(folder: &Path) -> impl Iterator<Item = PathBuf> {
    (1..1_000_000).map(move |number| folder.join(format!("capture-{number:03}")))
}

struct Pictures {
    folder: PathBuf,
    size: (u32, u32),
    written: u32,
}

impl Pictures {
    fn new(within: &Path, size: (u32, u32)) -> anyhow::Result<Self> {
        for folder in names(within) {
            match fs::create_dir(&folder) {
                Ok(()) => {
                    return Ok(Self {
                        folder,
                        size,
                        written: 0,
                    });
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => {
                    let folder = folder.display();
                    return Err(error).with_context(|| format!("cannot make '{folder}'"));
                }
            }
        }
        bail!("there is no free name for a folder")
    }
}

impl Recording for Pictures {
    fn name(&self) -> String {
        self.folder.display().to_string()
    }

    fn add(&mut self, rgba: &[u8]) -> anyhow::Result<()> {
        let (width, height) = self.size;
        let name = format!("frame-{:04}.png", self.written);
        Picture::from_rgba(width, height, rgba)?.write_rgb(&self.folder.join(name))?;
        self.written += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> anyhow::Result<()> {
        Ok(())
    }
}

struct Video {
    file: PathBuf,
    /// `None` once it has ended.
    encoder: Option<Child>,
}

impl Video {
    fn new(within: &Path, (width, height): (u32, u32), per_second: f32) -> anyhow::Result<Self> {
        let files = names(within).map(|name| name.with_extension("mp4"));
        let Some(file) = files.into_iter().find(|file| !file.exists()) else {
            bail!("there is no free name for a video");
        };
        let size = format!("{width}x{height}");
        let rate = per_second.to_string();
        let encoder = Command::new("ffmpeg")
            .args([
                "-loglevel",
                "error",
                "-n",
                "-f",
                "rawvideo",
                "-pix_fmt",
                "rgba",
            ])
            .args(["-s", &size, "-framerate", &rate, "-i", "-"])
            // Players want whole pairs of pixels.
            .args([
                "-vf",
                "crop=trunc(iw/2)*2:trunc(ih/2)*2",
                "-pix_fmt",
                "yuv420p",
            ])
            .args(["-movflags", "+faststart"])
            .arg(&file)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .context("cannot start ffmpeg")?;
        Ok(Self {
            file,
            encoder: Some(encoder),
        })
    }

    /// Waits for the encoder; what it said where it failed.
    fn end(&mut self) -> anyhow::Result<()> {
        let Some(mut encoder) = self.encoder.take() else {
            return Ok(());
        };
        drop(encoder.stdin.take());
        let mut said = String::new();
        if let Some(mut stderr) = encoder.stderr.take() {
            let _ = stderr.read_to_string(&mut said);
        }
        if encoder.wait().context("ffmpeg was lost")?.success() {
            return Ok(());
        }
        bail!("ffmpeg cannot write '{}': {}", self.name(), said.trim())
    }
}

impl Recording for Video {
    fn name(&self) -> String {
        self.file.display().to_string()
    }

    fn add(&mut self, rgba: &[u8]) -> anyhow::Result<()> {
        let pipe = self.encoder.as_mut().and_then(|e| e.stdin.as_mut());
        let written = pipe.map(|pipe| pipe.write_all(rgba));
        if written.is_some_and(|written| written.is_ok()) {
            return Ok(());
        }
        // Its own words say more than a closed pipe.
        self.end()?;
        bail!("ffmpeg stopped before the end of '{}'", self.name())
    }

    fn finish(mut self: Box<Self>) -> anyhow::Result<()> {
        self.end()
    }
}

impl Drop for Video {
    /// Given up: half a video is none.
    fn drop(&mut self) {
        if let Some(mut encoder) = self.encoder.take() {
            let _ = encoder.kill();
            let _ = encoder.wait();
            let _ = fs::remove_file(&self.file);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_go_to_a_new_folder_each_time() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["capture-001", "capture-002"] {
            let mut recording = start_in(folder.path(), Format::Pictures, (2, 1), 30.0).unwrap();
            recording.add(&[255, 0, 0, 255, 0, 255, 0, 255]).unwrap();
            recording.add(&[9; 8]).unwrap();
            recording.finish().unwrap();
            let first = folder.path().join(name).join("frame-0000.png");
            let picture = image::open(first).unwrap().to_rgb8();
            assert_eq!(picture.as_raw()[..], [255, 0, 0, 0, 255, 0]);
            assert!(folder.path().join(name).join("frame-0001.png").exists());
        }
    }

    #[test]
    fn a_video_is_there_when_it_is_finished_and_not_when_it_is_given_up() {
        if no_video().is_some() {
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("capture-001.mp4");
        let start = || start_in(folder.path(), Format::Video, (65, 48), 30.0).unwrap();
        let mut given_up = start();
        given_up.add(&[100; 65 * 48 * 4]).unwrap();
        drop(given_up);
        assert!(!file.exists());
        let mut finished = start();
        for grey in 0..5 {
            finished.add(&[40 * grey; 65 * 48 * 4]).unwrap();
        }
        finished.finish().unwrap();
        assert!(fs::metadata(&file).unwrap().len() > 500);
    }

    #[test]
    fn what_ffmpeg_says_is_in_the_error() {
        if no_video().is_some() {
            return;
        }
        let mut video =
            start_in(Path::new("/no/such/folder"), Format::Video, (4, 4), 30.0).unwrap();
        let failed = (0..200).find_map(|_| video.add(&[0; 64]).err());
        let error = failed.or_else(|| video.finish().err()).unwrap();
        assert!(
            format!("{error:#}").contains("/no/such/folder"),
            "{error:#}"
        );
    }
}
