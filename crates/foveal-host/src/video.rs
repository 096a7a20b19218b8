//! Videos: frames are piped into `ffmpeg`, which this program does not contain.

use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdin, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;

use anyhow::{Context, bail};

use crate::atomic_file::Pending;
use crate::picture::Picture;

/// The program that encodes.
const FFMPEG: &str = "ffmpeg";

/// A video that is being written. Under its final name it is whole or not there.
pub struct Video {
    encoder: Child,
    /// Taken when the last frame is in.
    frames: Option<ChildStdin>,
    /// Reads what the encoder complains about, so that it never waits for a reader.
    complaints: Option<JoinHandle<String>>,
    size: (u32, u32),
    path: PathBuf,
    /// Taken when the video is finished.
    file: Option<Pending>,
}

/// Whether ffmpeg is there.
pub fn is_available() -> bool {
    ask_version().is_ok_and(|status| status.success())
}

/// Checks that there is a program that can write a video to `path`.
///
/// # Errors
/// Names the file and the cause: no ffmpeg, a name without an ending.
pub fn check(path: &Path) -> anyhow::Result<()> {
    extension(path)?;
    match ask_version() {
        Err(error) if error.kind() == ErrorKind::NotFound => bail!(
            "cannot write the video '{}': it is encoded by the program ffmpeg, which is not installed here (Debian: \
             apt-get install ffmpeg). Without it write pictures: --output frame_####.png",
            path.display()
        ),
        other => other
            .map(drop)
            .with_context(|| format!("cannot start {FFMPEG}")),
    }
}

