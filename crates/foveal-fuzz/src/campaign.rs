//! Running a target on changed inputs, watched for panics, time and memory.
//!
//! Input number n follows from the seeds and n alone, so that a failure is found again by its
//! number. A thread beside it watches the clock: an input that does not end is saved, and the
//! process ends.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::memory;
use crate::mutate::mutate;
use crate::random::Rng;
use crate::targets::Target;

/// Which inputs are tried, and what one of them may take.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// Number of the first input.
    pub first: u64,
    /// No input begins after this time.
    pub time: Duration,
    /// Most inputs.
    pub inputs: u64,
    /// Longest time of one input.
    pub patience: Duration,
    /// Good inputs beside the target's own.
    pub more_seeds: Vec<Vec<u8>>,
    /// Folder for inputs that fail, made when the first one does.
    pub failures: PathBuf,
    /// Whether the number of inputs is printed every minute.
    pub verbose: bool,
}

/// What a campaign found.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Inputs that were tried.
    pub inputs: u64,
    /// Longest time of one.
    pub longest: Duration,
    /// Most memory of one.
    pub most_bytes: u64,
    /// One per cause.
    pub failures: Vec<Failure>,
}

/// An input that failed.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Number of the input.
    pub number: u64,
    /// What happened.
    pub cause: String,
    /// Where the input was saved.
    pub file: PathBuf,
}

/// Where the last panic happened. The hook is the process's, so campaigns run one after the other.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());
static TURN: Mutex<()> = Mutex::new(());

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|broken| broken.into_inner())
}

impl Campaign {
    /// Of some seconds, from this input on.
    #[must_use]
    pub fn new(seconds: u64, first: u64) -> Self {
        Self {
            first,
            time: Duration::from_secs(seconds),
            inputs: u64::MAX,
            patience: Duration::from_secs(5),
            more_seeds: Vec::new(),
            failures: PathBuf::from("out/fuzz"),
            verbose: false,
        }
    }

    /// Tries inputs until time or number is used up. Of failures with the same cause the first one
    /// counts.
    ///
    /// # Panics
    /// Where the target has no seeds.
    #[must_use]
    pub fn run(&self, target: &Target) -> Outcome {
        let _turn = lock(&TURN);
        let mut seeds = (target.seeds)();
        seeds.extend(self.more_seeds.iter().cloned());
        assert!(!seeds.is_empty(), "{} has no seeds", target.name);
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(|panic| *lock(&LAST_PANIC) = panic.to_string()));
        let watch = Watch::default();
        let outcome = std::thread::scope(|scope| {
            scope.spawn(|| watch.run(self, target, &seeds));
            let outcome = self.inputs_of(target, &seeds, &watch);
            watch.end.store(true, Ordering::Release);
            outcome
        });
        std::panic::set_hook(usual);
        outcome
    }

    fn inputs_of(&self, target: &Target, seeds: &[Vec<u8>], watch: &Watch) -> Outcome {
        let mut outcome = Outcome::default();
        let mut causes = BTreeSet::new();
        let begin = Instant::now();
        let mut minutes = 0;
        while begin.elapsed() < self.time && outcome.inputs < self.inputs {
            let number = self.first.wrapping_add(outcome.inputs);
            let input = input(seeds, number);
            let tried = watch.tried(number, || try_input(target, &input, self.patience));
            outcome.inputs += 1;
            outcome.longest = outcome.longest.max(tried.time);
            outcome.most_bytes = outcome.most_bytes.max(tried.bytes);
            if let Some(cause) = tried.cause
                && causes.insert(kind_of(&cause))
            {
                let file = self.save(target, number, &input);
                outcome.failures.push(Failure {
                    number,
                    cause,
                    file,
                });
            }
            if self.verbose && begin.elapsed().as_secs() / 60 > minutes {
                minutes += 1;
                eprintln!("{}: {} inputs", target.name, outcome.inputs);
            }
        }
        outcome
    }

    fn save(&self, target: &Target, number: u64, input: &[u8]) -> PathBuf {
        let file = self.failures.join(format!("{}-{number}", target.name));
        let saved =
            std::fs::create_dir_all(&self.failures).and_then(|()| std::fs::write(&file, input));
        if let Err(error) = saved {
            eprintln!("{} cannot be written: {error}", file.display());
        }
        file
    }
}

/// The input of this number.
fn input(seeds: &[Vec<u8>], number: u64) -> Vec<u8> {
    let mut rng = Rng(number);
    let mut input = seeds[rng.below(seeds.len())].clone();
    mutate(&mut input, &mut rng);
    input
}

