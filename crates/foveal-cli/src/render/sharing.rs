//! Which frames this job draws: all of a range, a part of it, or those that no other job has.

use std::collections::VecDeque;
use std::ops::Range;
use std::thread;
use std::time::Duration;

use foveal_host::atomic_file;
use foveal_host::claims::{self, Claim, Claims};
use foveal_host::failure::usage;

use super::frame_files::FrameJob;

/// Pause between two looks at frames that other jobs draw.
const PAUSE: Duration = Duration::from_millis(500);

/// One of several equal parts of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// As a job system says in the environment.
    Auto,
    /// Number from 0, and count.
    Of(u32, u32),
}

/// What job systems say: the job's number, where the numbers begin, their step, and the count.
const SYSTEMS: [[&str; 4]; 4] = [
    ["FOVEAL_PART", "", "", "FOVEAL_PARTS"],
    [
        "SLURM_ARRAY_TASK_ID",
        "SLURM_ARRAY_TASK_MIN",
        "SLURM_ARRAY_TASK_STEP",
        "SLURM_ARRAY_TASK_COUNT",
    ],
    ["JOB_COMPLETION_INDEX", "", "", "FOVEAL_PARTS"],
    [
        "AWS_BATCH_JOB_ARRAY_INDEX",
        "",
        "",
        "AWS_BATCH_JOB_ARRAY_SIZE",
    ],
];

impl Part {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let numbers = text
            .split_once('/')
            .and_then(|(part, count)| Some((part.parse().ok()?, count.parse().ok()?)));
        match numbers {
            Some((part, count)) if part < count => Ok(Self::Of(part, count)),
            _ => Err(format!(
                "'{text}' is no part: write its number, from 0, and the count, as in 0/4 to 3/4; or auto"
            )),
        }
    }

    /// The frames of this part; `variable` gives the environment's values.
    pub(super) fn of(
        self,
        range: &Range<u32>,
        variable: impl Fn(&str) -> Option<String>,
    ) -> anyhow::Result<Range<u32>> {
        let (part, count) = match self {
            Self::Of(part, count) => (part, count),
            Self::Auto => from_environment(variable)?,
        };
        let frames = u64::from(range.end - range.start);
        let place = |part: u32| {
            let frame = frames * u64::from(part) / u64::from(count);
            range.start + u32::try_from(frame).unwrap_or(u32::MAX)
        };
        Ok(place(part)..place(part + 1))
    }
}

fn from_environment(variable: impl Fn(&str) -> Option<String>) -> anyhow::Result<(u32, u32)> {
    for [index, first, step, count] in SYSTEMS {
        let Some(text) = variable(index) else {
            continue;
        };
        let number = |name: &str, default: Option<u32>| match variable(name) {
            None if default.is_some() => Ok(default.unwrap_or_default()),
            None => usage(format!(
                "--part auto: {index} is '{text}', but {count}, the count of jobs, is not set"
            )),
            Some(value) => value.parse::<u32>().or_else(|_| {
                usage(format!(
                    "--part auto: {name} is '{value}', which is no number"
                ))
            }),
        };
        let (index_number, first) = (number(index, None)?, number(first, Some(0))?);
        let (step, of) = (number(step, Some(1))?.max(1), number(count, None)?);
        return match index_number.checked_sub(first).map(|from| from / step) {
            Some(part) if part < of => Ok((part, of)),
            _ => usage(format!(
                "--part auto: {index} is {index_number}, beyond the {of} jobs of {count}"
            )),
        };
    }
    usage(
        "--part auto needs a job system: SLURM_ARRAY_TASK_ID, JOB_COMPLETION_INDEX (Kubernetes) with FOVEAL_PARTS, \
         AWS_BATCH_JOB_ARRAY_INDEX, or FOVEAL_PART with FOVEAL_PARTS",
    )
}