/// Lets ffmpeg say its version to nobody.
fn ask_version() -> std::io::Result<ExitStatus> {
    Command::new(FFMPEG)
        .arg("-version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
}

impl Video {
    /// Starts the encoder. The end of the file's name (.mp4, .mkv, .webm, .mov, .gif ..) chooses the
    /// container, ffmpeg the codec; H.264 at a visually lossless rate for .mp4, .mkv and .mov,
    /// where ffmpeg has it.
    ///
    /// # Errors
    /// Names the file and the cause: no ffmpeg, a folder that is not there.
    pub fn create(path: &Path, (width, height): (u32, u32), fps: f32) -> anyhow::Result<Self> {
        check(path)?;
        crate::atomic_file::check_writable(path)?;
        let ending = extension(path)?;
        let file = Pending::new(path, &format!(".{ending}"))?;
        let mut command = Command::new(FFMPEG);
        command
            .args(arguments((width, height), fps, &ending, has_x264()))
            .arg(file.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let spawned = command.spawn();
        let mut encoder = spawned.with_context(|| format!("cannot start {FFMPEG}"))?;
        let frames = encoder.stdin.take();
        let complaints = encoder.stderr.take().map(read_to_end);
        Ok(Self {
            encoder,
            frames,
            complaints,
            size: (width, height),
            path: path.to_owned(),
            file: Some(file),
        })
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// What ffmpeg said, if it ended early; a frame of another size.
    pub fn push(&mut self, picture: &Picture) -> anyhow::Result<()> {
        if (picture.width, picture.height) != self.size {
            bail!("the frames of a video have one size");
        }
        let written = match &mut self.frames {
            Some(frames) => frames.write_all(&picture.rgb_bytes()),
            None => Ok(()),
        };
        if written.is_ok() {
            return Ok(());
        }
        // Its own words say more than a closed pipe.
        self.wait()?;
        bail!("ffmpeg stopped before the end of '{}'", self.path.display())
    }

    /// Ends the video and puts it under its name.
    ///
    /// # Errors
    /// What ffmpeg said; the disk is full.
    pub fn finish(mut self) -> anyhow::Result<()> {
        self.wait()?;
        self.file.take().map_or(Ok(()), Pending::finish)
    }

    /// Waits until ffmpeg has ended; an error where it did not succeed.
    fn wait(&mut self) -> anyhow::Result<()> {
        drop(self.frames.take());
        let status = self.encoder.wait().context("cannot wait for ffmpeg")?;
        let complaints = self.complaints.take().and_then(|thread| thread.join().ok());
        if status.success() {
            return Ok(());
        }
        let text = complaints.unwrap_or_default();
        let last: Vec<&str> = text
            .lines()
            .rev()
            .filter(|l| !l.trim().is_empty())
            .take(3)
            .collect();
        let said: Vec<&str> = last.into_iter().rev().collect();
        bail!(
            "cannot write the video '{}': ffmpeg failed ({status}): {}",
            self.path.display(),
            said.join("; ")
        )
    }
}

impl Drop for Video {
    /// Given up: half a video is none.
    fn drop(&mut self) {
        // Nobody waits for one that is finished, or that has failed.
        if self.frames.take().is_some() {
            let _ = self.encoder.kill();
            let _ = self.encoder.wait();
        }
    }
}

/// Whether this ffmpeg was built with the usual encoder for H.264.
fn has_x264() -> bool {
    let listed = Command::new(FFMPEG)
        .args(["-hide_banner", "-encoders"])
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output();
    listed.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains("libx264"))
}

/// The end of the file's name, lower case.
fn extension(path: &Path) -> anyhow::Result<String> {
    match path.extension().and_then(|e| e.to_str()) {
        Some(ending) => Ok(ending.to_ascii_lowercase()),
        None => bail!(
            "'{}' must end in .mp4, .webm or another ending of a video that ffmpeg knows",
            path.display()
        ),
    }
}

/// From RGB to BT.709's Y'CbCr of limited range, which players take HD for. Colour of half
/// resolution, which every player shows, needs even sizes.
const YUV: &str = "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv";

/// What the file says of its colours: the frames are sRGB.
const COLORS: [&str; 8] = [
    "-colorspace",
    "bt709",
    "-color_primaries",
    "bt709",
    "-color_trc",
    "iec61966-2-1",
    "-color_range",
    "tv",
];

/// What ffmpeg is told before the file's name: raw RGB rows on its standard input.
fn arguments((width, height): (u32, u32), fps: f32, ending: &str, has_x264: bool) -> Vec<OsString> {
    let size = format!("{width}x{height}");
    let rate = fps.to_string();
    let mut words = vec![
        "-hide_banner",
        "-loglevel",
        "error",
        "-nostdin",
        "-y",
        "-f",
        "rawvideo",
        "-pixel_format",
        "rgb24",
        "-video_size",
        &size,
        "-framerate",
        &rate,
        "-i",
        "pipe:0",
    ];
    if matches!(ending, "mp4" | "mkv" | "mov" | "webm") {
        words.extend(["-vf", YUV, "-pix_fmt", "yuv420p"]);
        words.extend(COLORS);
        if has_x264 && ending != "webm" {
            words.extend(["-c:v", "libx264", "-crf", "16"]);
        }
        if ending != "webm" {
            words.extend(["-movflags", "+faststart"]);
        }
    }
    words.into_iter().map(OsString::from).collect()
}

fn read_to_end(mut stderr: ChildStderr) -> JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // What was read before an error is what there is to tell.
        let _ = std::io::Read::read_to_end(&mut stderr, &mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ffmpeg_is_told_size_rate_and_format() {
        let words = arguments((3, 2), 29.97, "mp4", true);
        let text: Vec<_> = words.iter().map(|w| w.to_str().unwrap()).collect();
        let text = text.join(" ");
        assert!(
            text.contains("-pixel_format rgb24 -video_size 3x2 -framerate 29.97 -i pipe:0"),
            "{text}"
        );
        assert!(text.contains("libx264"), "{text}");
        for (ending, has_x264) in [("webm", true), ("mp4", false)] {
            let words = arguments((3, 2), 30.0, ending, has_x264);
            assert!(!words.iter().any(|word| word == "libx264"), "{ending}");
        }
    }

    #[test]
    fn colours_are_converted_as_the_file_says_that_they_are() {
        for (ending, has_x264) in [("mp4", true), ("mov", false), ("mkv", true), ("webm", true)] {
            let words = arguments((3, 2), 30.0, ending, has_x264);
            let after = |flag: &str| {
                let at = words.iter().position(|word| word == flag).unwrap();
                words[at + 1].to_str().unwrap()
            };
            let matrix = "scale=out_color_matrix=bt709:out_range=tv";
            assert!(after("-vf").ends_with(matrix), "{ending}");
            assert_eq!(after("-pix_fmt"), "yuv420p");
            assert_eq!(after("-colorspace"), "bt709");
            assert_eq!(after("-color_primaries"), "bt709");
            assert_eq!(after("-color_trc"), "iec61966-2-1");
            assert_eq!(after("-color_range"), "tv");
        }
        let gif = arguments((3, 2), 30.0, "gif", true);
        assert!(!gif.iter().any(|word| word == "-vf"), "it has a palette");
    }

    #[test]
    fn saturated_colours_come_back_as_players_read_hd() {
        if !is_available() {
            println!("skipped: no ffmpeg");
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let colors = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [220, 40, 120]];
        let bytes = (0..64 * 64).flat_map(|i| {
            let [r, g, b] = colors[i % 64 / 16];
            [r, g, b, 255]
        });
        let picture = Picture::from_rgba(64, 64, bytes.collect()).unwrap();
        let film = folder.path().join("film.mkv");
        let mut video = Video::create(&film, (64, 64), 30.0).unwrap();
        for _ in 0..3 {
            video.push(&picture).unwrap();
        }
        video.finish().unwrap();
        let decoded = Command::new(FFMPEG)
            .args(["-v", "error", "-nostdin", "-i"])
            .arg(&film)
            .args(["-frames:v", "1", "-vf"])
            .arg("scale=in_color_matrix=bt709:in_range=tv:flags=accurate_rnd,format=rgb24")
            .args(["-f", "rawvideo", "-"])
            .output()
            .unwrap();
        for (i, color) in colors.iter().enumerate() {
            let at = 3 * (32 * 64 + 16 * i + 8);
            let found = &decoded.stdout[at..at + 3];
            for (a, b) in found.iter().zip(color) {
                assert!(a.abs_diff(*b) <= 8, "{found:?} instead of {color:?}");
            }
        }
    }

    #[test]
    fn a_name_without_an_ending_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = Video::create(&folder.path().join("film"), (2, 2), 30.0)
            .err()
            .unwrap();
        assert!(error.to_string().contains(".mp4"), "{error}");
    }
}
