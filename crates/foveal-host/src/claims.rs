//! Claims: which of several jobs works on which file of a folder that they share.
//!
//! A claim on `frame.png` is the file `.frame.png.claim-0`. A file is created by one process alone,
//! on network folders too. The owner writes a byte to its claim every few seconds. A claim that does
//! not grow for the expiry's time belongs to a job that is dead; who takes its place creates
//! `.frame.png.claim-1`, and so on: of two jobs that see the same dead claim one alone gets the next
//! number. No clocks are compared.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use anyhow::Context;

/// Signs of life in an expiry's time.
const SIGNS: u32 = 8;

/// The claims of others, as this job has seen them.
#[derive(Debug)]
pub struct Claims {
    expiry: Duration,
    seen: HashMap<PathBuf, Seen>,
}

/// A claim of another job.
#[derive(Debug, PartialEq, Eq)]
struct Seen {
    number: u32,
    bytes: u64,
    since: Instant,
}

/// What this job works on. The claim ends when it is dropped.
#[derive(Debug)]
pub struct Claim {
    file: PathBuf,
    number: u32,
    /// Closed to end the signs of life.
    end: Option<Sender<()>>,
    signs: Option<JoinHandle<()>>,
}

impl Claims {
    /// `expiry`: how long a claim holds without a sign of life.
    #[must_use]
    pub fn new(expiry: Duration) -> Self {
        Self {
            expiry,
            seen: HashMap::new(),
        }
    }

    /// A claim on `file`; `None` while another job has one. Look for the file again after a claim:
    /// the job that had the last one may just have finished it.
    ///
    /// # Errors
    /// Names the file and the system's reason.
    pub fn take(&mut self, file: &Path) -> anyhow::Result<Option<Claim>> {
        let number = match newest(file)? {
            None => 0,
            Some((number, bytes)) if self.is_dead(file, number, bytes) => number + 1,
            Some(_) => return Ok(None),
        };
        let path = path_of(file, number);
        match File::options().write(true).create_new(true).open(&path) {
            Ok(opened) => Ok(Some(Claim::new(file, number, opened, self.expiry / SIGNS)?)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(None),
            Err(error) => Err(error).with_context(|| format!("cannot write '{}'", path.display())),
        }
    }

    /// Whether a claim has not grown for the expiry's time, as far as this job has looked.
    fn is_dead(&mut self, file: &Path, number: u32, bytes: u64) -> bool {
        match self.seen.get(file) {
            Some(seen) if (seen.number, seen.bytes) == (number, bytes) => {
                seen.since.elapsed() >= self.expiry
            }
            _ => {
                let since = Instant::now();
                let seen = Seen {
                    number,
                    bytes,
                    since,
                };
                self.seen.insert(file.to_owned(), seen);
                false
            }
        }
    }
}

/// Removes claims on a file that is finished: those of jobs that died before they could.
pub fn remove_all(file: &Path) {
    let count = (0..).take_while(|&number| path_of(file, number).exists());
    remove(file, count.count() as u32);
}

/// The claim that holds, by its number, and its length.
fn newest(file: &Path) -> anyhow::Result<Option<(u32, u64)>> {
    let mut newest = None;
    for number in 0.. {
        let path = path_of(file, number);
        // Reading asks a network folder's server, which looking at the length alone may not.
        match fs::read(&path) {
            Ok(bytes) => newest = Some((number, bytes.len() as u64)),
            Err(error) if error.kind() == ErrorKind::NotFound => break,
            Err(error) => {
                return Err(error).with_context(|| format!("cannot read '{}'", path.display()));
            }
        }
    }
    Ok(newest)
}

fn path_of(file: &Path, number: u32) -> PathBuf {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!(".{name}.claim-{number}"))
}

/// Removes the first `count` claims, the last one first, so that no number is left above a gap.
fn remove(file: &Path, count: u32) {
    for number in (0..count).rev() {
        let _ = fs::remove_file(path_of(file, number));
    }
}

impl Claim {
    fn new(file: &Path, number: u32, mut opened: File, pause: Duration) -> anyhow::Result<Self> {
        let (end, ended) = mpsc::channel();
        let mut claim = Self {
            file: file.to_owned(),
            number,
            end: Some(end),
            signs: None,
        };
        let signs = move || {
            while ended.recv_timeout(pause) == Err(RecvTimeoutError::Timeout) {
                // A folder that fails for a while may come back.
                let _ = opened.write_all(b".").and_then(|()| opened.sync_data());
            }
        };
        let thread = thread::Builder::new().name("claim".to_owned());
        claim.signs = Some(thread.spawn(signs).context("cannot start a thread")?);
        Ok(claim)
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        self.end = None;
        if let Some(signs) = self.signs.take() {
            let _ = signs.join();
        }
        remove(&self.file, self.number + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claims(expiry_ms: u64) -> Claims {
        Claims::new(Duration::from_millis(expiry_ms))
    }

    fn names(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn one_job_has_it_until_it_ends() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("f.png");
        let (mut one, mut other) = (claims(60_000), claims(60_000));
        let claim = one.take(&file).unwrap().unwrap();
        assert!(other.take(&file).unwrap().is_none());
        assert!(one.take(&file).unwrap().is_none());
        drop(claim);
        assert_eq!(names(folder.path()), 0);
        assert!(other.take(&file).unwrap().is_some());
    }

    #[test]
    fn one_job_alone_follows_a_dead_one() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("f.png");
        fs::write(path_of(&file, 0), "...").unwrap();
        let mut jobs: Vec<Claims> = (0..4).map(|_| claims(200)).collect();
        assert!(
            jobs.iter_mut()
                .all(|job| job.take(&file).unwrap().is_none())
        );
        thread::sleep(Duration::from_millis(250));
        let taken: Vec<Claim> = jobs
            .iter_mut()
            .filter_map(|job| job.take(&file).unwrap())
            .collect();
        assert_eq!((taken.len(), taken[0].number), (1, 1));
        drop(taken);
        assert_eq!(names(folder.path()), 0);
    }

    #[test]
    fn a_living_job_keeps_its_claim() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("f.png");
        let claim = claims(400).take(&file).unwrap().unwrap();
        let mut other = claims(4000);
        assert!(other.take(&file).unwrap().is_none());
        let before = newest(&file).unwrap();
        let start = Instant::now();
        while newest(&file).unwrap() == before {
            assert!(start.elapsed() < Duration::from_secs(30), "no sign of life");
            thread::sleep(Duration::from_millis(20));
        }
        // The sign begins the other's wait anew.
        assert!(!other.is_dead(&file, 0, newest(&file).unwrap().unwrap().1));
        drop(claim);
    }

    #[test]
    fn claims_of_the_dead_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("f.png");
        for number in 0..3 {
            fs::write(path_of(&file, number), "").unwrap();
        }
        remove_all(&file);
        assert_eq!(names(folder.path()), 0);
    }
}
