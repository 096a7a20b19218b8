//! The files of an image sequence: which frame goes where.

use std::ops::Range;
use std::path::{Path, PathBuf};

use foveal_host::drawing::moment;
use foveal_host::failure::usage;

/// A file name with a place for the frame's number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FramePattern {
    folder: PathBuf,
    before: String,
    after: String,
    /// Least number of digits.
    digits: usize,
}

impl FramePattern {
    /// From a path whose last part has one run of `#` (one per digit) or one `{frame}` in it.
    pub(super) fn parse(path: &Path) -> anyhow::Result<Self> {
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
            return usage(format!(
                "'{}' is no file name for a sequence",
                path.display()
            ));
        };
        let (start, end, digits) = match (name.find("{frame}"), name.find('#')) {
            (Some(start), None) => (start, start + "{frame}".len(), 1),
            (None, Some(start)) => {
                let digits = name[start..].bytes().take_while(|&b| b == b'#').count();
                (start, start + digits, digits)
            }
            _ => {
                return usage(format!(
                    "with --frames the output's file name needs one place for the number, as in frame_####.png \
                     or {{frame}}.png; '{name}' has none or several"
                ));
            }
        };
        let (before, after) = (&name[..start], &name[end..]);
        if after.contains('#') || after.contains("{frame}") {
            return usage(format!(
                "'{name}' has several places for the frame's number"
            ));
        }
        Ok(Self {
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            before: before.to_owned(),
            after: after.to_owned(),
            digits,
        })
    }

    /// The file of one frame.
    pub(super) fn file(&self, frame: u32) -> PathBuf {
        let Self {
            folder,
            before,
            after,
            digits,
        } = self;
        folder.join(format!("{before}{frame:0digits$}{after}"))
    }
}

/// One picture to draw: its number, its moment, its file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FrameJob {
    pub(super) frame: u32,
    pub(super) moment: Moment,
    /// Where the picture goes; `None` where it is a part of a video alone.
    pub(super) file: Option<PathBuf>,
}

/// When a picture is, and hence when those before it are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Moment {
    /// A frame of a sequence, so many frames a second.
    Frame(u32, f32),
    /// A time in seconds, in a film of so many frames a second.
    Time(f32, f32),
    /// A time in seconds, at which everything rests.
    Rest(f32),
}

impl Moment {
    /// Time in seconds.
    pub(super) fn time_s(self) -> f32 {
        self.before_s(0)
    }

    /// Time in seconds of the picture that is `frames` earlier. Nothing is before 0.
    pub(super) fn before_s(self, frames: u32) -> f32 {
        match self {
            Self::Frame(frame, fps) => moment(frame.saturating_sub(frames), fps),
            Self::Time(time_s, fps) => {
                let earlier_s = f64::from(frames) / f64::from(fps);
                (f64::from(time_s) - earlier_s).max(0.0) as f32
            }
            Self::Rest(time_s) => time_s,
        }
    }
}

/// The frames of a range. Each depends on its own number alone, so that any sub-range gives the
/// same files.
pub(super) fn sequence(
    range: Range<u32>,
    fps: f32,
    pattern: Option<&FramePattern>,
) -> Vec<FrameJob> {
    range
        .map(|frame| FrameJob {
            frame,
            moment: Moment::Frame(frame, fps),
            file: pattern.map(|pattern| pattern.file(frame)),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_number_the_files() {
        let file =
            |pattern: &str, frame| FramePattern::parse(Path::new(pattern)).unwrap().file(frame);
        assert_eq!(
            file("out/frame_####.png", 7),
            Path::new("out/frame_0007.png")
        );
        assert_eq!(file("frame_##.png", 12345), Path::new("frame_12345.png"));
        assert_eq!(file("{frame}.png", 12), Path::new("12.png"));
        assert_eq!(file("a#b/f#.png", 3), Path::new("a#b/f3.png"));
    }

    #[test]
    fn names_without_one_place_are_refused() {
        for pattern in [
            "frame.png",
            "#_#.png",
            "#{frame}.png",
            "{frame}{frame}.png",
            "a#/f.png",
            "..",
        ] {
            assert!(
                FramePattern::parse(Path::new(pattern)).is_err(),
                "{pattern}"
            );
        }
    }

    #[test]
    fn a_frame_depends_on_its_number_alone() {
        let pattern = FramePattern::parse(Path::new("#.png")).unwrap();
        let whole = sequence(0..50, 29.97, Some(&pattern));
        let part = sequence(20..30, 29.97, Some(&pattern));
        assert_eq!(whole[20..30], part);
        assert_eq!(part[1].moment.before_s(1), part[0].moment.time_s());
        assert_eq!(whole[0].moment.before_s(1), 0.0);
    }

    #[test]
    fn moments_before_a_picture_are_a_frame_apart_and_none_is_before_the_start() {
        let before = |moment: Moment| [3, 2, 1, 0].map(|frames| moment.before_s(frames));
        assert_eq!(before(Moment::Frame(2, 4.0)), [0.0, 0.0, 0.25, 0.5]);
        assert_eq!(before(Moment::Time(0.625, 4.0)), [0.0, 0.125, 0.375, 0.625]);
        assert_eq!(before(Moment::Rest(0.5)), [0.5; 4]);
    }
}