/// The frames of this job, one after the other.
pub(super) enum Turns {
    /// This job draws them all.
    Alone(std::vec::IntoIter<FrameJob>),
    /// Each goes to the job that claims it first.
    Shared(VecDeque<FrameJob>, Claims),
}

impl Turns {
    pub(super) fn alone(jobs: Vec<FrameJob>) -> Self {
        Self::Alone(jobs.into_iter())
    }

    /// `expiry`: how long another job's frame is left to it without a sign of life.
    pub(super) fn shared(jobs: Vec<FrameJob>, expiry: Duration) -> Self {
        Self::Shared(jobs.into(), Claims::new(expiry))
    }

    /// The next frame, with the claim to hold until it is written. Waits for frames that other jobs
    /// draw, so that none is lost where one of them ends; `None` when all frames are there.
    pub(super) fn next(&mut self) -> anyhow::Result<Option<(FrameJob, Option<Claim>)>> {
        let (open, claims) = match self {
            Self::Alone(jobs) => return Ok(jobs.next().map(|job| (job, None))),
            Self::Shared(open, claims) => (open, claims),
        };
        loop {
            for _ in 0..open.len() {
                let Some(job) = open.pop_front() else { break };
                let Some(file) = job.file.as_deref() else {
                    continue;
                };
                if atomic_file::is_finished(file) {
                    claims::remove_all(file);
                    continue;
                }
                match claims.take(file)? {
                    // Finished between the look and the claim.
                    Some(_) if atomic_file::is_finished(file) => {}
                    Some(claim) => return Ok(Some((job, Some(claim)))),
                    None => open.push_back(job),
                }
            }
            if open.is_empty() {
                return Ok(None);
            }
            thread::sleep(PAUSE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn none(_: &str) -> Option<String> {
        None
    }

    #[test]
    fn parts_make_the_whole() {
        for (range, count) in [(0..10, 3), (5..6, 4), (7..100, 1), (0..u32::MAX, u32::MAX)] {
            let part = |part| Part::Of(part, count).of(&range, none).unwrap();
            let mut at = range.start;
            for number in (0..count).take(5) {
                assert_eq!(part(number).start, at);
                at = part(number).end;
            }
            assert_eq!(part(count - 1).end, range.end);
        }
        assert_eq!(Part::parse("1/4"), Ok(Part::Of(1, 4)));
        assert_eq!(Part::parse("auto"), Ok(Part::Auto));
        for wrong in ["4/4", "1", "/2", "-1/2", "0/0", "a/b", ""] {
            assert!(Part::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn job_systems_say_which_part() {
        let part = |said: &[(&str, &str)]| {
            let variable = |name: &str| {
                let found = said.iter().find(|(key, _)| *key == name);
                found.map(|(_, value)| (*value).to_owned())
            };
            Part::Auto
                .of(&(0..100), variable)
                .map_err(|error| error.to_string())
        };
        let slurm = |id| {
            part(&[
                ("SLURM_ARRAY_TASK_ID", id),
                ("SLURM_ARRAY_TASK_MIN", "1"),
                ("SLURM_ARRAY_TASK_STEP", "2"),
                ("SLURM_ARRAY_TASK_COUNT", "4"),
            ])
        };
        assert_eq!(slurm("1"), Ok(0..25));
        assert_eq!(slurm("7"), Ok(75..100));
        assert!(slurm("9").unwrap_err().contains("beyond the 4 jobs"));
        assert!(slurm("x").unwrap_err().contains("'x', which is no number"));
        let kubernetes = [("JOB_COMPLETION_INDEX", "2"), ("FOVEAL_PARTS", "5")];
        assert_eq!(part(&kubernetes), Ok(40..60));
        let error = part(&kubernetes[..1]).unwrap_err();
        assert!(error.contains("FOVEAL_PARTS, the count of jobs"), "{error}");
        assert!(part(&[]).unwrap_err().contains("needs a job system"));
    }
}
