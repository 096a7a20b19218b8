//! What the window captures, on its way to files: a folder of PNGs, or a video by `ffmpeg`.

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use foveal_host::picture::Picture;
use foveal_host::video;
use foveal_view::{Format, Recording};

/// Why videos cannot be made; `None` where they can.
pub(super) fn no_video() -> Option<String> {
    (!video::is_available()).then(|| "Needs the program ffmpeg, which is not there".to_owned())
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

    fn keeps_parts(&self) -> bool {
        true
    }

    fn add(&mut self, rgba: &[u8]) -> anyhow::Result<()> {
        let (width, height) = self.size;
        let name = format!("frame-{:04}.png", self.written);
        Picture::from_rgba(width, height, rgba.to_vec())?.write_rgb(&self.folder.join(name))?;
        self.written += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> anyhow::Result<()> {
        Ok(())
    }
}

struct Video {
    /// Taken, under a name that nobody else takes, until the video stands there.
    file: PathBuf,
    size: (u32, u32),
    /// `None` once it has ended.
    encoder: Option<video::Video>,
}

impl Video {
    fn new(within: &Path, size: (u32, u32), per_second: f32) -> anyhow::Result<Self> {
        for file in names(within).map(|name| name.with_extension("mp4")) {
            match File::create_new(&file) {
                Ok(_) => {
                    let mut video = Self {
                        file,
                        size,
                        encoder: None,
                    };
                    video.encoder = Some(video::Video::create(&video.file, size, per_second)?);
                    return Ok(video);
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => {
                    let file = file.display();
                    return Err(error).with_context(|| format!("cannot make '{file}'"));
                }
            }
        }
        bail!("there is no free name for a video")
    }
}

impl Recording for Video {
    fn name(&self) -> String {
        self.file.display().to_string()
    }

    fn keeps_parts(&self) -> bool {
        false
    }

    fn add(&mut self, rgba: &[u8]) -> anyhow::Result<()> {
        let (width, height) = self.size;
        let picture = Picture::from_rgba(width, height, rgba.to_vec())?;
        match &mut self.encoder {
            Some(encoder) => encoder.push(&picture),
            None => Ok(()),
        }
    }

    fn finish(mut self: Box<Self>) -> anyhow::Result<()> {
        let Some(encoder) = self.encoder.take() else {
            return Ok(());
        };
        let finished = encoder.finish();
        if finished.is_err() {
            let _ = fs::remove_file(&self.file);
        }
        finished
    }
}

impl Drop for Video {
    /// Given up: the name is free again.
    fn drop(&mut self) {
        if self.encoder.take().is_some() || fs::metadata(&self.file).is_ok_and(|m| m.len() == 0) {
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
        if let Some(cause) = no_video() {
            println!("skipped: {cause}");
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
    fn a_folder_that_is_missing_is_named() {
        let error = start_in(Path::new("/no/such/folder"), Format::Video, (4, 4), 30.0).err();
        let error = format!("{:#}", error.unwrap());
        assert!(error.contains("/no/such/folder"), "{error}");
    }
}