/// Causes that differ by numbers alone are one.
fn kind_of(cause: &str) -> String {
    let line = cause.lines().next().unwrap_or_default();
    line.chars().take(200).collect()
}

struct Tried {
    time: Duration,
    bytes: u64,
    cause: Option<String>,
}

fn try_input(target: &Target, input: &[u8], patience: Duration) -> Tried {
    let before = memory::begin();
    let start = Instant::now();
    let ended = catch_unwind(AssertUnwindSafe(|| (target.run)(input)));
    let time = start.elapsed();
    let bytes = memory::peak_since(before);
    let cause = if ended.is_err() {
        Some(std::mem::take(&mut *lock(&LAST_PANIC)))
    } else if time > patience {
        Some(format!("took too long\n{time:?}"))
    } else if bytes > target.max_bytes {
        Some(format!(
            "took too much memory\n{bytes} bytes, the limit is {}",
            target.max_bytes
        ))
    } else {
        None
    };
    Tried { time, bytes, cause }
}

/// What the thread beside a campaign looks at.
#[derive(Default)]
struct Watch {
    /// Odd while an input is tried.
    step: AtomicU64,
    number: AtomicU64,
    end: AtomicBool,
}

impl Watch {
    fn tried(&self, number: u64, what: impl FnOnce() -> Tried) -> Tried {
        self.number.store(number, Ordering::Relaxed);
        self.step.fetch_add(1, Ordering::AcqRel);
        let tried = what();
        self.step.fetch_add(1, Ordering::AcqRel);
        tried
    }

    fn run(&self, campaign: &Campaign, target: &Target, seeds: &[Vec<u8>]) {
        let (mut seen, mut since) = (0, Instant::now());
        while !self.end.load(Ordering::Acquire) {
            std::thread::sleep(Duration::from_millis(20));
            let step = self.step.load(Ordering::Acquire);
            if step != seen {
                (seen, since) = (step, Instant::now());
            }
            // Time for an input that is slow, and that the campaign then notes by itself.
            if step % 2 == 1 && since.elapsed() > 4 * campaign.patience {
                let number = self.number.load(Ordering::Relaxed);
                let file = campaign.save(target, number, &input(seeds, number));
                eprintln!(
                    "{}: input {number} has not ended after {:?}; it is saved as {}",
                    target.name,
                    since.elapsed(),
                    file.display()
                );
                std::process::exit(3);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(run: fn(&[u8])) -> Target {
        Target {
            name: "made",
            run,
            seeds: || vec![b"{\"a\": 1}".to_vec(), b"{\"b\": [2, 3]}".to_vec()],
            max_bytes: 1 << 40,
        }
    }

    fn campaign(inputs: u64) -> Campaign {
        Campaign {
            inputs,
            failures: std::env::temp_dir().join(format!("foveal-fuzz-{}", std::process::id())),
            ..Campaign::new(600, 0)
        }
    }

    #[test]
    fn a_panic_is_found_once_saved_and_found_again_by_its_number() {
        fn run(input: &[u8]) {
            assert!(!input.contains(&b'9'), "a nine among {}", input.len());
        }
        let outcome = campaign(3000).run(&target(run));
        assert_eq!(outcome.inputs, 3000);
        assert_eq!(outcome.failures.len(), 1, "{:?}", outcome.failures);
        let failure = &outcome.failures[0];
        assert!(failure.cause.contains("a nine among"), "{failure:?}");
        let saved = std::fs::read(&failure.file).unwrap_or_default();
        assert!(saved.contains(&b'9'));
        let campaign = Campaign {
            first: failure.number,
            ..campaign(1)
        };
        assert_eq!(campaign.run(&target(run)).failures.len(), 1);
        let removed = std::fs::remove_dir_all(&campaign.failures);
        assert!(removed.is_ok());
    }

    #[test]
    fn an_input_that_takes_long_is_found() {
        let slow = target(|_| std::thread::sleep(Duration::from_millis(30)));
        let campaign = Campaign {
            patience: Duration::from_millis(10),
            failures: std::env::temp_dir().join(format!("foveal-fuzz-slow-{}", std::process::id())),
            ..campaign(2)
        };
        let outcome = campaign.run(&slow);
        let _ = std::fs::remove_dir_all(&campaign.failures);
        assert!(outcome.failures[0].cause.contains("too long"));
        assert!(outcome.longest >= Duration::from_millis(30));
    }

    #[test]
    fn inputs_follow_from_their_number() {
        let seeds = (target(|_| {}).seeds)();
        let all: BTreeSet<Vec<u8>> = (0..200).map(|n| input(&seeds, n)).collect();
        assert!(all.len() > 150, "{}", all.len());
        assert_eq!(input(&seeds, 7), input(&seeds, 7));
    }
}
